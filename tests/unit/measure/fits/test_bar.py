"""A bar's constants: given back by its formula, limits, refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import VACUUM_PERMITTIVITY
from squeezefilm.measure.fits.ceramic.constants import (
    BarConstants,
    CeramicConstants,
    bar_constants,
    resonance_peaks,
)
from squeezefilm.measure.recordings.kinds import CeramicBar, ImpedanceSweep

BAR = CeramicBar(12e-3, 3e-3, 1e-3, 7850.0)
FREQUENCY = np.linspace(110e3, 140e3, 301)
S11, D31, EPS33 = 13.48e-12, -140e-12, 1400.0
LOSSES = (0.011, 0.015, 0.02)


def bar_sweep(noise: float = 0.0, frequency: np.ndarray = FREQUENCY) -> ImpedanceSweep:
    """The admittance of a bar, written apart from the fit's formula."""
    s, d, eps = (
        value * (1 - 1j * loss)
        for value, loss in zip((S11, D31, EPS33 * VACUUM_PERMITTIVITY), LOSSES, strict=True)
    )
    omega = 2 * np.pi * frequency
    k2 = d**2 / (s * eps)
    x = omega * BAR.length / 2 / np.sqrt(1 / (BAR.density * s))
    y = 1j * omega * eps * BAR.length * BAR.width / BAR.thickness * (1 - k2 + k2 * np.tan(x) / x)
    white = np.random.default_rng(2).standard_normal((2, y.size))
    return ImpedanceSweep(frequency, y * (1 + noise * (white[0] + 1j * white[1])))


def test_its_constants_are_given_back() -> None:
    found = bar_constants(bar_sweep(), BAR)
    assert found.compliance_11.value == pytest.approx(S11, rel=1e-9)
    assert found.charge_coefficient_31.value == pytest.approx(D31, rel=1e-9)
    assert found.free_permittivity_33.value == pytest.approx(EPS33, rel=1e-9)
    assert found.quality_factor.value == pytest.approx(1 / 0.011, rel=1e-6)
    assert found.charge_loss.value == pytest.approx(0.015, rel=1e-6)
    assert found.dielectric_loss.value == pytest.approx(0.02, rel=1e-6)
    coupling = abs(D31) / math.sqrt(S11 * EPS33 * VACUUM_PERMITTIVITY)
    assert found.coupling_31.value == pytest.approx(coupling, rel=1e-9)
    assert found.adequacy.adequate
    assert found.observations == ()


def test_a_higher_mode_is_told_to_be_another() -> None:
    found = bar_constants(bar_sweep(0.002, 3 * np.linspace(124e3, 134e3, 301)), BAR)
    assert not found.adequacy.adequate
    assert "another mode was probably recorded" in found.adequacy.sentence


def test_intervals_hold_them_under_noise() -> None:
    found: BarConstants = bar_constants(bar_sweep(0.01), BAR)
    for estimate, true in (
        (found.compliance_11, S11),
        (found.charge_coefficient_31, D31),
        (found.free_permittivity_33, EPS33),
    ):
        low, high = estimate.interval
        assert low < estimate.value < high
        # Three half widths: one draw may lie outside of its own.
        assert abs(estimate.value - true) < 1.5 * (high - low)


def test_the_curve_is_the_one_that_was_fitted() -> None:
    sweep = bar_sweep()
    assert bar_constants(sweep, BAR).model == pytest.approx(sweep.admittance, rel=1e-7)


def test_losses_push_the_extremes_of_the_admittance_apart_and_not_the_fitted_coupling() -> None:
    """What the formula of a body without losses makes of the extremes, as sheets have it."""

    def by_extremes(found: BarConstants) -> float:
        size = np.abs(found.model)
        low, high = FREQUENCY[np.argmax(size)], FREQUENCY[np.argmin(size)]
        ratio = math.pi / 2 * high / low * math.tan(math.pi / 2 * (high / low - 1))
        return math.sqrt(ratio / (1 + ratio))

    found = bar_constants(bar_sweep(), BAR)
    assert 1.005 < by_extremes(found) / found.coupling_31.value < 1.02


def test_bar_and_disc_share_their_constants_and_the_residual_is_the_datas() -> None:
    sweep = bar_sweep(0.01)
    found = bar_constants(sweep, BAR)
    assert isinstance(found, CeramicConstants)
    assert found.model + found.residual == pytest.approx(sweep.admittance)
    assert resonance_peaks(sweep).conductance_frequency == pytest.approx(128e3, rel=0.01)
    # Swept from above the resonance on, it begins as a coil.
    above = ImpedanceSweep(FREQUENCY[200:], sweep.admittance[200:])
    with pytest.raises(InputError, match="begins within the resonance"):
        bar_constants(above, BAR)


def test_what_is_no_bar_and_what_is_no_resonance_are_refused() -> None:
    with pytest.raises(InputError, match="twice the largest"):
        CeramicBar(4e-3, 3e-3, 1e-3, 7850.0)
    sweep = bar_sweep()
    below = ImpedanceSweep(FREQUENCY[150:250], np.conj(1 / sweep.admittance[150:250]))
    with pytest.raises(InputError, match=r"resonance|leads"):
        bar_constants(below, BAR)
