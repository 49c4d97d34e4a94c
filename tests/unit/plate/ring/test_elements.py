"""One harmonic of a ring as matrices: which row belongs to which field of which node."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.materials import ElasticMaterial
from squeezefilm.plate.ring.elements import HarmonicSystem, harmonic_system, ring_mesh
from squeezefilm.plate.ring.materials import isotropic_solid
from squeezefilm.plate.ring.section import AnnularSection, RingLayer


@pytest.fixture(scope="module")
def system() -> HarmonicSystem:
    glass = isotropic_solid(ElasticMaterial("glass", 70e9, 0.22, 2500.0))
    section = AnnularSection((RingLayer(0.0, 10e-3, 0.0, 1e-3, glass),))
    return harmonic_system(section, 2, 2, ring_mesh(section, graded=False))


def test_every_row_is_the_displacement_of_one_node(system: HarmonicSystem) -> None:
    n = system.displacements
    for row in range(n):
        vector = np.zeros(n)
        vector[row] = 1.0
        field = system.field(vector)
        assert field.shape == (system.r.size, 3)
        assert np.count_nonzero(field) >= 1
        assert np.abs(field).max() == 1.0
    assert np.count_nonzero(system.field(np.zeros(n))) == 0
