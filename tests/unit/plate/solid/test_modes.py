"""Shapes of a plate's modes as products of one along and one across."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.plate.elements.nodal_lines import zero_crossings
from squeezefilm.plate.solid.modes import profiles


def test_a_shape_is_split_into_its_nearest_product() -> None:
    along, across = np.array([1.0, -2.0, 3.0]), np.array([0.6, 0.8])
    shape = np.outer(along, across)
    x, y, share = profiles(shape)
    assert np.outer(x, y) == pytest.approx(shape)
    assert share == pytest.approx(1.0)
    # A second product at right angles to it, of a third of its size, takes its square's share.
    other = np.outer([2.0, 1.0, 0.0], [-0.8, 0.6])
    other *= np.linalg.norm(shape) / 3 / np.linalg.norm(other)
    x, y, share = profiles(shape + other)
    assert np.outer(x, y) == pytest.approx(shape)
    assert share == pytest.approx(0.9)
    assert profiles(np.zeros((3, 2)))[2] == 0.0


def test_a_profile_crosses_zero_between_two_points() -> None:
    x = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    crossed = zero_crossings(x, np.array([1.0, -3.0, 1e-9, -1.0, 2.0]))
    assert crossed == pytest.approx([0.25, 3 + 1 / 3])
