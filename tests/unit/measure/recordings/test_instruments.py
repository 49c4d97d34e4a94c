"""Exports of instruments are read right, whatever the order of their columns."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from tests.unit.measure.recordings import instrument_files as made
from tests.unit.measure.recordings.bench_files import resonator, text, written

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.measure.fits.circuit.impedance import fit_impedance
from squeezefilm.measure.fits.vibration.ring_down import fit_ring_down
from squeezefilm.measure.recordings.circuits_read import IMPEDANCES, Fixture
from squeezefilm.measure.recordings.files.analysers import read_touchstone
from squeezefilm.measure.recordings.files.raw_table import held_by, recognised
from squeezefilm.measure.recordings.files.scipy_files import read_wav
from squeezefilm.measure.recordings.kinds import ImpedanceSweep, RawSignals, RingDown
from squeezefilm.measure.recordings.read import (
    check_folder,
    check_recording,
    propose_description,
    proposed,
    read_recording,
    write_description,
)


@pytest.mark.parametrize("name", made.SWEEPS)
def test_a_sweep_says_itself_what_it_holds(name: str, tmp_path: Path) -> None:
    suffix, write = made.SWEEPS[name]
    f, z = resonator()
    path = written(tmp_path, write(f, z), "", f"a.{suffix}")
    found = check_recording(path)
    assert isinstance(found.recording, ImpedanceSweep)
    assert np.allclose(found.recording.frequency, f, rtol=1e-9)
    assert np.allclose(1 / found.recording.admittance, z, rtol=1e-6)
    usual = ("specified", "as version 1 of Touchstone has it")
    assert not [doubt for doubt in found.doubts if not any(word in doubt for word in usual)]
    assert len(check_folder(tmp_path).checks) == 1
    # What is proposed, kept as a file, reads the same.
    write_description(path)
    again = read_recording(path)
    assert isinstance(again, ImpedanceSweep)
    assert np.array_equal(again.admittance, found.recording.admittance)
    with pytest.raises(InputError, match="there already"):
        write_description(path)


@pytest.mark.parametrize("name", made.GAINS)
def test_a_gain_needs_its_shunt_and_then_makes_an_impedance(name: str, tmp_path: Path) -> None:
    f, z = resonator()
    path = written(tmp_path, made.GAINS[name](f, z), "", "a.csv")
    with pytest.raises(ConfigError, match="shunt"):
        read_recording(path)
    proposal = propose_description(path).text
    with pytest.raises(ConfigError, match="shunt"):
        read_recording(written(tmp_path, made.GAINS[name](f, z), proposal, "b.csv"))
    path.with_suffix(".toml").write_text(proposal.replace("… ohm", "100 ohm"), encoding="utf-8")
    found = read_recording(path)
    assert isinstance(found, ImpedanceSweep)
    assert np.allclose(1 / found.admittance, z, rtol=1e-6)


def _decay() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    t = np.arange(2000) * 2e-6
    a = np.exp(-np.pi * 300 * t) * np.cos(2 * np.pi * 30e3 * t)
    return t, a, 0.5 * a


@pytest.mark.parametrize("name", made.SCOPES)
def test_signals_over_time_are_proposed_and_confirmed_once(name: str, tmp_path: Path) -> None:
    suffix, kept, write = made.SCOPES[name]
    t, a, b = _decay()
    data = write(t, a, b)
    path = written(tmp_path, data, "", f"a.{suffix}")
    with pytest.raises(ConfigError, match="confirm"):
        read_recording(path)
    proposal = propose_description(path)
    text = proposal.text.replace("… nm/V", "20 nm/V")
    path.with_suffix(".toml").write_text(text, encoding="utf-8")
    if suffix == "wav":
        text = 'kind = "ring-down"\n[columns]\ntime = { column = 1, unit = "s" }\n'
        text += 'signal = { column = "Channel 1", unit = "1" }\n'
        path.with_suffix(".toml").write_text(text, encoding="utf-8")
    found = read_recording(path)
    if kept == 1:
        assert isinstance(found, RingDown)
        assert np.allclose(found.displacement, a, atol=2e-6)
        fit = fit_ring_down(found)
        assert fit.frequency.value == pytest.approx(30e3, rel=1e-6)
        assert fit.quality_factor.value == pytest.approx(100, rel=1e-3)
        assert fit.amplitude.unit == found.unit != "m"
    else:
        assert isinstance(found, RawSignals)
        assert np.allclose(found.voltage, a, atol=2e-6)
        assert np.allclose(found.displacement, 20e-9 * b, atol=1e-13)
    assert np.allclose(found.time - found.time[0], t, atol=1e-12)


@pytest.mark.parametrize("width", [1, 2, 4])
def test_a_sound_of_any_width_is_read(width: int, tmp_path: Path) -> None:
    t, a, b = _decay()
    path = written(tmp_path, made.sound(t, a, b, width), "", "a.wav")
    write = 'kind = "ring-down"\n[columns]\ntime = { column = 1, unit = "s" }\n'
    path.with_suffix(".toml").write_text(
        write + 'signal = { column = 3, unit = "1" }\n', encoding="utf-8"
    )
    found = read_recording(path)
    assert isinstance(found, RingDown)
    assert np.allclose(found.displacement, b, atol=2 ** (2 - 8 * width))
    path.write_bytes(path.read_bytes()[:-7])
    with pytest.raises(ConfigError, match="cut short"):
        read_recording(path)
    path.write_bytes(b"RIFFxxxx")
    with pytest.raises(ConfigError, match="no WAV file"):
        read_recording(path)


def test_columns_are_known_by_their_names_in_any_order() -> None:
    assert held_by(["|Z| (kΩ)", "θ (°)", "f (kHz)"]) == (
        ("frequency", "f (kHz)", "kHz"), ("magnitude", "|Z| (kΩ)", "kΩ"), ("phase", "θ (°)", "°")
    )  # fmt: skip
    assert held_by(["freq", "impedance", "phase"])[1:] == (
        ("magnitude", "impedance", "ohm"), ("phase", "phase", "deg")
    )  # fmt: skip
    # Two alike are told apart by their numbers.
    assert held_by(["Second", "Volt", "Volt"])[1:] == (("voltage", 2, "V"), ("voltage", 3, "V"))
    assert held_by(["a", "b"]) == () == held_by(["frequency", "b"])


def test_a_sweep_outside_of_the_instrument_s_range_is_doubted(tmp_path: Path) -> None:
    f, z = resonator()
    path = written(tmp_path, made.e4990a(f * 1e-4, z), "", "a.csv")
    doubts = check_recording(path).doubts
    assert any("the Keysight E4990A is specified from 20 Hz to 120 MHz" in one for one in doubts)
    assert recognised("no head") is None


def test_each_part_does_its_own(tmp_path: Path) -> None:
    f, z = resonator()
    path = written(tmp_path, made.touchstone(ports=2)(f, z), "", "a.s2p")
    table = read_touchstone(path)
    assert table.names[:4] == ("Frequency", "S11 real", "S11 imaginary", "S21 real")
    assert table.outside(f) is None
    proposal = proposed(table)
    assert (proposal.kind, proposal.to_confirm) == ("impedance", "")
    t, a, b = _decay()
    assert read_wav(written(tmp_path, made.sound(t, a, b), "", "b.wav")).values.shape == (2000, 3)
    at = Fixture(2 * np.pi * f, 50.0, 100.0)
    wave = 2 * 50.0 / (2 * 50.0 + z)
    through = IMPEDANCES["transmission", "transmission_imaginary"](wave.real, wave.imag, at)
    assert np.allclose(through, z)
    q = z.real / np.abs(z.imag)
    assert np.allclose(IMPEDANCES["series_capacitance", "quality_factor"](
        -1 / (at.omega * z.imag), 1 / q, at)[z.imag < 0], z[z.imag < 0])  # fmt: skip


def test_a_table_without_its_end_is_refused(tmp_path: Path) -> None:
    f, z = resonator()
    cut = made.e4990a(f, z).replace("END\n", "")
    with pytest.raises(ConfigError, match="no end: the file is cut short"):
        read_recording(written(tmp_path, cut, "", "a.csv"))


def test_a_head_without_times_is_refused(tmp_path: Path) -> None:
    t, a, b = _decay()
    whole = made.rigol_1000z(t, a, b)
    start, step = re.findall(r"^Sequence,Volt,Volt,(\S+),(\S+)$", whole, re.MULTILINE)[0]
    for said, instead in (
        ("Sequence", "Sequenz"),
        (f"{start},{step}", f"{start},0.0"),
        (f"{start},{step}", f"{start},-{step}"),
        (f"{start},{step}", f"{start},+-1"),
        (f"{start},{step}", f"1e,{step}"),
    ):
        with pytest.raises(ConfigError, match="first time and the interval"):
            read_recording(written(tmp_path, whole.replace(said, instead), "", "a.csv"))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("# HZ S RI R 50", "# HZ H RI R 50"), "option 'H' is not read"),
        (("29000", "ninety"), "no row of numbers"),
        (("\n", " 1\n"), "other than one or two ports"),
    ],
)
def test_a_touchstone_file_that_is_none_is_refused(
    change: tuple[str, str], message: str, tmp_path: Path
) -> None:
    rows = "29000 0.1 0.2\n29100 0.1 0.3\n29200 0.1 0.4\n"
    body = rows.replace(*change) if change[0] == "\n" else rows
    data = ("# HZ S RI R 50\n" + body).replace(*change) if change[0] != "\n" else (
        "# HZ S RI R 50\n" + body
    )  # fmt: skip
    with pytest.raises(ConfigError, match=message):
        read_recording(written(tmp_path, data, "", "a.s1p"))


def test_a_size_without_a_phase_is_proposed_and_fitted(tmp_path: Path) -> None:
    f, z = resonator(201)
    white = np.random.default_rng(4).standard_normal((2, f.size))
    z = z * (1 + 0.003 * (white[0] + 1j * white[1]))
    path = written(tmp_path, text("f (Hz),|Z| (kohm)", (f, 1e-3 * abs(z))), "")
    write_description(path)
    sweep = read_recording(path)
    assert isinstance(sweep, ImpedanceSweep)
    fit = fit_impedance(sweep)
    full = fit_impedance(ImpedanceSweep(f, 1 / z))
    assert fit.adequacy.adequate
    for name in ("series_resonance", "parallel_resonance", "quality_factor"):
        ours, theirs = (getattr(one.strongest, name) for one in (fit, full))
        assert ours.interval[0] < theirs.value < ours.interval[1]
        assert 1 < ours.standard_error / theirs.standard_error < 3
    with pytest.raises(InputError, match="sizes alone do not tell a drift"):
        fit_impedance(sweep, drift=True)
    said = path.with_suffix(".toml").read_text(encoding="utf-8")
    for key in ('correct = "phase sign"', 'open = "b.csv"'):
        path.with_suffix(".toml").write_text(f"{key}\n{said}", encoding="utf-8")
        with pytest.raises(ConfigError, match="asks for the phase too"):
            read_recording(path)


def test_two_voltages_and_a_shunt_make_an_impedance(tmp_path: Path) -> None:
    f, z = resonator()
    gain = 100 / (100 + z)
    data = text(
        "f,U,Us,phi", (f, np.full(f.size, 2.0), 1e3 * abs(gain), np.degrees(np.angle(gain)))
    )
    said = (
        'kind = "impedance"\nshunt = "100 ohm"\nband = { low = "29.5 kHz", high = "30.5 kHz" }\n'
        '[columns]\nfrequency = { column = "f", unit = "Hz" }\n'
        'voltage = { column = "U", unit = "V", given_as = "peak-to-peak" }\n'
        'shunt_voltage = { column = "Us", unit = "mV", given_as = "zero-to-peak" }\n'
        'phase = { column = "phi", unit = "deg" }\n'
    )
    found = read_recording(written(tmp_path, data, said))
    assert isinstance(found, ImpedanceSweep)
    kept = (f >= 29.5e3) & (f <= 30.5e3)
    assert np.array_equal(found.frequency, f[kept])
    assert np.allclose(1 / found.admittance, z[kept], rtol=1e-5)
    alone = said.replace('phase = { column = "phi", unit = "deg" }\n', "")
    sizes = check_recording(written(tmp_path, data, alone))
    assert isinstance(sizes.recording, ImpedanceSweep)
    assert not sizes.recording.phase_recorded
    size = sizes.recording.as_recorded(sizes.recording.admittance)
    assert np.allclose(size, np.abs(gain[kept]) / 100, rtol=1e-6)
    assert "no phase was recorded" in sizes.doubts[0]
    narrow = said.replace('"29.5 kHz"', '"29.51 kHz"').replace('"30.5 kHz"', '"29.52 kHz"')
    with pytest.raises(ConfigError, match="kHz holds 0 rows"):
        read_recording(written(tmp_path, data, narrow))
