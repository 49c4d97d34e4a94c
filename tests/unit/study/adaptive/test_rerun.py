"""Simulated adaptive runs are those of the methods; intervals that ask again, and refusals."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.adaptive import kernel
from squeezefilm.study.adaptive.bayesian import AdaptiveDesign, BayesianAdaptive
from squeezefilm.study.adaptive.rerun import Procedure, rerun_intervals, simulate_runs
from squeezefilm.study.adaptive.staircase import Staircase, StaircaseRule
from squeezefilm.study.psychometric.bootstrap import Experiments, Simulated
from squeezefilm.study.psychometric.fit import PsychometricFit, fit_psychometric
from squeezefilm.study.psychometric.function import (
    Axis,
    PsychometricFunction,
    PsychometricPrior,
    on_axis,
)

PRIOR = PsychometricPrior((1.0, 9.0), (0.5, 12.0))
BAYES = AdaptiveDesign(
    tuple(np.linspace(0.5, 10.0, 20)), PRIOR, cells=(16, 8, 3), most_trials=50
)  # fmt: skip
STAIRS = StaircaseRule(8.0, 1.0, 0.25, lowest=0.5, highest=10.0, most_trials=50)
RATIOS = StaircaseRule(8.0, 0.4, 0.1, 1, 3.0, lowest=0.5, highest=9.0, axis="log", reversals=8)
PERSON = PsychometricFunction("logistic", 4.5, 3.0, 0.5, 0.04)
THETA = np.array([4.5, math.log(3.0), 0.04, 0.5])


def by_hand(
    procedure: Procedure, person: PsychometricFunction, among: np.ndarray
) -> list[tuple[float, bool]]:
    method = (
        Staircase(procedure)
        if isinstance(procedure, StaircaseRule)
        else BayesianAdaptive(procedure)
    )
    for share in among:
        if method.finished:
            break
        x = method.next_stimulus()
        method.update(x, bool(share < person(x)))
    return [
        (one.intensity, one.correct if hasattr(one, "correct") else one.positive)
        for one in method.trials
    ]


@pytest.mark.parametrize("axis", ["linear", "log"])
@pytest.mark.parametrize("procedure", [BAYES, STAIRS, RATIOS], ids=["entropy", "linear", "ratios"])
def test_simulated_runs_are_those_of_the_methods(procedure: Procedure, axis: Axis) -> None:
    among = np.random.default_rng(3).random((6, procedure.most_trials))
    person = PERSON if axis == "linear" else dataclasses.replace(PERSON, width=0.9, axis=axis)
    theta = THETA if axis == "linear" else np.array([math.log(4.5), math.log(0.9), 0.04, 0.5])
    x, y = simulate_runs(procedure, 0, axis, theta, among)
    alike = []
    for run in range(6):
        asked = by_hand(procedure, person, among[run])
        size = len(asked)
        assert np.isnan(x[run, size:]).all()
        places = on_axis(np.array([one for one, _ in asked]), axis)
        alike += np.isclose(x[run, :size], places, atol=1e-9).tolist()
        alike += (y[run, :size] == [answer for _, answer in asked]).tolist()
    # Entropies come from a table, so that two stimuli that tell as much may change places.
    assert np.mean(alike) >= (0.97 if isinstance(procedure, AdaptiveDesign) else 1.0)


def test_trials_at_one_place_are_put_together() -> None:
    x = np.array([[3.0, 1.0, 3.0 + 1e-12, 2.0], [5.0, 5.0, np.nan, np.nan]])
    y = np.array([[1.0, 0.0, 0.0, 1.0], [1.0, 1.0, np.nan, np.nan]])
    k, n, used = np.zeros_like(x), np.zeros_like(x), np.zeros(2, dtype=np.int64)
    kernel.gather(x, y, k, n, used)
    assert used.tolist() == [3, 1]
    assert x[0, :3] == pytest.approx([1.0, 2.0, 3.0])
    assert k[0, :3].tolist() == [0.0, 1.0, 1.0]
    assert n[0, :3].tolist() == [1.0, 1.0, 2.0]
    assert (x[1, 0], k[1, 0], n[1, 0]) == (5.0, 2.0, 2.0)


def test_entropies_from_the_table_are_near_those_from_logarithms() -> None:
    random = np.random.default_rng(0)
    weights = random.dirichlet(np.ones(60))
    chances = random.uniform(0.5, 0.99, (1, 60, 7))
    exact, near = np.empty(7), np.empty(7)
    kernel.information(weights, chances, 3, 0.0, kernel.EXACT, exact)
    kernel.information(weights, chances, 3, 0.0, kernel.entropies(), near)
    assert near == pytest.approx(exact, abs=1e-6)
    assert exact.min() > 0.0


class _Dear:
    """Staircases that count how often they are simulated."""

    dear = True

    def __init__(self) -> None:
        self.among = np.random.default_rng(5).random((4000, 50))
        self.calls = 0

    def __call__(self, theta: np.ndarray) -> Simulated:
        self.calls += 1
        x, y = simulate_runs(STAIRS, 0, "linear", theta, self.among)
        k, n, used = np.zeros_like(x), np.zeros_like(x), np.zeros(len(x), dtype=np.int64)
        kernel.gather(x, y, k, n, used)
        return Simulated(x, k, n, used)


def mean_right(runs: Simulated, weights: np.ndarray) -> float:
    right = [k[:used].sum() for k, used in zip(runs.k, runs.used, strict=True)]
    return float(np.average(right, weights=weights))


def test_runs_of_one_truth_are_weighed_for_another() -> None:
    dear = _Dear()
    kept = Experiments(0, dear)
    kept.at(THETA)
    near = THETA + np.array([0.2, 0.05, 0.01, 0.0])
    weighed = mean_right(*kept.at(near))
    assert dear.calls == 1
    direct = _Dear()(near)
    # Forty standard errors of the mean are a trial; the truths differ by a third of one.
    assert weighed == pytest.approx(mean_right(direct, np.ones(4000)), abs=0.15)
    # Far away nothing that was kept is worth much, and new runs are made.
    kept.at(THETA + np.array([3.0, 0.0, 0.0, 0.0]))
    assert dear.calls == 2


def fitted(procedures: list[Procedure], seed: int = 1) -> PsychometricFit:
    random = np.random.default_rng(seed)
    asked = [
        one for each in procedures for one in by_hand(each, PERSON, random.random(each.most_trials))
    ]
    x, y = np.array([one for one, _ in asked]), np.array([float(one) for _, one in asked])
    return fit_psychometric(x, y, prior=PRIOR, replicates=0)


@pytest.mark.parametrize("procedures", [[BAYES], [STAIRS, RATIOS]], ids=["entropy", "staircases"])
def test_an_interval_holds_its_fit_and_is_wider_at_a_higher_level(
    procedures: list[Procedure],
) -> None:
    fit = fitted(procedures)
    found = rerun_intervals(fit, procedures, replicates=99, seed=4)
    assert set(found) == {"threshold", "width", "lapse_rate"}
    narrow = rerun_intervals(fit, procedures, level=0.5, replicates=99, seed=4)
    for name, (low, high) in found.items():
        best = getattr(fit.function, name)
        assert low - 1e-6 <= best <= high + 1e-6
        assert low - 1e-6 <= narrow[name][0] <= narrow[name][1] <= high + 1e-6
        assert narrow[name][1] - narrow[name][0] < high - low
    assert rerun_intervals(fit, procedures, replicates=99, seed=4) == found


def test_what_cannot_be_asked_again_is_refused() -> None:
    fit = fitted([BAYES])
    with pytest.raises(InputError, match="no procedure"):
        rerun_intervals(fit, [])
    with pytest.raises(InputError, match="ask for 49 to 49"):
        rerun_intervals(fit, [dataclasses.replace(BAYES, most_trials=49)])
    with pytest.raises(InputError, match="replicates = 38"):
        rerun_intervals(fit, [BAYES], replicates=38)
    with pytest.raises(InputError, match="logarithmic axis"):
        simulate_runs(
            dataclasses.replace(STAIRS, lowest=0.0), 0, "log", THETA, np.full((1, 50), 0.5)
        )
