"""Instruments recognised by the first lines of their exports, and what the columns of a table hold
by their names: the table `instruments.toml`, read here."""

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
from squeezefilm.core.errors import ConfigError
from squeezefilm.measure.recordings.circuits_read import IMPEDANCES, SIZES
from squeezefilm.measure.recordings.files.raw_table import Held, RawTable, parted

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
    if instrument is None:
        return list(lines)
    kept = list(lines)
    if instrument.begin:
        begins = [k for k, line in enumerate(lines) if re.match(instrument.begin, line)]
        first = begins[0] if begins else -1
        ends = [k for k in range(first + 1, len(lines)) if re.match(instrument.end, lines[k])]
        if begins and not ends:
            raise ConfigError(
                f"the table that begins in line {first + 1} has no end: the file is cut short; "
                "export it again"
            )
        last = ends[0] if ends else len(lines)
        kept = [line if first < k < last else "" for k, line in enumerate(lines)]
    return kept


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
    described = table.described or held_by(table.names)
    described = tuple(_turned(table, *held) for held in described)
    table = replace(table, described=described)
    return (
        table
        if instrument is None
        else replace(
            table,
            format=f"{instrument.name}, {table.format}",
            sure=True,
            instrument=instrument.name,
            specified=instrument.range,
        )
    )


def _turned(table: RawTable, quantity: str, column: str | int, unit: str) -> Held:
    """What a column holds, a phase without a unit of its own in rad where it stays within π."""
    at = table.index(column)
    if quantity == "phase" and at is not None and table.unit_in_name(at) is None:
        unit = "rad" if np.max(np.abs(table.values[:, at])) < np.pi else unit
    return quantity, column, unit
