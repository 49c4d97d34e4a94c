"""Response times: log-normal summaries over participants."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from squeezefilm.core import quantities as si
from squeezefilm.study.identification.condition_means import condition_means
from squeezefilm.study.identification.confusion import one_per_trial


@dataclass(frozen=True, slots=True)
class ResponseTimeSummary:
    """Response times of one condition.

    Attributes:
        name: of the condition.
        trials, participants: that have one.
        geometric_mean: of participants' geometric means (s).
        low, high: its t interval over participants (s), at `level`; NaN with one participant.
        level: of the interval.
        spread: standard deviation of ln(time) within participants (1).
        median: of all trials (s).
    """

    name: str
    trials: int
    participants: int
    geometric_mean: si.Second
    low: si.Second
    high: si.Second
    level: si.Dimensionless
    spread: si.Dimensionless
    median: si.Second


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
        own = np.bincount(who, logs) / np.maximum(np.bincount(who), 1)
        freedom = one.trials - one.participants
        summaries.append(
            ResponseTimeSummary(
                one.name,
                one.trials,
                one.participants,
                float(np.exp(one.mean)),
                float(np.exp(one.low)),
                float(np.exp(one.high)),
                level,
                math.sqrt(((logs - own[who]) ** 2).sum() / freedom) if freedom else math.nan,
                float(np.median(given[here])),
            )
        )
    return tuple(summaries)
