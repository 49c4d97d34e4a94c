"""Files as benches leave them, made here: every number is computed and labelled synthetic."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from squeezefilm.core import quantities as si

IMPEDANCE = """\
kind = "impedance"
name = "synthetic resonator"
[columns]
frequency = { column = "f", unit = "Hz" }
magnitude = { column = "Z", unit = "ohm" }
phase = { column = "theta", unit = "deg" }
"""


def resonator(points: int = 41) -> tuple[si.HertzArray, si.ComplexArray]:
    """Frequencies and impedances (ohm) of one series branch beside a capacitance."""
    f = np.linspace(29e3, 31e3, points)
    s = 2j * np.pi * f
    admittance = s * 3e-9 + 1 / (s * 0.7 + 1500 + 1 / (s * 40.2e-12))
    return f, 1 / admittance


def text(
    names: str, columns: Mapping[str, object] | tuple[object, ...], delimiter: str = ","
) -> str:
    """The CSV text of columns below a header."""
    values = columns.values() if isinstance(columns, Mapping) else columns
    rows = zip(*(np.asarray(one).tolist() for one in values), strict=True)
    return "\n".join([names, *(delimiter.join(f"{v:.9g}" for v in row) for row in rows), ""])


def impedance_text(delimiter: str = ",") -> str:
    """A good file of an impedance, 41 rows below a header."""
    f, z = resonator()
    names = delimiter.join(("f (Hz)", "Z (ohm)", "theta (deg)"))
    return text(names, (f, np.abs(z), np.degrees(np.angle(z))), delimiter)


def written(
    folder: Path, data: str | bytes, description: str = IMPEDANCE, name: str = "a.csv"
) -> Path:
    """The path of a file of data, its description beside it."""
    path = folder / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    if description:
        path.with_suffix(".toml").write_text(description, encoding="utf-8")
    return path


def export_4294a() -> str:
    """The same in the form of a 4294A's export."""
    f, z = resonator()
    head = (
        '4294A REV1.11\n"DATE:     1"\n\n\n"MEASURE PARAMETER: IMPEDANCE MAG PHASE (DEG)"\n'
        '"SWEEP TYPE: LIN FREQ"\n"NUMBER of POINTS: 41"\n"OSC LEVEL:  500 mVolt"\n\n\n'
    )
    parts = [head]
    for letter, values in (("A", np.abs(z)), ("B", np.degrees(np.angle(z)))):
        parts.append(f'"TRACE: {letter}"\n"FORMAT: LIN"\n\n')
        parts.append('"Frequency"\t"Data Trace Real"\t"Data Trace Imag"\n')
        parts += [f"{a:.11e}\t{b:.9e}\t{0:.6e}\n" for a, b in zip(f, values, strict=True)]
        parts.append("\n\n")
    return "".join(parts)
