"""An interval laid around the estimate by the spread of its resamples."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.confusion import recentred_interval

SPREAD = np.random.default_rng(1).normal(5.0, 0.2, 4000)


def test_it_lies_around_the_estimate_and_not_around_the_resamples() -> None:
    found = recentred_interval(2.0, SPREAD, 1000)
    assert (found.low + found.high) / 2 == pytest.approx(2.0, abs=0.02)
    assert found.high - found.low == pytest.approx(2 * 1.96 * 0.2, rel=0.05)
    few = recentred_interval(2.0, SPREAD, 6)
    assert few.high - few.low > 1.1 * (found.high - found.low)


def test_it_stays_within_what_the_statistic_can_be() -> None:
    found = recentred_interval(0.1, SPREAD, 20, least=0.0, greatest=0.2)
    assert (found.low, found.high) == (0.0, 0.2)


def test_resamples_that_are_no_numbers_are_left_out_and_none_left_is_refused() -> None:
    holes = np.append(SPREAD, np.full(100, np.nan))
    assert recentred_interval(2.0, holes, 20) == recentred_interval(2.0, SPREAD, 20)
    with pytest.raises(InputError, match="no resample gave a finite value"):
        recentred_interval(2.0, np.full(3, np.nan), 20)
    with pytest.raises(InputError, match="level"):
        recentred_interval(2.0, SPREAD, 20, level=1.0)
