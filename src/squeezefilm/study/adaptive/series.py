"""Adaptive series of a design: the method that each names, standing where its answers left it."""

from __future__ import annotations

import functools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import ndtr

from squeezefilm.core import quantities as si
from squeezefilm.study.adaptive.bayesian import AdaptiveDesign, BayesianAdaptive, information
from squeezefilm.study.adaptive.staircase import Runs, Staircase, StaircaseRule
from squeezefilm.study.design.rules import AdaptiveCondition
from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.design.tasks.task import StudyTask, Task
from squeezefilm.study.psychometric.function import PsychometricPrior

_CHOICES = 40
# Cells of thresholds, and every third criterion of a task's model: a choice takes a millisecond,
# and finer ones choose alike.
_THRESHOLDS, _LARGEST_CRITERION = 41, 4.0
_SPREAD_EVERY = 4
# Up to a third of the answers: with fewer, plain differences are never asked, and who lapses is
# not told from who is sharp.
_LAPSES = np.array([0.01, 0.04, 0.1, 0.2, 0.35])


@dataclass(frozen=True, slots=True, eq=False)
class _TaskModel:
    """Chances of a task's answers under each combination (cell) of its parameters.

    `differences` rise, of levels, shape (differences,); `answers` are two, `chances` those of the
    first, shape (cells, differences); `prior` is of the cells, those of each of the `thresholds` in
    a row, with everything else that is integrated out.
    """

    differences: si.FloatArray
    thresholds: si.FloatArray
    answers: tuple[str, str]
    chances: si.DimensionlessArray
    prior: si.DimensionlessArray


class ModelSeries:
    """The differences of a series by the model of its task: those whose answers tell the most of
    the threshold (QUEST+: Watson 2017, 10.1167/17.3.10); every fourth goes through all differences
    in turn.

    What tells the most lies near one difference, from which nobody can tell a sharp person who
    lapses often from one who is less sharp; the fourths show the whole function. Trials of the
    reference alone are planned where the task has them, so that people meet as much of it as of the
    rest and keep their criterion; their answers (a difference of 0) say who is sharp and where the
    criterion is, and are taken in like all others. About a reference that is remembered differences
    go as far below it as above.
    """

    def __init__(self, series: AdaptiveCondition, task: Task) -> None:
        described = TASKS[task]
        in_amounts = described.compares_amounts(series.varied)
        self._model = _task_model((series.lowest, series.highest), task, in_amounts)
        # As intensities have them, in parts of the reference or amounts.
        differences = self._model.differences
        self._choices = differences if in_amounts else np.expm1(differences)
        self._hears_choice = hears_choice(series, described)
        self._weights = self._model.prior
        self._asked = 0

    def next_stimulus(self) -> si.Dimensionless:
        """The next difference other than 0, in parts of the reference or as an amount."""
        model = self._model
        real = np.flatnonzero(model.differences)
        if self._asked % _SPREAD_EVERY == _SPREAD_EVERY - 1:
            # Steps of 17 come to each of the forty once before any comes again.
            return float(self._choices[real[17 * (self._asked // _SPREAD_EVERY) % real.size]])
        nuisance = model.prior.size // model.thresholds.size
        told = information(self._weights, model.chances, nuisance)
        return float(self._choices[real[int(np.argmax(told[real]))]])

    def update(self, intensity: si.Dimensionless, answered: bool | str) -> None:
        """Take in an answer to a difference: the answer itself of one surface, else whether it was
        right; 0 is the reference alone."""
        number, model = int(np.argmin(np.abs(self._choices - intensity))), self._model
        # The first answer, which is counted, is right of all but the reference alone.
        is_first = answered == (intensity > 0)
        if self._hears_choice:
            is_first = answered == model.answers[0]
        chance = model.chances[:, number]
        weights = self._weights * (chance if is_first else 1.0 - chance)
        self._weights = weights / float(weights.sum())
        self._asked += bool(model.differences[number])


@functools.lru_cache(maxsize=8)
def _task_model(ends: tuple[float, float], task: Task, in_amounts: bool) -> _TaskModel:
    """The model of a task's answers to the differences that a series may choose between."""
    described = TASKS[task]
    model = described.model
    assert model is not None
    is_signed = described.reference == "remembered"
    choices = np.geomspace(*ends, _CHOICES // 2 if is_signed else _CHOICES)
    above = choices if in_amounts else np.log1p(choices)
    below = -above[::-1] if is_signed else np.zeros(1)
    differences = np.concatenate([below, above])
    thresholds = np.geomspace(ends[0] / 4, 4 * ends[1], _THRESHOLDS)
    within = model.criteria[model.criteria <= _LARGEST_CRITERION]
    criteria = within[within.size // 2 % 3 :: 3]
    # Every combination, the last running fastest.
    grid = np.meshgrid(thresholds, criteria, _LAPSES, indexing="ij")
    threshold, criterion, lapse = (axis.reshape(-1, 1) for axis in grid)
    deviation = (threshold if in_amounts else np.log1p(threshold)) / model.threshold
    if model.rate is None:
        rise = ndtr((differences - criterion * above[-1]) / deviation)
    else:
        rise = model.rate(differences / deviation, criterion)
    counted = model.lapses * lapse + (1.0 - lapse) * rise
    answers = ("right", "wrong") if model.counts < 0 else described.answers[:: 1 - 2 * model.counts]
    # The prior of psychometric functions, Beta(1, 10).
    prior, lapses = np.ones(1), (1.0 - _LAPSES) ** 9
    for own in (np.ones(thresholds.size), np.ones(criteria.size), lapses):
        prior = np.multiply.outer(prior, own / own.sum()).ravel()
    return _TaskModel(differences, thresholds, (answers[0], answers[1]), counted, prior)


def hears_choice(series: AdaptiveCondition, task: StudyTask) -> bool:
    """True of a method that goes by what was answered, and not by whether it was right."""
    return series.in_runs or task.surfaces == 1


AdaptiveMethod = Staircase | BayesianAdaptive | ModelSeries | Runs


def adaptive_method(
    series: AdaptiveCondition,
    answers: Iterable[tuple[float, Any]] = (),
    task: Task = "two-interval",
) -> AdaptiveMethod:
    """The method of a series after the answers (intensity, and whether it was right, or of runs
    which it was) it has had.

    Intensities are differences from the reference in parts of its value. Nothing in the methods
    is random, so the answers in a study's file are all the state there is: playing them again
    gives the method that was interrupted.

    A staircase moves linearly, halves its step at each reversal down to a quarter, and goes on
    for `count` trials. The Bayesian choice is of 40 logarithmic steps between `lowest` and
    `highest`, for a logistic function of two alternatives; of tasks in which it takes more than
    what is right see `ModelSeries`.
    """
    method: AdaptiveMethod
    described = TASKS[task]
    if series.method == "staircase":
        method = Staircase(
            StaircaseRule(
                start=series.start,
                step=series.step,
                smallest_step=series.step / 4,
                down_after=series.down,
                lowest=series.lowest,
                highest=series.highest,
                most_trials=series.count,
            )
        )
    elif series.in_runs:
        in_amounts = described.compares_amounts(series.varied)
        method = Runs(series, is_flat=described.reference == "flat", in_amounts=in_amounts)
    elif not described.right_is_enough:
        method = ModelSeries(series, task)
    else:
        choices = np.geomspace(series.lowest, series.highest, _CHOICES)
        method = BayesianAdaptive(
            AdaptiveDesign(
                stimuli=tuple(float(choice) for choice in choices),
                prior=PsychometricPrior.for_stimuli(choices, "log"),
                axis="log",
                guess_rate=0.5,
                most_trials=series.count,
            )
        )
    for intensity, correct in answers:
        method.update(intensity, correct)
    return method
