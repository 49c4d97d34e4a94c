"""The method of an adaptive series: its rule, and where answers leave it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from tests.task_models import Placement, PlacementModel

from squeezefilm.physics.perception.senses import D_PRIME_OF_75
from squeezefilm.study.adaptive.bayesian import BayesianAdaptive
from squeezefilm.study.adaptive.series import ModelSeries, adaptive_method
from squeezefilm.study.adaptive.staircase import Staircase
from squeezefilm.study.design.rules import AdaptiveCondition
from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.design.tasks.same_different import share_right
from squeezefilm.study.design.tasks.surfaces import QUARTILE
from squeezefilm.study.design.tasks.task import Task

STAIRS = AdaptiveCondition("s", "staircase", start=0.4, step=0.08, lowest=0.01, down=3, count=9)
BAYES = AdaptiveCondition("b", "bayesian", lowest=0.01, highest=0.8, count=9)


def test_a_staircase_goes_down_after_so_many_right_and_halves_its_step_twice() -> None:
    method = adaptive_method(STAIRS)
    assert isinstance(method, Staircase)
    asked = []
    # Down after three right, up after one wrong; a turn halves the step, to a quarter at least.
    for right in (True, True, True, False, True, True, True, False, True):
        asked.append(method.next_stimulus())
        method.update(asked[-1], right)
    expected = [0.4, 0.4, 0.4, 0.32, 0.36, 0.36, 0.36, 0.34, 0.36]
    assert asked == pytest.approx(expected)
    assert method.finished


def test_a_staircase_stays_within_its_bounds_and_ends_with_its_trials_alone() -> None:
    low = dataclasses.replace(STAIRS, lowest=0.35, highest=0.45, count=6)
    method = adaptive_method(low, [(0.4, True)] * 3)
    assert method.next_stimulus() == 0.35
    method = adaptive_method(low, [(0.4, False)])
    assert method.next_stimulus() == 0.45
    # Turns at nearly each answer do not end it before its trials do.
    turning = adaptive_method(dataclasses.replace(STAIRS, down=1, count=30))
    assert isinstance(turning, Staircase)
    for number in range(30):
        assert not turning.finished
        turning.update(turning.next_stimulus(), number % 2 == 0)
    assert turning.finished


def test_the_bayesian_choice_is_of_40_even_ratios() -> None:
    method = adaptive_method(BAYES)
    assert isinstance(method, BayesianAdaptive)
    design = method.design
    assert design.stimuli == pytest.approx(0.01 * 80 ** (np.arange(40) / 39))
    assert (design.axis, design.guess_rate, design.most_trials) == ("log", 0.5, 9)
    assert method.next_stimulus() in design.stimuli
    # Right answers ask for harder comparisons, wrong ones for easier.
    right = adaptive_method(BAYES, [(0.1, True)] * 4).next_stimulus()
    wrong = adaptive_method(BAYES, [(0.1, False)] * 4).next_stimulus()
    assert right < wrong


def test_same_different_asks_harder_after_right_answers_and_learns_of_the_same() -> None:
    method = adaptive_method(BAYES, task="same-different")
    assert isinstance(method, ModelSeries)
    assert 0.01 <= method.next_stimulus() <= 0.8
    right = adaptive_method(BAYES, [(0.1, True), (0.0, True)] * 4, "same-different")
    wrong = adaptive_method(BAYES, [(0.1, False), (0.0, True)] * 4, "same-different")
    assert right.next_stimulus() < wrong.next_stimulus()
    # Who says "different" of pairs that are the same has shown less by saying it of others.
    eager = adaptive_method(BAYES, [(0.1, True), (0.0, False)] * 4, "same-different")
    assert eager.next_stimulus() > right.next_stimulus()


def test_a_same_different_series_finds_the_weber_fraction() -> None:
    series = dataclasses.replace(BAYES, lowest=0.02, highest=1.5, count=400)
    random, weber, criterion = np.random.default_rng(3), 0.2, 1.4
    method = adaptive_method(series, task="same-different")
    for number in range(400):
        asked = method.next_stimulus() if number % 2 else 0.0
        apart = np.log1p(asked) * 0.9538725524 / np.log1p(weber)
        different = abs(apart + np.sqrt(2) * random.standard_normal()) > criterion
        different = random.random() < 0.5 if random.random() < 0.02 else different
        method.update(asked, bool(different == (asked > 0)))
    assert isinstance(method, ModelSeries)
    found, error = threshold_told(method)
    assert error < 0.06
    assert abs(found - weber) < 3 * error


def threshold_told(method: ModelSeries) -> tuple[float, float]:
    """Posterior mean and standard deviation of the threshold."""
    thresholds = method._model.thresholds
    weights = method._weights.reshape(thresholds.size, -1).sum(axis=1)
    mean = float(weights @ thresholds)
    return mean, float(np.sqrt(weights @ (thresholds - mean) ** 2))


def answered(
    task: Task, asked: float, threshold: float, random: np.random.Generator
) -> tuple[float, bool | str]:
    """A difference, or the reference alone, and somebody's answer to it."""
    lapses = random.random() < 0.02
    if task == "yes-no":
        yes = asked * D_PRIME_OF_75 / threshold + random.standard_normal() > 0.6
        return asked, "yes" if (random.random() < 0.5 if lapses else yes) else "no"
    apart = np.log1p(asked) / np.log1p(threshold)
    if task == "direction":
        more = apart * QUARTILE + random.standard_normal() > 0.1
        return asked, "more" if (random.random() < 0.5 if lapses else more) else "less"
    surfaces = TASKS[task].surfaces
    right = random.random() < share_right(apart * D_PRIME_OF_75, surfaces)
    return asked, bool(random.random() < 1 / surfaces if lapses else right)


@pytest.mark.parametrize("task", ["yes-no", "direction", "odd-one-out", "odd-one-out-of-four"])
def test_a_series_by_the_tasks_model_finds_its_threshold(task: Task) -> None:
    """About a remembered reference it asks on both sides; 0 is asked where it is planned."""
    series = dataclasses.replace(BAYES, lowest=0.02, highest=0.9, count=300)
    random, threshold = np.random.default_rng(5), 0.2
    method = adaptive_method(series, task=task)
    asked = []
    for number in range(300):
        alone = TASKS[task].series(number, "bayesian")[1] == "no"
        intensity, answer = answered(
            task, 0.0 if alone else method.next_stimulus(), threshold, random
        )
        asked.append(intensity)
        method.update(intensity, answer)  # type: ignore[arg-type] # as the task has it
    assert isinstance(method, ModelSeries)
    found, error = threshold_told(method)
    assert error < 0.06
    assert abs(found - threshold) < 3 * error
    below = sum(one < 0 for one in asked)
    assert (below > 60) == (task == "direction")
    assert min(asked) >= 1 / 1.9 - 1 - 1e-12
    assert asked.count(0.0) == (150 if task == "yes-no" else 0)


@pytest.mark.parametrize("task", ["same-different", "yes-no", "direction", "odd-one-out"])
def test_a_series_chooses_as_the_placement_that_questplus_confirms(task: Task) -> None:
    """`tests/verification/test_study_oracles.py` compares that placement with questplus."""
    series = adaptive_method(dataclasses.replace(BAYES, count=40), task=task)
    assert isinstance(series, ModelSeries)
    model, random = series._model, np.random.default_rng(6)
    rest = model.prior[: model.prior.size // model.thresholds.size]
    same = Placement(
        PlacementModel(
            {"threshold": model.thresholds, "rest": np.arange(rest.size)},
            model.differences,
            model.answers,
            np.stack([model.chances, 1.0 - model.chances]),
            {"rest": rest},
        ),
        40,
    )
    for number in range(40):
        told = np.where(model.differences == 0, -1.0, same.expected_information())
        asked = series.next_stimulus()
        at = int(np.argmin(np.abs(series._choices - asked)))
        # Every fourth goes through all differences in turn.
        assert number % 4 == 3 or told[at] == pytest.approx(told.max(), abs=1e-12)
        first = bool(random.random() < 0.6)
        chosen = model.answers[0 if first else 1]
        series.update(asked, chosen if task in ("yes-no", "direction") else first)
        same.update(at, 0 if first else 1)
    assert series._weights == pytest.approx(same.probability.ravel(), abs=1e-12)


@pytest.mark.parametrize("series", [STAIRS, BAYES], ids=["staircase", "bayesian"])
def test_answers_played_again_give_the_method_that_was_interrupted(
    series: AdaptiveCondition,
) -> None:
    answers = [(0.4, True), (0.35, False), (0.5, True), (0.2, True)]
    whole = adaptive_method(series)
    for place, answer in enumerate(answers):
        assert adaptive_method(series, iter(answers[:place])).next_stimulus() == (
            whole.next_stimulus()
        )
        whole.update(*answer)
    again = adaptive_method(series, answers)
    assert again.next_stimulus() == whole.next_stimulus()
    assert len(again.trials) == 4  # type: ignore[attr-defined]
