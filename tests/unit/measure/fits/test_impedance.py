"""Circuits out of sweeps: what is found, chosen, refused and said."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import replace

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.circuit.branches import Layout, circuit_curve, relative_motion
from squeezefilm.measure.fits.circuit.impedance import fit_impedance, parallel_resonance
from squeezefilm.measure.fits.complex_fit import sweep_peaks
from squeezefilm.measure.recordings.kinds import ImpedanceSweep

FREQUENCY = np.linspace(25.5e3, 32.5e3, 401)
TRUTH = np.array([np.log(3.3e-9), 0.01, np.log(28.1e3), np.log(75.0), np.log(4.6e-10)])


def noisy(curve: si.ComplexArray, noise: float, seed: int = 1) -> si.ComplexArray:
    white = np.random.default_rng(seed).standard_normal((2, curve.size))
    return np.asarray(curve * (1 + noise * (white[0] + 1j * white[1])))


def sweep_of(layout: Layout, truth: si.FloatArray, noise: float = 1e-3) -> ImpedanceSweep:
    return ImpedanceSweep(FREQUENCY, noisy(circuit_curve(layout, truth, FREQUENCY)[0], noise))


PLAIN = sweep_of(Layout(1), TRUTH)


def test_a_circuit_is_found_and_its_numbers_belong_together() -> None:
    fit = fit_impedance(PLAIN)
    branch = fit.strongest
    assert (len(fit.branches), fit.coupling_loss, fit.drift) == (1, None, None)
    assert fit.adequacy.adequate
    assert branch.series_resonance.value == pytest.approx(28.1e3, rel=1e-4)
    assert branch.quality_factor.value == pytest.approx(75, rel=0.01)
    omega = 2 * np.pi * branch.series_resonance.value
    L, C, R = (
        getattr(branch, f"motional_{name}").value
        for name in ("inductance", "capacitance", "resistance")
    )
    assert pytest.approx(1) == omega**2 * L * C
    assert pytest.approx(branch.quality_factor.value) == omega * L / R
    fs, fp = branch.series_resonance.value, branch.parallel_resonance.value
    assert fp / fs == pytest.approx(np.sqrt(1 + C / fit.static_capacitance.value))
    assert branch.coupling_coefficient.value == pytest.approx(np.sqrt(1 - (fs / fp) ** 2))
    names = {one.answer for one in fit.observations}
    assert {"resonance_frequency", "parallel_resonance_frequency", "quality_factor"} <= names
    # It follows from the two resonances.
    assert "coupling_coefficient" not in names
    assert fit.admittance(FREQUENCY) == pytest.approx(PLAIN.admittance, rel=0.02)


@pytest.mark.parametrize("noise", [1e-4, pytest.param(0.02, marks=pytest.mark.slow)])
def test_two_modes_are_told_from_one(noise: float) -> None:
    truth = np.concatenate([TRUTH, [np.log(29.3e3), np.log(90.0), np.log(2e-10)]])
    fit = fit_impedance(sweep_of(Layout(2), truth, noise))
    assert [round(one.series_resonance.value / 1e3, 1) for one in fit.branches] == [28.1, 29.3]
    assert fit.main == 0
    assert fit.branches[0].parallel_resonance.value < 29.3e3
    alone = fit_impedance(sweep_of(Layout(2), truth, noise), branches=1)
    assert not alone.adequacy.adequate


@pytest.mark.slow
def test_five_modes_of_a_wide_band_are_found() -> None:
    """Two of them improve the fit little by themselves: it must look further than one step."""
    truth = TRUTH[:2]
    for f, quality, capacitance in (
        (20e3, 80, 1.3e-10),
        (33e3, 60, 3e-11),
        (45e3, 60, 3e-11),
        (61e3, 60, 3e-11),
        (80e3, 90, 7e-11),
    ):
        truth = np.append(truth, np.log([f, quality, capacitance]))
    frequency = np.linspace(10e3, 100e3, 1500)
    curve = circuit_curve(Layout(5), truth, frequency)[0]
    fit = fit_impedance(ImpedanceSweep(frequency, noisy(curve, 0.003)))
    found = [one.series_resonance.value for one in fit.branches]
    assert found == pytest.approx([20e3, 33e3, 45e3, 61e3, 80e3], rel=1e-3)
    assert (fit.main, fit.adequacy.adequate) == (0, True)


@pytest.mark.parametrize(
    ("quality", "capacitance", "band", "points"),
    [
        (2000.0, 2e-10, (27e3, 31e3), 401),
        (8.0, 4e-10, (18e3, 45e3), 401),
        (100.0, 2e-13, (27e3, 29.2e3), 401),
        (100.0, 2e-10, (27e3, 30e3), 25),
        (75.0, 2e-10, (28e3, 31e3), 201),
    ],
    ids=["sharp", "flat", "weak", "few points", "at the edge of the band"],
)
def test_resonances_of_all_sorts_are_found(
    quality: float, capacitance: float, band: tuple[float, float], points: int
) -> None:
    truth = TRUTH.copy()
    truth[3:] = np.log([quality, capacitance])
    frequency = np.linspace(*band, points)
    curve = circuit_curve(Layout(1), truth, frequency)[0]
    fit = fit_impedance(ImpedanceSweep(frequency, noisy(curve, 1e-4)))
    assert len(fit.branches) == 1
    assert fit.strongest.series_resonance.value == pytest.approx(28.1e3, rel=1e-3)
    assert fit.strongest.quality_factor.value == pytest.approx(quality, rel=0.05)


def test_a_coupling_that_loses_is_told() -> None:
    truth = np.append(TRUTH, 0.02)
    fit = fit_impedance(sweep_of(Layout(1, coupling_loss=True), truth))
    assert fit.coupling_loss is not None
    low, high = fit.coupling_loss.interval
    assert low < 0.02 < high
    assert len(fit.branches) == 1


def softened(g: float, h: float, noise: float) -> ImpedanceSweep:
    """A sweep of a branch that softens, its motion and its curve made to agree."""
    layout = Layout(1, coupling_loss=True, softening=True)
    held = 2j * np.pi * FREQUENCY * np.exp(TRUTH[0]) * (1 - 1j * TRUTH[1])
    motion = np.zeros(FREQUENCY.size)
    for _ in range(80):
        curve = circuit_curve(layout, np.append(TRUTH, [0.0, g, h]), FREQUENCY, motion)[0]
        motion = relative_motion(held, FREQUENCY, curve)
    return ImpedanceSweep(FREQUENCY, noisy(curve, noise))


@pytest.mark.parametrize("noise", [pytest.param(1e-4, marks=pytest.mark.slow), 5e-3])
def test_a_branch_that_softens_is_told(noise: float) -> None:
    fit = fit_impedance(softened(0.008, 0.3, noise))
    assert fit.softening is not None
    # From rest to the largest motion: f falls by 1 − 1/√1.008, 1/Q rises by 1/0.7 − 1.
    assert fit.softening.frequency_fall.value == pytest.approx(0.00398, abs=3e-4)
    assert fit.softening.loss_rise.value == pytest.approx(0.43, abs=0.05)
    assert fit.strongest.series_resonance.value == pytest.approx(28.1e3, rel=3e-4)
    assert fit.strongest.quality_factor.value == pytest.approx(75, rel=0.03)
    assert "softens" in fit.adequacy.sentence
    again = fit.admittance(FREQUENCY)
    assert again == pytest.approx(softened(0.008, 0.3, 0.0).admittance, rel=0.02)
    peaks = sweep_peaks(softened(0.008, 0.3, 0.0))
    assert fit.strongest.parallel_resonance.value == pytest.approx(
        peaks.resistance_frequency, rel=5e-4
    )


def test_a_linear_branch_is_not_said_to_soften() -> None:
    assert fit_impedance(PLAIN).softening is None


def test_a_drift_is_fitted_on_request_and_found_by_itself() -> None:
    drifting = sweep_of(Layout(1, drift=True), np.append(TRUTH, [0.1, 0.05]))
    fit = fit_impedance(drifting, drift=True)
    assert fit.drift == pytest.approx(0.1 + 0.05j, abs=5e-3)
    assert fit.strongest.quality_factor.value == pytest.approx(75, rel=0.01)
    assert fit.adequacy.adequate
    found = fit_impedance(drifting, branches=1)
    assert found.drift == pytest.approx(fit.drift, abs=5e-3)
    assert "alike" not in found.adequacy.sentence


def test_leads_are_fitted_where_told_and_doubted_where_a_loss_would_do_as_well() -> None:
    y = PLAIN.admittance
    leads = ImpedanceSweep(PLAIN.frequency, y / (1 + y * 30.0), compensated=False)
    told = fit_impedance(leads)
    assert told.layout.leads
    assert told.strongest.quality_factor.value == pytest.approx(75, rel=0.01)
    assert not fit_impedance(replace(leads, compensated=True)).layout.leads
    open_ = fit_impedance(replace(leads, compensated=None))
    low, high = open_.strongest.quality_factor.interval
    assert low < 75 < high
    assert "alike" in open_.adequacy.sentence or open_.layout.leads


@pytest.mark.parametrize(
    ("turn", "said"),
    [(lambda y: -y, "offset of 180°"), (np.conj, "wrong sign")],
)
def test_a_wrong_phase_is_refused_with_what_to_do(turn: object, said: str) -> None:
    assert callable(turn)
    with pytest.raises(InputError, match=said):
        fit_impedance(dataclasses.replace(PLAIN, admittance=turn(PLAIN.admittance)))


@pytest.mark.parametrize(
    ("frequency", "admittance", "said"),
    [
        (FREQUENCY[:9], PLAIN.admittance[:9], "at least 16"),
        (FREQUENCY[::-1], PLAIN.admittance, "do not rise"),
        (FREQUENCY, np.where(FREQUENCY > 30e3, np.nan, PLAIN.admittance), "not finite"),
        pytest.param(
            FREQUENCY,
            2j * np.pi * FREQUENCY * 3e-9 * (1 - 0.01j),
            "could not be found",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_what_cannot_be_fitted_is_refused(
    frequency: si.HertzArray, admittance: si.ComplexArray, said: str
) -> None:
    with pytest.raises(InputError, match=said):
        fit_impedance(ImpedanceSweep(frequency, admittance))


def test_more_branches_than_there_are_can_be_asked_for_but_not_too_many() -> None:
    with pytest.raises(InputError, match="branches"):
        fit_impedance(PLAIN, branches=9)


def test_peaks_are_read_without_a_model() -> None:
    peaks = sweep_peaks(sweep_of(Layout(1), TRUTH, 0.0))
    fit = fit_impedance(PLAIN).strongest
    assert peaks.conductance_frequency == pytest.approx(fit.series_resonance.value, rel=2e-4)
    assert peaks.resistance_frequency == pytest.approx(fit.parallel_resonance.value, rel=2e-4)
    assert peaks.conductance == pytest.approx(1 / fit.motional_resistance.value, rel=0.02)


def test_the_parallel_resonance_lies_between_two_branches() -> None:
    truth = np.concatenate([TRUTH, [np.log(29.3e3), np.log(90.0), np.log(2e-10)]])
    first, second = (parallel_resonance(Layout(2), truth, k) for k in (0, 1))
    assert 28.1e3 < first < 29.3e3 < second
    # There the susceptance of the circuit without loss vanishes.
    lossless = truth.copy()
    lossless[[1, 3, 6]] = 0.0, 30.0, 30.0
    for at in (first, second):
        y = circuit_curve(Layout(2), lossless, np.array([at, 1.001 * at]))[0]
        assert abs(y[0]) < 1e-6 * abs(y[1])


@pytest.mark.slow
def test_an_instrument_without_ranges_is_fitted_by_its_own_noise() -> None:
    """The same noise everywhere, 1 % of the top: at the parallel resonance 100 % of the curve."""
    held = 0
    for seed in range(40):
        random = np.random.default_rng(seed).standard_normal((2, FREQUENCY.size))
        curve = circuit_curve(Layout(1), TRUTH, FREQUENCY)[0]
        noise = 0.01 * np.abs(curve).max() / np.sqrt(2) * (random[0] + 1j * random[1])
        fit = fit_impedance(ImpedanceSweep(FREQUENCY, curve + noise))
        assert len(fit.branches) == 1
        assert fit.adequacy.adequate
        low, high = fit.strongest.series_resonance.interval
        held += low < np.exp(TRUTH[2]) < high
    assert held >= 34
    assert "noise falls no further" in fit.adequacy.sentence


@pytest.mark.slow
def test_a_neighbour_under_such_noise_is_found_or_missed_aloud() -> None:
    """One that adds 6 % of the top, in the noise of 1 %."""
    curve = circuit_curve(Layout(1), TRUTH, FREQUENCY)[0]
    log_frequency, log_quality, log_capacitance = TRUTH[2:5]
    other = [TRUTH[0], 0.0, log_frequency - 0.04, log_quality, log_capacitance + np.log(0.06)]
    held = circuit_curve(Layout(1), np.array([TRUTH[0] - 30, *other[1:]]), FREQUENCY)[0]
    random = np.random.default_rng(3).standard_normal((2, FREQUENCY.size))
    noise = 0.01 * np.abs(curve).max() / np.sqrt(2) * (random[0] + 1j * random[1])
    fit = fit_impedance(ImpedanceSweep(FREQUENCY, curve + held + noise))
    assert len(fit.branches) == 2
    assert fit.adequacy.adequate
    assert fit.branches[0].series_resonance.value == pytest.approx(
        np.exp(log_frequency - 0.04), rel=2e-3
    )
    one = fit_impedance(ImpedanceSweep(FREQUENCY, curve + held + noise), branches=1)
    assert not one.adequacy.adequate


@pytest.mark.parametrize(("neighbour", "capacitance"), [(39.5e3, 1e-9), (40.3e3, 3e-9)])
def test_a_mode_above_the_band_is_not_taken_for_a_coil(
    neighbour: float, capacitance: float
) -> None:
    """It adds to the static capacitance, of which a coil of a millihenry would leave 40 %, and
    would move the resonance by 2 %."""
    f = np.linspace(30.93e3, 37.14e3, 161)

    def branch(own: float, size: float) -> np.ndarray:
        return np.asarray(2j * np.pi * f * size / (1 - (f / own) ** 2 + 1j * f / (own * 44)))

    y = 2j * np.pi * f * 59e-9 + branch(34.04e3, 3.43e-9) + branch(neighbour, capacitance)
    white = np.random.default_rng(0).standard_normal((2, f.size)) / math.sqrt(2)
    fit = fit_impedance(ImpedanceSweep(f, y + 0.01 * np.abs(y).max() * (white[0] + 1j * white[1])))
    seen = 59e-9 + capacitance / (1 - (34.04e3 / neighbour) ** 2)
    assert fit.static_capacitance.value == pytest.approx(seen, rel=0.05)
    assert fit.branches[fit.main].series_resonance.value == pytest.approx(34.04e3, rel=5e-4)
    assert fit.branches[fit.main].quality_factor.value == pytest.approx(44, rel=0.05)
