"""Every estimator with an interval: the estimate lies in it, whatever was counted."""

from __future__ import annotations

import math
from typing import get_args

import numpy as np
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import Estimate, inverse_of
from squeezefilm.study.identification.confusion import (
    ConfusionMatrix,
    Method,
    participant_interval,
    proportion_interval,
    recentred_interval,
)
from squeezefilm.study.identification.sensitivity import information_transfer, ordered_sensitivity
from squeezefilm.study.psychometric.discrimination import sensitivity
from squeezefilm.study.psychometric.fit import fit_psychometric
from squeezefilm.study.tasks.population import Population

dear = settings(settings.get_profile("dear"))
levels = st.sampled_from([0.05, 0.5, 0.95, 0.999])


@st.composite
def counts(draw):
    """Answers of a few places, most often at the edges: nobody, everybody, or against the rise."""
    places = draw(st.integers(2, 6))
    trials = draw(st.lists(st.integers(1, 20), min_size=places, max_size=places))
    edge = draw(st.sampled_from(["any", "none", "all", "falling", "rising"]))
    positive = [draw(st.integers(0, n)) for n in trials]
    if edge in ("none", "all"):
        positive = [0 if edge == "none" else n for n in trials]
    elif edge != "any":
        share = np.linspace(0, 1, places)[:: 1 if edge == "rising" else -1]
        positive = [round(n * s) for n, s in zip(trials, share, strict=True)]
    return positive, trials


@dear
@given(
    counts(),
    st.sampled_from([None, 0.0, 0.5]),
    st.sampled_from(["linear", "log"]),
    levels,
)
@example(([0, 0, 0, 0, 4], [10, 8, 6, 3, 4]), None, "linear", 0.95)
@example(([20, 18, 10, 3, 0], [20] * 5), 0.5, "linear", 0.95)
def test_a_fitted_function_lies_in_its_intervals(answers, guess_rate, axis, level):
    positive, trials = answers
    fit = fit_psychometric(
        np.arange(1.0, len(trials) + 1.0),
        positive,
        trials,
        guess_rate=guess_rate,
        axis=axis,
        level=level,
    )
    for name, (low, high) in fit.posterior_interval.items():
        assert low <= getattr(fit.function, name) <= high, name


models = st.sampled_from(["yes-no", "two-interval", "differencing"])


@given(st.integers(1, 20), st.integers(1, 20), st.data(), models, levels, st.integers(0, 9))
def test_a_sensitivity_lies_in_its_interval(signals, noises, data, model, level, seed):
    hits, alarms = data.draw(st.integers(0, signals)), data.draw(st.integers(0, noises))
    found = sensitivity(hits, signals, alarms, noises, model, level=level, draws=39, seed=seed)
    assert found.low <= found.value <= found.high


@st.composite
def confusions(draw):
    """Every participant's matrix, with many empty cells; nobody without a trial."""
    people, kinds = draw(st.integers(2, 4)), draw(st.integers(2, 4))
    cells = st.lists(
        st.sampled_from([0, 0, 0, 1, 2, 9]),
        min_size=people * kinds**2,
        max_size=people * kinds**2,
    )
    made = np.array(draw(cells)).reshape(people, kinds, kinds)
    assume((made.sum(axis=(1, 2)) > 0).all())
    return made


@dear
@given(confusions(), levels, st.sampled_from([1, 40]), st.integers(0, 9))
def test_what_a_confusion_matrix_says_lies_in_its_intervals(made, level, resamples, seed):
    names = tuple(str(number) for number in range(made.shape[1]))
    matrix = ConfusionMatrix(made.sum(axis=0), names, names)
    right = matrix.proportion_correct
    for method in get_args(Method):
        assert right in proportion_interval(matrix.correct, matrix.trials, level, method)
    assert right in participant_interval(made, level, resamples, seed)
    carried = information_transfer(made, level, resamples, seed)
    assert carried.interval is None or carried.estimate in carried.interval
    try:
        ordered = ordered_sensitivity(made, level, resamples, seed)
    except InputError:
        return
    assert np.all((ordered.low <= ordered.d_prime) & (ordered.d_prime <= ordered.high))


@given(
    st.floats(-1.0, 3.0),
    st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=30),
    st.integers(2, 9),
    levels,
)
def test_a_recentred_interval_holds_its_estimate(estimate, resampled, people, level):
    found = recentred_interval(estimate, np.array(resampled), people, level, 0.0, 2.0)
    assert estimate in found


@given(st.lists(st.tuples(st.floats(-3, 3), st.floats(0.01, 3)), min_size=1, max_size=5), levels)
def test_a_population_lies_in_its_intervals(people, level):
    x = np.linspace(-4, 4, 41)
    likelihoods = [np.tile(np.exp(-0.5 * ((x - m) / s) ** 2), (5, 1)) for m, s in people]
    mean, spread = Population(x, np.full(41, 0.2), likelihoods).estimate(level)
    assert mean.value in mean
    if len(people) > 1:
        assert spread.value in spread


@given(st.floats(-2, 2), st.floats(0, 2))
@example(0.0, 1.0)
@example(-1.0, 2.0)
def test_an_inverse_lies_in_its_interval(value, reach):
    assume(value == 0 or abs(value) > 1e-3)
    loss = Estimate(value, reach / 2, (value - reach, value + reach), "1")
    found = inverse_of(loss)
    low, high = found.interval
    assert low <= found.value <= high
    assert not math.isnan(found.value)
