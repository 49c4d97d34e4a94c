"""What a fit is given and says: rows, priors, intervals and what the data do not bound."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.psychometric import kernel
from squeezefilm.study.psychometric.fit import falling_probability, fit_psychometric
from squeezefilm.study.psychometric.function import PsychometricPrior
from squeezefilm.study.psychometric.posterior import Answered, PsychometricPosterior, coarse_maxima

LEVELS = np.arange(1.0, 6.0)


def test_places_that_nobody_answered_are_left_out() -> None:
    rows = ([3.0, 1.0, 9.0, 2.0, 3.0], [4, 2, 0, 3, 5], [6, 4, 0, 5, 6])
    fit = fit_psychometric(*rows)
    assert fit.intensity.tolist() == [1.0, 2.0, 3.0]
    assert fit.positive.tolist() == [2.0, 3.0, 9.0]
    assert fit.trials.tolist() == [4.0, 5.0, 12.0]
    # The prior is of the places that were answered, not of 9.
    assert fit.prior.threshold == pytest.approx((0.0, 4.0))


def test_the_first_row_that_is_no_count_is_named() -> None:
    with pytest.raises(InputError, match=r"positive = 2 of trials = 2\.5 at intensity 7 is no"):
        fit_psychometric([5, 7, 8], [1, 2, 9], [2, 2.5, 3])
    with pytest.raises(InputError, match="positive = -1"):
        fit_psychometric([5, 7], [-1, 2], [2, 2])
    with pytest.raises(InputError, match="at least one row"):
        fit_psychometric([], [], [])
    with pytest.raises(InputError, match="one-dimensional"):
        fit_psychometric([[1.0, 2.0]], [[1, 2]], [[2, 2]])


def test_a_rate_that_is_known_may_be_none_at_all_or_a_half() -> None:
    for rate in (0.0, 0.5):
        fit = fit_psychometric(LEVELS, [3, 6, 8, 9, 10], [10] * 5, guess_rate=rate)
        assert fit.function.guess_rate == pytest.approx(rate, abs=1e-12)
        assert fit.fitted == ("threshold", "width", "lapse_rate")
    free = fit_psychometric(LEVELS, [1, 2, 8, 9, 9], [10] * 5, guess_rate=None)
    assert free.fitted[-1] == "guess_rate"
    assert set(free.posterior_interval) == set(free.fitted)
    for wrong in (-0.01, 0.51):
        with pytest.raises(InputError, match="guess_rate"):
            fit_psychometric(LEVELS, [1, 2, 8, 9, 9], [10] * 5, guess_rate=wrong)
    for level in (0.0, 1.0):
        with pytest.raises(InputError, match="level"):
            fit_psychometric(LEVELS, [1, 2, 8, 9, 9], [10] * 5, level=level)


def test_on_a_logarithmic_axis_all_goes_with_the_unit_of_intensity() -> None:
    answers = ([3, 5, 8, 9, 10], [10] * 5)
    one, other = (
        fit_psychometric(unit * 2.0**LEVELS, *answers, axis="log") for unit in (1.0, 1000.0)
    )
    assert other.function.threshold == pytest.approx(1000 * one.function.threshold, rel=1e-6)
    assert other.function.width == pytest.approx(one.function.width, rel=1e-5)
    first, second = one.posterior_interval, other.posterior_interval
    low, high = first["threshold"]
    assert low <= one.function.threshold <= high
    assert second["threshold"] == pytest.approx((1000 * low, 1000 * high), rel=2e-3)
    assert second["width"] == pytest.approx(first["width"], rel=2e-3)


def test_the_prior_of_stimuli_is_as_wide_as_it_says() -> None:
    # Range 8, smallest distance 1: thresholds half of the range beyond, widths from ½ to 24.
    prior = PsychometricPrior.for_stimuli(np.array([9.0, 1.0, 2.0, 2.0, 5.0]))
    assert prior.threshold == pytest.approx((-3.0, 13.0))
    assert prior.width == pytest.approx((0.5, 24.0))
    # Two of a thousand apart by 0.001: no less than 1 % of the range.
    near = PsychometricPrior.for_stimuli(np.array([0.0, 1000.0, 1000.001]))
    assert near.width[0] == pytest.approx(10.0, rel=1e-5)
    log = PsychometricPrior.for_stimuli(np.exp([1.0, 2.0, 9.0]), "log")
    assert np.log(log.threshold) == pytest.approx((-3.0, 13.0))
    assert log.width == pytest.approx((0.5, 24.0))
    with pytest.raises(InputError, match="1 different intensities"):
        PsychometricPrior.for_stimuli(np.array([2.0, 2.0]))


@pytest.mark.parametrize("parameter", range(4))
def test_a_priors_density_integrates_to_one_and_undoes_its_quantiles(parameter: int) -> None:
    prior = PsychometricPrior((1.0, 9.0), (0.5, 12.0), (1.0, 10.0), (2.0, 5.0))
    low, high = prior.bounds("log")
    assert low == pytest.approx([0.0, math.log(0.5), 0.0, 0.0])
    assert high == pytest.approx([math.log(9.0), math.log(12.0), 0.5, 0.49])
    end = 0.5 if parameter > 1 else high[parameter]
    edges = np.linspace(low[parameter], end, 4001)
    middle = 0.5 * (edges[1:] + edges[:-1])
    mass = prior.density(parameter, middle, "log") * np.diff(edges)
    assert mass.sum() == pytest.approx(1.0, abs=1e-6)
    share = np.array([0.1, 0.5, 0.9])
    below = [
        mass[middle <= one].sum() for one in prior.quantile(parameter, share, "log")
    ]  # fmt: skip
    assert below == pytest.approx(share, abs=2e-3)


def _even(cells: int) -> PsychometricPosterior:
    """Thresholds 1 to 3, even; nothing is left open of the others."""
    edges = (np.linspace(1.0, 3.0, cells + 1), np.array([1.0, 2.0]), np.array([0.0, 0.1]))
    share = np.full((cells, 1, 1, 1), 1 / cells)
    return PsychometricPosterior((*edges, np.array([0.5, 0.5])), share)


def test_an_even_posterior_has_even_quantiles() -> None:
    even = _even(10)
    for share in (0.0, 0.025, 0.3, 0.5, 1.0):
        assert even.quantile("threshold", share) == pytest.approx(1 + 2 * share, abs=1e-6)
    assert even.interval("threshold", 0.9) == pytest.approx((1.1, 2.9), abs=1e-6)
    assert even.interval("threshold") == pytest.approx((1.05, 2.95), abs=1e-6)
    # A rate that is known lies where it is known to.
    assert even.quantile("guess_rate", 0.1) == 0.5
    assert even.interval("guess_rate") == (0.5, 0.5)
    for level in (0.0, 1.0):
        with pytest.raises(InputError, match="level"):
            even.interval("threshold", level)
    with pytest.raises(InputError, match="share"):
        even.quantile("threshold", 1.1)


def test_marginals_are_sums_over_the_others() -> None:
    share = np.random.default_rng(0).random((3, 4, 2, 5))
    share /= share.sum()
    edges = tuple(np.arange(size + 1.0) for size in share.shape)
    found = PsychometricPosterior(edges, share)  # type: ignore[arg-type]
    for at, name in enumerate(("threshold", "width", "lapse_rate", "guess_rate")):
        moved = np.moveaxis(share, at, 0).reshape(share.shape[at], -1)
        assert found.marginal(name) == pytest.approx(moved.sum(axis=1))


@pytest.mark.parametrize("guess_rate", [0.5, None])
def test_searches_start_from_each_sixth_of_the_widths(guess_rate: float | None) -> None:
    prior = PsychometricPrior((0.0, 6.0), (0.1, 20.0))
    k, n = np.array([5.0, 6.0, 8.0, 9.0, 10.0]), np.full(5, 10.0)
    starts = coarse_maxima(Answered(kernel.LOGISTIC, "linear", prior, guess_rate, LEVELS, k, n))
    low, high = prior.bounds("linear")
    assert starts.shape == (6, 4)
    sixths = (starts[:, 1] - low[1]) / (high[1] - low[1]) * 6
    assert np.floor(sixths).tolist() == [0, 1, 2, 3, 4, 5]
    assert np.all((low[0] < starts[:, 0]) & (starts[:, 0] < high[0]))
    assert np.all((starts[:, 2] > 0) & (starts[:, 2] < 0.5))
    if guess_rate is not None:
        assert starts[:, 3] == pytest.approx(0.5)


@pytest.mark.parametrize("known", [0.0, 0.1, 0.25, 1 / 3, 0.5])
def test_a_known_guess_rate_is_kept_to_the_last_digit(known: float) -> None:
    found = fit_psychometric([1, 2, 3, 4, 5], [3, 6, 8, 9, 10], [10] * 5, guess_rate=known)
    assert found.function.guess_rate == known


@pytest.mark.parametrize("guess_rate", [None, 0.0, 0.5])
def test_falling_answers_are_said_to_fall_wherever_a_fit_is_shown(guess_rate: float | None) -> None:
    positive, trials = np.array([20, 18, 10, 3, 0]), np.full(5, 20)
    fit = fit_psychometric(LEVELS, positive, trials, guess_rate=guess_rate)
    assert fit.falls
    assert fit.falling_p < 1e-10
    said = "the answers fall with intensity"
    assert said in fit.notes[0]
    assert said in repr(fit)
    assert said in fit._repr_html_()
    assert said in fit.summary()["notes"][0]
    turned = fit_psychometric(LEVELS, trials - positive, trials, guess_rate=None)
    assert not turned.falls
    assert not any(said in note for note in turned.notes)
    assert turned.falling_p == pytest.approx(1 - fit.falling_p)


def test_what_the_answers_do_not_bound_is_said_where_a_fit_is_printed() -> None:
    fit = fit_psychometric(LEVELS, [5, 6, 5, 6, 10], [10] * 5)
    assert fit.bounded_by_prior
    assert "the answers do not bound the" in repr(fit)


def test_guessers_are_rarely_said_to_fall_and_a_single_share_never() -> None:
    random = np.random.default_rng(3)
    trials = np.full(5, 40.0)
    shares = [
        falling_probability(LEVELS, random.binomial(40, 0.5, 5).astype(float), trials)
        for _ in range(2000)
    ]
    assert np.mean(np.array(shares) < 0.05) == pytest.approx(0.05, abs=0.015)
    assert falling_probability(LEVELS, trials, trials) == 0.5
