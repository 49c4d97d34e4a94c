"""A quantity of trials by condition: means over participants, who are the random unit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from squeezefilm.core import quantities as si
from squeezefilm.study.identification.confusion import one_per_trial


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
        half = float("nan")
        if means.size > 1:
            t = float(stats.t.isf((1 - level) / 2, means.size - 1))
            half = t * float(means.std(ddof=1)) / np.sqrt(means.size)
        centre = float(means.mean())
        trials = int(count[:, column].sum())
        low, high = centre - half, centre + half
        found.append(ConditionMean(name, trials, means.size, centre, low, high, level))
    return tuple(found)
