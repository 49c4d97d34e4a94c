"""How many people a planned match-to-sample study needs, by simulated participants."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.perception.observer import Observer
from squeezefilm.results import stamp, to_json
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.identification.power import PowerCurve, distinction, power_curve
from squeezefilm.study.simulated.chain_tables import chain_tables
from squeezefilm.study.simulated.participants import right_answers, simulate_matches

SIZES = (2, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32, 48)
POOL = 4000
"""Simulated people that studies are drawn from: two of one study are hardly ever the same."""


@dataclass(frozen=True, eq=False)
class PlannedPower:
    """Power to tell two stimuli of a design apart on one display, by simulated participants.

    `curve` is over the number of people; `difference` the mean score of the whole pool (1).
    """

    design: str
    display: str
    first: str
    second: str
    observer: str
    curve: PowerCurve
    difference: si.Dimensionless
    seed: int
    origin: str = "simulated"

    def summary(self) -> dict[str, Any]:
        """What ``--json`` prints."""
        return {**to_json(self), "provenance": stamp((self.design, self.observer), self.seed)}


def planned_power(
    design: StudyDesign,
    observer: Observer,
    first: str,
    second: str,
    *,
    display: str | None = None,
    participants: tuple[int, ...] = SIZES,
    studies: int = 400,
    alpha: si.Dimensionless = 0.05,
    target: si.Dimensionless = 0.8,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> PlannedPower:
    """The power of a design to tell two of its stimuli apart, against the number of people.

    Studies are drawn from `POOL` simulated participants who do the whole design; the test is
    `distinction`, one-sided over people. What the observer assumes, this assumes: see its file.

    Args:
        design: of match-to-sample.
        observer: whose people they are.
        first, second: names of the stimuli.
        display: one of the design's; the first without it.
        participants, studies, alpha, target: as in `power_curve`.
        seed: of people, their answers and the studies.
        progress: is told each step.

    Raises:
        InputError: names that are not in the design, or what the simulation refuses.
    """
    asked = dataclasses.replace(design, catch=())
    a, b = (design.stimuli.index(asked.stimulus(name)) for name in (first, second))
    alone = _on_one_display(design, display)
    tell = progress or (lambda _: None)
    tables = chain_tables(alone, observer, progress=tell)
    tell(f"{POOL} simulated participants")
    pool = simulate_matches(alone, observer, POOL, seed, tables)
    curve = power_curve(
        pool.people(),
        lambda counts: distinction(counts, a, b).p_value,
        participants,
        studies=studies,
        alpha=alpha,
        target=target,
        seed=seed,
        progress=lambda done, all_: tell(f"studies of size {done} of {all_}"),
    )
    whole = distinction(pool.participant_counts(), a, b).score
    where = alone.displays[0]
    return PlannedPower(design.name, where, first, second, observer.name, curve, whole, seed)


def _on_one_display(design: StudyDesign, display: str | None) -> StudyDesign:
    """The design on one of its displays, the first without one. Raises `InputError` for another
    display, and for a design whose stimuli have no right answers of their own."""
    where = design.displays[0] if display is None else display
    if where not in design.displays:
        raise InputError(
            f"design '{design.name}' is not on '{where}'; it is on {', '.join(design.displays)}"
        )
    alone = dataclasses.replace(design, displays=(where,))
    if right_answers(alone).tolist() != list(range(len(design.stimuli))):
        raise InputError(
            f"power needs each stimulus of '{design.name}' to have its own right answer, in the "
            "order of the stimuli"
        )
    return alone
