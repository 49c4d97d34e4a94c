"""Same or different between surfaces that have no amount to compare: shapes, maps, directions.

There is no difference on a scale and so no Weber fraction. Each pair of the reference and another
has its share of answers "different" and a d′ by the differencing model, and each person a d′ over
all pairs, from the same "same" trials (`psychometric.discrimination`).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.study.psychometric.discrimination import differencing_sensitivity, sensitivity
from squeezefilm.study.psychometric.estimate import Estimate
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import ConditionFinding, PersonEstimate
from squeezefilm.study.tasks.two_interval import (
    condition_finding,
    mean_sensitivity,
    t_interval,
)

MEASURE = "sensitivity d′"
_MODEL = "differencing"


def unlike_conditions(
    main: Answers, level: si.Dimensionless, seed: int
) -> tuple[ConditionFinding, ...]:
    """Each pair: how often it was called different, and its d′; the first is the same twice."""
    alike, other = _pairs(main)
    found = []
    for one in (-1, *np.unique(other[~alike]).tolist()):
        mine = alike if one < 0 else ~alike & (other == one)
        if not mine.any():
            continue
        name = "the same" if one < 0 else main.surfaces[one].name
        counts = [] if one < 0 else _counts(main, mine, alike)
        d = mean_sensitivity(counts, _MODEL, differencing_sensitivity, level, seed)
        found.append(condition_finding(main, name, math.nan, mine, main.choice == 1, level, d))
    return tuple(found)


def unlike_persons(
    main: Answers, level: si.Dimensionless, seed: int
) -> tuple[list[PersonEstimate], Estimate | None]:
    """Each person's d′ over all pairs with the interval of their own trials, and the mean over
    people with Student's."""
    alike, _ = _pairs(main)
    persons = []
    for person in np.unique(main.participant):
        mine = main.participant == person
        for counts in _counts(main, mine & ~alike, mine & alike):
            one = sensitivity(*counts, _MODEL, level=level, seed=seed)
            value = Estimate(one.sensitivity.d_prime, *one.interval, level, "Jeffreys, over trials")
            persons.append(PersonEstimate(main.people[person], value, int(mine.sum()), False))
    if len(persons) < 2:
        return persons, persons[0].estimate if persons else None
    means = np.array([one.estimate.value for one in persons])
    return persons, t_interval(means, level)


def _pairs(main: Answers) -> tuple[NDArray[np.bool_], si.IntArray]:
    """Whether both were the same surface, and the number of the one that is not the reference."""
    names = [one.name for one in main.surfaces]
    here = names.index(main.design.reference) if main.design.reference in names else -1
    return main.first == main.second, np.where(main.first != here, main.first, main.second)


def _counts(
    main: Answers, signal: NDArray[np.bool_], noise: NDArray[np.bool_]
) -> list[tuple[int, int, int, int]]:
    """Hits, signals, false alarms and noises of each person who had both kinds of trial."""
    found = []
    for person in np.unique(main.participant[signal]):
        mine = main.participant == person
        hits, alarms = main.choice[signal & mine] == 1, main.choice[noise & mine] == 1
        if hits.size and alarms.size:
            found.append((int(hits.sum()), hits.size, int(alarms.sum()), alarms.size))
    return found
