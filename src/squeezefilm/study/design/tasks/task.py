"""The record of a task: what it presents, asks, takes for right, and makes of percepts.

A study plans, runs, simulates, plans its size, analyses, shows and exports by this record alone; a
new task is a module beside this one, and its name here and in `every_task`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.senses import D_PRIME_OF_75
from squeezefilm.physics.perception.stimuli import Stimulus, Varied

Task = Literal[
    "match-to-sample",
    "same-different",
    "two-interval",
    "odd-one-out",
    "odd-one-out-of-four",
    "odd-one-out-of-five",
    "magnitude-estimation",
    "yes-no",
    "direction",
    "detection",
    "paired-comparison",
    "ranking",
    "adjustment",
]
Surface = TypeVar("Surface")
Condition = tuple[str, ...]
"""The names of what one trial presents, in their order."""
Judged = Callable[[Stimulus], float]
"""Amount of what is judged that a surface has (SI)."""


@dataclass(frozen=True, slots=True)
class Amount:
    """Amount that may be judged: in words, its unit, and the unit and factor it is shown by."""

    words: str
    si_unit: str
    factor: float
    unit: str


JUDGED: dict[Varied, Amount] = {
    "spatial_period": Amount("spatial period", "m", 1e3, " mm"),
    "friction_depth": Amount("friction change", "1", 1e2, " %"),
    "ridge_share": Amount("ridge share", "1", 1e2, " %"),
    "orientation": Amount("orientation", "rad", 180 / math.pi, " deg"),
}
"""Amounts that may be judged."""


@dataclass(frozen=True, slots=True, eq=False)
class Percepts:
    """Percepts of people on one trial, of each surface in its order.

    Attributes:
        level: of what is judged, on its scale, shape (surfaces, people).
        felt: whether anything was, likewise; true where what is hardly felt can be judged too.
        deviation: standard deviation of one percept's level, shape (people,).
        criterion: from which a difference counts, in standard deviations of that difference.
        reference: level of the reference as it is remembered, shape (people,); NaN where it is
            presented.
    """

    level: si.FloatArray
    felt: NDArray[np.bool_]
    deviation: si.FloatArray
    criterion: si.Dimensionless
    reference: si.FloatArray | float = math.nan


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """Answers of people to one trial, each of shape (people,): the number of the answer, how much
    it is doubted (1, from 0 to 1), and whether there was anything to decide by."""

    choice: si.IntArray
    doubt: si.DimensionlessArray
    decided: NDArray[np.bool_]

    @classmethod
    def by_sign(cls, apart: si.FloatArray, decided: NDArray[np.bool_] | bool = True) -> Decision:
        """The first answer where a difference (in deviations) is above 0, in less doubt the larger
        it is; everybody decides, unless it is said who."""
        who = np.broadcast_to(decided, apart.shape)
        return cls(np.where(apart > 0, 0, 1), np.exp(-np.abs(apart)), who)


@dataclass(frozen=True, slots=True, eq=False)
class DifferenceModel:
    """Chance of an answer to a difference, by a person who attends.

    Attributes:
        difference: of the levels of a trial's surfaces, shape (surfaces, trials), and of the
            reference's; shape (trials,).
        criteria: that are held possible, alike; a single 0 where answers have none. Without a
            `rate` they are in parts of the greatest difference.
        rate: of the difference in deviations of one percept, and a person's criterion, which
            broadcast; None for the cumulative normal of the difference less the criterion.
        threshold: difference told in 75 % of two intervals, in the deviations of the model (1).
        lapses: share of such answers among lapses (1).
        d_prime: of the share of such answers; None where it takes false alarms as well
            (`psychometric.discrimination`).
        counts: number of the answer that is counted; −1 counts whatever is right.
        sensitivity: model of `psychometric.discrimination`.
        criterion: what results call a person's mean criterion; "" where they do not tell it.
    """

    difference: Callable[[si.FloatArray, float], si.FloatArray]
    criteria: si.FloatArray
    rate: Callable[[si.FloatArray, si.FloatArray], si.DimensionlessArray] | None = None
    threshold: si.Dimensionless = D_PRIME_OF_75
    lapses: si.Dimensionless = 0.5
    d_prime: Callable[[si.Dimensionless], float] | None = None
    counts: int = 0
    sensitivity: Literal["yes-no", "two-interval", "differencing"] = "yes-no"
    criterion: str = ""


def widest(levels: si.FloatArray, reference: float) -> si.FloatArray:
    """Difference between the greatest and the least level of each trial."""
    del reference
    return np.asarray(levels.max(axis=0) - levels.min(axis=0))


def from_reference(levels: si.FloatArray, reference: float) -> si.FloatArray:
    """Signed difference of the only level of each trial from the reference."""
    return np.asarray(levels[0] - reference)


def in_pairs(
    reference: Surface, comparison: Surface, reference_first: bool, answer: str
) -> tuple[Surface, ...]:
    """The reference and a comparison, in one order or the other; the reference twice where that is
    right."""
    if answer == "same":
        return reference, reference
    return (reference, comparison) if reference_first else (comparison, reference)


def alone(
    reference: Surface, comparison: Surface, reference_first: bool, answer: str
) -> tuple[Surface, ...]:
    """The comparison by itself; the reference where there is nothing to feel."""
    del reference_first
    return (reference,) if answer == "no" else (comparison,)


@dataclass(frozen=True, slots=True, eq=False)
class StudyTask:
    """A task.

    Attributes:
        name: as designs write it.
        surfaces: presented in a trial, one after the other.
        reference: whether one stimulus is what the others are compared with: "presented" in each
            trial, "remembered", or "flat"; "" where they are not.
        answers: that may be given; empty for numbers, and for names of a design's own.
        question: of what is judged, as people are asked.
        conditions: of a repetition, from the reference and the other stimuli.
        right: the right answer to surfaces, given how much one has of what is judged; empty where
            nothing is right.
        presents, analysed: sentences of a methods section.
        counted: head of what is counted of the answers.
        assumed: what simulated answers assume beyond the observer, in sentences.
        in_plane: what they assume besides where surfaces are explored freely.
        adaptive: methods that may choose comparisons.
        series: of the trial k of such a series, by a method: whether the reference comes first
            (or more than once), and what is right.
        arranges: what such a trial presents, from the reference, the comparison, whether the
            reference comes first, and what is right.
        in_amounts: whether differences are of amounts, and not of their logarithms.
        decides: how simulated people answer; None where that takes more than the percepts.
        model: of the answers to a difference; None where the task has an analysis of its own.
        ranks: the places of a trial's surfaces that each answer puts from most to least; empty
            where answers order nothing.
    """

    name: Task
    surfaces: int
    reference: Literal["", "presented", "remembered", "flat"]
    answers: tuple[str, ...]
    question: Callable[[str], str]
    conditions: Callable[[str, Sequence[str]], Iterable[Condition]]
    right: Callable[[Sequence[Stimulus], Judged], str]
    presents: str
    analysed: str
    counted: str
    assumed: tuple[str, ...] = ()
    in_plane: tuple[str, ...] = ()
    adaptive: tuple[str, ...] = ()
    series: Callable[[int, str], tuple[bool, str]] = lambda k, _: (
        k % 2 == 0,
        ("second", "first")[k % 2],
    )
    arranges: Callable[[Any, Any, bool, str], tuple[Any, ...]] = in_pairs
    in_amounts: bool = False
    decides: Callable[[Percepts], Decision] | None = None
    model: DifferenceModel | None = None
    ranks: tuple[tuple[int, ...], ...] = ()

    def compares_amounts(self, judged: Varied) -> bool:
        """True where differences are of amounts: of an orientation, or from a flat surface."""
        return self.in_amounts or judged == "orientation"

    def presents_comparison(self, reference_first: bool, answer: str) -> bool:
        """True where a trial of a series presents more than the reference."""
        return any(self.arranges(False, True, reference_first, answer))

    @property
    def right_is_enough(self) -> bool:
        """True where a series goes by right and wrong alone: which of two has more?"""
        return self.surfaces == 2 and self.ordered

    @property
    def ordered(self) -> bool:
        """True where answers are a cumulative normal of the difference."""
        return self.model is not None and self.model.rate is None


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


FELT = "On a flat surface there is the noise of a percept alone."
"""Assumption of tasks that detect a surface."""
UNFELT = "A person who feels no rhythm guesses."
"""Assumption of tasks on a scale."""
POPULATION = (
    "The population is a mixed model: logarithms of thresholds are normal over participants, lapse "
    "rates have a mean over participants of their own, and all likelihoods were integrated on a "
    "grid, so that intervals do not ask how differences were chosen (compare Moscatelli et al. "
    "2012, 10.1167/12.11.26; Kuss et al. 2005, 10.1167/5.5.8)."
)
"""Sentence of a methods section about people together; a Weber fraction is a threshold."""
STRENGTHS = (
    "Each surface has a strength, of which the share among those that are left is the probability "
    "that it is named next (Bradley and Terry 1952, 10.1093/biomet/39.3-4.324; Plackett 1975, "
    "10.2307/2346567), by maximum likelihood, with robust intervals over participants (Liang and "
    "Zeger 1986, 10.1093/biomet/73.1.13)."
)
"""Sentence of a methods section about tasks that order surfaces."""
SETTINGS = (
    "Each participant's mean of the runs from above and from below has Student's interval over "
    "runs, and the mean over participants (of thresholds, of their logarithms) that over them."
)
"""Sentence of a methods section about runs of adjustments and limits."""
CLEARER = "Of the two directions the one in which a rhythm is clearer decides."
"""Assumption of tasks on a scale about free exploration."""
