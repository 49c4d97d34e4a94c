"""A law as a table: straight between its points, and known in its range only."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.chain.friction_table import FrictionTable
from squeezefilm.errors import InputError, OutOfRangeError

AMPLITUDE = np.array([0.0, 1e-6, 3e-6])
TABLE = FrictionTable(AMPLITUDE, np.zeros(1), np.array([[1.0, 0.6, 0.2]]), 0.1)
SPEEDS = FrictionTable(
    AMPLITUDE, np.array([0.0, 0.1, 0.3]), np.array([[1, 0, 0], [1, 0.6, 0.2], [1, 0.8, 0.6]]), 0.1
)


def test_it_is_straight_between_its_points() -> None:
    asked = np.array([[0.0, 0.5e-6], [2e-6, 3e-6]])
    assert TABLE(asked) == pytest.approx(np.array([[1.0, 0.8], [0.4, 0.2]]))
    assert TABLE(np.array([3e-6 * (1 + 1e-10)])) == pytest.approx([0.2])


def test_over_speeds_it_is_straight_too_and_held_beyond_the_last() -> None:
    amplitude, speed = np.array([0.5e-6, 2e-6, 2e-6, 3e-6]), np.array([0.1, -0.2, 9.0, 0.0])
    assert SPEEDS(amplitude, speed) == pytest.approx([0.8, 0.55, 0.7, 0.0])
    assert SPEEDS(amplitude[:2]) == pytest.approx([0.8, 0.4])
    assert SPEEDS(amplitude[:2], 0.05) == pytest.approx([0.65, 0.2])
    assert SPEEDS.at_speed(-0.2) == pytest.approx([1.0, 0.7, 0.4])
    assert SPEEDS.over_speeds(np.array([2e-6])) == pytest.approx(np.array([[0.0], [0.4], [0.7]]))
    # One row stands for every speed.
    assert TABLE(amplitude, speed) == pytest.approx(TABLE(amplitude))
    assert TABLE.at_speed(7.0) == pytest.approx([1.0, 0.6, 0.2])


@pytest.mark.parametrize("amplitude", [-1e-9, 3.1e-6])
def test_outside_of_its_range_it_is_not_known(amplitude: float) -> None:
    with pytest.raises(OutOfRangeError, match="tabulate it higher"):
        TABLE(np.array([1e-6, amplitude]))


@pytest.mark.parametrize("amplitude", [np.array([np.nan]), np.zeros(0)])
def test_what_is_no_number_is_refused(amplitude: np.ndarray) -> None:
    with pytest.raises(InputError):
        TABLE(amplitude)
