"""A disc's constants: what is given back, what only the prior says, what is refused."""

from __future__ import annotations

import math
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from radial_mode import (
    Extrapolation,
    RadialPrediction,
    predict_radial_mode,
)
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import VACUUM_PERMITTIVITY
from squeezefilm.measure.fits.ceramic.constants import (
    DECISIVE,
    PARAMETERS,
    RecordedMode,
    _doubted,
    _evidence,
    ceramic_prior,
    compliances,
    coupling_read,
    permittivity_read,
)
from squeezefilm.measure.fits.ceramic.disc import (
    DiscConstants,
    disc_constants,
    disc_curve,
)
from squeezefilm.measure.fits.complex_fit import Prior
from squeezefilm.measure.fits.estimate import Adequacy
from squeezefilm.measure.fits.sweep_reading import SweepPeaks, sweep_peaks
from squeezefilm.measure.recordings.kinds import ImpedanceSweep
from squeezefilm.physics.plate.ring.ceramic_disc import CeramicDisc, disc_admittance, weak_constants

DISC = CeramicDisc(30e-3, 2.5e-3, 7700.0)
FREQUENCY = np.linspace(58e3, 84e3, 121)
TRUE = ceramic_prior().mean.copy()
TRUE[[1, 8, 9]] = 0.345, -0.44, 1.15
TRUE[[4, 5, 6]] = 0.012, 0.015, 0.018


def disc_sweep(frequency: np.ndarray = FREQUENCY, noise: float = 0.002) -> ImpedanceSweep:
    curve = disc_admittance(DISC, weak_constants(*compliances(TRUE)), frequency)[0]
    white = np.random.default_rng(4).standard_normal((2, curve.size))
    return ImpedanceSweep(frequency, curve * (1 + noise * (white[0] + 1j * white[1])))


@pytest.fixture(scope="module")
def found() -> DiscConstants:
    peaks = sweep_peaks(disc_sweep(noise=0))
    assert FREQUENCY[0] < peaks.conductance_frequency < peaks.resistance_frequency < FREQUENCY[-1]
    return disc_constants(disc_sweep(), DISC)


@pytest.mark.slow
def test_what_the_mode_tells_is_found_and_the_rest_stays_with_the_prior(
    found: DiscConstants,
) -> None:
    assert found.adequacy.residual < 0.004
    assert found.adequacy.adequate
    for estimate, true in (
        (found.poisson_ratio, TRUE[1]),
        (found.compliance_11, math.exp(TRUE[0])),
        (found.charge_coefficient_31, -math.exp(TRUE[2])),
        (found.free_permittivity_33, math.exp(TRUE[3])),
        (found.quality_factor, 1 / TRUE[4]),
        (found.charge_loss, TRUE[5]),
        (found.dielectric_loss, TRUE[6]),
    ):
        low, high = estimate.interval
        assert low < true < high, estimate
    # Poisson's ratio is left to the prior: the first mode hardly tells it.
    assert found.from_data["-s12/s11"] > 0.5
    assert found.from_data["ln |d31|"] < 0.01
    assert found.from_data["s44/s11"] > 0.9
    assert found.compliance_12.value < 0
    assert 0.3 < found.planar_coupling.value < 0.8
    assert found.observations == ()


def test_derivatives_are_those_of_differences() -> None:
    curve = partial(disc_curve, DISC, FREQUENCY[::30])
    slopes = curve(TRUE)[1]
    for k, name in enumerate(PARAMETERS):
        step = 1e-5 * np.eye(TRUE.size)[k]
        rise = (curve(TRUE + step)[0] - curve(TRUE - step)[0]) / 2e-5
        assert np.abs(rise - slopes[k]).max() < 1e-4 * np.abs(slopes[k]).max() + 1e-9, name


def test_the_prior_is_made_of_the_ceramics_of_the_library() -> None:
    prior = ceramic_prior()
    assert len(PARAMETERS) == prior.mean.size == prior.spread.size
    # PZT-4, -5A, -5H and -8: Poisson's ratio 0.29 to 0.35.
    assert 0.29 < prior.mean[1] < 0.35
    assert 0.01 < prior.spread[1] < 0.05
    s, d, eps = compliances(prior.mean)
    assert s[0].real > 0 > s[1].real
    assert d[0].real < 0 < d[1].real
    assert eps[1].real > 500


def test_a_thick_disc_and_a_sweep_without_the_mode_are_refused() -> None:
    with pytest.raises(InputError, match="times as wide as thick"):
        disc_constants(disc_sweep(), CeramicDisc(10e-3, 4e-3, 7700.0))
    above = np.linspace(84e3, 130e3, 60)
    with pytest.raises(InputError, match="not above the largest conductance"):
        disc_constants(disc_sweep(above, 0.0), DISC)


@pytest.fixture(scope="module")
def prediction(found: DiscConstants) -> RadialPrediction:
    return predict_radial_mode(found, disc_sweep(), draws=40)


@pytest.mark.slow
def test_the_second_mode_is_predicted_with_an_interval_that_holds_it(
    prediction: RadialPrediction,
) -> None:
    """The truth is one of constants that do not depend on frequency, which is allowed for."""
    truth = sweep_peaks(disc_sweep(np.linspace(155e3, 190e3, 400), 0.0))
    for estimate, true in (
        (prediction.series_resonance, truth.conductance_frequency),
        (prediction.parallel_resonance, truth.resistance_frequency),
        (prediction.peak_conductance, truth.conductance),
        (prediction.peak_resistance, truth.resistance),
    ):
        low, high = estimate.interval
        assert low < true < high, estimate
    wide = prediction.series_resonance.interval
    assert 0.005 < (wide[1] - wide[0]) / prediction.series_resonance.value < 0.08


@pytest.mark.slow
def test_poissons_ratio_limits_the_frequency_and_losses_the_conductance(
    prediction: RadialPrediction,
) -> None:
    frequency = {name: share[0] for name, share in prediction.shares.items()}
    assert max(frequency, key=lambda name: frequency[name]) == "Poisson's ratio"
    conductance = {name: share[2] for name, share in prediction.shares.items()}
    assert max(conductance, key=lambda name: conductance[name]) == "losses at another frequency"


@pytest.mark.slow
def test_its_own_mode_is_predicted_as_it_is(found: DiscConstants) -> None:
    one = predict_radial_mode(found, disc_sweep(), 1, draws=20)
    seen = sweep_peaks(disc_sweep(noise=0.0))
    assert one.series_resonance.value == pytest.approx(seen.conductance_frequency, rel=2e-3)
    assert one.peak_conductance.value == pytest.approx(seen.conductance, rel=0.05)


@pytest.mark.slow
def test_what_is_assumed_of_the_way_can_be_said(found: DiscConstants) -> None:
    still = Extrapolation(dispersion=0.0, dispersion_spread=0.0)
    without = predict_radial_mode(found, disc_sweep(), draws=20, assumed=still)
    with_it = predict_radial_mode(found, disc_sweep(), draws=20)
    # A loss of 0.012 over a factor of 2.6 in frequency: 2/π · 0.012 · ln 2.6 / 2 of the frequency.
    rise = with_it.series_resonance.value / without.series_resonance.value - 1
    assert rise == pytest.approx(0.012 * math.log(2.63) / math.pi, abs=1e-3)
    with pytest.raises(InputError, match="number"):
        predict_radial_mode(found, disc_sweep(), 9)


def test_a_compliance_that_no_ceramic_has_is_doubted_and_an_undecided_mode_too() -> None:
    good = Adequacy(True, 0.0, 0.0, "", "As noise would.")
    sure, unsure = RecordedMode(1, 2, 30.0), RecordedMode(2, 3, 1.0)
    assert _doubted(good, sure, 0.3).adequate
    doubted = _doubted(good, sure, math.log(0.15))
    assert not doubted.adequate
    assert "another mode was probably recorded" in doubted.sentence
    undecided = _doubted(good, unsure, 0.3)
    assert not undecided.adequate
    assert "decides nothing: sweep the lowest mode too" in undecided.sentence


@pytest.mark.slow
def test_the_second_mode_is_taken_for_the_second_and_gives_the_constants() -> None:
    second = disc_constants(disc_sweep(np.linspace(150e3, 195e3, 91)), DISC)
    assert second.mode.number == 2
    assert second.mode.preference > DECISIVE
    assert second.adequacy.adequate
    assert second.compliance_11.value == pytest.approx(math.exp(TRUE[0]), rel=0.04)
    assert second.charge_coefficient_31.value == pytest.approx(-math.exp(TRUE[2]), rel=0.04)
    assert second.free_permittivity_33.value == pytest.approx(math.exp(TRUE[3]), rel=0.03)
    low, high = second.compliance_11.interval
    assert low < math.exp(TRUE[0]) < high


def test_two_modes_in_one_sweep_are_fitted_together() -> None:
    both = disc_constants(disc_sweep(np.linspace(58e3, 195e3, 140)), DISC)
    assert both.mode.number == 1
    assert both.adequacy.adequate
    assert both.compliance_11.value == pytest.approx(math.exp(TRUE[0]), rel=0.01)
    # Of what was fitted: s12 = −σ s11 and k_p² = 2 d31²/(s11 ε33 (1 − σ)).
    s11, d31 = both.compliance_11.value, both.charge_coefficient_31.value
    poisson, permittivity = both.poisson_ratio.value, both.free_permittivity_33.value
    assert both.compliance_12.value == pytest.approx(-poisson * s11)
    assert both.planar_coupling.value**2 == pytest.approx(
        2 * d31**2 / (s11 * permittivity * VACUUM_PERMITTIVITY * (1 - poisson))
    )
    # The ratio of two radial modes tells Poisson's.
    assert both.from_data["-s12/s11"] < 0.2


def test_evidence_is_the_prior_over_what_the_data_leave() -> None:
    """Against the integral of the prior times the likelihood, where the latter is narrow."""
    prior = Prior(np.array([1.0, -2.0]), np.array([0.5, 2.0]))
    where = {0: ([1.2, -1.0], 0.02), 3: ([0.1, 1.5], 0.03)}
    correlated = np.array([[1.0, 0.4], [0.4, 2.0]])
    fits: Any = {
        number: SimpleNamespace(
            parameters=np.array(parameters),
            covariance=spread**2 * correlated,
            spread=spread,
            degrees_of_freedom=30,
        )
        for number, (parameters, spread) in where.items()
    }
    grid = (
        np.stack(np.meshgrid(*2 * [np.linspace(-6, 6, 201)]), axis=-1)
        @ np.linalg.cholesky(correlated).T
    )
    expected = {}
    for number, (parameters, spread) in where.items():
        places = np.array(parameters) + spread * grid
        likelihood = multivariate_normal(parameters, spread**2 * correlated)
        # Up to the constant of its best point: the likelihood falls as the covariance says.
        shape = likelihood.pdf(places) / likelihood.pdf(parameters)
        of_prior = multivariate_normal(prior.mean, np.diag(prior.spread**2)).pdf(places)
        cell = spread**2 * (12 / 200) ** 2 * np.sqrt(np.linalg.det(correlated))
        expected[number] = np.log(cell * np.sum(shape * of_prior)) - 30 * np.log(spread)
    found = _evidence(fits, prior)
    assert found[0] - found[3] == pytest.approx(expected[0] - expected[3], abs=0.02)


def test_a_body_without_losses_tells_its_coupling_and_permittivity() -> None:
    """Of two modes over a clamped capacitance, by the frequencies where Y and 1/Y have their poles
    and by all points."""
    square, shares, geometry = 0.12, (0.8, 0.15), 0.28
    resonances = np.array([65e3, 170e3])

    def motion(f: np.ndarray) -> np.ndarray:
        parts = [
            share / (1 - (f / own) ** 2) for share, own in zip(shares, resonances, strict=True)
        ]
        return np.sum(parts, axis=0) + 1 - sum(shares)

    for number, own in enumerate(resonances, 1):
        # Between the poles of this mode alone: those below stand still, those above give way.
        clamped = 1 - square * sum(shares[:number])
        opened = own * math.sqrt(1 + square * shares[number - 1] / clamped)
        read = coupling_read(SweepPeaks(own, 1.0, opened, 1.0), shares, number)
        assert read == pytest.approx(square)
    assert coupling_read(SweepPeaks(65e3, 1.0, 200e3, 1.0), (0.5, 0.2), 1) == 0.9
    f = np.linspace(30e3, 60e3, 40)
    y = 2j * np.pi * f * 1700 * VACUUM_PERMITTIVITY * geometry * (1 + square * (motion(f) - 1))
    assert permittivity_read(
        ImpedanceSweep(f, y), square, motion(f) + 0j, geometry
    ) == pytest.approx(1700)
