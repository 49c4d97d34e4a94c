"""A law as a table: straight between its points, and known in its range only."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.chain.friction_table import FrictionTable
from squeezefilm.errors import InputError, OutOfRangeError

TABLE = FrictionTable.of_amplitude(np.array([0.0, 1e-6, 3e-6]), np.array([1.0, 0.6, 0.2]))


def test_it_is_straight_between_its_points() -> None:
    asked = np.array([[0.0, 0.5e-6], [2e-6, 3e-6]])
    assert TABLE(asked) == pytest.approx(np.array([[1.0, 0.8], [0.4, 0.2]]))
    assert TABLE(np.array([3e-6 * (1 + 1e-10)])) == pytest.approx([0.2])


@pytest.mark.parametrize("amplitude", [-1e-9, 3.1e-6])
def test_outside_of_its_range_it_is_not_known(amplitude: float) -> None:
    with pytest.raises(OutOfRangeError, match="tabulate it higher"):
        TABLE(np.array([1e-6, amplitude]))


@pytest.mark.parametrize("amplitude", [np.array([np.nan]), np.zeros(0)])
def test_what_is_no_number_is_refused(amplitude: np.ndarray) -> None:
    with pytest.raises(InputError):
        TABLE(amplitude)
