"""Quantities of trials over participants: means by condition, drift over a session, attention."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from squeezefilm.core import quantities as si
from squeezefilm.study.identification.confusion import one_per_trial
from squeezefilm.study.psychometric.estimate import t_interval
from squeezefilm.study.record.answers import Answers


@dataclass(frozen=True, slots=True)
class ConditionMean:
    """A quantity of trials by condition: the mean of participants' means, with its t interval.

    `low` and `high` are NaN with one participant.
    """

    name: str
    trials: int
    participants: int
    mean: float
    low: float
    high: float
    level: si.Dimensionless


def condition_means(
    participant: ArrayLike,
    condition: ArrayLike,
    values: ArrayLike,
    names: tuple[str, ...],
    level: si.Dimensionless = 0.95,
) -> tuple[ConditionMean, ...]:
    """Means by condition with participants as the random unit; conditions without a value are
    left out.

    Args:
        participant, condition: numbers from 0 up, shape (trials,).
        values: of the trials, shape (trials,), in any unit; NaN for none.
        names: of the conditions.
        level: of the intervals.

    Raises:
        InputError: arrays of unequal length, or a level not between 0 and 1.
    """
    si.require("level", level, above=0.0, below=1.0)
    person = np.asarray(participant, dtype=np.int64)
    kind, given = np.asarray(condition, dtype=np.int64), np.asarray(values, dtype=float)
    one_per_trial(participant=person, condition=kind, values=given)
    there = np.isfinite(given)
    person, kind, given = person[there], kind[there], given[there]
    people = int(person.max()) + 1 if person.size else 0
    group, size = person * len(names) + kind, people * len(names)
    count = np.bincount(group, minlength=size).reshape(people, len(names))
    total = np.bincount(group, given, size).reshape(people, len(names))
    found = []
    for column, name in enumerate(names):
        some = count[:, column] > 0
        if not np.any(some):
            continue
        means = total[some, column] / count[some, column]
        mean = t_interval(means, level)
        trials = int(count[:, column].sum())
        found.append(
            ConditionMean(name, trials, means.size, mean.value, mean.low, mean.high, level)
        )
    return tuple(found)


@dataclass(frozen=True, slots=True)
class ResponseTimeSummary:
    """Response times of one condition.

    Attributes:
        name: of the condition.
        trials, participants: that have one.
        geometric_mean: of participants' geometric means (s).
        low, high: its t interval over participants (s), at `level`; NaN with one participant.
        level: of the interval.
    """

    name: str
    trials: int
    participants: int
    geometric_mean: si.Second
    low: si.Second
    high: si.Second
    level: si.Dimensionless


def response_time_summary(
    participant: ArrayLike,
    condition: ArrayLike,
    response_time: ArrayLike,
    names: tuple[str, ...],
    level: si.Dimensionless = 0.95,
) -> tuple[ResponseTimeSummary, ...]:
    """Summaries by condition of times (s), NaN for one not taken; those of a participant count as
    log-normal. Conditions are as `condition_means` has them, and those without a time left out.

    Raises `InputError` for times not above 0, and as `condition_means` does.
    """
    given = np.asarray(response_time, dtype=float)
    one_per_trial(participant=participant, condition=condition, response_time=given)
    si.require("response_time", given[~np.isnan(given)], si.Unit("s"), above=0.0)
    return tuple(
        ResponseTimeSummary(
            logs.name,
            logs.trials,
            logs.participants,
            float(np.exp(logs.mean)),
            float(np.exp(logs.low)),
            float(np.exp(logs.high)),
            level,
        )
        for logs in condition_means(participant, condition, np.log(given), names, level)
    )


ATTENDS: si.Dimensionless = 0.95
"""Share of catch trials that a person who attends gets right; assumed."""
_DOUBTFUL = 0.05


@dataclass(frozen=True, slots=True)
class Drift:
    """Change of a quantity from a person's first trial to their last, over people.

    Attributes:
        quantity: what changed, in words.
        change: mean over people of each one's slope by least squares, over the whole session, in
            the quantity's unit.
        low, high: its t interval over people at `level`; NaN for one person.
        p_value: of no change, two-sided; NaN for one person.
        participants: with ten trials or more.
    """

    quantity: str
    change: float
    low: float
    high: float
    level: si.Dimensionless
    p_value: si.Dimensionless
    participants: int


@dataclass(frozen=True, slots=True)
class Attention:
    """A person's catch trials.

    `p_value` is the probability of no more right ones from a person who gets 95 % of them right;
    `attended` says that it is 5 % or more.
    """

    person: str
    right: int
    asked: int
    p_value: si.Dimensionless
    attended: bool


@dataclass(frozen=True, slots=True)
class Course:
    """The course of a session on one display: what drifted, and who attended; empty where nothing
    was recorded."""

    drift: tuple[Drift, ...]
    attention: tuple[Attention, ...]


def course_of(answers: Answers, display: int) -> Course:
    """The course of the main trials on a display (number in the design's order), and its catch
    trials."""
    main, drifts = answers.main(display), []
    if not np.isnan(main.correct).all() and not (main.series >= 0).any():
        drifts.append(drift(main, main.correct, "share of right answers"))
    times = main.response_time
    if np.isfinite(times).any():
        drifts.append(drift(main, np.log(np.where(times > 0, times, np.nan)), "ln response time"))
    caught = answers.take((answers.display == display) & (answers.phase == "catch"))
    return Course(tuple(value for value in drifts if value is not None), attention(caught))


def drift(
    main: Answers, values: si.FloatArray, quantity: str, level: si.Dimensionless = 0.95
) -> Drift | None:
    """The change of a quantity over each person's trials; None where nobody has ten.

    Place in the session runs from 0 at a person's first main trial to 1 at the last.
    """
    slopes = []
    for person in np.unique(main.participant):
        mine = main.participant == person
        mine &= np.isfinite(values)
        if np.count_nonzero(mine) < 10:
            continue
        # Not their numbers: what was asked again has a late one, and a foreign file any.
        place = np.linspace(0.0, 1.0, np.count_nonzero(mine))
        slopes.append(float(np.polyfit(place, values[mine], 1)[0]))
    if not slopes:
        return None
    mean, count, p = t_interval(np.array(slopes), level), len(slopes), math.nan
    if count > 1 and (error := float(np.std(slopes, ddof=1)) / math.sqrt(count)) > 0:
        p = float(2 * stats.t.sf(abs(mean.value) / error, count - 1))
    return Drift(quantity, mean.value, mean.low, mean.high, level, p, count)


def attention(caught: Answers) -> tuple[Attention, ...]:
    """Each person's catch trials, judged."""
    people = []
    for person in np.unique(caught.participant):
        right = caught.correct[caught.participant == person]
        right = right[np.isfinite(right)]
        if not right.size:
            continue
        people.append(judged(caught.people[person], int(right.sum()), right.size))
    return tuple(people)


def judged(person: str, right: int, asked: int) -> Attention:
    """Verdict on whether somebody who attends would miss so many catch trials."""
    p = float(stats.binom.cdf(right, asked, ATTENDS))
    return Attention(person, right, asked, p, p >= _DOUBTFUL)
