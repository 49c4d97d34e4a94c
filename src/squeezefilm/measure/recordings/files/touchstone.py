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
                reference = float(_numbers(value, number, path)[0])
            if key.upper() in ("NOISE DATA", "END"):
                break
        elif bare and not bare.startswith("#"):
            values = _numbers(bare, number, path)
            if rows and len(values) == 5 and len(rows[0]) == 9:
                notes.append("its noise parameters were left out")
                break
            rows.append(values)
            lines.append(number)
    unit, kind, form, ohms = _options(option[1:], path)
    reference = ohms if reference is None else reference
    ports = {3: 1, 9: 2}.get(len(rows[0]) if rows else 3)
    if ports is None:
        raise ConfigError("holds other than one or two ports; export one or two", file=path)
    for values, number in zip(rows, lines, strict=True):
        if len(values) != len(rows[0]):
            raise ConfigError(
                f"has {len(values)} numbers where the rows before have {len(rows[0])}; export it "
                "again",
                file=path,
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
    instrument = recognised(text)
    raw = RawTable(
        file=path,
        format=f"Touchstone file of {ports} port{'s' * (ports > 1)}, {kind} over {reference:g} ohm",
        names=tuple(names),
        values=table,
        lines=np.array(lines, dtype=int),
        notes=tuple(notes),
        described=_held(names, unit, kind, form),
        sure=True,
        reference=reference,
        instrument="" if instrument is None else instrument.name,
        specified=None if instrument is None else instrument.range,
    )
    raw.require_finite()
    return raw


def _options(words: list[str], path: Path) -> tuple[str, str, str, si.Ohm]:
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
                f"the option '{word[:20]}' is not read; export S, Y or Z parameters as RI, MA or "
                "DB",
                file=path,
            )
    return unit, kind, form, ohms


def _held(names: list[str], unit: str, kind: str, form: str) -> tuple[Held, ...]:
    """Quantities that the columns of port 1 hold."""
    real, imaginary = {
        "S": ("reflection", "reflection_imaginary"),
        "Z": ("resistance", "reactance"),
        "Y": ("conductance", "susceptance"),
    }[kind]
    linear = {"S": "1", "Z": "ohm", "Y": "S"}[kind]
    second, angle = (imaginary, linear) if form == "RI" else ("phase", "deg")
    if form != "RI":
        real = {"S": "reflection", "Z": "magnitude", "Y": "admittance_magnitude"}[kind]
    first = f"dB re 1 {linear}" if form == "DB" else linear
    return (("frequency", "Frequency", unit), (real, names[1], first), (second, names[2], angle))


def _numbers(text: str, line: int, path: Path) -> list[float]:
    try:
        return [float(cell) for cell in text.split()]
    except ValueError:
        raise ConfigError(f"'{text[:40]}' is no row of numbers", file=path, line=line) from None
