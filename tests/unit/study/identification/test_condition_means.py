"""Means by condition over people, who are the random unit."""

from __future__ import annotations

import math

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.condition_means import condition_means


def test_means_are_over_people_not_trials() -> None:
    # One person with three trials of 1, one with a single trial of 3: the mean is 2.
    found = condition_means([0, 0, 0, 1, 0], [0, 0, 0, 0, 1], [1, 1, 1, 3, math.nan], ("a", "b"))
    assert [item.name for item in found] == ["a"]
    assert found[0].mean == 2
    assert (found[0].trials, found[0].participants) == (4, 2)
    assert found[0].high - 2 == pytest.approx(12.706, abs=1e-3)


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        (([0], [0, 0], [1.0, 1.0]), "one value a trial"),
        (([0, 0], [0, 0], [1.0]), "one value a trial"),
        (([[0]], [[0]], [[1.0]]), "one value a trial"),
    ],
)
def test_rows_that_are_none_are_refused(rows: tuple[list, list, list], says: str) -> None:
    with pytest.raises(InputError, match=says):
        condition_means(*rows, ("a",))


@pytest.mark.parametrize("level", [0.0, 1.0, 1.5])
def test_a_level_is_between_none_and_all(level: float) -> None:
    with pytest.raises(InputError, match="level"):
        condition_means([0, 1], [0, 0], [1.0, 2.0], ("a",), level)


def test_a_wider_level_reaches_further_and_one_person_nowhere() -> None:
    rows = ([0, 1, 2, 0], [0, 0, 0, 1], [1.0, 2.0, 6.0, 5.0])
    a, b = condition_means(*rows, ("a", "b"), 0.9)
    # Student's t of two degrees of freedom, 2.920, times √(7/3).
    assert (a.mean, a.level) == (3.0, 0.9)
    assert a.high - 3.0 == pytest.approx(2.919986 * math.sqrt(7 / 3), rel=1e-6)
    assert a.low == pytest.approx(6.0 - a.high)
    assert (b.mean, b.trials, b.participants) == (5.0, 1, 1)
    assert math.isnan(b.low)
    assert math.isnan(b.high)
    assert condition_means([], [], [], ("a",)) == ()
