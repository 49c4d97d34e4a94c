"""Scores of measured curves: what they may not depend on, and what they are by definition."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.friction.friction_scores import (
    SHAPES,
    ModelScore,
    fitted_shape,
    rest_friction,
    scored,
    shape_scores,
)
from squeezefilm.measure.recordings.kinds import FrictionCurve, Told
from squeezefilm.validation.published_friction import total_scores

AMPLITUDE = np.linspace(0.1e-6, 2.5e-6, 13)
SHAPE = np.exp(-AMPLITUDE / 1.1e-6)


def curve(friction: np.ndarray, finger: str = "a", **more: float) -> FrictionCurve:
    return FrictionCurve(
        AMPLITUDE,
        friction,
        30e3,
        0.3,
        0.02,
        quantity="friction_force",
        told=Told(name=finger, source="a paper"),
        finger=finger,
        **more,
    )


@pytest.mark.parametrize("name", SHAPES)
def test_a_shape_finds_the_amplitude_that_made_a_curve(name: str) -> None:
    made = 0.37 * SHAPES[name](AMPLITUDE / 0.83e-6)
    decay, shape = fitted_shape(name, AMPLITUDE, made)
    assert decay == pytest.approx(0.83e-6, rel=1e-5)
    assert 0.37 * shape == pytest.approx(made, rel=1e-4)
    score = next(one for one in shape_scores(curve(made)) if one.model == name)
    assert score.fitted == 2
    assert score.difference == pytest.approx(0.0, abs=1e-5)


def test_the_friction_at_rest_is_that_of_a_line_and_must_be_above_zero() -> None:
    line = 0.4 - 5e4 * AMPLITUDE
    line[3:] = 7.0
    assert rest_friction(curve(line)) == pytest.approx(0.4)
    with pytest.raises(InputError, match="must be above 0"):
        rest_friction(curve(-line))


def test_no_normalisation_decides() -> None:
    random = np.random.default_rng(5)
    measured = curve(0.3 * np.exp(-AMPLITUDE / 0.9e-6) + 0.01 * random.standard_normal(13))
    in_coefficients = replace(
        measured, friction=measured.friction / 0.3, quantity="friction_coefficient"
    )
    score = scored("a model", SHAPE, measured)
    assert scored("a model", SHAPE, in_coefficients).difference == pytest.approx(score.difference)
    assert scored("a model", 0.7 * SHAPE, measured).difference == pytest.approx(score.difference)
    # The fitted friction at rest is the least-squares one: no other is nearer.
    for factor in (0.99, 1.01):
        worse = np.mean((measured.friction - factor * score.friction) ** 2)
        assert worse > np.mean((measured.friction - score.friction) ** 2)


def test_a_deviation_holds_spread_and_reading_error() -> None:
    measured = curve(SHAPE, reading_error=0.03)
    assert measured.deviation == pytest.approx(np.full(13, 0.03))
    both = replace(measured, spread=np.full(13, 0.04))
    assert both.deviation == pytest.approx(np.full(13, 0.05))
    assert curve(SHAPE).deviation is None
    assert scored("a model", np.ones(13), curve(SHAPE)).in_spreads is None


def test_a_model_that_refuses_an_amplitude_has_no_total() -> None:
    refused = SHAPE.copy()
    refused[4] = np.nan
    score = scored("a model", refused, curve(SHAPE))
    assert score.answered == 12
    (total,) = total_scores([curve(SHAPE)], [[score]])
    assert (total.difference, total.log_score) == (None, None)
    nowhere = scored("a model", np.full(13, np.nan), curve(SHAPE))
    assert (nowhere.difference, nowhere.answered) == (None, 0)


def test_the_log_score_is_a_density_with_the_error_over_the_other_fingers() -> None:
    random = np.random.default_rng(7)
    curves = [
        curve(0.3 * SHAPE * (1 + 0.1 * random.standard_normal(13)), finger)
        for finger in ("a", "b", "c")
    ]
    scores = [[scored("a model", SHAPE, one)] for one in curves]
    (total,) = total_scores(curves, scores)
    off = [
        (one.friction - row[0].friction) / rest_friction(one)
        for one, row in zip(curves, scores, strict=True)
    ]
    expected = []
    for k in range(3):
        others = np.sqrt(np.mean([np.mean(off[j] ** 2) for j in range(3) if j != k]))
        expected.append(np.mean(norm.logpdf(off[k], scale=others)))
    assert total.log_score == pytest.approx(np.mean(expected))
    assert total.log_score_error == pytest.approx(np.std(expected, ddof=1) / np.sqrt(3))
    assert total.units == 3


def test_a_finger_counts_once_however_often_it_was_measured() -> None:
    random = np.random.default_rng(9)
    first, second = (
        curve(0.3 * SHAPE * (1 + size * random.standard_normal(13)), finger)
        for finger, size in (("a", 0.02), ("b", 0.2))
    )
    once, often = [first, second], [first, second, second, second]
    totals = [
        total_scores(curves, [[scored("a model", SHAPE, one)] for one in curves])[0]
        for curves in (once, often)
    ]
    assert totals[0] == totals[1]
    unnamed = replace(first, finger="")
    assert unnamed.unit == replace(second, finger="").unit != first.unit


def test_a_model_that_refuses_an_amplitude_comes_last_however_near_it_is() -> None:
    near, far = (ModelScore("a", 1, np.ones(2), off, None) for off in (0.1, 0.2))
    partial = ModelScore("b", 1, np.array([1.0, np.nan]), 0.01, None)
    assert sorted([partial, far, near], key=lambda score: score.rank) == [near, far, partial]
