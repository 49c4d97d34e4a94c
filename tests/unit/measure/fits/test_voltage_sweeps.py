"""Sweeps at several voltages: the backbone, the jump up and the jump down."""

import dataclasses

import numpy as np
import pytest
from tests.made_bench.duffing import SofteningResonance

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.vibration.voltage_sweeps import (
    _Duffing,
    _Points,
    fit_voltage_sweeps,
)
from squeezefilm.measure.recordings.kinds import FrequencyResponse, VoltageSweeps

F = np.linspace(31.5e3, 34.5e3, 90)
SIZE = 2e-6
SOFT = SofteningResonance(33.2e3, 60.0, SIZE / 15, -0.02 / SIZE**2, 0.05 / SIZE)


def bench(true: SofteningResonance = SOFT, noise: float = 0.005, volts=(2.0, 6.0, 15.0)):
    random, sweeps, ways = np.random.default_rng(1), [], []
    for V in volts:
        for way in ("up", "down"):
            f = F if way == "up" else F[::-1]
            x = true.swept(f, V)
            parts = noise * SIZE / np.sqrt(2) * random.standard_normal((2, f.size))
            sweeps.append(FrequencyResponse(f, (x + parts[0] + 1j * parts[1]) / V, V))
            ways.append(way)
    return VoltageSweeps(tuple(sweeps), tuple(ways))


def test_the_backbone_is_recovered() -> None:
    fit = fit_voltage_sweeps(bench())
    assert fit.law == "quadratic"
    assert fit.adequacy.adequate
    assert fit.backbone.value == pytest.approx(SOFT.backbone, rel=0.02)
    assert fit.damping_rise.value == pytest.approx(SOFT.damping_rise, rel=0.3)
    bent = fit.frequency.value * (1 + fit.backbone.value * SIZE**2)
    assert bent == pytest.approx(33.2e3 * 0.98, rel=1e-3)


@pytest.mark.slow
def test_jumps_begin_at_the_critical_amplitude() -> None:
    true = SOFT._replace(damping_rise=0.0)
    fit = fit_voltage_sweeps(bench(true))
    assert fit.critical_amplitude is not None
    # The voltage at which the largest of a fine sweep's steps grows beyond all bounds.
    fine = np.linspace(32.6e3, 33.3e3, 1500)

    def hysteresis(volts: float) -> float:
        up, down = true.swept(fine, volts), true.swept(fine[::-1], volts)[::-1]
        return float(np.max(np.abs(np.abs(up) - np.abs(down))))

    critical = fit.critical_amplitude * 15 / SIZE
    assert hysteresis(0.9 * critical) < 0.01 * SIZE
    assert hysteresis(1.15 * critical) > 0.05 * SIZE


def test_a_shift_in_proportion_to_the_amplitude_is_another_law() -> None:
    sweeps = bench()
    # Every sweep of a linear plate, moved by its own amplitude: x = swept where f is moved back.
    rows = []
    for one in sweeps.sweeps:
        x = np.asarray(one.displacement_per_volt) * one.voltage
        moved = one.frequency * (1 - 0.02 * np.abs(x) / SIZE) / (1 - 0.02 * np.abs(x / SIZE) ** 2)
        order = np.argsort(moved)
        rows.append(FrequencyResponse(moved[order], x[order] / one.voltage, one.voltage))
    fit = fit_voltage_sweeps(VoltageSweeps(tuple(rows), ("up",) * len(rows)))
    assert fit.law == "linear"
    assert fit.backbone.unit == "1/m"
    assert fit.critical_amplitude is None


def test_a_linear_plate_has_no_backbone() -> None:
    fit = fit_voltage_sweeps(bench(SOFT._replace(backbone=0.0, damping_rise=0.0)))
    assert fit.backbone.interval[0] < 0 < fit.backbone.interval[1]
    assert fit.critical_amplitude is None


def test_another_mode_in_the_band_is_a_misfit() -> None:
    recording = bench()
    more = 0.3 * SIZE / 15 / 60 / (1 + 1j / 60 - (F / 33.9e3) ** 2)
    sweeps = tuple(
        dataclasses.replace(
            one,
            displacement_per_volt=one.displacement_per_volt
            + (more if one.frequency[0] < one.frequency[-1] else more[::-1]),
        )
        for one in recording.sweeps
    )
    fit = fit_voltage_sweeps(dataclasses.replace(recording, sweeps=sweeps))
    assert not fit.adequacy.adequate
    assert "kHz" in fit.adequacy.where
    assert fit.observations == ()


def test_a_phase_of_the_other_sign_is_noticed() -> None:
    recording = bench()
    sweeps = tuple(
        dataclasses.replace(one, displacement_per_volt=one.displacement_per_volt.conj())
        for one in recording.sweeps
    )
    fit = fit_voltage_sweeps(dataclasses.replace(recording, sweeps=sweeps))
    assert fit.phase_reversed
    assert fit.quality_factor.value == pytest.approx(60, rel=0.05)


def test_what_tells_of_no_amplitude_is_refused() -> None:
    good = bench()
    one = good.sweeps[0]
    for sweeps, ways, words in (
        ((one,), ("up", "down"), "directions"),
        ((one, one), ("up", "up"), "one voltage"),
        ((FrequencyResponse(F, np.ones(90) + 1j),), ("up",), "no voltage"),
        ((FrequencyResponse(F[:5], np.ones(5) + 1j, 1.0),), ("up",), "at least 30"),
        ((FrequencyResponse(F, np.ones(90) + 0j, 1.0),), ("up",), "no phase"),
    ):
        with pytest.raises(InputError, match=words):
            fit_voltage_sweeps(VoltageSweeps(sweeps, ways))


@pytest.mark.parametrize("law", ["quadratic", "linear"])
def test_a_step_to_the_curve_is_newtons_and_a_fold_has_none(law) -> None:
    """Against differences of the equation of motion in the real and the imaginary part."""
    random = np.random.default_rng(6)
    u = random.normal(size=12) + 1j * random.normal(size=12)
    v = random.uniform(0.2, 1, 12)
    f = 30e3 * random.uniform(0.98, 1.02, 12)
    at = np.array([0.003, 0.02, -0.01, 0.1, 0.03, -0.02, 0.01, 0.02])

    def missed(u):
        """D(|u|)·(u − R v) − g v, with the backbone and the loss written out."""
        a = np.abs(u)
        back = (1 + at[2] * a ** (2 if law == "quadratic" else 1)) * (1 + at[0])
        D = back**2 * (1 + 1j * at[1] * (1 + at[3] * a)) - (f / 30e3) ** 2
        return D * (u - (at[6] + 1j * at[7]) * v) - (at[4] + 1j * at[5]) * v, D

    h = 1e-6
    rows = [(missed(u + d)[0] - missed(u - d)[0]) / (2 * h) for d in (h, 1j * h)]
    slopes = np.array([[row.real for row in rows], [row.imag for row in rows]])
    slopes, (wanted, D) = slopes.transpose(2, 0, 1), missed(u)
    newton = np.linalg.solve(slopes, np.stack([wanted.real, wanted.imag], axis=1)[..., None])
    duffing = _Duffing(_Points(f, u, v, 1e-6, 10.0), law, 30e3)
    step, determinant = duffing.steps_to_curve(at)
    assert step == pytest.approx(newton[:, 0, 0] + 1j * newton[:, 1, 0], rel=1e-5)
    assert determinant == pytest.approx(np.linalg.det(slopes) / abs(D) ** 2, rel=1e-5)
