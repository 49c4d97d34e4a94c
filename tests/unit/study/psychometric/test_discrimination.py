"""d′: what is refused, and how intervals follow the counts."""

from __future__ import annotations

import math

import pytest
from scipy.special import ndtri

from squeezefilm.core.errors import InputError
from squeezefilm.study.psychometric.discrimination import (
    corrected_proportion,
    differencing_d_prime,
    sensitivity,
    two_interval_d_prime,
    yes_no_d_prime,
)

OF_RATES = (
    yes_no_d_prime,
    two_interval_d_prime,
    differencing_d_prime,
)


@pytest.mark.parametrize("of", OF_RATES)
def test_rates_of_none_or_all_are_refused(of) -> None:  # type: ignore[no-untyped-def]
    for end in (0.0, 1.0, -0.1, 1.1):
        with pytest.raises(InputError) as refused:
            of(end, 0.5)
        assert "hit_rate" in str(refused.value)
        with pytest.raises(InputError, match="false_alarm_rate"):
            of(0.5, end)


def test_counts_that_are_none_are_refused() -> None:
    assert corrected_proportion(0, 1) == 0.25
    for count, trials, says in ((0, 0, "trials"), (-1, 3, "count"), (4, 3, "count")):
        with pytest.raises(InputError, match=says):
            corrected_proportion(count, trials)


@pytest.mark.parametrize("model", ["yes-no", "two-interval", "differencing"])
def test_more_trials_narrow_the_interval_about_the_same_d_prime(model: str) -> None:
    few = sensitivity(16, 20, 6, 20, model, draws=400, seed=3)
    many = sensitivity(1600, 2000, 600, 2000, model, draws=400, seed=3)
    assert few.low < few.value < few.high
    assert many.high - many.low < 0.2 * (few.high - few.low)
    of = dict(zip(("yes-no", "two-interval", "differencing"), OF_RATES, strict=True))[model]
    assert few.value == of(16.5 / 21, 6.5 / 21)
    narrow = sensitivity(16, 20, 6, 20, model, level=0.5, draws=400, seed=3)
    assert narrow.level == 0.5
    assert few.low < narrow.low < narrow.high < few.high
    assert few == sensitivity(16, 20, 6, 20, model, draws=400, seed=3)


def test_an_interval_of_many_trials_is_that_of_two_proportions() -> None:
    # Gourevitch & Galanter 1967: variance of d′ from those of two proportions.
    found = sensitivity(3200, 4000, 1200, 4000, "yes-no", draws=4000)
    error = math.sqrt(
        sum(
            p * (1 - p) / 4000 / math.exp(-(float(ndtri(p)) ** 2)) * 2 * math.pi for p in (0.8, 0.3)
        )
    )
    low, high = found.low, found.high
    assert high - low == pytest.approx(2 * 1.96 * error, rel=0.06)
    assert (low + high) / 2 == pytest.approx(float(ndtri(0.8) - ndtri(0.3)), abs=0.01)


def test_settings_of_an_interval_that_are_refused() -> None:
    for level in (0.0, 1.0):
        with pytest.raises(InputError, match="level"):
            sensitivity(5, 10, 2, 10, "yes-no", level=level)
    with pytest.raises(InputError, match="draws"):
        sensitivity(5, 10, 2, 10, "yes-no", draws=38)
    assert sensitivity(5, 10, 2, 10, "yes-no", draws=39).level == 0.95
    with pytest.raises(InputError, match="model"):
        sensitivity(5, 10, 2, 10, "yes/no")
