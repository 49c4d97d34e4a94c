"""Response times: summaries by hand, ex-Gaussians that are refused, and the density's limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.response_times import (
    ExGaussian,
    ex_gaussian_density,
    fit_ex_gaussian,
    response_time_summary,
)

NAMES = ("a", "b", "c")
# Person, condition, time: three people, the third without "b"; nobody has "c".
PERSON = [0, 0, 0, 1, 1, 2, 2, 2]
KIND = [0, 0, 1, 0, 1, 0, 0, 0]
TIMES = [1.0, 2.0, 3.0, 5.0, 0.5, 4.0, 2.0, 1.0]


def test_a_summary_is_of_peoples_means_and_its_spread_of_their_own_trials() -> None:
    a, b = response_time_summary(PERSON, KIND, TIMES, NAMES, level=0.9)
    assert (a.name, a.trials, a.participants, a.level) == ("a", 6, 3, 0.9)
    assert (b.name, b.trials, b.participants) == ("b", 2, 2)
    own = [np.log([1.0, 2.0]), np.log([5.0]), np.log([4.0, 2.0, 1.0])]
    means = [one.mean() for one in own]
    half = stats.t.ppf(0.95, 2) * np.std(means, ddof=1) / math.sqrt(3)
    assert a.geometric_mean == pytest.approx(math.exp(np.mean(means)))
    assert a.low == pytest.approx(math.exp(np.mean(means) - half))
    assert a.high == pytest.approx(math.exp(np.mean(means) + half))
    # Six trials less three people's means.
    within = sum(float(((one - one.mean()) ** 2).sum()) for one in own)
    assert a.spread == pytest.approx(math.sqrt(within / 3))
    assert a.median == 2.0
    # One trial each: nothing to tell a spread from.
    assert math.isnan(b.spread)
    assert b.median == 1.75


def test_times_that_were_not_taken_and_conditions_without_any_are_left_out() -> None:
    kept = response_time_summary(PERSON, KIND, TIMES, NAMES)
    holes = response_time_summary(
        [*PERSON, 7, 0], [*KIND, 2, 1], [*TIMES, math.nan, math.nan], NAMES
    )
    for one, other in zip(kept, holes, strict=True):
        assert (one.name, one.trials, one.median) == (other.name, other.trials, other.median)
        assert one.low == pytest.approx(other.low)
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


def test_ten_times_that_differ_are_enough() -> None:
    times = np.array([0.5, 0.55, 0.6, 0.62, 0.65, 0.7, 0.8, 0.95, 1.3, 2.0])
    found = fit_ex_gaussian(np.append(times, math.nan))
    assert found.values == 10
    # μ + τ is the mean at the likeliest.
    assert found.mean + found.tail == pytest.approx(times.mean(), rel=1e-3)
    density = ex_gaussian_density(times, found)
    assert found.log_likelihood == pytest.approx(float(np.log(density).mean()), abs=1e-9)
    assert fit_ex_gaussian(times.reshape(2, 5)) == found
    for few, many in ((times[:9], 9), (np.full(12, 0.7), 12)):
        with pytest.raises(InputError, match=f"{many} response times .*have no ex-Gaussian"):
            fit_ex_gaussian(few)
    with pytest.raises(InputError, match="response_time"):
        fit_ex_gaussian(np.append(times, 0.0))


@pytest.mark.parametrize("tail", [1e-4, 0.02, 0.3, 30.0])
def test_the_density_is_right_from_a_short_tail_to_a_long_one(tail: float) -> None:
    fit = ExGaussian(0.5, 0.04, tail, 0.0, 10)
    t = np.linspace(0.35, 0.5 + 0.16 + 3 * tail, 60)
    if tail > 1e-3:
        oracle = stats.exponnorm.pdf(t, tail / 0.04, 0.5, 0.04)
    else:
        # A tail of next to nothing moves the normal part by its mean.
        oracle = stats.norm.pdf(t, 0.5 + tail, 0.04)
    assert ex_gaussian_density(t, fit) == pytest.approx(oracle, rel=1e-4, abs=1e-9)
