"""Every kind of recording out of files whose truth is known, in other units and conventions."""

from __future__ import annotations

import os
import re
import typing
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.unit.measure.recordings.bench_files import IMPEDANCE, impedance_text, text, written

import squeezefilm as sf
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.description import KINDS
from squeezefilm.measure.recordings.read import check_folder, check_recording, read_recording

DATA = Path(os.environ.get("SQUEEZEFILM_DATA", Path(__file__).parents[5] / "shared" / "data"))
T = np.arange(4000) / 400e3


def described(kind: str, columns: str, more: str = "") -> str:
    """A description of a kind."""
    return f'kind = "{kind}"\n{more}\n[columns]\n{columns}\n'


def test_the_front_door_has_it() -> None:
    assert sf.read_recording is read_recording


def test_a_frequency_response_in_peak_to_peak_micrometres(tmp_path: Path) -> None:
    f = np.linspace(29e3, 31e3, 51)
    h = 1e-7 / (1 - (f / 30e3) ** 2 + 1j * f / 30e3 / 60)
    columns = (f / 1e3, 2e6 * np.abs(h) * 10, np.degrees(np.angle(h)))
    said = described(
        "frequency response",
        'frequency = { column = 1, unit = "kHz" }\n'
        'displacement = { column = 2, unit = "um", given_as = "peak-to-peak" }\n'
        'phase = { column = 3, unit = "deg" }',
        'voltage = { amplitude = "20 V", given_as = "peak-to-peak" }',
    )
    found = check_recording(written(tmp_path, text("f,d,p", columns), said))
    assert np.allclose(found.recording.displacement_per_volt, h, rtol=1e-6)
    assert found.recording.voltage == 10.0
    assert ("drive voltage", "10 V zero-to-peak, given as peak-to-peak") in found.facts
    asked = said.replace(', given_as = "peak-to-peak" }\nphase', " }\nphase")
    path = written(tmp_path, text("f,d,p", columns), asked, "b.csv")
    with pytest.raises(ConfigError, match='write given_as = "zero-to-peak"') as caught:
        check_recording(path)
    assert (caught.value.key, caught.value.line) == ("columns.displacement", 5)
    both = f'{said}voltage = {{ column = 2, unit = "um", given_as = "rms" }}\n'
    path = written(tmp_path, text("f,d,p", columns), both, "d.csv")
    with pytest.raises(ConfigError, match="keep one of the two"):
        check_recording(path)
    asked = said.replace("voltage =", "# voltage =")
    path = written(tmp_path, text("f,d,p", columns), asked, "c.csv")
    with pytest.raises(ConfigError, match="the drive's voltage is needed"):
        check_recording(path)


def test_decibels_say_what_0_dB_stands_for(tmp_path: Path) -> None:
    """As network analysers export: magnitude in dB, phase in degrees."""
    f = np.linspace(29e3, 31e3, 51)
    h = 1e-7 / (1 - (f / 30e3) ** 2 + 1j * f / 30e3 / 60)
    v = 2j * np.pi * f * h
    said = described(
        "frequency response",
        'frequency = { column = 1, unit = "Hz" }\n'
        'velocity = { column = 2, unit = "dB re 2 V/V", scale = "125 mm/s/V" }\n'
        'phase = { column = 3, unit = "deg" }',
    )
    decibels = 20 * np.log10(np.abs(v) / 0.125 / 2)
    data = text("f,dB,p", (f, decibels, np.degrees(np.angle(v))))
    found = check_recording(written(tmp_path, data, said))
    assert np.allclose(found.recording.displacement_per_volt, h, rtol=1e-6)
    assert any("decibels made linear" in value for _, value in found.facts)
    wrong = data.replace(data.splitlines()[5].split(",")[1], "90000")
    with pytest.raises(ConfigError, match="are these dB"):
        check_recording(written(tmp_path, wrong, said, "b.csv"))
    y = 1 / (50 + 1 / (2j * np.pi * f * 5e-9))
    said = described(
        "impedance",
        'frequency = { column = 1, unit = "Hz" }\n'
        'magnitude = { column = 2, unit = "dB re 1 ohm" }\n'
        'phase = { column = 3, unit = "deg" }',
    )
    columns = (f, -20 * np.log10(np.abs(y)), -np.degrees(np.angle(y)))
    swept = read_recording(written(tmp_path, text("f,|Z| [dB],p", columns), said, "c.csv"))
    assert np.allclose(swept.admittance, y, rtol=1e-6)


def test_a_response_of_velocity_over_volts_by_an_instrument_s_scale(tmp_path: Path) -> None:
    f = np.linspace(29e3, 31e3, 51)
    h = 1e-7 / (1 - (f / 30e3) ** 2 + 1j * f / 30e3 / 60)
    v = 2j * np.pi * f * h / 0.125
    said = described(
        "frequency response",
        'frequency = { column = 1, unit = "Hz" }\n'
        'velocity = { column = 2, unit = "V/V", scale = "125 mm/s/V" }\n'
        'velocity_imaginary = { column = 3, unit = "V/V", scale = "125 mm/s/V" }\n'
        'coherence = { column = 4, unit = "1" }',
    )
    data = text("f,r,i,c", (f, v.real, v.imag, np.full(51, 0.5)))
    found = check_recording(written(tmp_path, data, said))
    assert np.allclose(found.recording.displacement_per_volt, h, rtol=1e-6)
    assert found.recording.voltage is None
    assert any(what == "assumed" for what, _ in found.facts)
    assert any("coherence is 0.50" in doubt for doubt in found.doubts)
    assert found.recording.place is None
    for given in ("x", "y"):
        alone = said.replace("[columns]", f'{given} = "3 mm"\n[columns]')
        with pytest.raises(ConfigError, match="x and y go together") as caught:
            read_recording(written(tmp_path, data, alone, f"{given}.csv"))
        assert caught.value.key == given
    both = said.replace("[columns]", 'x = "3 mm"\ny = "4 mm"\n[columns]')
    told = check_recording(written(tmp_path, data, both, "c.csv"))
    assert told.recording.place == (3e-3, 4e-3)
    assert ("place", "x, y = 3 mm, 4 mm") in told.facts


def test_scans_of_a_line_and_of_a_face(tmp_path: Path) -> None:
    x = np.linspace(0, 0.08, 41)
    w = 1e-6 * np.cos(2 * np.pi * x / 0.024)
    line = described(
        "line scan",
        'position = { column = "x", unit = "mm" }\n'
        'displacement = { column = "w", unit = "nm", given_as = "rms" }',
        'frequency = "30 kHz"',
    )
    found = check_recording(written(tmp_path, text("x,w", (1e3 * x, 1e9 * w / 2**0.5)), line))
    assert np.allclose(found.recording.displacement, w)
    assert found.recording.frequency == 30e3
    assert any("no phase was recorded" in doubt for doubt in found.doubts)
    grid = described(
        "grid scan",
        'x = { column = "x", unit = "mm" }\ny = { column = "y", unit = "mm" }\n'
        'displacement = { column = "w", unit = "um", given_as = "zero-to-peak" }\n'
        'phase = { column = "p", unit = "deg" }',
        'frequency = "30 kHz"\nvoltage = { amplitude = "10 V", given_as = "rms" }',
    )
    columns = (1e3 * x, np.arange(41) % 3, 1e6 * w, np.full(41, 90.0))
    scan = read_recording(written(tmp_path, text("x,y,w,p", columns), grid, "b.csv"))
    assert isinstance(scan, kinds.GridScan)
    assert np.allclose(scan.displacement, 1j * w)
    assert scan.voltage == pytest.approx(10 * 2**0.5)
    columns = (np.round(x, 2), np.zeros(41), 1e6 * w, np.full(41, 90.0))
    with pytest.raises(ConfigError, match="lines 2 and 3 have one place"):
        read_recording(written(tmp_path, text("x,y,w,p", columns), grid, "c.csv"))


RING = described(
    "ring-down",
    'time = { column = 1, unit = "ms" }\ndisplacement = { column = 2, unit = "um" }',
)


def test_a_ring_down_and_what_is_doubtful_of_one(tmp_path: Path) -> None:
    w = np.exp(-T / 2e-3) * np.cos(2 * np.pi * 30e3 * T)
    found = check_recording(written(tmp_path, text("t,w", (1e3 * T, w)), RING))
    assert np.allclose(found.recording.displacement, 1e-6 * w, atol=1e-15)
    assert found.doubts == ()
    for number, (changed, says) in enumerate(
        (
            (np.clip(w, -0.3, 0.3), "at its largest value"),
            (np.ones_like(w) * w[0] * np.cos(2 * np.pi * 30e3 * T), "the drive was not off"),
            (w + 1.0, "has an offset"),
        )
    ):
        path = written(tmp_path, text("t,w", (1e3 * T, changed)), RING, f"r{number}.csv")
        assert any(says in doubt for doubt in check_recording(path).doubts), says
    given = RING.replace('unit = "um" }', 'unit = "um", given_as = "rms" }')
    with pytest.raises(ConfigError, match="is no amplitude; delete it"):
        check_recording(written(tmp_path, text("t,w", (1e3 * T, w)), given, "z.csv"))


def test_mains_hum_is_found_where_it_is_and_not_elsewhere(tmp_path: Path) -> None:
    t = np.arange(20000) / 100e3
    rng = np.random.default_rng(5)
    w = np.cos(2 * np.pi * 20e3 * t) * np.exp(-t / 0.05) + 0.05 * rng.standard_normal(t.size)
    quiet = check_recording(written(tmp_path, text("t,w", (1e3 * t, w)), RING))
    assert not [doubt for doubt in quiet.doubts if "hum" in doubt]
    loud = w + 0.1 * np.sin(2 * np.pi * 50 * t)
    found = check_recording(written(tmp_path, text("t,w", (1e3 * t, loud)), RING, "b.csv"))
    assert [doubt for doubt in found.doubts if "50 Hz" in doubt and "mains hum" in doubt]


SIGNALS = described(
    "raw signals",
    'time = { column = 1, unit = "s" }\nvoltage = { column = 2, unit = "V" }\n'
    'velocity = { column = 3, unit = "m/s" }',
)


def test_raw_signals_of_velocity_are_integrated_and_must_be_even(tmp_path: Path) -> None:
    w = 2 * np.pi * 30e3
    v, moved = 5 * np.sin(w * T), 1e-6 * np.sin(w * T + 0.4)
    data = text("t,u,v", (T, v, 1e-6 * w * np.cos(w * T + 0.4)))
    found = read_recording(written(tmp_path, data, SIGNALS))
    assert isinstance(found, kinds.RawSignals)
    middle = slice(100, -100)
    # Simpson's rule with 13 samples a period.
    assert np.allclose(found.displacement[middle], moved[middle], atol=3e-9)
    keep = np.ones(T.size, dtype=bool)
    keep[1000:1010] = False
    data = text("t,u,v", (T[keep], v[keep], moved[keep]))
    with pytest.raises(ConfigError, match="samples are missing before this row") as caught:
        read_recording(written(tmp_path, data, SIGNALS, "b.csv"))
    assert caught.value.line == 1002


def test_sweeps_at_several_voltages_are_told_apart(tmp_path: Path) -> None:
    up = np.linspace(29e3, 31e3, 21)
    f = np.concatenate([up, up[::-1], up])
    u = np.concatenate([np.full(42, 2.0), np.full(21, 8.0)])
    h = 1e-7 / (1 - (f / 30e3) ** 2 + 1j * f / 30e3 / 60)
    said = described(
        "voltage sweeps",
        'frequency = { column = 1, unit = "Hz" }\n'
        'voltage = { column = 2, unit = "V", given_as = "zero-to-peak" }\n'
        'displacement = { column = 3, unit = "m", given_as = "zero-to-peak" }\n'
        'displacement_imaginary = { column = 4, unit = "m", given_as = "zero-to-peak" }',
    )
    found = read_recording(written(tmp_path, text("f,u,r,i", (f, u, u * h.real, u * h.imag)), said))
    assert isinstance(found, kinds.VoltageSweeps)
    assert found.directions == ("up", "down", "up")
    assert [one.voltage for one in found.sweeps] == [2.0, 2.0, 8.0]
    for one in found.sweeps:
        assert np.allclose(one.frequency, up)
        assert np.allclose(one.displacement_per_volt, h[:21], rtol=1e-6)


def test_sweeps_may_have_files_of_their_own(tmp_path: Path) -> None:
    f = np.linspace(29e3, 31e3, 21)
    h = 1e-7 / (1 - (f / 30e3) ** 2 + 1j * f / 30e3 / 60)
    for name, volts, order in (("low", 2.0, 1), ("high", 8.0, -1)):
        parts = (f[::order], volts * h.real[::order], volts * h.imag[::order])
        written(tmp_path, text("f,r,i", parts), "", f"{name}.csv")
    said = described(
        "voltage sweeps",
        'frequency = { column = 1, unit = "Hz" }\n'
        'displacement = { column = 2, unit = "m", given_as = "zero-to-peak" }\n'
        'displacement_imaginary = { column = 3, unit = "m", given_as = "zero-to-peak" }',
    )
    for name, volts in (("low", "2 V"), ("high", "16 V")):
        given = "zero-to-peak" if name == "low" else "peak-to-peak"
        said += f'[[sweeps]]\nfile = "{name}.csv"\n'
        said += f'voltage = {{ amplitude = "{volts}", given_as = "{given}" }}\n'
    path = tmp_path / "all.toml"
    path.write_text(said, encoding="utf-8")
    found = check_recording(path)
    sweeps = found.recording
    assert isinstance(sweeps, kinds.VoltageSweeps)
    assert [one.voltage for one in sweeps.sweeps] == [2.0, 8.0]
    assert sweeps.directions == ("up", "down")
    assert found.points == 42
    for one in sweeps.sweeps:
        assert np.allclose(one.displacement_per_volt, h, rtol=1e-6)
    data = (tmp_path / "high.csv").read_text(encoding="utf-8").replace("31000,", "x,")
    (tmp_path / "high.csv").write_text(data, encoding="utf-8")
    with pytest.raises(ConfigError, match=r"high\.csv, line 2, column 1"):
        check_recording(path)


BENCH = described(
    "friction bench",
    'time = { column = 1, unit = "s" }\nnormal_force = { column = 2, unit = "N" }\n'
    'tangential_force = { column = 3, unit = "N" }\nposition = { column = 4, unit = "mm" }\n'
    'voltage = { column = 5, unit = "V", given_as = "peak-to-peak" }',
    'amplitude_per_volt = "50 nm/V"',
)


def test_a_friction_bench_by_its_drive_s_voltage(tmp_path: Path) -> None:
    t = np.linspace(0, 1, 200)
    columns: Any = (t, 0.5 + 0 * t, 0.2 + 0 * t, 40 * t, np.full(200, 40.0))
    found = read_recording(written(tmp_path, text("t,n,f,x,u", columns), BENCH))
    assert isinstance(found, kinds.FrictionBench)
    assert np.allclose(found.vibration_amplitude, 1e-6)
    columns = (t, 0.05 + 0 * t, 0.5 + 0 * t, 40 * t, np.full(200, 40.0))
    doubts = check_recording(written(tmp_path, text("t,n,f,x,u", columns), BENCH, "b.csv")).doubts
    assert any("are the two columns swapped" in doubt for doubt in doubts)
    bare = BENCH.replace('amplitude_per_volt = "50 nm/V"', "")
    with pytest.raises(ConfigError, match="or the voltage with amplitude_per_volt"):
        read_recording(written(tmp_path, text("t,n,f,x,u", columns), bare, "c.csv"))


CURVE = described(
    "friction curve",
    'vibration_amplitude = { column = 1, unit = "um", given_as = "zero-to-peak" }\n'
    'relative_friction = { column = 2, unit = "%" }\nspread = { column = 3, unit = "%" }',
    'frequency = "30 kHz"\nnormal_force = "0.5 N"\nspeed = "20 mm/s"\ndisplay = "own.toml"',
)


def test_a_friction_curve_names_what_it_was_measured_on(tmp_path: Path) -> None:
    a = np.linspace(0, 2, 9)
    data = text("a,m,s", (a, 100 - 30 * a, np.full(9, 5.0)))
    found = check_recording(written(tmp_path, data, CURVE))
    curve = found.recording
    assert isinstance(curve, kinds.FrictionCurve)
    assert np.allclose(curve.friction, 1 - 0.3 * a)
    assert (curve.normal_force, curve.speed) == (0.5, 0.02)
    assert curve.display == str(tmp_path / "own.toml")
    assert found.doubts == ()
    share = CURVE.replace('2, unit = "%"', '2, unit = "1"')
    celsius = written(tmp_path, data, share.replace("kind", 'temperature = "23 °C"\nkind'), "b.csv")
    assert check_recording(celsius).recording.told.temperature == 296.15
    doubts = check_recording(written(tmp_path, data, share, "c.csv")).doubts
    assert any('is the unit "%"?' in doubt for doubt in doubts)


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ('"0.5 N"', '"0 N"', "normal_force"),
        ('"20 mm/s"', '"20 km/s"', "speed"),
        ('"30 kHz"', '"-30 kHz"', "frequency"),
        ("kind =", 'temperature = "0 K"\nkind =', "temperature"),
        ("kind =", "points = 0\nkind =", "points"),
    ],
)
def test_a_condition_that_cannot_be_is_refused_at_its_key(
    old: str, new: str, key: str, tmp_path: Path
) -> None:
    path = written(tmp_path, "a,m,s\n0,100,5\n1,80,5\n2,60,5\n", CURVE.replace(old, new))
    with pytest.raises(ConfigError) as caught:
        check_recording(path)
    assert caught.value.key == key


def test_a_folder_keeps_what_can_be_read_and_names_what_cannot(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no recording"):
        check_folder(tmp_path)
    written(tmp_path, impedance_text())
    written(tmp_path, impedance_text().replace("-", "x", 1), name="bad.csv")
    (tmp_path / "plate.toml").write_text('name = "a display"\n', encoding="utf-8")
    found = check_folder(tmp_path)
    assert [one.file.name for one in found.checks] == ["a.csv"]
    assert [one.file.name for one in found.refused] == ["bad.toml"]


def test_a_description_may_stand_elsewhere(tmp_path: Path) -> None:
    data = written(tmp_path, impedance_text(), "", "data.csv")
    told = tmp_path / "told.toml"
    told.write_text(f'file = "data.csv"\n{IMPEDANCE}', encoding="utf-8")
    one, other = read_recording(data, described=told), read_recording(told)
    assert isinstance(one, kinds.ImpedanceSweep)
    assert isinstance(other, kinds.ImpedanceSweep)
    assert np.array_equal(one.admittance, other.admittance)
    assert one.told.name == "synthetic resonator"
    told.write_text(IMPEDANCE, encoding="utf-8")
    with pytest.raises(ConfigError, match="one file of data of the same name"):
        read_recording(told)


PAGE = Path(__file__).parents[4] / "docs" / "reference" / "measured-data.md"


def test_the_examples_of_the_page_are_read_and_it_names_every_kind(tmp_path: Path) -> None:
    page = PAGE.read_text(encoding="utf-8")
    files = re.findall(r'^```\w+ title="([^"]+)"\n(.*?)^```', page, re.MULTILINE | re.DOTALL)
    for name, content in files:
        (tmp_path / name).write_text(content, encoding="utf-8")
    found = check_folder(tmp_path)
    assert len(files) == 2 * len(found.checks) == 4
    assert found.refused == ()
    table = re.findall(r"^\| `([a-z -]+)` \|", page, re.MULTILINE)
    assert table[1:] == list(KINDS)
    for kind, described_by in KINDS.items():
        columns = typing.get_type_hints(described_by)["columns"]
        named = next(one for one in (*typing.get_args(columns), columns) if is_dataclass(one))
        for field in fields(named):
            assert f"`{field.name}`" in page, (kind, field.name)


REAL = {
    "pzt-bar-k31.txt": (
        'frequency = { column = "f", unit = "Hz" }\nconductance = { column = "G", unit = "S" }\n'
        'susceptance = { column = "B", unit = "S" }',
        301, (110e3, 140e3),
    ),
    "pzt-disc-35mm-first-radial.csv": (
        'frequency = { column = 1, unit = "Hz" }\nmagnitude = { column = 2, unit = "ohm" }\n'
        'phase = { column = 3, unit = "deg" }',
        201, (50e3, 72e3),
    ),
}  # fmt: skip
NEEDS_DATA = pytest.mark.skipif(
    not (DATA / "impedance").is_dir(),
    reason="measured data are absent; SQUEEZEFILM_DATA names their folder",
)


@NEEDS_DATA
@pytest.mark.parametrize("name", REAL)
def test_real_sweeps_are_read_without_a_doubt(name: str, tmp_path: Path) -> None:
    columns, points, ends = REAL[name]
    told = tmp_path / "told.toml"
    told.write_text(described("impedance", columns), encoding="utf-8")
    found = check_recording(DATA / "impedance" / name, told)
    sweep = found.recording
    assert found.points == points
    assert (sweep.frequency[0], sweep.frequency[-1]) == pytest.approx(ends)
    assert found.doubts == ()
    assert np.all(sweep.admittance.real > 0)


@NEEDS_DATA
def test_the_real_export_says_itself_and_its_phase_is_noticed() -> None:
    found = check_recording(DATA / "impedance" / "piezo-28kHz.txt")
    z = 1 / np.abs(found.recording.admittance)
    f = found.recording.frequency
    # As SOURCE.md beside the data has it.
    assert (found.points, round(f[z.argmin()]), round(f[z.argmax()])) == (801, 28098, 30045)
    assert (z.min(), z.max()) == pytest.approx((175.9, 14935), rel=1e-3)
    assert "phase that is off by 180 deg" in found.doubts[0]
    assert np.all(found.recording.admittance.real < 0)
