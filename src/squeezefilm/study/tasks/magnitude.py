"""Magnitude estimation: Stevens' exponents of people and population, and the scale itself.

Every person has a scale of numbers of their own: an intercept of their own takes it out of the
regression of ln number on ln stimulus, and modulus equalisation (Lane, Catania & Stevens 1961,
10.1121/1.1908600) out of geometric means.
"""

from __future__ import annotations

import math

import numpy as np
from scipy import stats

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.psychometric.estimate import Estimate, t_interval
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import ConditionFinding, PersonEstimate, through
from squeezefilm.study.tasks.population import scatter_interval


def exponents(
    main: Answers, level: si.Dimensionless
) -> tuple[list[PersonEstimate], Estimate | None, Estimate | None]:
    """Each person's exponent with the t interval of their own line; the population's mean with
    that over people; and the spread over people."""
    people = np.unique(main.participant)
    persons = []
    for person in people:
        mine = main.participant == person
        x, y = np.log(main.values[main.presented[0][mine]]), np.log(main.estimate[mine])
        dx = x - x.mean()
        if not np.any(dx) or x.size < 3:
            continue
        slope = float(dx @ y / (dx @ dx))
        residual = float(np.sum((y - y.mean() - slope * dx) ** 2)) / (x.size - 2)
        reach = float(stats.t.isf((1 - level) / 2, x.size - 2)) * math.sqrt(residual / (dx @ dx))
        estimate = Estimate(slope, slope - reach, slope + reach, level, "t, own line")
        persons.append(PersonEstimate(main.people[person], estimate, x.size, False))
    return persons, *of_exponents(persons, level)


def of_exponents(
    persons: list[PersonEstimate], level: si.Dimensionless
) -> tuple[Estimate | None, Estimate | None]:
    """The population's mean exponent and its spread over people, without what each one's own error
    adds; of one person their own."""
    if len(persons) < 2:
        return persons[0].estimate if persons else None, None
    own = [person.estimate for person in persons]
    slopes = np.array([estimate.value for estimate in own])
    sure = float(stats.norm.isf((1 - level) / 2))
    errors = np.array([(estimate.high - estimate.low) / (2 * sure) for estimate in own])
    spread = Estimate(*scatter_interval(slopes, errors**2, level), level, "Q profile, over people")
    return t_interval(slopes, level), spread


def magnitude_conditions(
    main: Answers, level: si.Dimensionless
) -> tuple[tuple[ConditionFinding, ...], list[str]]:
    """Geometric mean of the numbers given to each stimulus, people's own scales taken out; and what
    needs care."""
    logs, people = np.log(main.estimate), np.unique(main.participant)
    own = np.full(main.trials, math.nan)
    counts = []
    for person in people:
        mine = main.participant == person
        own[mine] = logs[mine].mean()
        counts.append(np.bincount(main.presented[0][mine], minlength=len(main.surfaces)).tolist())
    notes = []
    if any(count != counts[0] for count in counts):
        notes.append(
            "people have not judged the stimuli equally often, so that their scales cannot be "
            "taken out exactly; the exponents do not suffer from it"
        )
    logs = logs - own + float(np.mean([own[main.participant == one][0] for one in people]))
    findings = []
    for stimulus in sorted(np.unique(main.presented[0]), key=lambda s: main.values[s]):
        here = main.presented[0] == stimulus
        means = np.array(
            [
                logs[here & (main.participant == person)].mean()
                for person in np.unique(main.participant[here])
            ]
        )
        findings.append(
            ConditionFinding(
                main.surfaces[stimulus].name,
                float(main.values[stimulus]),
                int(here.sum()),
                means.size,
                magnitude=through(t_interval(means, level), math.exp),
            )
        )
    return tuple(findings), notes


def require_magnitudes(main: Answers) -> None:
    """Refuse stimuli without an amount, which have no logarithm. Raises `InputError`."""
    for one in np.unique(main.presented[0]):
        if not main.values[one] > 0.0:
            raise InputError(
                f"stimulus '{main.surfaces[one].name}' has {main.design.judged} 0; a power law "
                "needs amounts above 0. Leave it out of the design, or judge something else"
            )
