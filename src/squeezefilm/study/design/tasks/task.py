"""The record of a task: what it presents, asks, takes for right, and makes of percepts.

A study plans, runs, simulates, plans its size, analyses, shows and exports by this record alone; a
new task is a module beside this one, and its name here and in `every_task`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.stimuli import Stimulus

Task = Literal[
    "match-to-sample", "same-different", "two-interval", "odd-one-out", "magnitude-estimation"
]
Condition = tuple[str, ...]
"""The names of what one trial presents, in their order."""
Judged = Callable[[Stimulus], float]
"""Amount of what is judged that a surface has (SI)."""


@dataclass(frozen=True, slots=True, eq=False)
class Percepts:
    """Percepts of people on one trial, of each surface in its order.

    Attributes:
        level: of what is judged, on its scale, shape (surfaces, people).
        felt: whether anything was, likewise; true where what is hardly felt can be judged too.
        deviation: standard deviation of one percept's level, shape (people,).
        criterion: from which a difference counts, in standard deviations of that difference.
    """

    level: si.FloatArray
    felt: NDArray[np.bool_]
    deviation: si.FloatArray
    criterion: si.Dimensionless


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """Answers of people to one trial, each of shape (people,): the number of the answer, how much
    it is doubted (1, from 0 to 1), and whether there was anything to decide by."""

    choice: si.IntArray
    doubt: si.DimensionlessArray
    decided: NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class DifferenceModel:
    """Chance that a difference of d′ is told, by a person who attends.

    Attributes:
        rate: of d′ and a person's criterion, which broadcast.
        criteria: that are held possible, alike; a single 0 where answers have no criterion.
        lapses: share of such answers among lapses (1).
        d_prime: of the share of such answers; None where it takes false alarms as well
            (`psychometric.discrimination`).
        counts: number of the answer that is counted; −1 counts whatever is right.
    """

    rate: Callable[[si.FloatArray, si.FloatArray], si.DimensionlessArray]
    criteria: si.FloatArray
    lapses: si.Dimensionless
    d_prime: Callable[[si.Dimensionless], float] | None
    counts: int


@dataclass(frozen=True, slots=True, eq=False)
class StudyTask:
    """A task.

    Attributes:
        name: as designs write it.
        surfaces: presented in a trial, one after the other; from two on, one is the reference.
        answers: that may be given; empty for numbers, and for names of a design's own.
        question: of what is judged, as people are asked.
        conditions: of a repetition, from the reference and the other stimuli.
        most_per_stimulus: as many conditions as a stimulus has at most.
        right: the right answer to surfaces, given how much one has of what is judged; empty where
            nothing is right.
        presents, analysed: sentences of a methods section.
        counted: head of what is counted of the answers.
        assumed: what simulated answers assume beyond the observer, in sentences.
        in_plane: what they assume besides where surfaces are explored freely.
        adaptive: methods that may choose comparisons.
        decides: how simulated people answer; None where that takes more than the percepts.
        model: of the answers to a difference; None where the task has an analysis of its own.
    """

    name: Task
    surfaces: int
    answers: tuple[str, ...]
    question: Callable[[str], str]
    conditions: Callable[[str, Sequence[str]], tuple[Condition, ...]]
    most_per_stimulus: int
    right: Callable[[Sequence[Stimulus], Judged], str]
    presents: str
    analysed: str
    counted: str
    assumed: tuple[str, ...] = ()
    in_plane: tuple[str, ...] = ()
    adaptive: tuple[str, ...] = ()
    decides: Callable[[Percepts], Decision] | None = None
    model: DifferenceModel | None = None


def one_each(reference: str, others: Sequence[str]) -> tuple[Condition, ...]:
    """Conditions that present each stimulus by itself; the reference, if any, is among `others`."""
    del reference
    return tuple((name,) for name in others)


def nothing_is_right(surfaces: Sequence[Stimulus], judged: Judged) -> str:
    """Empty answer, whatever was presented."""
    del surfaces, judged
    return ""


def kinds_of(surfaces: Sequence[Stimulus]) -> list[int]:
    """A number for each surface, the same for those that feel the same by all that is known.

    Raises `ConfigError` for a surface whose file cannot be read.
    """
    known: dict[object, int] = {}
    return [
        known.setdefault((surface.texture, surface.surface()), len(known)) for surface in surfaces
    ]


CLEARER = "Of the two directions the one in which a rhythm is clearer decides."
"""Assumption of tasks on a scale about free exploration."""
