"""The numbers of cells and times that a film may be solved with."""

from __future__ import annotations

import numpy as np

from squeezefilm.physics.film.periodic.resolution import CELLS, CHECKS, TIMES, resolution_of


def test_times_are_odd_rise_and_are_checked_by_more_of_them() -> None:
    # An even number leaves the highest harmonic without a derivative.
    assert np.all(TIMES % 2 == 1)
    assert np.all(CHECKS % 2 == 1)
    assert np.all(np.diff(TIMES) > 0)
    assert np.all(np.diff(CHECKS) >= 0)
    assert np.all(TIMES < CHECKS)
    # No more than half as many again (of the fewest, two or four): a check is no solve of its own.
    assert np.all(np.maximum(1.5 * TIMES, TIMES + 4) >= CHECKS)
    # Steps of a third at most, so that none is much finer than was asked for.
    assert np.all(TIMES[1:] <= np.maximum(4 / 3 * TIMES[:-1] + 1, TIMES[:-1] + 2))


def test_cells_are_halved_twice_and_rise_by_half_at_most() -> None:
    assert np.all(CELLS % 4 == 0)
    assert np.all(np.diff(CELLS) > 0)
    assert np.all(CELLS[2:] <= 1.5 * CELLS[1:-1])


def test_a_resolution_has_its_times_and_those_that_check_them() -> None:
    for index, (times, checks) in enumerate(zip(TIMES, CHECKS, strict=True)):
        found = resolution_of(8, index)
        assert (found.cells, found.times.number, found.check.number) == (8, times, checks)
