"""Nodal line elements: values and slopes at points."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.physics.plate.elements.lobatto import gauss_points, lagrange, lobatto_nodes


@pytest.mark.parametrize("degree", [1, 2, 5])
def test_lagrange_polynomials_carry_a_polynomial_and_its_slope(degree: int) -> None:
    at = (-1.0, -0.3, 0.4, 1.0)
    values, slopes = lagrange(degree, at)
    assert values.shape == slopes.shape == (4, degree + 1)
    wanted = np.polynomial.Polynomial(np.arange(1.0, degree + 2))
    nodal = wanted(lobatto_nodes(degree))
    assert values @ nodal == pytest.approx(wanted(np.array(at)), abs=1e-12)
    assert slopes @ nodal == pytest.approx(wanted.deriv()(np.array(at)), abs=1e-12)
    assert values[0] == pytest.approx([1.0] + degree * [0.0], abs=1e-12)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_gauss_points_are_exact_to_their_degree_and_no_further(count: int) -> None:
    points, weights = gauss_points(count)
    for power in range(2 * count):
        exact = 2 / (power + 1) if power % 2 == 0 else 0.0
        assert weights @ points**power == pytest.approx(exact, abs=1e-14)
    assert abs(weights @ points ** (2 * count) - 2 / (2 * count + 1)) > 1e-4
