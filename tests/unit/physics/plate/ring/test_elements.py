"""One harmonic of a ring as matrices: which row belongs to which field of which node."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.core.materials import ElasticMaterial
from squeezefilm.physics.plate.elements.box_model import isotropic_solid
from squeezefilm.physics.plate.ring.elements import (
    HarmonicSystem,
    graded_edges,
    harmonic_system,
    node_coordinates,
)
from squeezefilm.physics.plate.ring.section import AnnularSection, RingLayer

SOLID = isotropic_solid(ElasticMaterial("glass", 70e9, 0.22, 2500.0))


@pytest.fixture(scope="module")
def system() -> HarmonicSystem:
    section = AnnularSection((RingLayer(0.0, 10e-3, 0.0, 1e-3, SOLID),))
    return harmonic_system(section, 2, 2)


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


def test_nodes_are_shared_at_edges() -> None:
    found = node_coordinates(np.array([1.0, 3.0, 4.0]), 2)
    assert found == pytest.approx([1.0, 2.0, 3.0, 3.5, 4.0])
    # Degree 3: the inner nodes of −1…1 are ±1/√5.
    inner = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(5)
    assert node_coordinates(np.array([0.0, 1.0]), 3) == pytest.approx([0.0, *inner, 1.0])


def test_edges_hold_all_breaks_and_no_long_element() -> None:
    assert graded_edges([0.0, 1.0, 1.3], 0.5) == pytest.approx([0.0, 0.5, 1.0, 1.3])
    assert graded_edges([0.0, 1.0], 0.49) == pytest.approx([0.0, 1 / 3, 2 / 3, 1.0])
    # Rounding of a break does not ask for one element more.
    assert graded_edges([0.0, 1.0 + 1e-12], 0.5).size == 3
    assert graded_edges([2.0, 2.1], 1.0) == pytest.approx([2.0, 2.1])


def test_elements_shrink_towards_singular_corners() -> None:
    left = graded_edges([0.0, 1.0, 2.0], 1.0, [0.0])
    assert left == pytest.approx([0.0, 0.15, 1.0, 2.0])
    both = graded_edges([0.0, 1.0, 2.0], 1.0, [1.0])
    assert both == pytest.approx([0.0, 0.85, 1.0, 1.15, 2.0])
    # The elements next to the corner are the longest's, not the whole span's.
    fine = graded_edges([1.0, 2.0], 0.5, [1.0, 2.0])
    fan = 0.5 * 0.15
    assert fine == pytest.approx([1.0, 1.0 + fan, 1.5, 2 - fan, 2.0])


def test_no_element_is_shorter_than_the_shortest() -> None:
    for shortest, kept in ((0.1, 1), (0.2, 0)):
        edges = graded_edges([0.0, 1.0], 1.0, [0.0, 1.0], shortest)
        assert edges.size == 2 + 2 * kept
        assert edges == pytest.approx(1.0 - edges[::-1])
        assert np.diff(edges).min() > shortest


def test_a_corner_is_met_within_rounding_only() -> None:
    assert graded_edges([0.0, 1.0], 1.0, [0.5e-9]).size == 3
    assert graded_edges([0.0, 1.0], 1.0, [2e-9]).size == 2
    assert graded_edges([0.0, 1.0], 1.0, [5.0, 1.0]).size == 3


def test_a_stepped_section_has_its_own_height_mass_and_surface() -> None:
    """A web below and beside a ring that stands higher."""
    web = RingLayer(5e-3, 20e-3, -1e-3, 1e-3, SOLID)
    ring = RingLayer(20e-3, 30e-3, 0.5e-3, 4e-3, SOLID)
    section = AnnularSection((web, ring))
    assert (web.thickness, ring.thickness) == pytest.approx((2e-3, 3.5e-3))
    assert section.thickness == pytest.approx(5e-3)
    volume = math.pi * (2e-3 * (20**2 - 5**2) + 3.5e-3 * (30**2 - 20**2)) * 1e-6
    assert section.mass == pytest.approx(SOLID.density * volume)
    assert section.surface_radii == (20e-3, 30e-3)
    assert section.mean_diameter == pytest.approx(50e-3)
    shear = math.sqrt(SOLID.density / SOLID.stiffness[3, 3])
    assert section.shear_times == pytest.approx({SOLID.name: 3.5e-3 * shear})
