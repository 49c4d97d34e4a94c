"""Touchstone files of one or two ports (.s1p, .s2p, versions 1 and 2), as network analysers and
NanoVNAs write them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError
from squeezefilm.measure.recordings.files.instruments import recognised
from squeezefilm.measure.recordings.files.raw_table import Held, RawTable
from squeezefilm.measure.recordings.files.text_table import decoded

SUFFIX = re.compile(r"\.[sSyYzZ]([12])[pP]|\.[tT][sS]")
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
