"""Psychometric functions against closed forms, quadrature, and SciPy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from scipy.optimize import minimize
from scipy.special import betaincinv, ndtr

from squeezefilm.study.psychometric import kernel, posterior
from squeezefilm.study.psychometric.fit import fit_psychometric
from squeezefilm.study.psychometric.function import (
    SHAPES,
    Axis,
    PsychometricFunction,
    PsychometricPrior,
    Shape,
    on_axis,
)
from squeezefilm.study.psychometric.posterior import (
    PARAMETERS,
    Answered,
    PsychometricPosterior,
)

LEVELS = np.arange(1.0, 9.0)
CORRECT = np.array([21.0, 19.0, 24.0, 25.0, 31.0, 36.0, 38.0, 39.0])
TRIALS = np.full(8, 40.0)


def axis_of(shape: Shape) -> Axis:
    return "log" if shape == "weibull" else "linear"


@pytest.mark.parametrize("shape", SHAPES)
def test_threshold_and_width_are_where_the_shape_says(shape: Shape) -> None:
    axis = axis_of(shape)
    function = PsychometricFunction(shape, 2.0, 0.7, 0.25, 0.03, axis)
    assert function(2.0) == pytest.approx(0.25 + 0.72 * 0.5, abs=1e-14)
    low, high = (float(on_axis(function.quantile(share), axis)) for share in (0.05, 0.95))
    assert high - low == pytest.approx(0.7, abs=1e-14)
    for p in (0.26, 0.5, 0.9, 0.969):
        assert function(function.intensity(p)) == pytest.approx(p, abs=1e-13)


def test_shapes_are_the_fields_own() -> None:
    x = np.array([0.5, 1.0, 2.0, 3.5])
    # Weibull's function with its usual parameters.
    beta = 3.0
    width = math.log(math.log(0.05) / math.log(0.95)) / beta
    weibull = PsychometricFunction("weibull", 2.0 * math.log(2) ** (1 / beta), width, axis="log")
    assert weibull(x) == pytest.approx(1 - np.exp(-((x / 2.0) ** beta)), abs=1e-14)
    gaussian = PsychometricFunction("gaussian", 1.2, 2 * 1.6448536269514722 * 0.8)
    assert gaussian(x) == pytest.approx(ndtr((x - 1.2) / 0.8), abs=1e-14)
    logistic = PsychometricFunction("logistic", 1.2, 2 * math.log(19) * 0.8)
    assert logistic(x) == pytest.approx(1 / (1 + np.exp(-(x - 1.2) / 0.8)), abs=1e-14)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("guess_rate", [pytest.param(0.5, marks=pytest.mark.slow), None])
def test_the_fit_is_the_maximum_that_scipy_finds(shape: Shape, guess_rate: float | None) -> None:
    axis = axis_of(shape)
    free = 3 if guess_rate is not None else 4
    fit = fit_psychometric(LEVELS, CORRECT, TRIALS, shape=shape, axis=axis, guess_rate=guess_rate)
    x = on_axis(LEVELS, axis)
    low, high = fit.prior.bounds(axis)
    high[2] = 0.45

    def loss(row: np.ndarray) -> float:
        threshold = float(np.exp(row[0])) if axis == "log" else float(row[0])
        guess = 0.5 if guess_rate is not None else float(row[3])
        function = PsychometricFunction(
            shape, threshold, float(np.exp(row[1])), guess, float(row[2]), axis
        )
        p = np.clip(function(np.exp(x) if axis == "log" else x), 1e-12, 1 - 1e-12)
        prior = 9 * math.log1p(-row[2]) + (9 * math.log1p(-guess) if free == 4 else 0.0)
        return -float(np.sum(CORRECT * np.log(p) + (TRIALS - CORRECT) * np.log(1 - p))) - prior

    function = fit.function
    ours = np.array(
        [
            float(on_axis(function.threshold, axis)),
            math.log(function.width),
            function.lapse_rate,
            function.guess_rate,
        ]
    )[:free]
    starts = [ours + 1e-3, ours, np.array([0.5 * (low[0] + high[0]), 1.0, 0.05, 0.3])[:free]]
    bounds = list(zip(low, high, strict=True))[:free]
    least = min(minimize(loss, s, method="L-BFGS-B", bounds=bounds).fun for s in starts)
    assert loss(ours) <= least + 1e-6


def _loss(part: np.ndarray, x: np.ndarray, counts: np.ndarray, trials: np.ndarray) -> float:
    """Less the ln density of a Weibull function of four alternatives."""
    theta, beta = np.append(part, 0.25), np.array([1.0, 10.0, 1.0, 1.0])
    return -float(kernel.log_density(kernel.GUMBEL, theta, beta, x, counts, trials))


@pytest.mark.nightly
def test_no_start_leads_higher_than_the_fit() -> None:
    # Few answers can have several local maxima; threshold and width of the starts cover the prior.
    truth = PsychometricFunction("weibull", 3.0, 1.0, 0.25, 0.02, "log")
    levels = np.geomspace(1.0, 8.0, 8)
    random = np.random.default_rng(0)
    for _ in range(40):
        counts, trials = random.binomial(30, truth(levels)).astype(float), np.full(8, 30.0)
        fit = fit_psychometric(levels, counts, trials, shape="weibull", axis="log", guess_rate=0.25)
        f, x = fit.function, np.log(levels)
        low, high = fit.prior.bounds("log")
        bounds = list(zip(low, high, strict=True))[:3]
        data = x, counts, trials
        least = _loss(np.array([math.log(f.threshold), math.log(f.width), f.lapse_rate]), *data)
        for m in np.linspace(low[0], high[0], 7):
            for w in np.linspace(low[1], high[1], 6):
                start = [m, w, 0.02]
                other = minimize(_loss, start, data, method="L-BFGS-B", bounds=bounds).fun
                assert least <= other + 1e-3


def test_the_fit_recovers_expected_counts_exactly() -> None:
    # Data equal to their expectation: the likelihood is largest at the truth.
    truth = PsychometricFunction("logistic", 4.5, 4.0, 0.25, 0.0)
    trials = np.full(8, 10_000_000.0)
    fit = fit_psychometric(LEVELS, np.round(trials * truth(LEVELS)), trials, guess_rate=0.25)
    assert fit.function.threshold == pytest.approx(4.5, abs=1e-5)
    assert fit.function.width == pytest.approx(4.0, abs=1e-4)
    assert fit.function.lapse_rate == pytest.approx(0.0, abs=1e-5)
    assert fit.deviance < 1e-5


def posterior_mean(found: PsychometricPosterior, parameter: str) -> float:
    """The mean of a marginal posterior, in the parameter's unit."""
    edges = found.edges[PARAMETERS.index(parameter)]
    middles = PchipInterpolator(np.arange(edges.size), edges)(np.arange(edges.size - 1) + 0.5)
    return float(found.marginal(parameter) @ middles)


def test_far_above_threshold_the_lapse_rate_has_its_beta_posterior() -> None:
    # ψ = 1 − λ there, so k of n answers are binomial: the posterior is Beta(1 + n − k, 10 + k).
    prior = PsychometricPrior((0.0, 1.0), (0.1, 0.2))
    fit = fit_psychometric([50.0, 60.0], [57, 58], [60, 60], prior=prior)
    low, high = fit.posterior_interval["lapse_rate"]
    exact = betaincinv(6, 125, 0.025), betaincinv(6, 125, 0.975)
    assert (low, high) == pytest.approx(exact, abs=0.01 * (exact[1] - exact[0]))
    assert posterior_mean(fit.posterior, "lapse_rate") == pytest.approx(6 / 131, rel=3e-3)
    # The answers say nothing of threshold and width: their posteriors are the priors.
    assert fit.posterior_interval["threshold"] == pytest.approx((0.025, 0.975), abs=1e-3)
    assert set(fit.bounded_by_prior) == {"threshold", "width"}


@pytest.mark.slow
@pytest.mark.parametrize("guess_rate", [0.5, None])
def test_the_grid_is_fine_enough(guess_rate: float | None, monkeypatch: pytest.MonkeyPatch) -> None:
    fit = fit_psychometric(LEVELS, CORRECT, TRIALS, guess_rate=guess_rate)
    f = fit.function
    mode = np.array([f.threshold, math.log(f.width), f.lapse_rate, f.guess_rate])
    coarse = fit.posterior
    answered = Answered(kernel.LOGISTIC, "linear", fit.prior, guess_rate, LEVELS, CORRECT, TRIALS)
    monkeypatch.setattr(posterior, "_FINE", (96, 64, 28, 1))
    monkeypatch.setattr(posterior, "_FINE_WITH_GUESS", (96, 64, 28, 28))
    fine = posterior.grid_posterior(answered, mode)
    names = ("threshold", "width", "lapse_rate", "guess_rate")
    for name in names[: 3 if guess_rate is not None else 4]:
        width = np.diff(fine.interval(name))[0]
        assert coarse.interval(name) == pytest.approx(fine.interval(name), abs=0.02 * width)
        mean = posterior_mean(fine, name)
        assert posterior_mean(coarse, name) == pytest.approx(mean, abs=0.003 * width)


def test_deviances_of_many_trials_are_chi_squared() -> None:
    truth = PsychometricFunction("gaussian", 4.5, 4.0, 0.0, 0.05)
    random, trials = np.random.default_rng(2), np.full(8, 4000.0)
    # 8 places less 3 parameters.
    deviances = [
        fit_psychometric(
            LEVELS, random.binomial(4000, truth(LEVELS)), trials, shape="gaussian", guess_rate=0.0
        ).deviance
        for _ in range(120)
    ]
    assert np.mean(deviances) == pytest.approx(5.0, abs=4 * math.sqrt(10 / 120))
    zigzag = np.array([110.0, 190, 110, 190, 110, 190, 110, 190])
    assert fit_psychometric(LEVELS, zigzag, np.full(8, 200.0)).deviance > 100.0
