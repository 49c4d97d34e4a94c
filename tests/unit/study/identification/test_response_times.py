"""Response times: summaries by hand, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.condition_means import response_time_summary

NAMES = ("a", "b", "c")
# Person, condition, time: three people, the third without "b"; nobody has "c".
PERSON = [0, 0, 0, 1, 1, 2, 2, 2]
KIND = [0, 0, 1, 0, 1, 0, 0, 0]
TIMES = [1.0, 2.0, 3.0, 5.0, 0.5, 4.0, 2.0, 1.0]


def test_a_summary_is_of_peoples_means() -> None:
    a, b = response_time_summary(PERSON, KIND, TIMES, NAMES, level=0.9)
    assert (a.name, a.trials, a.participants, a.level) == ("a", 6, 3, 0.9)
    assert (b.name, b.trials, b.participants) == ("b", 2, 2)
    own = [np.log([1.0, 2.0]), np.log([5.0]), np.log([4.0, 2.0, 1.0])]
    means = [one.mean() for one in own]
    half = stats.t.ppf(0.95, 2) * np.std(means, ddof=1) / math.sqrt(3)
    assert a.geometric_mean == pytest.approx(math.exp(np.mean(means)))
    assert a.low == pytest.approx(math.exp(np.mean(means) - half))
    assert a.high == pytest.approx(math.exp(np.mean(means) + half))


def test_times_that_were_not_taken_and_conditions_without_any_are_left_out() -> None:
    kept = response_time_summary(PERSON, KIND, TIMES, NAMES)
    holes = response_time_summary(
        [*PERSON, 7, 0], [*KIND, 2, 1], [*TIMES, math.nan, math.nan], NAMES
    )
    for one, other in zip(kept, holes, strict=True):
        assert (one.name, one.trials, one.low) == (other.name, other.trials, other.low)
    assert response_time_summary([], [], [], NAMES) == ()


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        (([0], [0, 0], [1.0, 1.0]), "one value a trial"),
        (([0, 0], [0, 0], [1.0]), "one value a trial"),
        (([[0]], [[0]], [[1.0]]), "one value a trial"),
        (([0], [0], [-1.0]), "response_time = -1"),
    ],
)
def test_rows_that_are_none_are_refused(rows: tuple[list, list, list], says: str) -> None:
    with pytest.raises(InputError, match=says):
        response_time_summary(*rows, NAMES)
    for level in (0.0, 1.0):
        with pytest.raises(InputError, match="level"):
            response_time_summary(PERSON, KIND, TIMES, NAMES, level)
