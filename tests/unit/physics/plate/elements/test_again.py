"""What is left out of a pickle is solved again, once, and nothing else is taken for it."""

import pickle
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

import squeezefilm as sf
from squeezefilm.physics.plate.solid.modes import SolvedAgain

SOLVED = []


@dataclass(frozen=True, eq=False)
class Solved(SolvedAgain):
    """A small number and many."""

    size: int
    numbers: np.ndarray
    _again: Callable[[], "Solved"] | None = None
    _bulk: ClassVar[tuple[str, ...]] = ("numbers",)


def solve() -> Solved:
    """A result that can be had again."""
    SOLVED.append(1)
    return Solved(3, np.arange(100_000.0), solve)


def test_the_bulk_stays_behind_and_is_solved_again_once() -> None:
    whole = solve()
    SOLVED.clear()
    sent = pickle.dumps(whole)
    assert len(sent) < 500
    there = pickle.loads(sent)
    assert there.size == 3
    assert not SOLVED
    np.testing.assert_array_equal(there.numbers, whole.numbers)
    assert there.numbers is there.numbers
    assert len(SOLVED) == 1


def test_without_a_way_to_solve_again_all_is_sent() -> None:
    there = pickle.loads(pickle.dumps(Solved(3, np.arange(9.0))))
    np.testing.assert_array_equal(there.numbers, np.arange(9.0))


def test_a_name_that_is_none_of_it_is_refused() -> None:
    with pytest.raises(AttributeError, match="Solved has no attribute 'nombers'"):
        _ = solve().nombers  # type: ignore[attr-defined]


@pytest.mark.nightly
def test_a_solved_plate_travels_small_and_answers_as_before() -> None:
    plate = sf.solve_plate("biet2008-plate", points=40)
    sent = pickle.dumps(plate)
    assert len(sent) < 2_000_000
    there = pickle.loads(sent)
    assert there.summary()["frequency_Hz"] == plate.summary()["frequency_Hz"]
    x, y = np.array([0.01]), np.array([0.02])
    np.testing.assert_allclose(
        there.response.displacement(x, y), plate.response.displacement(x, y), rtol=1e-9
    )
    height = plate.plate.thickness
    for one, other in zip(there.modes.shapes, plate.modes.shapes, strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_allclose(
        np.abs(there.solid.modes.field(0, x, y, height)),
        np.abs(plate.solid.modes.field(0, x, y, height)),
        rtol=1e-6,
    )
