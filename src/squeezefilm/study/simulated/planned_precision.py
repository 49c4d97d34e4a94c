"""Number of people who make a study's answer precise, or show that two displays differ.

For any task: simulated people do the whole design, each one's answers are fitted once, and studies
are put together of people drawn with replacement.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError
from squeezefilm.core.kept.store import Kept
from squeezefilm.physics.display import load_display
from squeezefilm.study.identification.power import PowerCurve, above_0, curve_of, sizes_of
from squeezefilm.study.psychometric.estimate import Estimate, t_interval
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.simulated.chain_tables import chain_tables
from squeezefilm.study.simulated.planned_power import (
    Planned,
    PlannedPower,
    PlannedStudies,
    on_one_display,
)
from squeezefilm.study.tasks.findings import PARTS, through
from squeezefilm.study.tasks.measures import measured
from squeezefilm.study.tasks.thresholds import on_grid

PEOPLE = 400
"""Simulated people that studies are drawn from; each one's fit takes some 20 ms."""

_TRUTHS: Kept[tuple[str, float]] = Kept("simulated-truths", tuple[str, float])
_SHARES: Kept[tuple[float, float]] = Kept("simulated-shares", tuple[float, float])

Interval = Callable[[si.IntArray], Estimate]


@dataclass(frozen=True, slots=True, eq=False)
class PlannedPrecision(Planned):
    """Precision against the number of people.

    Attributes:
        measure: "Weber fraction", "threshold", "exponent" or "proportion correct".
        precision: half the interval asked for: of one of `PARTS` in parts of it, else absolute.
        truth: the value of all simulated people.
        curve: share of the studies whose interval is that narrow, against the number of people.
        held: share whose interval holds `truth`, shape (numbers,).
    """

    measure: str
    precision: si.Dimensionless
    truth: float
    curve: PowerCurve
    held: si.DimensionlessArray


@dataclass(frozen=True, slots=True, eq=False)
class PrecisionAsked(PlannedStudies):
    """Studies whose 95 % interval is to have half of its length within `precision`, of people drawn
    from so many simulated `people`."""

    precision: si.Dimensionless
    _: KW_ONLY
    people: int = PEOPLE


@called_with(PrecisionAsked)
def planned_precision(asked: PrecisionAsked) -> PlannedPrecision:
    """Number of people who make the answer of a design as precise as asked, by simulation.

    Arguments are those of `PlannedStudies`, half of the interval that is wanted (of Weber fractions
    in parts of the value, of exponents and proportions correct absolute), and how many people are
    simulated, at least 20. What was found until it was stopped is kept on disk, and not computed
    again.

    Raises:
        InputError: a number out of range, or what the simulation refuses.
    """
    precision, studies, people = asked.precision, asked.studies, asked.people
    si.require("precision", precision, above=0.0, at_most=2.0)
    si.require("target", asked.target, above=0.0, below=1.0)
    si.require("studies", studies, at_least=10, at_most=100_000)
    si.require("people", people, at_least=20, at_most=20_000)
    sizes = sizes_of(asked.participants, studies)
    alone = on_one_display(asked.design, asked.display)
    tables = chain_tables(alone, asked.observer, finger=asked.finger, progress=asked.tell)

    @functools.cache
    def fitted() -> tuple[str, Interval]:
        return interval_of(asked.answers(tables, people), asked.tell)

    def interval(who: si.IntArray) -> Estimate:
        return fitted()[1](who)

    of_people = f"{tables.asked} {people} {asked.seed}"
    measure, truth = _TRUTHS.found(
        of_people, lambda: (fitted()[0], interval(np.arange(people)).value)
    )

    def precise(found: Estimate) -> bool:
        if measure in PARTS:
            return found.low > 0 and math.sqrt(found.high / found.low) - 1.0 <= precision
        return 0.5 * (found.high - found.low) <= precision

    def shares(size: int) -> tuple[float, float]:
        random = np.random.default_rng([asked.seed, size])
        each = [interval(random.integers(0, people, size)) for _ in range(studies)]
        holds = [truth in found for found in each]
        return float(np.mean([precise(found) for found in each])), float(np.mean(holds))

    counts, held = [], []
    for size in sizes:
        asked.tell(f"studies of {size} people")
        reached, holds = _SHARES.found(
            f"{of_people} {precision} {studies} {size}", functools.partial(shares, size)
        )
        counts.append(round(reached * studies))
        held.append(holds)
    return PlannedPrecision(
        **asked.named(tables, alone.displays[0]),
        measure=measure,
        precision=precision,
        truth=truth,
        curve=curve_of(sizes, counts, studies, 0.05, asked.target),
        held=np.array(held),
    )


def interval_of(answers: Answers, tell: Callable[[str], None]) -> tuple[str, Interval]:
    """Name of what a study of these people measures, and its value with the 95 % interval of any
    group of them, whose people are fitted once."""
    main = answers.main(0)
    design, in_runs = main.design, any(series.in_runs for series in main.design.adaptive)
    tell("each person's fit")
    if design.described.model and design.on_a_scale and not in_runs:
        population = on_grid(main).population
        return design.measure, lambda who: through(population.estimate(0.95, who)[0], math.exp)
    measure, values = person_values(main)
    return measure, lambda who: t_interval(values[who], 0.95)


def person_values(main: Answers) -> tuple[str, si.FloatArray]:
    """Name of what the answers to one display measure of a person, and each one's value, as the
    analysis fits it; shape (people,)."""
    if main.design.task == "match-to-sample":
        right = np.bincount(main.participant, main.correct)
        return "proportion correct", right / np.bincount(main.participant)
    found = measured(main, 0.95, 0, lambda _: None)
    lacking = len(main.people) - len(found.persons)
    if lacking:
        why = "end fewer than two runs; give the series more trials, or larger steps"
        if not any(series.in_runs for series in main.design.adaptive):
            why = f"have no {found.measure} of their own: {'; '.join(found.notes)}"
        raise InputError(
            f"{lacking} of {len(main.people)} simulated people {why}", quantity="count"
        )
    return found.measure, np.array([person.estimate.value for person in found.persons])


# Two displays: the test is of the differences of values within people, so that people may differ as
# they like: that of a mixed model with a slope of each person's own, where all have done as many
# trials.
_DIFFERENCES: Kept[tuple[str, si.FloatArray]] = Kept(
    "simulated-differences", tuple[str, si.FloatArray]
)


@dataclass(frozen=True, slots=True, eq=False)
class ContrastAsked(PlannedStudies):
    """Studies on `here` and on `there`, two displays by name or file; a test at `alpha` (1) over
    people drawn from so many simulated `people`."""

    here: str
    there: str
    _: KW_ONLY
    alpha: si.Dimensionless = 0.05
    people: int = PEOPLE


@called_with(ContrastAsked)
def planned_contrast(asked: ContrastAsked) -> PlannedPower:
    """The power of a design to show that people do otherwise on one display than on another.

    Arguments are those of `PlannedStudies` (a `display` is not asked for), two displays, the test's
    `alpha`, and how many people are simulated, at least 20. The test is Student's over people,
    two-sided. `difference` is the mean over all people of the value on `here` less that on `there`.

    Raises:
        InputError: a display against itself, a number out of range, or what the simulation refuses.
    """
    design, here, there = asked.design, asked.here, asked.there
    si.require("people", asked.people, at_least=20, at_most=20_000)
    if here == there:
        raise InputError(f"'{here}' is asked to differ from itself; name two displays")
    for display in (here, there):
        if display not in design.displays:
            load_display(display)
    both = dataclasses.replace(design, displays=(here, there))
    tables = chain_tables(both, asked.observer, finger=asked.finger, progress=asked.tell)

    def simulated() -> tuple[str, si.FloatArray]:
        answers = asked.answers(tables, asked.people)
        asked.tell("each person's fits")
        return within_people(answers)

    measure, differences = _DIFFERENCES.found(
        f"{tables.asked} {asked.people} {asked.seed}", simulated
    )
    return PlannedPower(
        **asked.named(tables, ""),
        first=here,
        second=there,
        curve=asked.power(differences, otherwise_than_0, asked.alpha),
        difference=float(differences.mean()),
        measure=measure,
    )


def within_people(answers: Answers) -> tuple[str, si.FloatArray]:
    """Name of what is measured of a person, and each person's value on the first display less that
    on the second, shape (people,); of a Weber fraction the logarithm."""
    (measure, here), (_, there) = (person_values(answers.main(number)) for number in (0, 1))
    if measure in PARTS:
        return f"ln {measure}", np.log(here) - np.log(there)
    return measure, here - there


def otherwise_than_0(scores: NDArray[Any]) -> float:
    """p of Student's two-sided test of people's mean; 1 where all are 0, 0 where all have the same
    other value."""
    return min(2.0 * above_0(scores if scores.mean() >= 0.0 else -scores), 1.0)
