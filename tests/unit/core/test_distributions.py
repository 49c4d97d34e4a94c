"""Distributions of uncertain values: quantiles against SciPy's own."""

import numpy as np
import pytest
from scipy import stats

from squeezefilm.core.distributions import LogNormal, Normal, Uniform
from squeezefilm.core.errors import InputError
from squeezefilm.measure.calibration.priors import share_of

P = np.linspace(0, 1, 101)


def test_normal_quantiles_are_those_of_the_truncated_normal() -> None:
    expected = stats.truncnorm(-3, 3, loc=5.0, scale=0.7).ppf(P)
    assert Normal(5.0, 0.7).quantile(P) == pytest.approx(expected, rel=1e-9)
    assert Normal(5.0, 0.7).support == pytest.approx((2.9, 7.1))


def test_uniform_quantiles_are_straight() -> None:
    assert Uniform(-1.0, 3.0).quantile(P) == pytest.approx(-1 + 4 * P)
    assert Uniform(-1.0, 3.0).support == (-1.0, 3.0)


def test_a_log_normal_s_logarithm_is_normal() -> None:
    people = LogNormal(9.6, 0.345)
    expected = np.exp(stats.truncnorm(-3, 3, loc=np.log(9.6), scale=0.345).ppf(P))
    assert people.quantile(P) == pytest.approx(expected, rel=1e-9)
    assert people.support == pytest.approx(people.quantile(np.array([0.0, 1.0])))
    assert share_of(people, people.quantile(P)) == pytest.approx(P, abs=1e-9)
    assert share_of(people, np.array([-1.0, 0.0, 1e3])).tolist() == [0, 0, 1]


def test_impossible_ones_are_refused() -> None:
    for median, deviation in ((0.0, 0.3), (9.6, 0.0)):
        with pytest.raises(InputError, match="above 0"):
            LogNormal(median, deviation)
    with pytest.raises(InputError, match="lower value first"):
        Uniform(2.0, 1.0)
    with pytest.raises(InputError, match="above 0"):
        Normal(1.0, 0.0)
    with pytest.raises(InputError, match="finite"):
        Normal(float("nan"), 1.0)
