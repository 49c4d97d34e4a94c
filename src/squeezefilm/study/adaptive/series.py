"""Adaptive series of a design: the method that each names, standing where its answers left it."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from squeezefilm.study.adaptive.bayesian import AdaptiveDesign, BayesianAdaptive
from squeezefilm.study.adaptive.staircase import Staircase, StaircaseRule
from squeezefilm.study.design.special_trials import AdaptiveCondition
from squeezefilm.study.psychometric.prior import PsychometricPrior

_CHOICES = 40


AdaptiveMethod = Staircase | BayesianAdaptive


def adaptive_method(
    series: AdaptiveCondition, answers: Iterable[tuple[float, bool]] = ()
) -> AdaptiveMethod:
    """The method of a series after the answers (intensity, correct) it has had.

    Intensities are differences from the reference in parts of its value. Nothing in the methods
    is random, so the answers in a study's file are all the state there is: playing them again
    gives the method that was interrupted.

    A staircase moves linearly, halves its step at each reversal down to a quarter, and goes on
    for `count` trials. The Bayesian choice is of 40 logarithmic steps between `lowest` and
    `highest`, for a logistic function of two alternatives.
    """
    method: AdaptiveMethod
    if series.method == "staircase":
        method = Staircase(
            StaircaseRule(
                start=series.start,
                step=series.step,
                smallest_step=series.step / 4,
                down_after=series.down,
                lowest=series.lowest,
                highest=series.highest,
                reversals=series.count + 2,
                most_trials=series.count,
            )
        )
    else:
        choices = np.geomspace(series.lowest, series.highest, _CHOICES)
        method = BayesianAdaptive(
            AdaptiveDesign(
                stimuli=tuple(float(one) for one in choices),
                prior=PsychometricPrior.for_stimuli(choices, "log"),
                axis="log",
                guess_rate=0.5,
                most_trials=series.count,
            )
        )
    for intensity, correct in answers:
        method.update(intensity, correct)
    return method
