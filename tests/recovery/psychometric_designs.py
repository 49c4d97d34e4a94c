"""Simulated people of known threshold, width and lapse rate, and how they are tested.

Designs and truths were fixed before any coverage was computed, and none was left out since.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from squeezefilm.core.quantities import FloatArray
from squeezefilm.study.adaptive.bayesian import AdaptiveDesign, BayesianAdaptive
from squeezefilm.study.adaptive.staircase import Staircase, StaircaseRule
from squeezefilm.study.psychometric.fit import PsychometricFit, fit_psychometric
from squeezefilm.study.psychometric.function import PsychometricFunction, PsychometricPrior

PARAMETERS = ("threshold", "width", "lapse_rate")
Answers = tuple[FloatArray, FloatArray]
Procedure = StaircaseRule | AdaptiveDesign
Experiment = Callable[[PsychometricFunction, np.random.Generator], Answers]

LINEAR = np.arange(1.0, 9.0)
LOGARITHMIC = np.geomspace(1.0, 8.0, 8)
WIDE_PRIOR = PsychometricPrior((1.0, 9.0), (0.5, 12.0))


def constant(levels: FloatArray, repetitions: int) -> Experiment:
    def answers(truth: PsychometricFunction, random: np.random.Generator) -> Answers:
        intensity = np.repeat(levels, repetitions)
        return intensity, random.random(intensity.size) < truth(intensity)

    return answers


def entropy(trials: int, cells: tuple[int, int, int] = (40, 20, 5)) -> tuple[Procedure, ...]:
    stimuli = tuple(np.linspace(0.0, 10.0, 41))
    return (AdaptiveDesign(stimuli, WIDE_PRIOR, cells=cells, most_trials=trials),)


def staircases(trials: int) -> tuple[Procedure, ...]:
    """Half of the trials two down, one up (71 %), half seven down, one up (91 %)."""
    return tuple(
        StaircaseRule(
            8.0, 0.6, 0.2, down_after=n, lowest=0.0, highest=10.0, most_trials=trials // 2,
        )
        for n in (2, 7)
    )  # fmt: skip


def adaptive(procedures: tuple[Procedure, ...]) -> Experiment:
    """Trial by trial, as a study does it."""

    def answers(truth: PsychometricFunction, random: np.random.Generator) -> Answers:
        shown: list[tuple[float, bool]] = []
        for one in procedures:
            method = Staircase(one) if isinstance(one, StaircaseRule) else BayesianAdaptive(one)
            while not method.finished:
                x = method.next_stimulus()
                shown.append((x, bool(random.random() < truth(x))))
                method.update(*shown[-1])
        return np.array([x for x, _ in shown]), np.array([float(y) for _, y in shown])

    return answers


@dataclass(frozen=True)
class Recovery:
    """A truth, an experiment on it, and the prior of the fit (None: from the stimuli)."""

    truth: PsychometricFunction
    experiment: Experiment
    prior: PsychometricPrior | None = None

    def fit(self, seed: int) -> PsychometricFit:
        intensity, positive = self.experiment(self.truth, np.random.default_rng(seed))
        return fit_psychometric(
            intensity, positive, shape=self.truth.shape, axis=self.truth.axis,
            guess_rate=self.truth.guess_rate, prior=self.prior,
        )  # fmt: skip


PERSON = PsychometricFunction("logistic", 5.0, 3.0, 0.5, 0.03)
RECOVERIES: dict[str, Recovery] = {
    "two-interval, 320 constant stimuli": Recovery(
        PsychometricFunction("logistic", 4.5, 3.0, 0.5, 0.03), constant(LINEAR, 40)
    ),
    "yes/no, 160 constant stimuli": Recovery(
        PsychometricFunction("gaussian", 4.5, 4.0, 0.0, 0.02), constant(LINEAR, 20)
    ),
    "four alternatives, 240 constant stimuli": Recovery(
        PsychometricFunction("weibull", 3.0, 1.0, 0.25, 0.02, "log"), constant(LOGARITHMIC, 30)
    ),
    "two-interval, 200 stimuli chosen by entropy": Recovery(
        PERSON, adaptive(entropy(200)), WIDE_PRIOR
    ),
    "two-interval, 200 stimuli on staircases": Recovery(
        PERSON, adaptive(staircases(200)), WIDE_PRIOR
    ),
}


@dataclass(frozen=True)
class Coverage:
    """Share of runs whose interval held the truth, and the median length of the intervals."""

    share: float
    length: float


def coverage(recovery: Recovery, runs: int) -> dict[str, Coverage]:
    """Coverage of the posterior intervals by parameter."""
    rows: dict[str, list[tuple[bool, float]]] = {}
    for seed in range(runs):
        for name, (low, high) in recovery.fit(seed).posterior_interval.items():
            inside = low <= getattr(recovery.truth, name) <= high
            rows.setdefault(name, []).append((inside, high - low))
    return {
        name: Coverage(
            float(np.mean([inside for inside, _ in row])),
            float(np.median([length for _, length in row])),
        )
        for name, row in rows.items()
    }
