"""The factorised K − σM of plates with ceramics in places: its inverse, by its own operators."""

from __future__ import annotations

import numpy as np
import pytest
from tests.verification.random_plates import random_plate

from squeezefilm.physics.plate.elements.slab_modes import SlabFactor
from squeezefilm.physics.plate.solid.layers import COARSE
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.symmetry import all_classes


@pytest.mark.parametrize("seed", range(4))
def test_a_solution_fulfils_its_equations(seed: int) -> None:
    plate = random_plate(seed)
    slabs = plate_model(plate, 30e3, COARSE, all_classes(plate)[-1]).slabs
    shift = (2 * np.pi * 20e3) ** 2
    right = np.random.default_rng(seed).standard_normal((slabs.unknowns, 2))
    right[slabs.held] = 0
    kept = right.copy()
    x = SlabFactor(slabs, shift).solve(right)
    np.testing.assert_array_equal(right, kept)
    assert np.all(x[slabs.held] == 0)
    left = slabs.stiffness_times(x) - shift * slabs.mass_times(x)
    np.testing.assert_allclose(left, right, atol=1e-6 * np.abs(right).max())
