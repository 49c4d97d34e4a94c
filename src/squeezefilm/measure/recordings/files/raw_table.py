"""The numbers of a file as columns with names, before anybody says what they are."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, QuantityError

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
    def known_names(self) -> list[str]:
        """Names by which columns may be called: their names, whole and without a unit."""
        bare = [parted(name)[0] for name in self.names]
        return [name for name in (*bare, *self.names) if name]

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
