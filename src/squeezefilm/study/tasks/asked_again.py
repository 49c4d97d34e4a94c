"""Thresholds of adaptive series with intervals from simulated people who are asked again.

A person's Weber fraction has a posterior, to which it does not matter how stimuli were chosen.
Beside it stands what does not rest on a prior: a function fitted to the person's right answers, and
the thresholds that simulated runs of the same staircases and Bayesian choices do not refuse
(`adaptive.rerun`). In two intervals the difference at which half of the function's rise is reached
is told in 75 % of the trials by who attends: it is the Weber fraction, without a bias.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.adaptive.bayesian import BayesianAdaptive
from squeezefilm.study.adaptive.rerun import Procedure, rerun_intervals
from squeezefilm.study.adaptive.series import adaptive_method
from squeezefilm.study.adaptive.staircase import Staircase
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.psychometric.estimate import Estimate
from squeezefilm.study.psychometric.fit import fit_psychometric
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import PersonEstimate

LEAST_RUNS = 39
"""Simulated experiments without which there is no 95 % interval."""


def require_rerun(design: StudyDesign, reruns: int) -> None:
    """Refuse to ask again where nobody was asked adaptively in two intervals.

    Raises `InputError`, also for fewer simulated experiments than `LEAST_RUNS`.
    """
    if not reruns:
        return
    si.require("reruns", reruns, at_least=LEAST_RUNS)
    if design.task != "two-interval" or not design.adaptive:
        raise InputError(
            f"reruns = {reruns}: '{design.name}' has no adaptive series in two intervals that "
            "could be simulated again; leave reruns out",
            quantity="reruns",
        )


def asked_again(
    main: Answers,
    persons: Sequence[PersonEstimate],
    reruns: int,
    level: si.Dimensionless,
    seed: int,
    tell: Callable[[str], None],
) -> tuple[PersonEstimate, ...]:
    """The persons with their threshold (1, in parts of the reference) by `reruns` simulated runs.

    Who answered to one difference only has none. A person takes seconds, with Bayesian choices
    longer than with staircases.
    """
    found = []
    for count, person in enumerate(persons, 1):
        tell(f"simulated reruns, person {count} of {len(persons)}: {reruns} runs")
        mine = main.take(main.participant == main.people.index(person.person))
        found.append(dataclasses.replace(person, asked_again=_threshold(mine, reruns, level, seed)))
    return tuple(found)


def _threshold(mine: Answers, reruns: int, level: si.Dimensionless, seed: int) -> Estimate | None:
    if np.unique(mine.intensity).size < 2:
        return None
    fit = fit_psychometric(
        mine.intensity,
        mine.correct,
        shape="weibull",
        axis="log",
        level=level,
        replicates=0,
    )
    procedures = [
        _procedure(mine, number, trials)
        for number in range(len(mine.design.adaptive))
        if (trials := int(np.count_nonzero(mine.series == number)))
    ]
    ends = rerun_intervals(
        fit, procedures, level=level, replicates=reruns, seed=seed, parameters=("threshold",)
    )["threshold"]
    return Estimate(fit.function.threshold, *ends, level, f"{reruns} simulated reruns")


def _procedure(mine: Answers, series: int, trials: int) -> Procedure:
    """What chose the stimuli of a series, for as many trials as were answered."""
    method = adaptive_method(mine.design.adaptive[series])
    assert isinstance(method, Staircase | BayesianAdaptive)
    if isinstance(method, Staircase):
        return dataclasses.replace(method.rule, most_trials=trials)
    return dataclasses.replace(method.design, most_trials=trials)
