"""Adaptive series of a design: the method that each names, standing where its answers left it."""

from __future__ import annotations

import functools
from collections.abc import Iterable
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.senses import D_PRIME_OF_75
from squeezefilm.study.adaptive.bayesian import AdaptiveDesign, BayesianAdaptive
from squeezefilm.study.adaptive.placement import Placement, PlacementModel
from squeezefilm.study.adaptive.runs import Runs
from squeezefilm.study.adaptive.staircase import Staircase, StaircaseRule
from squeezefilm.study.design.special_trials import AdaptiveCondition
from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.design.tasks.same_different import SAME_DIFFERENT
from squeezefilm.study.design.tasks.task import Task
from squeezefilm.study.psychometric.function import PsychometricPrior

_CHOICES = 40
# Cells of Weber fractions and criteria: a choice takes a millisecond, and finer ones choose alike.
_WEBER_FRACTIONS, _CRITERIA, _LARGEST_CRITERION = 41, 12, 4.0
_SPREAD_EVERY = 4
# Up to a third of the answers: with fewer, plain differences are never asked, and who lapses is
# not told from who is sharp.
_LAPSES = np.array([0.01, 0.04, 0.1, 0.2, 0.35])


class SameDifferentSeries:
    """The differences of a same-different series: those whose answers tell the most of the Weber
    fraction, by the differencing model; every fourth goes through all differences in turn.

    What tells the most lies near one difference, from which nobody can tell a sharp person who
    lapses often from one who is less sharp; the fourths show the whole function. Half of the
    trials are planned to present the reference twice, so that people meet as much of the same as
    of the different and keep their criterion; their answers (a difference of 0) say who is sharp
    and who says "different", and are taken in like all others.
    """

    def __init__(self, series: AdaptiveCondition) -> None:
        self._choices = np.geomspace(series.lowest, series.highest, _CHOICES)
        self.placement = Placement(_differencing(series.lowest, series.highest), series.count)

    @property
    def finished(self) -> bool:
        """True where it has its trials."""
        return self.placement.finished

    def next_stimulus(self) -> si.Dimensionless:
        """The next difference above 0, in parts of the reference."""
        asked = sum(number > 0 for number, _ in self.placement.given)
        if asked % _SPREAD_EVERY == _SPREAD_EVERY - 1:
            # Steps of 17 come to each of the forty once before any comes again.
            return float(self._choices[17 * (asked // _SPREAD_EVERY) % _CHOICES])
        told = self.placement.expected_information()[1:]
        return float(self._choices[int(np.argmax(told))])

    def update(self, intensity: si.Dimensionless, correct: bool) -> None:
        """Take in whether the answer to a difference was right; 0 of a pair that was the same."""
        number = 0
        if intensity > 0:
            number = 1 + int(np.argmin(np.abs(np.log(self._choices / intensity))))
        # "different" is right of all but a pair that is the same.
        said = "different" if correct == (intensity > 0) else "same"
        self.placement.update(number, self.placement.model.answers.index(said))


@functools.lru_cache(maxsize=8)
def _differencing(lowest: float, highest: float) -> PlacementModel:
    differences = np.append(0.0, np.log1p(np.geomspace(lowest, highest, _CHOICES)))
    fractions = np.geomspace(lowest / 4, 4 * highest, _WEBER_FRACTIONS)
    criteria = _LARGEST_CRITERION * (np.arange(_CRITERIA) + 0.5) / _CRITERIA
    parameters = {"Weber fraction": fractions, "criterion": criteria, "lapse rate": _LAPSES}
    # Every combination, the last running fastest.
    grid = np.meshgrid(*parameters.values(), indexing="ij")
    weber, criterion, lapse = (axis.reshape(-1, 1) for axis in grid)
    model = SAME_DIFFERENT.model
    assert model is not None
    assert model.rate is not None
    rise = model.rate(differences * D_PRIME_OF_75 / np.log1p(weber), criterion)
    different = model.lapses * lapse + (1.0 - lapse) * rise
    chances = np.stack([different, 1.0 - different])
    # The prior of psychometric functions, Beta(1, 10).
    prior = {"lapse rate": (1.0 - _LAPSES) ** 9}
    return PlacementModel(parameters, differences, ("different", "same"), chances, prior)


AdaptiveMethod = Staircase | BayesianAdaptive | SameDifferentSeries | Runs


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
    `highest`, for a logistic function of two alternatives; of same-different see
    `SameDifferentSeries`.
    """
    method: AdaptiveMethod
    if task == "same-different":
        method = SameDifferentSeries(series)
    elif series.method == "staircase":
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
        described = TASKS[task]
        in_amounts = described.compares_amounts(series.varied)
        method = Runs(series, is_flat=described.reference == "flat", in_amounts=in_amounts)
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
