"""How many people show that two displays differ, for any task, adaptive series included.

Simulated people do the whole design on both displays. Each one's value on each display is fitted as
the analysis fits it: the logarithm of the Weber fraction, the exponent, or the share of right
answers. The test is of the differences within people, so that people may differ as they like: the
test of a mixed model with a slope of each person's own, where all have done as many trials.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.kept.store import Kept
from squeezefilm.physics.display import load_display
from squeezefilm.physics.perception.observer import Observer
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.identification.power import power_curve
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.simulated.chain_tables import chain_tables
from squeezefilm.study.simulated.planned_power import (
    SIZES,
    PlannedPower,
    drawn_with_replacement,
)
from squeezefilm.study.simulated.planned_precision import (
    PEOPLE,
    person_values,
    simulated_answers,
)

_DIFFERENCES: Kept[tuple[str, si.FloatArray]] = Kept(
    "simulated-differences", tuple[str, si.FloatArray]
)


def planned_contrast(
    design: StudyDesign,
    observer: Observer,
    display: str,
    other: str,
    *,
    participants: tuple[int, ...] = SIZES,
    studies: int = 400,
    alpha: si.Dimensionless = 0.05,
    target: si.Dimensionless = 0.8,
    people: int = PEOPLE,
    seed: int = 0,
    finger: str | Path = "new",
    progress: Callable[[str], None] | None = None,
) -> PlannedPower:
    """The power of a design to show that people do otherwise on one display than on another.

    Args:
        design: of any task; its own displays are not asked for.
        observer: whose people they are.
        display, other: two displays, by name or file.
        participants, studies, alpha, target: as in `power_curve`.
        people: simulated, that studies are drawn from, at least 20.
        seed: of people, answers and studies.
        finger: whose finger a display is under, see `with_finger`.
        progress: is told each step.

    The test is Student's over people, two-sided. `difference` is the mean over all people of the
    value on `display` less that on `other`.

    Raises:
        InputError: a display against itself, a number out of range, or what the simulation refuses.
    """
    si.require("people", people, at_least=20, at_most=20_000)
    if display == other:
        raise InputError(f"'{display}' is asked to differ from itself; name two displays")
    for one in (display, other):
        if one not in design.displays:
            load_display(one)
    tell = progress or (lambda _: None)
    both = dataclasses.replace(design, displays=(display, other))
    tables = chain_tables(both, observer, finger=finger, progress=tell)

    def simulated() -> tuple[str, si.FloatArray]:
        answers = simulated_answers(tables, people, seed, tell)
        tell("each person's fits")
        return within_people(answers)

    measure, differences = _DIFFERENCES.found(f"{tables.asked} {people} {seed}", simulated)
    curve = power_curve(
        drawn_with_replacement(differences),
        otherwise_than_0,
        participants,
        studies=studies,
        alpha=alpha,
        target=target,
        seed=seed,
        progress=lambda done, all_: tell(f"studies of size {done} of {all_}"),
    )
    mean = float(differences.mean())
    return PlannedPower(
        design.name,
        "",
        display,
        other,
        observer.name,
        curve,
        mean,
        seed,
        measure=measure,
        finger=tables.whose_finger,
    )


def within_people(answers: Answers) -> tuple[str, si.FloatArray]:
    """What is measured of a person, and each person's value on the first display less that on the
    second, shape (people,); of a Weber fraction the logarithm."""
    (measure, here), (_, there) = (person_values(answers.main(number)) for number in (0, 1))
    if measure == "Weber fraction":
        return "ln Weber fraction", np.log(here) - np.log(there)
    return measure, here - there


def otherwise_than_0(scores: NDArray[Any]) -> float:
    """p of Student's two-sided test of people's mean; 1 where all are 0, 0 where all have the same
    other value."""
    mean, spread = float(scores.mean()), float(scores.std(ddof=1))
    if spread == 0.0:
        return 1.0 if mean == 0.0 else 0.0
    t = abs(mean) / spread * math.sqrt(scores.size)
    return float(2.0 * stats.t.sf(t, scores.size - 1))
