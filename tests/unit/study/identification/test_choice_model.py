"""The choice model and the map of distances: shapes, single cases by hand, and refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.choice_model import (
    choice_model,
)


def test_two_stimuli_are_fitted_exactly_and_nothing_is_left_to_test() -> None:
    found = choice_model([[30, 10], [20, 60]])
    assert found.probabilities == pytest.approx(np.array([[0.6, 1 / 7], [0.4, 6 / 7]]))
    # η = √(p12 p21/(p11 p22)), and the biases' ratio √(p12 p11/(p21 p22)).
    eta = math.sqrt((1 / 7) * 0.4 / (0.6 * 6 / 7))
    assert found.similarity[0, 1] == found.similarity[1, 0] == pytest.approx(eta)
    ratio = math.sqrt((1 / 7) * 0.6 / (0.4 * 6 / 7))
    assert found.bias == pytest.approx([ratio / (1 + ratio), 1 / (1 + ratio)])
    assert found.distance == pytest.approx(np.array([[0, -math.log(eta)], [-math.log(eta), 0]]))
    assert found.degrees_of_freedom == 0
    assert math.isnan(found.deviance)
    assert math.isnan(found.p_value)
    p = found.probabilities
    assert found.log_likelihood == pytest.approx(
        30 * math.log(p[0, 0]) + 20 * math.log(p[1, 0]) + 10 * math.log(p[0, 1])
        + 60 * math.log(p[1, 1])
    )  # fmt: skip


def test_a_deviance_is_twice_what_the_shares_are_likelier() -> None:
    n = np.array([[70, 5, 25], [22, 60, 5], [8, 35, 70]])
    found = choice_model(n)
    share = n / n.sum(axis=0)
    saturated = float((n * np.log(share)).sum())
    assert found.degrees_of_freedom == 1
    assert found.deviance == pytest.approx(2 * (saturated - found.log_likelihood), rel=1e-6)
    assert found.p_value == pytest.approx(stats.chi2.sf(found.deviance, 1), rel=1e-9)
    assert found.pseudo_trials == 0.0
    # Trials that nobody had belong to no test.
    with_more = choice_model(n, 1.0)
    assert with_more.pseudo_trials == 1.0
    assert math.isnan(with_more.deviance)
    assert math.isnan(with_more.p_value)


def test_what_fits_at_once_takes_one_round() -> None:
    # All counts 1 are where the search begins.
    assert choice_model(np.ones((3, 3), dtype=int)).rounds == 1
    assert choice_model(np.full((3, 3), 4)).rounds == 2


def test_pseudo_trials_are_spread_evenly_over_the_answers() -> None:
    # Each column of two has 1 more trial: a half for each answer.
    found = choice_model([[3, 0], [0, 3]], 1.0)
    assert found.probabilities[:, 0] == pytest.approx([3.5 / 4, 0.5 / 4])


def test_without_a_confusion_no_answer_is_preferred() -> None:
    found = choice_model(np.diag([9, 4, 2]))
    assert found.bias == pytest.approx([1 / 3] * 3)
    assert found.similarity == pytest.approx(np.eye(3))


def test_groups_without_a_common_confusion_have_the_same_mean_bias() -> None:
    # The first two are confused with each other, and so are the last two.
    n = np.zeros((4, 4), dtype=int)
    n[:2, :2], n[2:, 2:] = [[30, 10], [20, 60]], [[50, 20], [10, 40]]
    bias = choice_model(n).bias
    assert bias.sum() == pytest.approx(1.0)
    assert bias[0] * bias[1] == pytest.approx(bias[2] * bias[3])
    pair = choice_model(n[:2, :2]).bias
    assert bias[0] / bias[1] == pytest.approx(pair[0] / pair[1])


@pytest.mark.parametrize(
    ("counts", "says"),
    [
        (np.ones((2, 3), dtype=int), r"counts of shape \(2, 3\) are not square"),
        (np.ones(4, dtype=int), "are not square"),
        (np.array([[3, 0], [2, 0]]), "trials of every stimulus"),
        (np.array([[3, 1, 1], [1, 3, 1], [1, 1, 0]]), "stimulus 2 was never answered rightly"),
    ],
)
def test_counts_that_the_model_has_no_place_for(counts: np.ndarray, says: str) -> None:
    with pytest.raises(InputError, match=says):
        choice_model(counts)
    with pytest.raises(InputError, match="pseudo_trials"):
        choice_model(np.diag([3, 3]), -1.0)
