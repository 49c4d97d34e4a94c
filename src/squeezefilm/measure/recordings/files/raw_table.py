"""Columns of a file by their names: units in them, what they hold (`instruments.toml`), and the
instruments that are recognised by the first lines of their exports."""

from __future__ import annotations

import functools
import itertools
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, QuantityError
from squeezefilm.measure.recordings.circuits_read import IMPEDANCES, SIZES

# In brackets that stand in no others; else behind "in", a stroke, or an underscore (there of two
# letters or more: "R_s" is a resistance in series).
_UNIT = re.compile(
    r"\s*(?<![(\[])[(\[]\s*([^()\[\]]*?)\s*[)\]]"
    r"|(?:\s+in\s+|\s*/\s*)([a-zA-ZµμΩ°%]+)$|_([a-zA-ZµμΩ°]{2,})$"
)
_SYMBOLS: dict[str, str] = tomllib.loads(
    Path(__file__).with_name("units.toml").read_text(encoding="utf-8")
)

Held = tuple[str, str | int, str]
"""A quantity, the column that holds it (name, or number from 1), and its unit."""


@dataclass(frozen=True, eq=False)
class RawTable:
    """Columns of a file with their names ("" where it names none), shape of `values` (rows,
    columns).

    `lines` are the rows' lines in the file, counted from 1 (None in a file that has no lines),
    `header_line` that of the names. `format` is what the file was read as; `notes` and `doubts` are
    what a person should know of the reading. `described` are the quantities that the file itself
    says its columns hold, `sure` where its head names the `instrument`, which is `specified` from
    and to these frequencies (Hz); `reference` (Ω) is that of its waves. `moved` is the motion that
    each column holds ("velocity", ""), where the file says that.

    Raises `ConfigError` for a table without a row, and at the place of what is no finite number.
    """

    file: Path
    format: str
    names: tuple[str, ...]
    values: si.FloatArray
    lines: si.IntArray | None = None
    header_line: int | None = None
    notes: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()
    described: tuple[Held, ...] = ()
    sure: bool = False
    reference: si.Ohm = 50.0
    instrument: str = ""
    specified: tuple[float, float] | None = None
    moved: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.values.size:
            raise self.error("holds no numbers; give a file with a table of them")
        bad = np.argwhere(~np.isfinite(self.values))
        if bad.size:
            row, column = (int(index) for index in bad[0])
            value = self.values[row, column]
            raise self.error(
                f"{value} is no finite number; leave the whole row out where nothing was measured "
                f"({len(bad)} such in this file)",
                row,
                column,
            )

    def error(self, message: str, row: int | None = None, column: int | None = None) -> ConfigError:
        """An error at a row and a column (both from 0), with the line and the column from 1."""
        line = None
        if row is not None and self.lines is not None:
            line = int(self.lines[row])
        elif row is not None:
            message = f"value {row + 1}: {message}"
        at = None if column is None else column + 1
        return ConfigError(message, file=self.file, line=line, column=at)

    def outside(self, frequency: si.HertzArray) -> str | None:
        """A doubt about a sweep that leaves the frequencies for which its instrument is
        specified."""
        if self.specified is None:
            return None
        low, high = self.specified
        if low <= frequency[0] and frequency[-1] <= high:
            return None
        swept, specified = (
            " to ".join(si.format_quantity(float(end), si.Unit("Hz")) for end in pair)
            for pair in ((frequency[0], frequency[-1]), self.specified)
        )
        return f"the sweep goes from {swept}; the {self.instrument} is specified from {specified}"

    def index(self, wanted: str | int) -> int | None:
        """The place (from 0) of a column by its number from 1, or by its name; None if none is so
        called. A unit in a name may be left out."""
        if isinstance(wanted, int):
            return wanted - 1 if 1 <= wanted <= self.values.shape[1] else None
        for reading in (str, _folded, lambda name: _folded(parted(name)[0])):
            places = [k for k, name in enumerate(self.names) if reading(name) == reading(wanted)]
            if len(places) == 1:
                return places[0]
        return None

    def unit_in_name(self, column: int) -> str | None:
        """The unit that a column's name holds, where it is one that is known."""
        unit = parted(self.names[column])[1]
        return unit if is_unit(unit) else None

    @property
    def columns_in_words(self) -> str:
        """The columns by number and name, for messages."""
        shown = (f"{k} '{name}'" if name else f"{k}" for k, name in enumerate(self.names, 1))
        return ", ".join(shown)


def parted(name: str) -> tuple[str, str]:
    """A column's name without its unit, and the unit ("dB" among them); "" where it has none."""
    for match in reversed(list(_UNIT.finditer(name))):
        symbol = (match[1] if match[1] is not None else match[2] or match[3]).strip()
        symbol = _SYMBOLS.get(symbol.casefold(), symbol)
        # Of two channels over another "A" and the like are no ampere.
        if (symbol.startswith("dB") or is_unit(symbol)) and not (match[2] and symbol == "A"):
            return (name[: match.start()] + name[match.end() :]).strip(), symbol
    return name.strip(), ""


def unit_alone(cell: str) -> str:
    """The unit that a cell holds and nothing else; "" where it does not."""
    bare, unit = parted(f"({cell.strip('()[] ')})")
    # The word is a column's name, in the heads of oscilloscopes.
    return "" if bare or cell.casefold() == "second" else unit


def is_unit(symbol: str) -> bool:
    """True where a symbol is a unit that is known."""
    try:
        si.parse_unit(symbol)
    except QuantityError:
        return False
    return True


def _folded(name: str) -> str:
    return " ".join(name.split()).casefold()


_HEAD_CHARACTERS = 4000
_BESIDE_A_NAME = re.compile(r"^trace\s*\d*\s*:?\s*|^tr\d+\s+|[-_ ]data$|^measurement\s*:?\s*")


@dataclass(frozen=True)
class Instrument:
    """An entry of the table: see there."""

    name: str
    head: str
    range: tuple[float, float] | None = None
    begin: str = ""
    end: str = ""
    names: tuple[str, ...] = ()
    single: bool = False
    counted: bool = False
    start: str = ""
    step: str = ""


# The quantity that names like these say, and the unit meant where a name has none.
_Word = tuple[str, re.Pattern[str], str]


@functools.cache
def _tables() -> tuple[tuple[Instrument, ...], tuple[_Word, ...]]:
    text = Path(__file__).with_name("instruments.toml").read_text(encoding="utf-8")
    tree = tomllib.loads(text)
    instruments = []
    for entry in tree["instrument"]:
        entry |= {key: tuple(entry[key]) for key in ("range", "names") if key in entry}
        instruments.append(Instrument(**entry))
    words = tuple((w["quantity"], re.compile(w["names"]), w["unit"]) for w in tree["column"])
    return tuple(instruments), words


def recognised(text: str) -> Instrument | None:
    """The instrument whose export begins as a text does; None for one that is not known."""
    head = text[:_HEAD_CHARACTERS]
    for instrument in _tables()[0]:
        if re.search(instrument.head, head, re.MULTILINE | re.IGNORECASE):
            return instrument
    return None


def held_by(names: Sequence[str]) -> tuple[Held, ...]:
    """Quantities that columns with these names hold: frequency with the first pair that makes an
    impedance, or time with voltages; nothing where the names do not say."""
    quantities: dict[str, list[tuple[int, str]]] = {}
    for number, name in enumerate(names, 1):
        if held := read_name(name):
            quantities.setdefault(held[0], []).append((number, held[1]))
    if "frequency" in quantities:
        wanted = _pair(quantities)
        chosen = [("frequency", quantities["frequency"][0])] if wanted else []
        # Of an analyser with two channels the second is that over the first.
        chosen += [
            (name, quantities[name][-1 if name in ("gain", "phase") else 0]) for name in wanted
        ]
    elif "time" in quantities:
        chosen = [("time", quantities["time"][0])]
        chosen += [("voltage", place) for place in quantities.get("voltage", [])]
    else:
        return ()
    return tuple((name, _column(names, number), unit) for name, (number, unit) in chosen)


def _pair(quantities: Mapping[str, object]) -> tuple[str, ...]:
    for wanted in (*IMPEDANCES, *((name,) for name in SIZES)):
        if all(name in quantities for name in wanted):
            return wanted
    return ()


def _column(names: Sequence[str], number: int) -> str | int:
    """A column by its name where that is its own, or by its number."""
    name = names[number - 1]
    alike = [other for other in names if other.casefold() == name.casefold()]
    return name if len(alike) == 1 and '"' not in name and "\\" not in name else number


def read_name(name: str) -> tuple[str, str] | None:
    """The quantity that a column's name says, with its unit; None for a name that says none."""
    bare, unit = parted(name)
    bare = _BESIDE_A_NAME.sub("", " ".join(bare.casefold().split()))
    bare = _BESIDE_A_NAME.sub("", bare).strip(" _:-−")
    readings = bare, bare.replace("_", " "), bare.rpartition(":")[2].strip()
    for reading, (quantity, names, usual) in itertools.product(readings, _tables()[1]):
        meant = unit or usual
        if meant == "dB" and usual in ("ohm", "S"):
            meant = f"dB re 1 {usual}"
        elif meant == "S" and usual == "s":
            # Seconds and siemens, both "(S)" in one maker's files.
            meant = "s"
        if names.fullmatch(reading) and _fits(meant, usual):
            return quantity, meant
    return None


def _fits(unit: str, usual: str) -> bool:
    """True where a unit is one of what is usually told in another."""
    if "dB" in unit + usual:
        return unit in (usual, f"dB re 1 {usual}") or (unit, usual) == ("dB", "1")
    return si.parse_unit(unit)[1] == si.parse_unit(usual)[1]


def table_lines(lines: Sequence[str], instrument: Instrument | None) -> list[str]:
    """The lines of a file with those blanked that stand outside the first table."""
    if instrument is None or not instrument.begin:
        return list(lines)
    begins = [k for k, line in enumerate(lines) if re.match(instrument.begin, line)]
    first = begins[0] if begins else -1
    ends = [k for k in range(first + 1, len(lines)) if re.match(instrument.end, lines[k])]
    if begins and not ends:
        raise ConfigError(
            f"the table that begins in line {first + 1} has no end: the file is cut short; export "
            "it again"
        )
    last = ends[0] if ends else len(lines)
    return [line if first < k < last else "" for k, line in enumerate(lines)]


def times_of(text: str, instrument: Instrument) -> tuple[float, float] | None:
    """The first time and the interval (s) that a head says; None where rows hold their times."""
    if not instrument.step:
        return None
    head = text[:_HEAD_CHARACTERS]
    matches = [
        re.search(pattern, head, re.MULTILINE | re.IGNORECASE) if pattern else ("", "0")
        for pattern in (instrument.start, instrument.step)
    ]
    try:
        start, step = (float(match[1]) if match else float("nan") for match in matches)
    except ValueError:
        start, step = float("nan"), float("nan")
    if not step > 0 or start != start:
        raise ConfigError(
            f"the head of the {instrument.name} does not say the first time and the interval; "
            "export it again, with times"
        )
    return start, step


def with_meaning(table: RawTable, instrument: Instrument | None) -> RawTable:
    """A table with what its columns hold by their names, and the instrument that wrote it."""
    described = tuple(_turned(table, *held) for held in held_by(table.names))
    if instrument is None:
        return replace(table, described=described)
    return replace(
        table,
        described=described,
        format=f"{instrument.name}, {table.format}",
        sure=True,
        instrument=instrument.name,
        specified=instrument.range,
    )


def _turned(table: RawTable, quantity: str, column: str | int, unit: str) -> Held:
    """What a column holds, a phase without a unit of its own in rad where it stays within π."""
    at = table.index(column)
    if quantity == "phase" and at is not None and table.unit_in_name(at) is None:
        unit = "rad" if np.max(np.abs(table.values[:, at])) < np.pi else unit
    return quantity, column, unit
