"""The export of an impedance analyser (Agilent and Keysight 4294A): a head that says what was
measured, then one table a trace."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError
from squeezefilm.core.hard_limits import RECORDING_BYTES
from squeezefilm.core.regular_file import opened
from squeezefilm.measure.recordings.circuits_read import IMPEDANCES
from squeezefilm.measure.recordings.files.instruments import read_name
from squeezefilm.measure.recordings.files.raw_table import Held, RawTable
from squeezefilm.measure.recordings.files.text_table import Notation, decoded, values_in

_HEAD = re.compile(r"\s*\"?4294A\b")
_SAID = re.compile(r'\s*"([^":]+):\s*([^"]*)"\s*$')
_COLUMNS = ("real", "imaginary", "memory real", "memory imaginary")
# What a trace holds by a word of the head's parameter, as columns are called.
_TRACED = {name for pair in IMPEDANCES for name in pair} - {"phase", "gain"}
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
    rows: si.FloatArray
    lines: list[int]


def read_4294a(path: Path) -> RawTable:
    """The table of an export: frequency and, of each trace, real and imaginary part.

    Raises `ConfigError`, with line and column, for a cell that is no finite number, a trace that
    has another count of points than the head says, and traces of different frequencies.
    """
    text, notes = decoded(path)
    head, traces = _read(text.split("\n"))
    if not traces:
        raise ConfigError('holds no trace; the export has lines "TRACE: A" with rows below')
    points = head.get("NUMBER of POINTS", "")
    for trace in traces:
        if points.isdigit() and len(trace.rows) != int(points):
            raise ConfigError(
                f"trace {trace.letter} has {len(trace.rows)} points, and the head says {points}: "
                "the file is cut short or was changed; export it again",
                line=trace.lines[-1] if trace.lines else None,
            )
    first = traces[0]
    if not first.lines:
        raise ConfigError(f"trace {first.letter} has no points; export it again")
    frequency = first.rows[:, 0]
    columns, names = [frequency], ["Frequency"]
    for trace in traces:
        numbers = trace.rows
        if not np.array_equal(numbers[:, :1].ravel(), frequency):
            raise ConfigError(
                f"trace {trace.letter} is at other frequencies than trace {first.letter}; export "
                "both of one sweep",
                line=trace.lines[0] if trace.lines else None,
            )
        columns += list(numbers[:, 1:].T)
        names += [f"{trace.letter} {part}" for part in _COLUMNS[: numbers.shape[1] - 1]]
    notes += [
        f"the analyser says {key.lower()}: {value}"
        for key, value in head.items()
        if key in ("OSC LEVEL", "DC BIAS", "SWEEP TYPE")
    ]
    return RawTable(
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


def _described(head: dict[str, str], names: Sequence[str]) -> tuple[Held, ...]:
    """Quantities of the columns by the analyser's own words; nothing for a parameter not known, or
    one that leaves the sign of the reactance open."""
    said = head.get("MEASURE PARAMETER", "").upper()
    words = re.findall(r"\|?[A-Z]+\|?", said)
    known = [held for word in words if (held := read_name(word)) and held[0] in _TRACED]
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


def _read(lines: Sequence[str]) -> tuple[dict[str, str], list[_Trace]]:
    """Words of the head, and the traces."""
    head: dict[str, str] = {}
    traces: list[tuple[str, list[tuple[int, str]]]] = []
    for number, line in enumerate(lines, 1):
        if not line.strip() or _HEAD.match(line):
            continue
        if match := _SAID.match(line):
            if match[1] == "TRACE":
                traces.append((match[2].strip(), []))
            elif not traces:
                head[match[1]] = match[2].strip()
        elif traces and not line.lstrip().startswith('"'):
            traces[-1][1].append((number, line))
    return head, [_trace(letter, rows) for letter, rows in traces]


def _trace(letter: str, rows: Sequence[tuple[int, str]]) -> _Trace:
    count = len(rows[0][1].split()) if rows else 0
    notation = Notation(None, ".", count, tuple(range(count)))
    return _Trace(letter, values_in(rows, notation), [number for number, _ in rows])
