"""What is doubtful of a recording, and nothing else, is said of it."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest

from squeezefilm.core.quantities import FloatArray
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.doubts import doubts_of


def assert_said(recording: kinds.Recording, *patterns: str) -> None:
    """One doubt for each pattern, in this order."""
    said = doubts_of(recording)
    assert len(said) == len(patterns), said
    for doubt, pattern in zip(said, patterns, strict=True):
        assert re.search(pattern, doubt), doubt


F = np.linspace(29e3, 31e3, 41)
CAPACITOR = 2j * np.pi * F * 5e-9


def swept(admittance: FloatArray, frequency: FloatArray = F) -> kinds.ImpedanceSweep:
    return kinds.ImpedanceSweep(frequency, admittance)


def test_signs_of_an_impedance() -> None:
    lossy = CAPACITOR + 1e-4
    assert_said(swept(lossy))
    # A coil's phase at both ends; at one end only it may be a resonance.
    assert_said(swept(lossy.conj()), r"phase begins at \+84 deg and ends positive too")
    for end in (0, -1):
        half = lossy.conj()
        half[end] = lossy[end]
        assert_said(swept(half))
    assert_said(swept(-lossy), r"negative at 100 % of the points .* begins at \+96 deg")
    noisy = lossy - np.where(np.arange(F.size) < 3, 2e-4, 0.0)
    assert_said(swept(noisy), r"^the conductance is negative at 3 of 41 points")


@pytest.mark.parametrize(("ohm", "doubted"), [(0.009, 1), (0.011, 0), (0.9e8, 0), (1.1e8, 1)])
def test_an_impedance_of_unusual_size(ohm: float, doubted: int) -> None:
    admittance = (1e-3 + 1j) / abs(1e-3 + 1j) / ohm * np.ones(F.size)
    assert_said(swept(admittance), *["impedances of .* ohm are unusual"] * doubted)


@pytest.mark.parametrize(
    ("frequency", "patterns"),
    [
        (F[:20], []),
        (F[:19], ["^19 points are few"]),
        (np.linspace(700.0, 990.0, 41), ["up to 990 Hz are unusual"]),
        (np.linspace(700.0, 1010.0, 41), []),
        (np.linspace(8e6, 9.9e6, 41), []),
        (np.linspace(8e6, 10.1e6, 41), ["up to 10.1 MHz are unusual"]),
        (np.geomspace(3e3, 3e5, 41), []),
        (np.delete(F, 20), ["missing between 29.95 kHz and 30.05 kHz, or the step"]),
        (np.delete(F, np.arange(1, 30)), ["^12 points are few"]),
        (np.r_[F[0] - 85.0, F], []),
    ],
)
def test_frequencies_few_unusual_or_missing(frequency: FloatArray, patterns: list[str]) -> None:
    admittance = 2j * np.pi * frequency * 5e-9 + 1e-5
    assert_said(swept(admittance, frequency), *patterns)


def response(frequency: FloatArray = F, **given: object) -> kinds.FrequencyResponse:
    h = 1e-7 / (1 - (frequency / 30e3) ** 2 + 1j * frequency / 30e3 / 60)
    return dataclasses.replace(kinds.FrequencyResponse(frequency, h, 2.0), **given)  # type: ignore[arg-type]


def test_responses_and_sweeps_of_them() -> None:
    right, h = response(), response().displacement_per_volt
    assert_said(right)
    assert_said(response(F[:19]), "^19 points are few for a resonance")
    assert_said(response(coherence=np.full(F.size, 0.91)))
    assert_said(response(coherence=np.full(F.size, 0.89)), r"^the coherence is 0\.89 in the middle")
    rises = r"^the phase rises by 1\d\d deg through the resonance"
    assert_said(response(displacement_per_volt=h.conj()), rises)
    # What turns only far from the peak is noise.
    far = np.where(np.abs(h) > 0.25 * np.max(np.abs(h)), h, h.conj())
    assert_said(response(displacement_per_volt=far))
    other = response(displacement_per_volt=h.conj(), voltage=8.0)
    assert_said(kinds.VoltageSweeps((right, response(voltage=8.0)), ("up", "down")))
    assert_said(kinds.VoltageSweeps((right, other), ("up", "up")), "^sweep 2: the phase rises")
    assert_said(kinds.VoltageSweeps((right, right), ("up", "up")), "^all sweeps are at one voltage")


X = np.linspace(0, 0.05, 40)


def test_scans_without_a_phase() -> None:
    wave = 1e-6 * np.cos(400 * X)
    travelling = wave + 1e-8j * np.sin(400 * X)
    assert_said(kinds.LineScan(X, travelling, 3e4))
    assert_said(kinds.LineScan(X[:20], travelling[:20], 3e4))
    assert_said(kinds.LineScan(X[:19], travelling[:19], 3e4), "^19 places are few")
    for flat in (wave, wave + 0j):
        assert_said(kinds.LineScan(X, flat, 3e4), "^no phase was recorded: a travelling part")
        assert_said(
            kinds.LineScan(X, np.abs(flat), 3e4), "^no phase was recorded, and all values are pos"
        )
    for grid, patterns in (
        (travelling, []),
        (wave + 0j, []),
        (np.abs(travelling) + 0j, ["^no phase was recorded, and all values are positive: a mode"]),
        (np.abs(wave) + 1e-8j, []),
    ):
        assert_said(kinds.GridScan(X, 0 * X, grid, 3e4), *patterns)


T = np.arange(4000) / 4e5
RINGING = 1e-6 * np.exp(-T / 2e-3) * np.cos(2 * np.pi * 3e4 * T + 0.3)


def test_a_ring_down_that_was_driven_or_has_holes() -> None:
    assert_said(kinds.RingDown(T, RINGING))
    steady = 1e-6 * np.cos(2 * np.pi * 3e4 * T)
    assert_said(kinds.RingDown(T, steady * np.exp(-T / 0.04)))
    assert_said(kinds.RingDown(T, steady * np.exp(-T / 0.055)), "^the second half is as large")
    holed = np.delete(np.arange(T.size), np.arange(800, 820))
    assert_said(kinds.RingDown(T[holed], RINGING[holed]), r"missing after 1\.99\d ms")


def test_signals_at_an_end_off_the_middle_still_or_too_fast() -> None:
    volts = 5 * np.cos(2 * np.pi * 3e4 * T + 0.1)

    def moved(displacement: FloatArray) -> kinds.RawSignals:
        return kinds.RawSignals(T, volts, displacement)

    wave = 1e-6 * np.cos(2 * np.pi * 3.01e4 * T)
    assert_said(moved(wave))
    assert_said(moved(0 * wave), "^the displacement does not change at all")
    rms = 1e-6 / np.sqrt(2)
    assert_said(moved(wave + 0.45 * rms))
    for sign in (-1, 1):
        assert_said(moved(wave + 0.57 * sign * rms), r"offset of 0\.6 times its r\.m\.s\. value")
    for limits, end in (((None, 0.7e-6), "largest"), ((-0.7e-6, None), "smallest")):
        assert_said(moved(np.clip(wave, *limits)), f"^the displacement is at its {end} value in ")
    assert_said(moved(1e-6 * np.cos(2 * np.pi * 7.913e4 * T)))
    fast = 1e-6 * np.cos(2 * np.pi * 8.113e4 * T)
    assert_said(moved(fast), r"strongest line at 81.1 kHz, with 4\.9 samples a period")


@pytest.mark.parametrize(
    ("share", "mains", "count", "heard"),
    [
        (0.03, 50.0, 20_000, 1),
        (0.03, 60.0, 20_000, 1),
        (0.015, 50.0, 20_000, 0),
        (0.03, 55.0, 20_000, 0),
        # Seven periods of it are too few to tell it from a drift.
        (0.03, 50.0, 14_000, 0),
    ],
)
def test_mains_hum(share: float, mains: float, count: int, heard: int) -> None:
    time = np.arange(count) / 1e5
    hum = share * np.cos(2 * np.pi * mains * time + 1.0)
    x = 1e-6 * (np.cos(2 * np.pi * 15708.3 * time) + hum)
    volts = 5 * np.cos(2 * np.pi * 13591.4 * time)
    pattern = f"^the displacement holds {mains:.0f} Hz of 3 % of its largest swing"
    assert_said(kinds.RawSignals(time, volts, x), *[pattern] * heard)


def test_a_friction_bench_with_signs_or_columns_changed() -> None:
    time = np.linspace(0, 1.0, 500)
    random = np.random.default_rng(1)
    noise = 0.01 * random.normal(size=(2, time.size))
    normal, tangential = 0.5 + noise[0], 0.3 + noise[1]
    good = kinds.FrictionBench(time, normal, tangential, 0.05 * time, 0 * time)
    assert_said(good)
    assert_said(
        dataclasses.replace(good, normal_force=-normal), "^the normal force is negative most"
    )
    assert_said(
        dataclasses.replace(good, normal_force=tangential / 10),
        r"^the tangential force is 10\.0 times the normal force",
    )
    assert_said(dataclasses.replace(good, position=0 * time), "^the position does not change")
    for name, force in (("normal", normal), ("tangential", tangential)):
        clipped = dataclasses.replace(
            good, **{f"{name}_force": np.minimum(force, np.median(force))}
        )
        assert_said(clipped, f"^the {name} force is at its largest value in 250 samples, first at ")


A = np.array([0.0, 1e-6, 2e-6])


def test_a_friction_curve_that_leaves_things_open() -> None:
    good = kinds.FrictionCurve(
        A, np.array([1.0, 0.6, 0.4]), 3e4, 0.5, 0.05, np.full(3, 0.02), display="biet2008-plate"
    )
    assert_said(good)

    def but(**changes: object) -> kinds.FrictionCurve:
        return dataclasses.replace(good, **changes)  # type: ignore[arg-type]

    assert_said(but(friction=np.array([1.0, 0.3, -0.1])), r"goes down to -0\.1, below zero")
    assert_said(but(friction=np.array([1.0, 1.45, 0.4])))
    assert_said(but(friction=np.array([1.0, 1.6, 0.4])), r"^µ′/µ goes up to 1\.6: .*%")
    assert_said(but(friction=np.array([1.09, 0.6, 0.4])))
    for off in (0.85, 1.15):
        assert_said(but(friction=np.array([off, 0.6, 0.4])), rf"^µ′/µ is {off} where nothing vib")
    # Where nothing was recorded without vibration, or of plain friction, 1 means nothing.
    assert_said(but(friction=np.array([0.8, 0.6, 0.4]), vibration_amplitude=A + 1e-7))
    assert_said(but(friction=np.array([2.0, 0.6, 0.4]), quantity="friction_coefficient"))
    for spread in (None, np.zeros(3)):
        assert_said(but(spread=spread), "^no spread is given")
    assert_said(but(normal_force=None), "^the normal force is not told")
    assert_said(but(speed=None), "^the speed is not told")
    assert_said(but(display=""), "^no display is named")


def test_of_other_kinds_nothing_is_doubted() -> None:
    assert doubts_of(kinds.FrictionDecays(A + 1e-7, np.full(3, 0.5), 3e4)) == ()
