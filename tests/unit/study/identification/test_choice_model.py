"""The choice model and the map of distances: shapes, single cases by hand, and refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.choice_model import (
    choice_model,
    perceptual_map,
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


@pytest.mark.parametrize("sign", [1, -1])
def test_the_first_axis_rises_along_the_stimuli_whichever_way_they_lie(sign: int) -> None:
    # Uneven steps far from nought, so that a sum without the middle taken off would be misled.
    places = sign * np.array([7.0, 7.5, 9.0, 9.2, 13.0])
    found = perceptual_map(np.abs(places[:, None] - places), 1)
    assert found.points[:, 0] == pytest.approx(sign * (places - places.mean()))
    assert (found.explained, found.negative) == pytest.approx((1.0, 0.0), abs=1e-9)
    turned = perceptual_map(np.abs(places[:, None] - places)[::-1, ::-1], 1)
    assert turned.points[-1, 0] > turned.points[0, 0]


def test_a_map_says_how_much_of_the_distances_it_shows() -> None:
    # Corners of a rectangle 4 by 2: its two axes hold 4 · 2² and 4 · 1².
    points = np.array([[-2, -1], [-2, 1], [2, -1], [2, 1]], dtype=float)
    d = np.linalg.norm(points[:, None] - points[None], axis=-1)
    assert perceptual_map(d, 1).explained == pytest.approx(16 / 20)
    assert perceptual_map(d, 3).explained == pytest.approx(1.0)
    # Three of which the far two are farther apart than by way of the third.
    d = np.array([[0.0, 1.0, 3.0], [1.0, 0.0, 1.0], [3.0, 1.0, 0.0]])
    centre = np.eye(3) - 1 / 3
    values = np.linalg.eigvalsh(-0.5 * centre @ d**2 @ centre)
    found = perceptual_map(d, 2)
    assert found.negative == pytest.approx(-values[values < 0].sum() / values[values > 0].sum())
    assert found.explained == pytest.approx(1.0)
    assert found.points[:, 1] == pytest.approx(0.0, abs=1e-6)


def test_points_all_in_one_place_are_shown_whole() -> None:
    found = perceptual_map(np.zeros((3, 3)), 2)
    assert (found.explained, found.negative) == (1.0, 0.0)
    assert found.points.shape == (3, 2)
    assert np.all(found.points == 0)


def test_distances_that_are_none_are_refused() -> None:
    with pytest.raises(InputError, match=r"distances of shape \(2, 3\) are not square"):
        perceptual_map(np.ones((2, 3)))
    with pytest.raises(InputError, match="are not square"):
        perceptual_map(np.ones(3), 1)
    with pytest.raises(InputError, match="must be symmetric"):
        perceptual_map([[0.0, 1.0, 2.0], [1.5, 0.0, 1.0], [2.0, 1.0, 0.0]])
    three = np.ones((3, 3)) - np.eye(3)
    for dimensions in (0, 3):
        with pytest.raises(InputError, match=f"dimensions = {dimensions} must be 1 to 2"):
            perceptual_map(three, dimensions)
    assert perceptual_map(three, 1).points.shape == (3, 1)
