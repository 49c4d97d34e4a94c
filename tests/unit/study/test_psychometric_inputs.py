"""What psychometric functions, fits and adaptive methods refuse, and what they say then."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.adaptive.bayesian import AdaptiveDesign, BayesianAdaptive
from squeezefilm.study.psychometric.fit import fit_psychometric
from squeezefilm.study.psychometric.function import PsychometricFunction, PsychometricPrior

PRIOR = PsychometricPrior((1.0, 9.0), (0.5, 12.0))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"shape": "logistik"}, "Did you mean 'logistic'"),
        ({"shape": "weibull"}, "give axis = 'log'"),
        ({"axis": "lin"}, "linear, log"),
        ({"width": 0.0}, "width = 0 "),
        ({"threshold": -1.0, "axis": "log"}, "threshold = -1 "),
        ({"guess_rate": 0.6, "lapse_rate": 0.4}, "leaves no rise"),
    ],
)
def test_functions_that_are_none(change: dict[str, Any], message: str) -> None:
    values: dict[str, Any] = {"shape": "logistic", "threshold": 4.0, "width": 2.0} | change
    with pytest.raises(InputError, match=message):
        PsychometricFunction(**values)


def test_probabilities_and_intensities_out_of_reach() -> None:
    function = PsychometricFunction("weibull", 4.0, 2.0, 0.5, 0.02, "log")
    with pytest.raises(InputError, match=r"probability = 0\.99"):
        function.intensity(0.99)
    with pytest.raises(InputError, match="intensity = -1"):
        function(-1.0)
    assert np.shape(function(np.ones((2, 3)))) == (2, 3)
    assert isinstance(function(1.0), float)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (([1, 2], [1, 2, 3], [4, 4]), "shapes"),
        (([1, 2], [5, 2], [4, 4]), "positive = 5 of trials = 4 at intensity 1"),
        (([1, 2], [0.5, 2], [4, 4]), "must be whole"),
        (([1, 2], [0, 0], [0, 0]), "at least one answer"),
        (([1, np.nan], [1, 1], [4, 4]), "intensity = nan"),
        (([2, 2], [1, 1], [4, 4]), "two or more intensities"),
    ],
)
def test_data_that_cannot_be_fitted(rows: tuple[Any, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        fit_psychometric(*rows)


def test_settings_of_a_fit_that_are_refused() -> None:
    data = ([1.0, 2.0, 3.0], [5, 8, 10], [10, 10, 10])
    with pytest.raises(InputError, match="guess_rate"):
        fit_psychometric(*data, guess_rate=0.7)
    with pytest.raises(InputError, match="parameter = 'slope'"):
        fit_psychometric(*data).posterior.interval("slope")


def test_one_answer_a_row_is_the_same_as_counts() -> None:
    rows = fit_psychometric([1, 3, 1, 2, 2, 3], [0, 1, 1, 0, 1, 1])
    counts = fit_psychometric([1, 2, 3], [1, 1, 2], [2, 2, 2])
    assert rows.summary() == counts.summary()


def test_a_fit_is_reproducible_and_says_itself_in_json() -> None:
    data = ([1.0, 2.0, 3.0, 4.0], [5, 6, 9, 10], [10, 10, 10, 10])
    first, again = (fit_psychometric(*data).summary() for _ in range(2))
    assert first == again
    assert json.loads(json.dumps(first, allow_nan=False)) == first
    assert set(first["posterior_interval"]) == {"threshold", "width", "lapse_rate"}


def test_perfect_answers_leave_the_width_to_the_prior_and_say_so() -> None:
    fit = fit_psychometric([1.0, 2.0, 3.0, 4.0], [0, 0, 20, 20], [20] * 4, guess_rate=0.0)
    assert "width" in fit.bounded_by_prior
    assert fit.posterior_interval["width"][0] == pytest.approx(fit.prior.width[0], rel=0.2)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"threshold": (3.0, 3.0)}, "no range"),
        ({"width": (0.0, 3.0)}, "width = 0 "),
        ({"lapse_rate": (0.5, 10.0)}, "lapse_rate"),
    ],
)
def test_priors_that_are_none(change: dict[str, Any], message: str) -> None:
    values: dict[str, Any] = {"threshold": (1.0, 9.0), "width": (0.5, 12.0)} | change
    with pytest.raises(InputError, match=message):
        PsychometricPrior(**values)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"stimuli": (1.0,)}, "two or more"),
        ({"interest": "lapse"}, "Allowed: threshold and width, all"),
        ({"guess_rate": 0.9}, "guess_rate"),
        ({"cells": (0, 3, 3)}, "cells = 0"),
    ],
)
def test_adaptive_designs_that_are_none(change: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        AdaptiveDesign(**({"stimuli": (1.0, 2.0), "prior": PRIOR} | change))


def test_a_finished_choice_says_so() -> None:
    method = BayesianAdaptive(AdaptiveDesign((1.0, 5.0), PRIOR, cells=(4, 3, 2), most_trials=1))
    method.update(method.next_stimulus(), True)
    with pytest.raises(InputError, match="all 1 trials"):
        method.next_stimulus()
    with pytest.raises(InputError, match="all 1 trials"):
        method.update(5.0, True)
