"""Placement in any task: against sums by hand, and better than chance."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import pytest
from scipy.special import ndtr
from tests.task_models import (
    Placement,
    PlacementModel,
    magnitude_model,
    match_to_sample_model,
    same_different_model,
    two_interval_model,
)

from squeezefilm.physics.perception.senses import D_PRIME_OF_75

WEBER = np.geomspace(0.03, 0.8, 14)
STEPS = np.linspace(0.0, 1.0, 11)
TWO = two_interval_model(np.concatenate([-STEPS[:0:-1], STEPS]), WEBER, np.array([-0.1, 0.0, 0.1]))
ALIKE = same_different_model(STEPS, WEBER, np.array([0.7, 1.4, 2.1]))
MATCH = match_to_sample_model(np.geomspace(1.0, 4.0, 7), WEBER)
NUMBERS = magnitude_model(
    np.geomspace(1.0, 10.0, 7), np.linspace(0.2, 1.6, 15), np.geomspace(5.0, 20.0, 4),
    np.array([0.15, 0.3]), np.geomspace(1.0, 100.0, 13),
)  # fmt: skip
MODELS = {"two": TWO, "alike": ALIKE, "match": MATCH, "numbers": NUMBERS}


def played(model: PlacementModel, trials: int, answers: Iterable[tuple[int, int]]) -> Placement:
    """A placement that has had answers: pairs of the numbers of stimulus and answer."""
    placement = Placement(model, trials)
    for stimulus, answer in answers:
        placement.update(stimulus, answer)
    return placement


def entropy(weights: np.ndarray) -> float:
    some = weights[weights > 0]
    return float(-np.sum(some * np.log(some)))


def of_first(placement: Placement) -> np.ndarray:
    """Posterior probability of each value of the first parameter."""
    return placement.probability.reshape(placement.model.sizes[0], -1).sum(axis=1)


@pytest.mark.parametrize("name", MODELS)
def test_information_is_the_expected_fall_of_entropy(name: str) -> None:
    model = MODELS[name]
    given = [(0, 0), (len(model.stimuli) - 1, 1), (1, 0)]
    placement = played(model, 9, given)
    now = entropy(of_first(placement))
    told = placement.expected_information()
    cells = placement.probability.ravel()
    for stimulus in range(len(model.stimuli)):
        after = 0.0
        for answer in range(len(model.answers)):
            share = float(cells @ model.chances[answer, :, stimulus])
            if share > 0:
                then = played(model, 9, [*given, (stimulus, answer)])
                after += share * entropy(of_first(then))
        assert told[stimulus] == pytest.approx(now - after, abs=1e-10)
    assert told[placement.next_stimulus()] == told.max()


@pytest.mark.parametrize("name", MODELS)
def test_chosen_stimuli_tell_more_than_random_ones(name: str) -> None:
    model = MODELS[name]
    ends: dict[str, list[float]] = {"chosen": [], "random": []}
    for seed in range(12):
        random = np.random.default_rng(seed)
        truth = random.choice(len(model.first_weights()), p=model.first_weights())
        for kind, found in ends.items():
            placement = Placement(model, 30)
            while not placement.finished:
                at = placement.next_stimulus()
                at = at if kind == "chosen" else int(random.integers(len(model.stimuli)))
                answer = random.choice(len(model.answers), p=model.chances[:, truth, at])
                placement.update(at, int(answer))
            found.append(entropy(of_first(placement)))
    assert np.mean(ends["chosen"]) < np.mean(ends["random"])


def test_the_models_are_those_of_the_analyses() -> None:
    # The difference of one Weber fraction is told in 75 % of two intervals by who does not lapse.
    exact = np.array([0.0])
    two = two_interval_model(np.array([0.0, math.log1p(0.2)]), np.array([0.2, 0.3]), lapses=exact)
    assert two.chances[0, 0] == pytest.approx([0.5, 0.75])
    alike = same_different_model(
        np.array([0.0, math.log1p(0.2)]), np.array([0.2, 0.3]), np.array([1.4]), exact
    )
    alarms = 2 * ndtr(-1.4 / math.sqrt(2))
    hits = ndtr((D_PRIME_OF_75 - 1.4) / math.sqrt(2)) + ndtr((-D_PRIME_OF_75 - 1.4) / math.sqrt(2))
    assert alike.chances[0, 0] == pytest.approx([alarms, hits])
    match = match_to_sample_model(np.array([1.0, 1.2]), np.array([0.2, 0.3]), exact)
    assert match.chances[0, 0] == pytest.approx(
        [ndtr(D_PRIME_OF_75 / 2), 1 - ndtr(D_PRIME_OF_75 / 2)]
    )
    numbers = magnitude_model(
        np.array([1.0, 4.0]), np.array([1.0, 0.5]), np.array([10.0]), np.array([0.3]),
        np.array([5.0, 20.0]),
    )  # fmt: skip
    # Exponent 1: 5 and 20 are the middles of the two numbers.
    assert numbers.chances[0, 0, 0] == pytest.approx(0.5)
    assert numbers.chances[2, 0, 1] == pytest.approx(0.5)
    assert numbers.answers == ("to 5", "5 to 20", "20 to")
