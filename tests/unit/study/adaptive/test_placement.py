"""Placement in any task: against sums by hand, better than chance, and what it refuses."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable

import numpy as np
import pytest
from scipy.special import ndtr
from tests.task_models import (
    magnitude_model,
    match_to_sample_model,
    same_different_model,
    two_interval_model,
)

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.senses import D_PRIME_OF_75
from squeezefilm.study.adaptive.placement import Placement, PlacementModel

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


@pytest.mark.parametrize("name", MODELS)
def test_information_is_the_expected_fall_of_entropy(name: str) -> None:
    model = MODELS[name]
    first = next(iter(model.parameters))
    given = [(0, 0), (len(model.stimuli) - 1, 1), (1, 0)]
    placement = played(model, 9, given)
    now = entropy(placement.marginal(first))
    told = placement.expected_information()
    cells = placement.probability.ravel()
    for stimulus in range(len(model.stimuli)):
        after = 0.0
        for answer in range(len(model.answers)):
            share = float(cells @ model.chances[answer, :, stimulus])
            if share > 0:
                then = played(model, 9, [*given, (stimulus, answer)])
                after += share * entropy(then.marginal(first))
        assert told[stimulus] == pytest.approx(now - after, abs=1e-10)
    assert told[placement.next_stimulus()] == told.max()


@pytest.mark.parametrize("name", MODELS)
def test_chosen_stimuli_tell_more_than_random_ones(name: str) -> None:
    model = MODELS[name]
    first = next(iter(model.parameters))
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
            found.append(entropy(placement.marginal(first)))
    assert np.mean(ends["chosen"]) < np.mean(ends["random"])


def test_a_persons_weber_fraction_is_found() -> None:
    errors = []
    for seed in range(20):
        random = np.random.default_rng(seed)
        place = random.integers(3, 10)
        truth = int(np.ravel_multi_index((place, 1, 1), ALIKE.sizes))
        placement = Placement(ALIKE, 80)
        while not placement.finished:
            at = placement.next_stimulus()
            placement.update(at, int(random.random() >= ALIKE.chances[0, truth, at]))
        mean, spread = placement.estimate("Weber fraction")
        errors.append((mean - WEBER[place]) / spread)
        # Pairs that are the same are asked too, or the criterion would not be known.
        assert any(at == 0 for at, _ in placement.given)
    assert abs(np.mean(errors)) < 0.8
    assert np.std(errors) < 1.6


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


def test_what_no_answer_tells_is_refused() -> None:
    with pytest.raises(InputError, match="no answer tells anything"):
        two_interval_model(np.array([0.0, 0.0]), WEBER)
    with pytest.raises(InputError, match="put 0 among"):
        same_different_model(STEPS[1:], WEBER, np.array([1.4]))
    with pytest.raises(InputError, match="must rise"):
        match_to_sample_model(np.array([2.0, 1.0]), WEBER)
    with pytest.raises(InputError, match="edges must rise"):
        magnitude_model(STEPS[1:], STEPS[1:], WEBER, WEBER, np.array([2.0, 2.0]))
    with pytest.raises(InputError, match="sum to 1"):
        dataclasses.replace(MATCH, chances=0.5 * MATCH.chances)
    with pytest.raises(InputError, match="have the shape"):
        dataclasses.replace(MATCH, answers=("a",))
    with pytest.raises(InputError, match="prior of 'lapses'"):
        dataclasses.replace(MATCH, prior={"lapses": np.ones(4)})
    with pytest.raises(InputError, match="interest = 3"):
        dataclasses.replace(MATCH, interest=3)


def test_a_placement_refuses_what_it_has_not_asked() -> None:
    placement = Placement(MATCH, 1)
    with pytest.raises(InputError, match="stimuli 0 to 6"):
        placement.update(7, 0)
    with pytest.raises(InputError, match="parameter"):
        placement.marginal("bias")
    placement.update(3, 3)
    for again in (placement.next_stimulus, lambda: placement.update(3, 3)):
        with pytest.raises(InputError, match="all 1 trials"):
            again()
    sure = PlacementModel(
        {"p": np.array([0.0, 1.0])}, np.array([1.0, 2.0]), ("yes", "no"),
        np.array([[[1.0, 1.0], [1.0, 0.5]], [[0.0, 0.0], [0.0, 0.5]]]), {},
    )  # fmt: skip
    with pytest.raises(InputError, match="'no' to stimulus 0 is impossible"):
        Placement(sure, 3).update(0, 1)
