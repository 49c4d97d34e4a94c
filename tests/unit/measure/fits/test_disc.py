"""A disc's constants: what is given back, what only the prior says, what is refused."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest

from radial_mode import (
    Extrapolation,
    RadialPrediction,
    predict_radial_mode,
)
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import VACUUM_PERMITTIVITY
from squeezefilm.measure.fits.ceramic.constants import (
    PARAMETERS,
    DiscConstants,
    _doubted,
    ceramic_prior,
    compliances,
    coupling_read,
    disc_constants,
    disc_curve,
    permittivity_read,
)
from squeezefilm.measure.fits.complex_fit import SweepPeaks, sweep_peaks
from squeezefilm.measure.fits.estimate import Adequacy
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


def test_a_compliance_that_no_ceramic_has_is_doubted() -> None:
    good = Adequacy(True, 0.0, 0.0, "", "As noise would.")
    assert _doubted(good, 0.3) is good
    doubted = _doubted(good, math.log(0.15))
    assert not doubted.adequate
    assert "another mode was probably recorded" in doubted.sentence


@pytest.mark.slow
def test_the_second_mode_alone_is_told_to_be_another() -> None:
    second = disc_constants(disc_sweep(np.linspace(150e3, 195e3, 91)), DISC)
    assert not second.adequacy.adequate
    assert "another mode was probably recorded" in second.adequacy.sentence


def test_two_modes_in_one_sweep_are_fitted_together() -> None:
    both = disc_constants(disc_sweep(np.linspace(58e3, 195e3, 140)), DISC)
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

    opened = resonances[0] * math.sqrt(1 + square * shares[0] / (1 - square * shares[0]))
    read = coupling_read(SweepPeaks(resonances[0], 1.0, opened, 1.0), shares[0])
    assert read == pytest.approx(square)
    assert coupling_read(SweepPeaks(65e3, 1.0, 200e3, 1.0), 0.5) == 0.9
    f = np.linspace(30e3, 60e3, 40)
    y = 2j * np.pi * f * 1700 * VACUUM_PERMITTIVITY * geometry * (1 + square * (motion(f) - 1))
    assert permittivity_read(
        ImpedanceSweep(f, y), square, motion(f) + 0j, geometry
    ) == pytest.approx(1700)
