"""Ceramics recorded at their second or third mode: the mode is found, and with it the constants."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.measure.fits.ceramic.bar import _curve as bar_curve
from squeezefilm.measure.fits.ceramic.bar import bar_constants
from squeezefilm.measure.fits.ceramic.constants import CeramicConstants, ceramic_prior
from squeezefilm.measure.fits.ceramic.disc import disc_constants, disc_curve
from squeezefilm.measure.recordings.kinds import CeramicBar, ImpedanceSweep
from squeezefilm.physics.plate.ring.ceramic_disc import CeramicDisc

DENSITY = 7700.0
# η of the radial modes at a Poisson ratio of 0.3: Meeker 1996, IEEE 176-1987.
RADIAL = {2: 5.39, 3: 8.57}


def noisy(curve: np.ndarray, random: np.random.Generator) -> np.ndarray:
    white = random.standard_normal((2, curve.size))
    return np.asarray(curve * (1 + 0.005 * (white[0] + 1j * white[1])))


def bar_found(truth: np.ndarray, mode: int, random: np.random.Generator) -> CeramicConstants:
    bar = CeramicBar(random.uniform(12e-3, 30e-3), 2.5e-3, 1e-3, DENSITY)
    own = np.array([truth[0], truth[2], truth[3], *truth[4:7]])
    resonance = (2 * mode - 1) / (2 * bar.length * math.sqrt(DENSITY * math.exp(truth[0])))
    frequency = np.linspace(0.96 * resonance, 1.06 * resonance, 301)
    curve = bar_curve(bar, own, 2 * np.pi * frequency)[0]
    return bar_constants(ImpedanceSweep(frequency, noisy(curve, random)), bar)


def disc_found(truth: np.ndarray, mode: int, random: np.random.Generator) -> CeramicConstants:
    disc = CeramicDisc(random.uniform(25e-3, 45e-3), 2e-3, DENSITY)
    speed = 1 / math.sqrt(DENSITY * math.exp(truth[0]) * (1 - truth[1] ** 2))
    resonance = RADIAL[mode] * speed / (math.pi * disc.diameter)
    frequency = np.linspace(0.95 * resonance, 1.08 * resonance, 201)
    curve = disc_curve(disc, frequency, truth, mode)[0]
    return disc_constants(ImpedanceSweep(frequency, noisy(curve, random)), disc)


@pytest.mark.campaign
def test_ten_ceramics_recorded_at_another_mode_than_the_first() -> None:
    """Constants within 3 %, or the fit says which other mode it may be."""
    random, known, errors = np.random.default_rng(48), ceramic_prior(of_class=True), []
    for number in range(10):
        truth = known.mean + 0.6 * known.spread * random.standard_normal(known.mean.size)
        truth[4:7], truth[7] = random.uniform(0.004, 0.02, 3), 0.0
        mode = int(random.integers(2, 4))
        found = (disc_found if number % 2 else bar_found)(truth, mode, random)
        error = [
            abs(found.compliance_11.value) / math.exp(truth[0]) - 1,
            abs(found.charge_coefficient_31.value) / math.exp(truth[2]) - 1,
            found.free_permittivity_33.value / math.exp(truth[3]) - 1,
        ]
        print(f"mode {mode} taken for {found.mode.number}: {np.round(100 * np.array(error), 2)} %")
        assert found.mode.number == mode
        errors.append(error)
    assert np.abs(errors).max() < 0.03
