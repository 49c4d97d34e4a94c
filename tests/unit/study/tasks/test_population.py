"""People's likelihoods put together, against sums done by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from squeezefilm.core.errors import InputError
from squeezefilm.study.tasks.population import (
    LAPSES,
    MEAN_LAPSES,
    USUAL_SPREAD,
    Population,
    lapse_weights,
    scatter_interval,
)

X = np.linspace(-3.0, 3.0, 601)


def person(value: float, error: float, factors: tuple[float, ...] = ()) -> np.ndarray:
    """Somebody whose answers say a normal likelihood of x, and each lapse rate by a factor."""
    likelihood = stats.norm.pdf(X, value, error)
    by_lapse = np.array(factors or (1.0,) * len(MEAN_LAPSES))
    return by_lapse[:, None] * likelihood


def population(people: list[np.ndarray]) -> Population:
    """People by their likelihoods, on the grid of all."""
    return Population(X, np.full(X.size, 0.01), people)


def by_hand(values: list[float], errors: list[float]) -> tuple[float, float, float]:
    """Quantiles of mu under a flat prior of it and a half-normal one of tau, by brute force."""
    mu, tau = np.linspace(-3, 3, 1201), np.linspace(1e-3, 2.0, 401)[:, None]
    logs = -0.5 * (tau / USUAL_SPREAD) ** 2
    for value, error in zip(values, errors, strict=True):
        scale = np.hypot(tau, error)
        logs = logs - 0.5 * ((value - mu) / scale) ** 2 - np.log(scale)
    total = np.exp(logs).sum(axis=0)
    below = np.cumsum(total) / total.sum()
    low, middle, high = np.interp([0.025, 0.5, 0.975], below, mu)
    return float(low), float(middle), float(high)


@pytest.mark.slow
def test_normal_likelihoods_give_the_random_effects_posterior() -> None:
    random = np.random.default_rng(2)
    for _ in range(5):
        values = random.normal(-1.0, 0.4, 7).tolist()
        errors = random.uniform(0.1, 0.5, 7).tolist()
        people = [person(*one) for one in zip(values, errors, strict=True)]
        found, _ = population(people).estimate()
        low, middle, high = by_hand(values, errors)
        assert found.value == pytest.approx(middle, abs=0.02)
        assert found.low == pytest.approx(low, abs=0.04)
        assert found.high == pytest.approx(high, abs=0.04)


@pytest.mark.slow
def test_people_who_are_alike_have_no_spread_and_a_group_of_them_is_those_people() -> None:
    alike = population([person(0.5, 0.1)] * 12)
    found, spread = alike.estimate()
    assert spread.value < 0.1
    assert found.low < 0.5 < found.high
    few, _ = alike.estimate(people=np.array([0, 3, 3]))
    assert few.high - few.low > found.high - found.low
    assert alike.estimate(0.5)[0].high < found.high
    assert alike.size == 12


def test_the_interval_of_the_spread_is_what_the_scatter_does_not_refuse() -> None:
    # Equal errors: the scatter over v + tau^2 is chi-squared, and the ends are closed forms.
    random = np.random.default_rng(4)
    values, error = random.normal(0.0, 0.6, 9), 0.2
    _, spread = population([person(one, error) for one in values]).estimate(0.9)
    scatter = float(np.sum((values - values.mean()) ** 2))
    for end, share in ((spread.low, 0.95), (spread.high, 0.05)):
        variance = scatter / stats.chi2.ppf(share, 8) - error**2
        assert end == pytest.approx(np.sqrt(variance), rel=2e-3)
    assert spread.low < spread.value < spread.high
    _, one = population([person(0.0, 0.2)]).estimate()
    assert np.isnan([one.value, one.low, one.high]).all()


@pytest.mark.parametrize("spread", [0.1, 0.4, 1.2])
def test_the_spread_of_normal_people_is_held_as_often_as_said(spread: float) -> None:
    errors, runs = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.2, 0.3]), 2000
    seen = np.random.default_rng(9).normal(0.0, np.hypot(spread, errors), (runs, errors.size))
    held = [spread in scatter_interval(x, errors**2) for x in seen]
    assert np.mean(held) == pytest.approx(0.95, abs=4 * np.sqrt(0.95 * 0.05 / runs))


def test_lapse_rates_are_those_that_all_answers_speak_for() -> None:
    means = lapse_weights() @ LAPSES
    assert means == pytest.approx(MEAN_LAPSES, rel=0.12)
    careful = tuple(1.0 if h < 0.03 else 0.1 for h in MEAN_LAPSES)
    found = population([person(0.0, 0.2, careful)] * 6).lapses()
    assert found.sum() == pytest.approx(1.0)
    assert found[:3].sum() > 0.99


def test_nobody_is_no_population() -> None:
    with pytest.raises(InputError, match="at least one person"):
        population([])
    with pytest.raises(InputError, match="level"):
        population([person(0.0, 1.0)]).estimate(1.0)


def test_more_answers_at_random_than_the_model_knows_are_told() -> None:
    many = population([person(0.1, 0.1, (0.1, 0.2, 0.4, 0.7, 1.0))] * 6)
    few = population([person(0.1, 0.1, (1.0, 0.7, 0.4, 0.2, 0.1))] * 6)
    assert many.lapses()[-1] > 0.5
    assert "more than the 8 %" in many.lapse_note
    assert few.lapse_note == ""
