"""Measures of people by task: of each, of the population, and by condition."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import mstats

from squeezefilm.study.psychometric.estimate import Estimate, student
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.by_condition import (
    MEASURE,
    condition_findings,
    more_numbers,
    unlike_persons,
)
from squeezefilm.study.tasks.findings import (
    Measured,
    PersonEstimate,
    through,
)
from squeezefilm.study.tasks.scales import (
    exponents,
    magnitude_conditions,
    of_exponents,
    rank_exponents,
    strengths,
)
from squeezefilm.study.tasks.thresholds import on_grid, settings_of

Tell = Callable[[str], None]


def measured(main: Answers, level: float, seed: int, tell: Tell) -> Measured:
    """Results of the analysis that the answers' task has, with a robust number where there is one.

    `level` is of the intervals (1), `seed` of resampling; `tell` hears each step.
    """
    task = main.design.described
    analysis = _magnitudes if task.model is None else _by_difference
    if task.ranks:
        analysis = _ranked
    elif any(series.in_runs for series in main.design.adaptive):
        analysis = settings_of
    found = analysis(main, level, seed, tell)
    return replace(found, robust=found.robust or _trimmed(found.persons, level))


def _trimmed(persons: Sequence[PersonEstimate], level: float) -> Estimate | None:
    """The mean of people's values without the fifth at either end, with Yuen's interval (1974,
    10.1093/biomet/61.1.165); None of fewer than five people."""
    values = np.sort([person.estimate.value for person in persons])
    cut = values.size // 5
    if not cut:
        return None
    kept = values.size - 2 * cut
    error = float(mstats.winsorize(values, (cut / values.size,) * 2).std(ddof=1))
    error *= math.sqrt((values.size - 1) / (kept * (kept - 1.0)))
    mean = float(values[cut : values.size - cut].mean())
    return student(mean, error, kept - 1, level, "trimmed by a fifth at either end")


def _by_difference(main: Answers, level: float, seed: int, tell: Tell) -> Measured:
    if not main.design.on_a_scale:
        return _unlike(main, level, seed, tell)
    people = on_grid(main, tell)
    tell("mixed model over people")
    notes: list[str] = []
    persons = people.estimates(level)
    pooled, spread, robust = persons[0].estimate, None, None
    if len(persons) > 1:
        population = people.population
        mean, spread = population.estimate(level)
        pooled, robust = through(mean, math.exp), through(population.robust(level), math.exp)
        # Answers at random go into a criterion where there is one.
        criterion = main.model.criterion
        notes += [note for note in [population.lapse_note] if note and not criterion]
    else:
        notes.append(
            "one participant: the population's interval is theirs, and says nothing of others"
        )
    return Measured(
        main.design.measure,
        tuple(persons),
        pooled,
        spread,
        () if main.design.described.ranks else condition_findings(main, level, seed),
        tuple(notes),
        more_numbers(main, people.bias, level),
        people.functions(level),
        robust,
    )


def _ranked(main: Answers, level: float, seed: int, tell: Tell) -> Measured:
    """Strengths, beside the threshold or the exponent where surfaces have amounts."""
    tell("strengths of the surfaces")
    conditions, notes = strengths(main, level)
    design = main.design
    if design.on_a_scale and design.described.model is not None:
        found = _by_difference(main, level, seed, tell)
        return replace(found, conditions=conditions, notes=(*found.notes, *notes))
    if design.on_a_scale and not design.in_amounts:
        persons = rank_exponents(main, level)
        pooled, spread = of_exponents(persons, level)
        return Measured("exponent", tuple(persons), pooled, spread, conditions, tuple(notes))
    notes.append(
        f"the surfaces have no amount of {design.judged} with which strengths grow by a power"
    )
    return Measured("strength", (), None, None, conditions, tuple(notes))


def _unlike(main: Answers, level: float, seed: int, tell: Tell) -> Measured:
    tell("sensitivity of each person")
    persons, pooled = unlike_persons(main, level, seed)
    conditions = condition_findings(main, level, seed)
    notes = [
        f"the surfaces have no {main.design.judged} to be told apart by, so that there is no Weber "
        "fraction: d′ is of whole surfaces"
    ]
    more = more_numbers(main, [], level)
    return Measured(MEASURE, tuple(persons), pooled, None, conditions, tuple(notes), more)


def _magnitudes(main: Answers, level: float, _seed: int, tell: Tell) -> Measured:
    tell("power law of each person")
    persons, pooled, spread = exponents(main, level)
    conditions, notes = magnitude_conditions(main, level)
    lacking = np.unique(main.participant).size - len(persons)
    if lacking:
        notes.append(
            f"{lacking} {'person has' if lacking == 1 else 'people have'} no line of their own "
            "(fewer than 3 answers, or to one stimulus only) and no share in the exponent"
        )
    if len(persons) == 1:
        notes.append("one line: the interval is of it, and not of a population")
    return Measured("exponent", tuple(persons), pooled, spread, conditions, tuple(notes))
