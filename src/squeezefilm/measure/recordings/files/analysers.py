"""Files of analysers that say themselves what they hold: the export of an impedance analyser
(Agilent and Keysight 4294A), a head and one table a trace; and Touchstone files of one or two ports
(.s1p, .s2p, versions 1 and 2), as network analysers and NanoVNAs write them."""

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
from squeezefilm.measure.recordings.files.raw_table import Held, RawTable, read_name, recognised
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
        return _traces_held(meant, ("A real", "A imaginary"))
    if {"REAL", "IMAG"} <= set(words) or {"REAL", "IMAGINARY"} <= set(words):
        meant = [(part, known[0][1]) for part in _PARTS[known[0][1]]]
    elif {"PHASE", "THETA"} & set(words) or "Θ" in said:
        meant = [known[0], ("phase", "rad" if "RAD" in words else "deg")]
    else:
        meant = known
    if tuple(name for name, _ in meant) not in IMPEDANCES or "B real" not in names:
        return ()
    return _traces_held(meant, ("A real", "B real"))


def _traces_held(meant: Sequence[tuple[str, str]], columns: Sequence[str]) -> tuple[Held, ...]:
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


TOUCHSTONE = re.compile(r"\.[sSyYzZ]([12])[pP]|\.[tT][sS]")
_UNITS = {"HZ": "Hz", "KHZ": "kHz", "MHZ": "MHz", "GHZ": "GHz"}
# The rest of a device in series, over what others leave; S21 over S11 past noise and crosstalk.
_IN_SERIES, _PASSED = 0.3, 0.05
# Port by port, as version 1 has it: S21 before S12.
_PORTS = {1: ("11",), 2: ("11", "21", "12", "22")}


def read_touchstone(path: Path) -> RawTable:
    """The table of a Touchstone file: frequency, and two columns of each parameter.

    Z and Y of version 1 are over the reference and are given in Ω and S here. Raises
    `ConfigError`, with the line, for options that are not known, a row of another count of numbers,
    and more than two ports.
    """
    text, notes = decoded(path)
    option, reference = ["#"], None
    rows: list[list[float]] = []
    lines: list[int] = []
    version, swapped = 1, False
    for number, line in enumerate(text.split("\n"), 1):
        bare = line.partition("!")[0].strip()
        if bare.startswith("#") and len(option) == 1:
            option = bare.upper().replace("#", "# ").split()
        elif bare.startswith("["):
            key, _, value = bare[1:].partition("]")
            version = 2 if key.upper() == "VERSION" else version
            swapped |= value.strip() == "12_21"
            if key.upper() == "REFERENCE" and value.strip():
                reference = float(_numbers(value, number)[0])
            if key.upper() in ("NOISE DATA", "END"):
                break
        elif bare and not bare.startswith("#"):
            values = _numbers(bare, number)
            if rows and len(values) == 5 and len(rows[0]) == 9:
                notes.append("its noise parameters were left out")
                break
            rows.append(values)
            lines.append(number)
    unit, kind, form, ohms = _options(option[1:])
    reference = ohms if reference is None else reference
    ports = {3: 1, 9: 2}.get(len(rows[0]) if rows else 3)
    if ports is None:
        raise ConfigError("holds other than one or two ports; export one or two")
    for values, number in zip(rows, lines, strict=True):
        if len(values) != len(rows[0]):
            raise ConfigError(
                f"has {len(values)} numbers where the rows before have {len(rows[0])}; export it "
                "again",
                line=number,
            )
    table = np.array(rows, dtype=float).reshape(len(rows), -1)
    parts = {"RI": ("real", "imaginary"), "MA": ("size", "angle"), "DB": ("dB", "angle")}[form]
    order = ("11", "12", "21", "22") if swapped and ports == 2 else _PORTS[ports]
    names = ["Frequency", *(f"{kind}{port} {part}" for port in order for part in parts)]
    if version == 1 and kind in "ZY" and table.size:
        scale = reference if kind == "Z" else 1 / reference
        table[:, 1::2] *= 1.0 if form == "DB" else scale
        table[:, 2::2] *= scale if form == "RI" else 1.0
        table[:, 1::2] += 20 * np.log10(scale) if form == "DB" else 0.0
    at, doubts = _place(table, names, kind, form)
    if version == 1 and kind in "ZY" and reference != 1:
        doubts.append(
            f"{kind} was taken as over {reference:g} ohm, as version 1 of Touchstone has it: of a "
            f"program that writes ohms or siemens it is {reference:g} times off; compare one value"
        )
    if names[at].startswith("S21"):
        notes.append("S11 + S21 = 1: the device is in series between the ports, S21 is read")
    instrument = recognised(text)
    return RawTable(
        file=path,
        format=f"Touchstone file of {ports} port{'s' * (ports > 1)}, {kind} over {reference:g} ohm",
        names=tuple(names),
        values=table,
        lines=np.array(lines, dtype=int),
        notes=tuple(notes),
        doubts=tuple(doubts),
        described=_held(names[at : at + 2], unit, kind, form),
        sure=True,
        reference=reference,
        instrument="" if instrument is None else instrument.name,
        specified=None if instrument is None else instrument.range,
    )


def _options(words: list[str]) -> tuple[str, str, str, si.Ohm]:
    """Unit, parameter, form and reference (Ω) of the option line, in any order."""
    unit, kind, form, ohms = "GHz", "S", "MA", 50.0
    for before, word in zip(["", *words], words, strict=False):
        if word in _UNITS:
            unit = _UNITS[word]
        elif word in ("S", "Y", "Z"):
            kind = word
        elif word in ("RI", "MA", "DB"):
            form = word
        elif before == "R" and re.fullmatch(r"[\d.]+(E[+-]?\d+)?", word) and float(word) > 0:
            ohms = float(word)
        elif word != "R":
            raise ConfigError(
                f"the option '{word[:20]}' is not read; export S, Y or Z parameters as RI, MA or DB"
            )
    return unit, kind, form, ohms


def _place(table: si.FloatArray, names: list[str], kind: str, form: str) -> tuple[int, list[str]]:
    """The column where the parameter begins that the device is read from, and doubts: S21 of a
    device in series between two ports, else what port 1 sees."""
    at = {name[:3]: names.index(name) for name in reversed(names[1:])}
    if len(at) == 1 or kind != "S" or not table.size:
        return at[f"{kind}11"], []
    s11, s21 = (_complex(table[:, at[port] :], form) for port in ("S11", "S21"))
    # In series S11 + S21 = 1; alone at port 1 S21 is missing there, across both 2 S11 too much.
    rest, *apart = (float(np.linalg.norm(of)) for of in (s11 + s21 - 1, 1 - s11, s11))
    if rest < _IN_SERIES * min(apart):
        return at["S21"], []
    if float(np.linalg.norm(s21)) < _PASSED * apart[1]:
        return at["S11"], []
    return at["S11"], [
        "port 2 takes part (S21 is no noise), and the device is not in series between the ports: "
        "S11 is read as if it stood at port 1 alone"
    ]


def _complex(columns: si.FloatArray, form: str) -> si.ComplexArray:
    """A parameter by the first two columns."""
    first, second = columns[:, 0], columns[:, 1]
    if form == "RI":
        return np.asarray(first + 1j * second)
    size = 10 ** (first / 20) if form == "DB" else first
    return np.asarray(size * np.exp(1j * np.radians(second)))


def _held(columns: list[str], unit: str, kind: str, form: str) -> tuple[Held, ...]:
    """Quantities that a parameter's two columns hold."""
    wave = "transmission" if columns[0].startswith("S21") else "reflection"
    real, imaginary, size, linear = {
        "S": (wave, f"{wave}_imaginary", wave, "1"),
        "Z": ("resistance", "reactance", "magnitude", "ohm"),
        "Y": ("conductance", "susceptance", "admittance_magnitude", "S"),
    }[kind]
    frequency, (first, second) = ("frequency", "Frequency", unit), columns
    if form == "RI":
        return frequency, (real, first, linear), (imaginary, second, linear)
    decibels = f"dB re 1 {linear}" if form == "DB" else linear
    return frequency, (size, first, decibels), ("phase", second, "deg")


def _numbers(text: str, line: int) -> list[float]:
    try:
        return [float(cell.replace(",", ".")) for cell in text.split()]
    except ValueError:
        raise ConfigError(f"'{text[:40]}' is no row of numbers", line=line) from None
