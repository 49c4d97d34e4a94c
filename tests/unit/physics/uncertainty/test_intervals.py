"""The ends of an interval where draws are refused or nothing reaches them."""

import math

import numpy as np
import pytest

from squeezefilm.physics.uncertainty.intervals import ends, quantiles


def test_ends_are_the_quantiles_of_independent_draws() -> None:
    """Positions k/(n + 1): of 0 … 98 the 5 % quantile is 4, the 95 % one 94."""
    assert ends(np.arange(99.0)) == pytest.approx((4.0, 49.0, 94.0))
    assert tuple(quantiles(np.arange(99.0) / 98)) == pytest.approx((4 / 98, 0.5, 94 / 98))


def test_what_nothing_reaches_is_infinite_and_what_is_refused_may_be_anything() -> None:
    some = np.arange(99.0)
    some[95:] = np.inf
    low, middle, high = ends(some)
    assert (low, middle) == pytest.approx((4.0, 49.0))
    assert high == pytest.approx(94.0)
    some[90:] = np.inf
    assert ends(some)[2] == math.inf
    refused = np.arange(1.0, 100.0)
    refused[50:54] = np.nan
    low, middle, high = ends(refused)
    # Four of them at zero and four at infinity: both ends move outwards by as many places.
    assert low == pytest.approx(1.0)
    assert high == pytest.approx(99.0)
    assert middle == pytest.approx(np.nanmedian(refused))
    assert math.isnan(ends(np.array([np.nan]))[1])
