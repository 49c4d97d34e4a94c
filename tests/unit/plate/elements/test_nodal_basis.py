"""Nodal line elements: values and slopes at points, shared nodes, edges graded to corners."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.plate.elements.lobatto import lobatto_nodes
from squeezefilm.plate.elements.nodal_basis import (
    gauss_points,
    graded_edges,
    lagrange,
    node_coordinates,
)


@pytest.mark.parametrize("degree", [1, 2, 5])
def test_lagrange_polynomials_carry_a_polynomial_and_its_slope(degree: int) -> None:
    at = (-1.0, -0.3, 0.4, 1.0)
    values, slopes = lagrange(degree, at)
    assert values.shape == slopes.shape == (4, degree + 1)
    wanted = np.polynomial.Polynomial(np.arange(1.0, degree + 2))
    nodal = wanted(lobatto_nodes(degree))
    assert values @ nodal == pytest.approx(wanted(np.array(at)))
    assert slopes @ nodal == pytest.approx(wanted.deriv()(np.array(at)))
    assert values[0] == pytest.approx([1.0] + degree * [0.0])


@pytest.mark.parametrize("count", [1, 2, 5])
def test_gauss_points_are_exact_to_their_degree_and_no_further(count: int) -> None:
    points, weights = gauss_points(count)
    for power in range(2 * count):
        exact = 2 / (power + 1) if power % 2 == 0 else 0.0
        assert weights @ points**power == pytest.approx(exact, abs=1e-14)
    assert abs(weights @ points ** (2 * count) - 2 / (2 * count + 1)) > 1e-4


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
    fine = graded_edges([1.0, 2.0], 0.5, [1.0, 2.0], levels=2)
    fan = [0.5 * 0.15**2, 0.5 * 0.15]
    assert fine == pytest.approx([1.0, *(1.0 + np.array(fan)), 1.5, 2 - fan[1], 2 - fan[0], 2.0])


def test_no_element_is_shorter_than_the_shortest() -> None:
    for shortest, kept in ((0.001, 3), (0.01, 2), (0.1, 1), (0.2, 0)):
        edges = graded_edges([0.0, 1.0], 1.0, [0.0, 1.0], levels=3, shortest=shortest)
        assert edges.size == 2 + 2 * kept
        assert edges == pytest.approx(1.0 - edges[::-1])
        assert np.diff(edges).min() > shortest


def test_a_corner_is_met_within_rounding_only() -> None:
    assert graded_edges([0.0, 1.0], 1.0, [0.5e-9]).size == 3
    assert graded_edges([0.0, 1.0], 1.0, [2e-9]).size == 2
    assert graded_edges([0.0, 1.0], 1.0, [5.0, 1.0]).size == 3
