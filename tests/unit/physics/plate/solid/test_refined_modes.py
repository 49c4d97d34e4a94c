"""A reduced plate moved to its extrapolated resonance: by how much, and when it is left alone."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.linalg import eigh

from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.layout import CeramicPatch, RectangularPlate
from squeezefilm.physics.plate.solid.coarse_modes import coarse_modes
from squeezefilm.physics.plate.solid.layers import COARSE
from squeezefilm.physics.plate.solid.reduced import ReducedClass, reduced_class, resolved_frequency
from squeezefilm.physics.plate.solid.refined_modes import EXTRAPOLATION, extrapolated_class

GLASS = ElasticMaterial("glass", 72e9, 0.22, 2480)
CERAMIC = Piezoceramic("P1-91", 67.9e9, 0.2897, 23e9, 7700, -247e-12, 1900, 60)
PLATE = RectangularPlate(
    24e-3, 14e-3, 1.2e-3, 3, 60, GLASS, CERAMIC,
    (CeramicPatch(2e-3, 0, 20e-3, 14e-3, 0.5e-3),),
)  # fmt: skip
BAND = (13e3, 16e3)


def resonances(one: ReducedClass) -> np.ndarray:
    return np.asarray(np.sqrt(eigh(one.stiffness, one.mass)[0].clip(0)) / (2 * np.pi))


@pytest.fixture(scope="module")
def reduced() -> ReducedClass:
    return reduced_class(PLATE, ("S", "S"), BAND, 4, [])


@pytest.mark.parametrize(
    ("band", "mode"),
    [
        (BAND, 0),
        # Of two in the band the one that is driven three times as hard.
        ((13e3, 38e3), 1),
        # Out of the band by a tenth of its frequency that counts for less.
        ((14e3, 32.6e3), 0),
        ((15.5e3, 33.5e3), 1),
    ],
)
def test_the_resonance_moves_by_its_share_of_the_two_meshes_difference(
    reduced: ReducedClass, band: tuple[float, float], mode: int
) -> None:
    moved = extrapolated_class(reduced, band)
    before = resonances(reduced)
    fine = float(before[mode])
    # The coarse mesh by itself, solved from nothing.
    coarse = coarse_modes(PLATE, ("S", "S"), fine, resolved_frequency(band), None, 1)
    a = float(np.sqrt(coarse.values[0]) / (2 * np.pi))
    assert abs(a - fine) > 1e-4 * fine
    ratio = resonances(moved)[-1] / before[-1]
    assert fine * ratio == pytest.approx(fine - EXTRAPOLATION[0] * (a - fine), rel=1e-7)
    assert moved.stiffness == pytest.approx(ratio**2 * reduced.stiffness)
    assert moved.loss == pytest.approx(ratio**2 * reduced.loss)
    assert moved.mass is reduced.mass
    assert moved.basis is reduced.basis


def test_it_is_left_alone_where_nothing_can_be_compared(reduced: ReducedClass) -> None:
    coarse = dataclasses.replace(reduced, resolution=COARSE)
    assert extrapolated_class(coarse, BAND) is coarse
    found = resonances(reduced)
    mode = float(found[(found > BAND[0]) & (found < BAND[1])][0])
    # A mode is near up to a tenth outside the band.
    for aside in (50.0, -50.0):
        for band in ((mode / 0.9 + aside, 20e3), (1e3, mode / 1.1 - aside)):
            assert (extrapolated_class(reduced, band) is reduced) == (aside > 0)
    undriven = dataclasses.replace(reduced, drive=0 * reduced.drive)
    assert extrapolated_class(undriven, BAND) is undriven
