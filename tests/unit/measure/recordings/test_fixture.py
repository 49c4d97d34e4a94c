"""A device in a fixture, by sweeps of the fixture alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.unit.measure.recordings.bench_files import text, written

from squeezefilm.core.errors import ConfigError
from squeezefilm.measure.recordings.read import check_recording, read_recording

COLUMNS = """
[columns]
frequency = { column = 1, unit = "Hz" }
resistance = { column = 2, unit = "ohm" }
reactance = { column = 3, unit = "ohm" }
"""


def described(more: str) -> str:
    return f'kind = "impedance"\n{more}\n{COLUMNS}'


@pytest.mark.parametrize("files", [("open", "short"), ("short",), ("open",)])
def test_what_a_fixture_adds_is_taken_off(tmp_path: Path, files: tuple[str, ...]) -> None:
    """A plate in a fixture of 40 pF across it, behind leads of 0.8 ohm and 300 nH."""
    f = np.linspace(30e3, 40e3, 201)
    omega = 2 * np.pi * f
    plate = 1j * omega * 20e-9 + 1 / (250 + 1j * omega * 0.1 + 1 / (1j * omega * 2.1e-10))
    in_series = 0.8 + 1j * omega * 300e-9 if "short" in files else 0 * omega
    across = 1j * omega * 40e-12 if "open" in files else 0 * omega
    measured = in_series + 1 / (plate + across)
    fixture = {"open": in_series + 1 / (across + 1e-30), "short": in_series}
    for name in files:
        z = fixture[name]
        text_there = text("f,r,x", (f, z.real, z.imag))
        (tmp_path / f"{name}.csv").write_text(text_there, encoding="utf-8")
    told = "\n".join(f'{name} = "{name}.csv"' for name in files)
    rows = text("f,r,x", (f, measured.real, measured.imag))
    found = check_recording(written(tmp_path, rows, described(told)))
    assert np.allclose(found.recording.admittance, plate, rtol=1e-4)
    assert found.recording.compensated
    assert ("without its fixture", f"by {' and '.join(f'{name}.csv' for name in files)}") in (
        found.facts
    )
    told_too = written(tmp_path, rows, described(f"{told}\ncompensated = false"))
    with pytest.raises(ConfigError, match="exclude each other"):
        read_recording(told_too)
    short = text("f,r,x", (f[:100], fixture[files[0]][:100].real, fixture[files[0]][:100].imag))
    (tmp_path / f"{files[0]}.csv").write_text(short, encoding="utf-8")
    path = written(tmp_path, rows, described(told))
    with pytest.raises(ConfigError, match="swept beyond; sweep the fixture over the same"):
        read_recording(path)


@pytest.mark.parametrize("files", [("short",), ("open", "short")])
def test_a_fixture_that_is_the_device_is_refused(tmp_path: Path, files: tuple[str, ...]) -> None:
    f = np.linspace(30e3, 40e3, 11)
    rows = text("f,r,x", (f, 100 + 0 * f, -200 + 0 * f))
    told = "\n".join(f'{name} = "a.csv"' for name in files)
    path = written(tmp_path, rows, described(told))
    with pytest.raises(ConfigError, match="measures as the device does"):
        read_recording(path)
