"""The export of an impedance analyser (Agilent and Keysight 4294A): a head that says what was
measured, then one table a trace."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from squeezefilm.core.errors import ConfigError
from squeezefilm.core.hard_limits import RECORDING_BYTES
from squeezefilm.core.regular_file import opened
from squeezefilm.measure.recordings.circuits_read import IMPEDANCES
from squeezefilm.measure.recordings.files.raw_table import Held, RawTable
from squeezefilm.measure.recordings.files.text_table import decoded

_HEAD = re.compile(r"\s*\"?4294A\b")
_SAID = re.compile(r'\s*"([^":]+):\s*([^"]*)"\s*$')
_COLUMNS = ("real", "imaginary", "memory real", "memory imaginary")
# What traces A and B hold, by the words of the head's parameter.
_SYMBOLS = {
    "LS": ("series_inductance", "H"),
    "LP": ("parallel_inductance", "H"),
    "CS": ("series_capacitance", "F"),
    "CP": ("parallel_capacitance", "F"),
    "RS": ("resistance", "ohm"),
    "R": ("resistance", "ohm"),
    "RP": ("parallel_resistance", "ohm"),
    "X": ("reactance", "ohm"),
    "G": ("conductance", "S"),
    "B": ("susceptance", "S"),
    "Q": ("quality_factor", "1"),
    "D": ("dissipation_factor", "1"),
    "|Z|": ("magnitude", "ohm"),
    "Z": ("magnitude", "ohm"),
    "IMPEDANCE": ("magnitude", "ohm"),
    "|Y|": ("admittance_magnitude", "S"),
    "Y": ("admittance_magnitude", "S"),
    "ADMITTANCE": ("admittance_magnitude", "S"),
}
_PARTS = {"ohm": ("resistance", "reactance"), "S": ("conductance", "susceptance")}


def is_4294a(path: Path) -> bool:
    """True where a file begins as the analyser's export does."""
    try:
        with opened(path, RECORDING_BYTES, "a recording") as handle:
            return _HEAD.match(os.read(handle, 40).decode("latin-1")) is not None
    except (ConfigError, OSError):
        return False


@dataclass(frozen=True)
class _Trace:
    """A trace as it stands in the file: its letter, the rows and their lines."""

    letter: str
    rows: list[tuple[float, ...]]
    lines: list[int]


def read_4294a(path: Path) -> RawTable:
    """The table of an export: frequency and, of each trace, real and imaginary part.

    Raises `ConfigError`, with line and column, for a cell that is no finite number, a trace that
    has another count of points than the head says, and traces of different frequencies.
    """
    text, notes = decoded(path)
    head, traces = _read(text.split("\n"), path)
    if not traces:
        raise ConfigError(
            'holds no trace; the export has lines "TRACE: A" with rows below', file=path
        )
    points = head.get("NUMBER of POINTS", "")
    for trace in traces:
        if points.isdigit() and len(trace.rows) != int(points):
            raise ConfigError(
                f"trace {trace.letter} has {len(trace.rows)} points, and the head says {points}: "
                "the file is cut short or was changed; export it again",
                file=path,
                line=trace.lines[-1] if trace.lines else None,
            )
    first = traces[0]
    frequency = np.array([row[0] for row in first.rows])
    columns, names = [frequency], ["Frequency"]
    for trace in traces:
        numbers = np.array(trace.rows).reshape(len(trace.rows), -1)
        other = (
            np.flatnonzero(numbers[:, 0] != frequency)
            if numbers.shape[0] == frequency.size
            else [0]
        )
        if len(other):
            raise ConfigError(
                f"trace {trace.letter} is at other frequencies than trace {first.letter}; export "
                "both of one sweep",
                file=path,
                line=trace.lines[int(other[0])],
                column=1,
            )
        columns += list(numbers[:, 1:].T)
        names += [f"{trace.letter} {part}" for part in _COLUMNS[: numbers.shape[1] - 1]]
    notes += [
        f"the analyser says {key.lower()}: {value}"
        for key, value in head.items()
        if key in ("OSC LEVEL", "DC BIAS", "SWEEP TYPE")
    ]
    table = RawTable(
        file=path,
        format=f"4294A export, {head.get('MEASURE PARAMETER', 'parameter not said')}",
        names=tuple(names),
        values=np.stack(columns, axis=1),
        lines=np.array(first.lines),
        notes=tuple(notes),
        described=_described(head, names),
        sure=True,
        instrument="4294A",
        specified=(40.0, 110e6),
    )
    table.require_finite()
    return table


def _described(head: dict[str, str], names: Sequence[str]) -> tuple[Held, ...]:
    """Quantities of the columns by the analyser's own words; nothing for a parameter not known, or
    one that leaves the sign of the reactance open."""
    said = head.get("MEASURE PARAMETER", "").upper()
    words = re.findall(r"\|?[A-Z]+\|?", said)
    known = [_SYMBOLS[word] for word in words if word in _SYMBOLS]
    if "A real" not in names or not known:
        return ()
    if {"COMPLEX", "COMP"} & set(words):
        meant = [(part, "ohm") for part in _PARTS["ohm"]]
        return _held(meant, ("A real", "A imaginary"))
    if {"REAL", "IMAG"} <= set(words) or {"REAL", "IMAGINARY"} <= set(words):
        meant = [(part, known[0][1]) for part in _PARTS[known[0][1]]]
    elif {"PHASE", "THETA"} & set(words) or "Θ" in said:
        meant = [known[0], ("phase", "rad" if "RAD" in words else "deg")]
    else:
        meant = known
    if tuple(name for name, _ in meant) not in IMPEDANCES or "B real" not in names:
        return ()
    return _held(meant, ("A real", "B real"))


def _held(meant: Sequence[tuple[str, str]], columns: Sequence[str]) -> tuple[Held, ...]:
    pairs = zip(meant, columns, strict=True)
    return (("frequency", "Frequency", "Hz"), *((name, at, unit) for (name, unit), at in pairs))


def _read(lines: Sequence[str], path: Path) -> tuple[dict[str, str], list[_Trace]]:
    """Words of the head, and the traces."""
    head: dict[str, str] = {}
    traces: list[_Trace] = []
    for number, line in enumerate(lines, 1):
        if not line.strip() or _HEAD.match(line):
            continue
        if match := _SAID.match(line):
            if match[1] == "TRACE":
                traces.append(_Trace(match[2].strip(), [], []))
            elif not traces:
                head[match[1]] = match[2].strip()
        elif traces and not line.lstrip().startswith('"'):
            rows = traces[-1].rows
            rows.append(_row(line, number, path, len(rows[0]) if rows else 0))
            traces[-1].lines.append(number)
    return head, traces


def _row(line: str, number: int, path: Path, cells_before: int) -> tuple[float, ...]:
    cells = line.split()
    if len(cells) not in (3, 5) or len(cells) != (cells_before or len(cells)):
        raise ConfigError(
            f"has {len(cells)} cells, and a row of a trace has three (frequency, real, imaginary), "
            "or five with a trace in memory; export it again",
            file=path,
            line=number,
            column=min(len(cells), 3),
        )
    numbers = []
    for column, cell in enumerate(cells, 1):
        try:
            value = float(cell)
        except ValueError:
            value = float("nan")
        if not np.isfinite(value):
            raise ConfigError(
                f"'{cell[:40]}' is no finite number", file=path, line=number, column=column
            )
        numbers.append(value)
    return tuple(numbers)
