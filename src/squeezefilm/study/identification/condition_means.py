"""Quantities of trials by condition, response times too: means over participants, who are the
random unit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from squeezefilm.core import quantities as si
from squeezefilm.study.identification.confusion import one_per_trial
from squeezefilm.study.psychometric.estimate import t_interval


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
    """Summaries by condition; times of a participant count as log-normal.

    Args:
        participant: numbers from 0 up, shape (trials,).
        condition: number of the condition, shape (trials,), 0 to len(names) − 1.
        response_time: in s, shape (trials,), above 0; NaN for a time not taken.
        names: of the conditions; those without a time are left out.
        level: of the intervals.

    Raises:
        InputError: times not above 0, arrays of unequal length, or a level not between 0 and 1.
    """
    person, kind = (np.asarray(numbers, dtype=np.int64) for numbers in (participant, condition))
    given = np.asarray(response_time, dtype=float)
    one_per_trial(participant=person, condition=kind, response_time=given)
    taken = ~np.isnan(given)
    si.require("response_time", given[taken], si.Unit("s"), above=0.0)
    si.require("level", level, above=0.0, below=1.0)
    summaries = []
    for column in np.unique(kind[taken]).tolist():
        here = taken & (kind == column)
        who, logs = person[here], np.log(given[here])
        (one,) = condition_means(who, np.zeros_like(who), logs, (names[column],), level)
        summaries.append(
            ResponseTimeSummary(
                one.name,
                one.trials,
                one.participants,
                float(np.exp(one.mean)),
                float(np.exp(one.low)),
                float(np.exp(one.high)),
                level,
            )
        )
    return tuple(summaries)
