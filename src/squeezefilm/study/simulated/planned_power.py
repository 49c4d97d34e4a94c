"""Number of people that a planned study needs to tell two stimuli apart, by simulation."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.results import stamp, to_json
from squeezefilm.physics.display import load_display
from squeezefilm.physics.perception.observer import Observer
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.identification.power import (
    PowerCurve,
    above_0,
    distinction_scores,
    power_curve,
)
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.simulated.answers import simulated_answers
from squeezefilm.study.simulated.chain_tables import ChainTables, chain_tables
from squeezefilm.study.simulated.participants import match_counts, right_answers

SIZES = (2, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32, 48)
POOL = 4000
"""Simulated people that studies are drawn from: two of one study are hardly ever the same."""

_SCORES: Kept[si.FloatArray] = Kept("simulated-scores", si.FloatArray)


@dataclass(frozen=True, slots=True, eq=False)
class PlannedStudies:
    """Request for studies that are simulated to plan one.

    Args:
        design: of any task.
        observer: whose people they are.
        display: one of the design's (the first without it), or another's name or file.
        participants: numbers of people, each at least 2.
        studies: simulated per number, at least 10.
        target: share of studies that are to find what is asked.
        seed: of people, their answers and the studies.
        finger: whose finger a display is under, see `with_finger`.
        progress: is told each step.
    """

    design: StudyDesign
    observer: Observer
    _: KW_ONLY
    display: str | None = None
    participants: tuple[int, ...] = SIZES
    studies: int = 400
    target: si.Dimensionless = 0.8
    seed: int = 0
    finger: str | Path = "new"
    progress: Callable[[str], None] | None = None

    def tell(self, step: str) -> None:
        """Tell a step to whoever listens."""
        if self.progress is not None:
            self.progress(step)

    def answers(self, tables: ChainTables, people: int) -> Answers:
        """Answers of so many simulated people to the design of tables."""
        self.tell(f"{people} simulated participants")
        return simulated_answers(tables, people, self.seed, self.tell)

    def named(self, tables: ChainTables, display: str) -> dict[str, Any]:
        """Fields of `Planned` of the studies that were asked for, as computed with tables."""
        return {
            "design": self.design.name,
            "display": display,
            "observer": self.observer.name,
            "seed": self.seed,
            "finger": tables.whose_finger,
            "origin": "simulated",
        }

    def power(
        self,
        scores: si.FloatArray,
        test: Callable[[NDArray[Any]], float],
        alpha: si.Dimensionless,
    ) -> PowerCurve:
        """The power of a test at `alpha` in studies of people drawn with replacement, whose
        `scores` (people,) are known."""

        def drawn(participants: int, random: np.random.Generator) -> si.FloatArray:
            return np.asarray(scores[random.integers(0, scores.size, participants)])

        return power_curve(
            drawn,
            test,
            self.participants,
            studies=self.studies,
            alpha=alpha,
            target=self.target,
            seed=self.seed,
            progress=lambda done, all_: self.tell(f"studies of size {done} of {all_}"),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """Result of simulated studies of a design, with the names of design, display and observer."""

    design: str
    display: str
    observer: str
    seed: int
    finger: str
    origin: str

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values."""
        return {**to_json(self), "provenance": stamp((self.design, self.observer), self.seed)}


@dataclass(frozen=True, slots=True, eq=False)
class PlannedPower(Planned):
    """Power to tell two stimuli of a design apart on one display, or two displays by a design, by
    simulated participants.

    `curve` is over the number of people; `difference` the mean score of the whole pool (1).
    `measure` is what a person's value is where displays are compared (`display` is empty then).
    """

    first: str
    second: str
    curve: PowerCurve
    difference: si.Dimensionless
    measure: str


@dataclass(frozen=True, slots=True, eq=False)
class PairAsked(PlannedStudies):
    """Studies that are to tell `first` from `second`, by a test at `alpha` (1)."""

    first: str
    second: str
    _: KW_ONLY
    alpha: si.Dimensionless = 0.05


@called_with(PairAsked)
def planned_power(asked: PairAsked) -> PlannedPower:
    """The power of a design to tell two of its stimuli apart, against the number of people.

    Studies are drawn from `POOL` simulated participants who do the whole design, without adaptive
    series; the test is Student's over people, one-sided, of `distinction_scores` in
    match-to-sample, else of `pair_scores`. What the observer assumes, this assumes: see its file.
    What people felt and answered is kept on disk. Arguments are those of `PlannedStudies`, the
    names of two stimuli, and the test's `alpha`.

    Raises:
        InputError: names that are not in the design, or what the simulation refuses.
    """
    design, first, second = asked.design, asked.first, asked.second
    alone = on_one_display(design, asked.display)
    a, b = (design.stimuli.index(alone.stimulus(name)) for name in (first, second))
    if design.task == "match-to-sample":
        if right_answers(alone).tolist() != list(range(len(alone.stimuli))):
            raise InputError(
                f"power needs each stimulus of '{alone.name}' to have its own right answer, in the "
                "order of the stimuli"
            )
    else:
        require_pair(alone, first, second)
    tables = chain_tables(alone, asked.observer, finger=asked.finger, progress=asked.tell)

    def simulated() -> si.FloatArray:
        answers = asked.answers(tables, POOL)
        if design.task == "match-to-sample":
            return distinction_scores(match_counts(answers), a, b)
        return pair_scores(answers, first, second)

    scores = _SCORES.found(f"{tables.asked} {first!r} {second!r} {asked.seed}", simulated)
    return PlannedPower(
        **asked.named(tables, alone.displays[0]),
        first=first,
        second=second,
        curve=asked.power(scores, above_0, asked.alpha),
        difference=float(scores.mean()),
        measure="score",
    )


def require_pair(design: StudyDesign, first: str, second: str) -> None:
    """Refuse two stimuli of a design that no test tells apart. Raises `InputError`."""
    if design.adaptive:
        raise InputError(
            f"the series of '{design.name}' choose their comparisons, so that no pair is presented "
            "often; ask how many people make the threshold precise instead, with precision 20 %, "
            "or show that it is another one on another display, with against DISPLAY"
        )
    if first == second:
        raise InputError(f"'{first}' is asked to be told from itself; name two stimuli")
    if design.described.reference == "presented" and design.reference not in (first, second):
        raise InputError(
            f"'{design.name}' compares with its reference '{design.reference}'; name it as one of "
            "the two"
        )


def pair_scores(answers: Answers, first: str, second: str) -> si.FloatArray:
    """Success of each person at telling two stimuli apart, shape (people,); 0 in the mean of people
    who cannot: share of right answers less that of guesses; "different" to them less "different" to
    the same; or, of one surface, the difference of the shares that are counted, or of the mean
    logarithms of their numbers, more less less.

    Raises `InputError` for a pair that no test tells apart.
    """
    design, main = answers.design, answers.main(0)
    require_pair(design, first, second)
    names = np.array([surface.name for surface in main.surfaces])
    people, size = main.participant, len(main.people)

    def mean(values: si.FloatArray, rows: NDArray[np.bool_]) -> si.FloatArray:
        return np.asarray(
            np.bincount(people[rows], values[rows], size)
            / np.maximum(np.bincount(people[rows], minlength=size), 1)
        )

    shown = names[main.presented]
    if design.described.ranks:
        first_of = names[main.in_order]
        both = (first_of == first).any(axis=0) & (first_of == second).any(axis=0)
        ahead = (first_of == first).argmax(axis=0) < (first_of == second).argmax(axis=0)
        a, b = (design.judged_value(design.stimulus(name)) for name in (first, second))
        return mean((ahead == (a > b)).astype(float), both) - 0.5
    if not design.compares:
        less, more = sorted(
            (first, second), key=lambda name: design.judged_value(design.stimulus(name))
        )
        values = main.told.astype(float) if design.answers else np.log(main.estimate)
        return mean(values, shown[0] == more) - mean(values, shown[0] == less)
    alike = (shown == shown[0]).all(axis=0)
    here = np.isin(shown, [first, second]).all(axis=0) & ~alike
    if not alike.any():
        return mean(main.correct, here) - 1.0 / len(design.answers)
    different = main.told.astype(float)
    return mean(different, here) - mean(different, alike)


def on_one_display(design: StudyDesign, display: str | None) -> StudyDesign:
    """The design on one display: its first without a name, or any that can be loaded, one of the
    user's own too. Raises what `load_display` raises."""
    where = design.displays[0] if display is None else display
    if where not in design.displays:
        load_display(where)
    return dataclasses.replace(design, displays=(where,))
