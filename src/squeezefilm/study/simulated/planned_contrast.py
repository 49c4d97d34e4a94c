"""Number of people who show that two displays differ, for any task, adaptive series included.

Simulated people do the whole design on both displays. Each one's value on each display is fitted as
the analysis fits it: the logarithm of the Weber fraction, the exponent, or the share of right
answers. The test is of the differences within people, so that people may differ as they like: the
test of a mixed model with a slope of each person's own, where all have done as many trials.
"""

from __future__ import annotations

import dataclasses
from dataclasses import KW_ONLY, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError
from squeezefilm.core.kept.store import Kept
from squeezefilm.physics.display import load_display
from squeezefilm.study.identification.power import above_0
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.simulated.chain_tables import chain_tables
from squeezefilm.study.simulated.planned_power import PlannedPower, PlannedStudies
from squeezefilm.study.simulated.planned_precision import PEOPLE, person_values
from squeezefilm.study.tasks.findings import PARTS

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
