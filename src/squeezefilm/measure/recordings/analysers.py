"""The export of an impedance analyser (Agilent and Keysight 4294A): a head that says what was
measured, then one table a trace."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from squeezefilm.errors import ConfigError
from squeezefilm.hard_limits import RECORDING_BYTES
from squeezefilm.measure.recordings.raw_table import RawTable
from squeezefilm.measure.recordings.text_table import decoded
from squeezefilm.regular_file import opened

_HEAD = re.compile(r"\s*\"?4294A\b")
_SAID = re.compile(r'\s*"([^":]+):\s*([^"]*)"\s*$')
# What the head says was measured, and what traces A and B then hold. Others were never seen here.
_PARAMETERS: dict[str, tuple[tuple[str, str], tuple[str, str]]] = {
    "IMPEDANCE MAG PHASE (DEG)": (("magnitude", "ohm"), ("phase", "deg")),
}


def is_4294a(path: Path) -> bool:
    """Whether a file begins as the analyser's export does."""
    try:
        with opened(path, RECORDING_BYTES, "a recording") as handle:
            return _HEAD.match(os.read(handle, 40).decode("latin-1")) is not None
    except (ConfigError, OSError):
        return False


@dataclass(frozen=True)
class _Trace:
    """One trace as it stands in the file: its letter, the rows and their lines."""

    letter: str
    rows: list[tuple[float, float, float]]
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
        numbers = np.array(trace.rows).reshape(-1, 3)
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
        columns += [numbers[:, 1], numbers[:, 2]]
        names += [f"{trace.letter} real", f"{trace.letter} imaginary"]
    notes += [f"the analyser says {key.lower()}: {value}" for key, value in head.items()
              if key in ("OSC LEVEL", "DC BIAS", "SWEEP TYPE")]  # fmt: skip
    table = RawTable(
        file=path,
        format=f"4294A export, {head.get('MEASURE PARAMETER', 'parameter not said')}",
        names=tuple(names),
        values=np.stack(columns, axis=1),
        lines=np.array(first.lines),
        notes=tuple(notes),
        described=_described(head, names),
    )
    table.require_finite()
    return table


def _described(head: dict[str, str], names: Sequence[str]) -> tuple[tuple[str, str, str], ...]:
    """Which column holds what by the analyser's own words; nothing for a parameter not known."""
    meant = _PARAMETERS.get(head.get("MEASURE PARAMETER", ""))
    if meant is None or "A real" not in names or "B real" not in names:
        return ()
    (first, first_unit), (second, second_unit) = meant
    return (
        ("frequency", "Frequency", "Hz"),
        (first, "A real", first_unit),
        (second, "B real", second_unit),
    )


def _read(lines: Sequence[str], path: Path) -> tuple[dict[str, str], list[_Trace]]:
    """What the head says, and the traces."""
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
            traces[-1].rows.append(_row(line, number, path))
            traces[-1].lines.append(number)
    return head, traces


def _row(line: str, number: int, path: Path) -> tuple[float, float, float]:
    cells = line.split()
    if len(cells) != 3:
        raise ConfigError(
            f"has {len(cells)} cells, and a row of a trace has three (frequency, real, imaginary); "
            "export it again",
            file=path,
            line=number,
            column=min(len(cells), 3),
        )
    found = []
    for column, cell in enumerate(cells, 1):
        try:
            value = float(cell)
        except ValueError:
            value = float("nan")
        if not np.isfinite(value):
            raise ConfigError(
                f"'{cell[:40]}' is no finite number", file=path, line=number, column=column
            )
        found.append(value)
    return found[0], found[1], found[2]
