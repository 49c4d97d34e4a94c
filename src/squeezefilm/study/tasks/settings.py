"""Settings and turning points: what adjustments and limits say of each person, and of all."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy import stats

from squeezefilm.core import quantities as si
from squeezefilm.study.adaptive.series import adaptive_method
from squeezefilm.study.adaptive.staircase import Ending, Runs
from squeezefilm.study.design.tasks.two_surfaces import QUARTILE
from squeezefilm.study.psychometric.estimate import Estimate, t_interval
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import (
    EQUALITY,
    ConditionFinding,
    PersonEstimate,
    through,
)


def endings(main: Answers, person: int) -> list[Ending]:
    """Where the runs of a person ended, of all series, in their order."""
    found: list[Ending] = []
    names = main.design.answers
    for number, series in enumerate(main.design.adaptive):
        mine = (main.participant == person) & (main.series == number)
        said = [names[k] for k in main.choice[mine]]
        given = zip(main.intensity[mine].tolist(), said, strict=True)
        method = adaptive_method(series, given, main.design.task)
        assert isinstance(method, Runs)
        found += method.endings
    return found


def settings_of(
    main: Answers, level: si.Dimensionless
) -> tuple[str, list[PersonEstimate], tuple[ConditionFinding, ...], dict[str, Estimate], list[str]]:
    """Name of what is measured; each person's mean with Student's interval over their runs; the
    mean over people of runs from above and from below; the difference that is just told, by the
    scatter of runs; and what needs care.

    Against a flat surface it is the threshold, an amount; else the point of equality, a difference
    from the reference in its parts. Means are of what the design takes differences of: amounts, or
    their logarithms. Nobody with fewer than two runs has a value.
    """
    in_amounts = main.design.in_amounts
    measure = "threshold" if main.design.described.reference == "flat" else EQUALITY
    # Of logarithms half and twice the reference are as far from it.
    back: Callable[[float], float] = float if in_amounts else math.expm1
    persons, spreads = [], []
    halves: dict[bool, list[si.FloatArray]] = {True: [], False: []}
    people = np.unique(main.participant)
    for person in people:
        runs = endings(main, person)
        if len(runs) < 2:
            continue
        levels = np.array([run.level for run in runs])
        levels, is_down = levels if in_amounts else np.log1p(levels), [run.is_down for run in runs]
        sides = [levels[np.equal(is_down, begins_above)] for begins_above in halves]
        for each, some in zip(halves.values(), sides, strict=True):
            each += [some] if some.size else []
        own, deviation = _own([some for some in sides if some.size], level)
        persons.append(PersonEstimate(main.people[person], through(own, back), len(runs), False))
        spreads.append(QUARTILE * deviation)
    conditions = tuple(
        ConditionFinding(
            "from above" if is_down else "from below",
            math.nan,
            sum(ends.size for ends in each),
            len(each),
            magnitude=through(t_interval(np.array([ends.mean() for ends in each]), level), back),
        )
        for is_down, each in halves.items()
        if each
    )
    more = {}
    if spreads:
        just_told = through(t_interval(np.array(spreads), level), back)
        more["difference just told, by the scatter"] = just_told
    lacking = people.size - len(persons)
    notes = [f"{lacking} of {people.size} people ended fewer than two runs"] if lacking else []
    return measure, persons, conditions, more, notes


def _own(sides: list[si.FloatArray], level: float) -> tuple[Estimate, float]:
    """The mean of the means from above and from below, so that neither weighs more by ending more
    runs, and the deviation of runs within a side; with one run from each the deviation of both."""
    free = sum(some.size - 1 for some in sides)
    if free < 1:
        ends = np.concatenate(sides)
        own = t_interval(ends, level)
        return Estimate(own.value, own.low, own.high, level, "t, over runs"), float(
            ends.std(ddof=1)
        )
    value = float(np.mean([some.mean() for some in sides]))
    variance = sum(float(((some - some.mean()) ** 2).sum()) for some in sides) / free
    error = math.sqrt(variance * sum(1 / some.size for some in sides)) / len(sides)
    reach = float(stats.t.isf((1 - level) / 2, free)) * error
    own = Estimate(value, value - reach, value + reach, level, "t, over runs")
    return own, math.sqrt(variance)


def of_settings(
    measure: str, in_amounts: bool, persons: list[PersonEstimate], level: si.Dimensionless
) -> Estimate | None:
    """The mean over people with Student's interval: of logarithms, but for a point of equality
    where differences are of amounts; of one person their own."""
    if len(persons) < 2:
        return persons[0].estimate if persons else None
    values = np.array([person.estimate.value for person in persons])
    if measure == EQUALITY and in_amounts:
        return t_interval(values, level)
    if measure == EQUALITY:
        return through(t_interval(np.log1p(values), level), math.expm1)
    return through(t_interval(np.log(values), level), math.exp)
