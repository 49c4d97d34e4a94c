"""Staircases and Bayesian choice against closed forms and exact sums."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.adaptive.bayesian import AdaptiveDesign, BayesianAdaptive
from squeezefilm.study.adaptive.staircase import Staircase, StaircaseRule
from squeezefilm.study.psychometric.function import PsychometricFunction, PsychometricPrior

PRIOR = PsychometricPrior((1.0, 9.0), (0.5, 12.0))
STIMULI = tuple(np.linspace(0.0, 10.0, 21))
PERSON = PsychometricFunction("logistic", 5.0, 3.0, 0.5, 0.02)


def mean_of_stationary_distribution(down_after: int, step: float) -> float:
    """Mean level of a staircase as a Markov chain of (level, answers in a row), without noise."""
    function = PsychometricFunction("logistic", 0.0, 4.0)
    levels = np.arange(-6.0, 6.0 + step / 2, step)
    p = function(levels)
    # Balance of the flows: one sparse linear solve over level and streak.
    count = levels.size * down_after
    matrix = np.zeros((count, count))
    for i in range(levels.size):
        for streak in range(down_after):
            here = i * down_after + streak
            up = min(i + 1, levels.size - 1) * down_after
            matrix[up, here] += 1 - p[i]
            if streak + 1 == down_after:
                matrix[max(i - 1, 0) * down_after, here] += p[i]
            else:
                matrix[here + 1, here] += p[i]
    balance = matrix - np.eye(count)
    balance[-1] = 1.0
    right = np.zeros(count)
    right[-1] = 1.0
    share = np.linalg.solve(balance, right).reshape(levels.size, down_after).sum(axis=1)
    return float(share @ levels)


@pytest.mark.parametrize("down_after", [1, 2, 3])
def test_small_steps_settle_where_steps_up_and_down_cancel(down_after: int) -> None:
    function = PsychometricFunction("logistic", 0.0, 4.0)
    goal = function.intensity(0.5 ** (1 / down_after))
    errors = [
        abs(mean_of_stationary_distribution(down_after, step) - goal) for step in (0.2, 0.1, 0.05)
    ]
    assert errors[-1] < 0.05
    if errors[0] > 1e-8:
        # The mean is off by a share of the step: half the step, half the error.
        assert errors[1] / errors[2] == pytest.approx(2.0, rel=0.2)


@pytest.mark.slow
def test_a_long_staircase_spends_its_time_where_the_chain_says() -> None:
    rule = StaircaseRule(0.0, 0.2, 0.2, down_after=2, lowest=-6, highest=6, most_trials=4000)
    function = PsychometricFunction("logistic", 0.0, 4.0)
    random, stairs = np.random.default_rng(1), Staircase(rule)
    shown = []
    for _ in range(4000):
        x = stairs.next_stimulus()
        stairs.update(x, bool(random.random() < function(x)))
        shown.append(x)
    blocks = np.array(shown).reshape(20, -1).mean(axis=1)
    error = blocks.std(ddof=1) / math.sqrt(20)
    assert np.mean(shown) == pytest.approx(mean_of_stationary_distribution(2, 0.2), abs=4 * error)


def test_a_staircase_played_by_hand() -> None:
    stairs = Staircase(StaircaseRule(8.0, 2.0, 0.5, down_after=2, lowest=0, highest=10))
    levels = []
    for correct in (True, True, True, True, False, True, True, False):
        levels.append(stairs.next_stimulus())
        stairs.update(levels[-1], correct)
    # Down 2 twice; the first reversal halves the step, the second halves it again, as the third.
    assert levels == [8, 8, 6, 6, 4, 5, 5, 4.5]
    assert [trial.reversal for trial in stairs.trials] == [
        False, False, False, False, True, False, True, True,
    ]  # fmt: skip
    assert stairs.next_stimulus() == 5.0
    assert stairs.threshold(discard=1) == pytest.approx((5 + 4.5) / 2)


def test_on_a_logarithmic_axis_steps_are_ratios() -> None:
    stairs = Staircase(StaircaseRule(8.0, math.log(2), math.log(2), down_after=1, axis="log"))
    for _ in range(3):
        stairs.update(stairs.next_stimulus(), True)
    assert stairs.next_stimulus() == pytest.approx(1.0)


def test_a_finished_staircase_says_so() -> None:
    stairs = Staircase(StaircaseRule(8.0, 1.0, 1.0, most_trials=1))
    stairs.update(8.0, True)
    assert stairs.finished
    with pytest.raises(InputError, match="finished after 1 trials"):
        stairs.next_stimulus()
    with pytest.raises(InputError, match="no two reversals"):
        stairs.threshold()


def entropy(weights: np.ndarray) -> float:
    some = weights[weights > 0]
    return float(-np.sum(some * np.log(some)))


@pytest.mark.parametrize("interest", ["all", "threshold and width"])
def test_expected_information_is_the_expected_fall_of_entropy(interest: str) -> None:
    design = AdaptiveDesign(
        STIMULI,
        PRIOR,
        cells=(12, 8, 3),
        interest=interest,  # type: ignore[arg-type]
    )
    method = BayesianAdaptive(design)
    for x, positive in ((6.0, True), (3.5, False), (5.0, True)):
        method.update(x, positive)
    told = method.expected_information()
    for at, x in enumerate(STIMULI[::5]):
        # By its definition: each answer tried, weighted with its probability.
        expected = 0.0
        for positive in (True, False):
            branch = BayesianAdaptive(design)
            for trial in method.trials:
                branch.update(trial.intensity, trial.positive)
            branch.update(x, positive)
            share = _predicted(method, x)
            expected += (share if positive else 1 - share) * entropy_of(branch)
        assert entropy_of(method) - expected == pytest.approx(told[5 * at], abs=1e-12)
    assert np.all(told >= -1e-12)


def entropy_of(method: BayesianAdaptive) -> float:
    """Entropy of the posterior of what is of interest (nat)."""
    weights = method.probability
    if method.design.interest == "threshold and width":
        weights = weights.sum(axis=2)
    return entropy(weights)


def _predicted(method: BayesianAdaptive, x: float) -> float:
    total = 0.0
    axis_cells = method.design.cells
    nodes = [
        PRIOR.quantile(at, (np.arange(size) + 0.5) / size, "linear")
        for at, size in enumerate(axis_cells)
    ]
    for (i, j, k), weight in np.ndenumerate(method.probability):
        person = PsychometricFunction(
            "logistic", float(nodes[0][i]), float(np.exp(nodes[1][j])), 0.5, float(nodes[2][k])
        )
        total += weight * float(person(x))
    return total


def test_the_estimate_is_the_posterior_mean_of_place_and_geometric_mean_of_width() -> None:
    method = BayesianAdaptive(AdaptiveDesign((2.0, 6.0), PRIOR, cells=(4, 4, 2)))
    method.update(6.0, True)
    places, widths = (PRIOR.quantile(at, (np.arange(4) + 0.5) / 4, "linear") for at in range(2))
    place = log_width = 0.0
    for (i, j, _), weight in np.ndenumerate(method.probability):
        place += weight * places[i]
        log_width += weight * widths[j]
    assert method.estimate() == pytest.approx((place, np.exp(log_width)))


def test_the_posterior_is_bayes_rule() -> None:
    method = BayesianAdaptive(AdaptiveDesign((2.0, 6.0), PRIOR, cells=(4, 3, 2)))
    method.update(6.0, True)
    # Also off the list of stimuli.
    method.update(4.3, False)
    nodes = [PRIOR.quantile(at, (np.arange(n) + 0.5) / n, "linear") for at, n in
             enumerate((4, 3, 2))]  # fmt: skip
    weights = np.zeros((4, 3, 2))
    for i, j, k in np.ndindex(weights.shape):
        person = PsychometricFunction(
            "logistic", float(nodes[0][i]), float(np.exp(nodes[1][j])), 0.5, float(nodes[2][k])
        )
        weights[i, j, k] = person(6.0) * (1 - person(4.3))
    assert method.probability == pytest.approx(weights / weights.sum(), abs=1e-14)


@pytest.mark.slow
def test_chosen_stimuli_tell_more_than_random_ones() -> None:
    # From a range as wide as one takes who does not know where the threshold is.
    wide = tuple(np.linspace(0.0, 30.0, 31))
    design = AdaptiveDesign(wide, PRIOR, cells=(30, 16, 4), most_trials=60)
    ends: dict[str, list[float]] = {"chosen": [], "random": []}
    for seed in range(24):
        random = np.random.default_rng(seed)
        for kind, list_of_ends in ends.items():
            method = BayesianAdaptive(design)
            while not method.finished:
                x = method.next_stimulus() if kind == "chosen" else float(random.choice(wide))
                method.update(x, bool(random.random() < PERSON(x)))
            list_of_ends.append(entropy_of(method))
    assert np.mean(ends["chosen"]) < np.mean(ends["random"]) - 0.3


def test_an_impossible_answer_is_refused() -> None:
    design = AdaptiveDesign(
        (0.0, 100.0), PsychometricPrior((1.0, 2.0), (0.01, 0.02)), guess_rate=0.0
    )
    with pytest.raises(InputError, match="impossible under every parameter"):
        BayesianAdaptive(design).update(-1e4, True)
