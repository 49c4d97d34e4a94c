"""Task "same or different": the differencing model of two surfaces.

The difference of two percepts decides: P("different" | d′) = Φ((d′ − k)/√2) + Φ((−d′ − k)/√2), with
the person's criterion k in standard deviations of one percept (Macmillan and Creelman 2005,
chapter 9).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import ndtr

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.tasks.task import (
    POPULATION,
    Condition,
    Decision,
    DifferenceModel,
    Judged,
    Percepts,
    StudyTask,
    kinds_of,
    widest,
)

_CRITERIA, _LARGEST_CRITERION = 81, 8.0


def _conditions(reference: str, others: Sequence[str]) -> tuple[Condition, ...]:
    """Each other stimulus with the reference in either order, and as often the same twice, half
    with each of the two."""
    pairs = [pair for other in others for pair in ((reference, other), (other, reference))]
    return (*pairs, *((one, one) for other in others for one in (reference, other)))


def _right(surfaces: Sequence[Stimulus], judged: Judged) -> str:
    del judged
    return "same" if len(set(kinds_of(surfaces))) == 1 else "different"


def _decides(given: Percepts) -> Decision:
    apart = np.abs(given.level[0] - given.level[1]) / (math.sqrt(2.0) * given.deviation)
    both, either = given.felt.all(axis=0), given.felt.any(axis=0)
    different = (either & ~both) | (both & (apart > given.criterion))
    doubt = np.where(both, np.exp(-np.abs(apart - given.criterion)), 1.0)
    return Decision(different.astype(np.int64), doubt, np.ones(both.shape, dtype=bool))


def _rate(d_prime: si.FloatArray, criteria: si.FloatArray) -> si.DimensionlessArray:
    root = math.sqrt(2.0)
    return np.asarray(ndtr((d_prime - criteria) / root) + ndtr((-d_prime - criteria) / root))


SAME_DIFFERENT = StudyTask(
    name="same-different",
    surfaces=2,
    reference="presented",
    answers=("same", "different"),
    question=lambda _: "Were the two surfaces the same or different?",
    conditions=_conditions,
    right=_right,
    presents=(
        "On each trial two surfaces were presented one after the other, and the participant said "
        "whether they were the same or different; the reference was {reference}"
    ),
    analysed=(
        "Each participant's answers were fitted by the differencing model of Macmillan and "
        "Creelman (2005), with a criterion and lapses; the Weber fraction is the difference with "
        "d′ = 0.954, which is told in 75 % of two intervals. "
        f"{POPULATION}"
    ),
    counted="Called different",
    assumed=(
        "Two surfaces are called different where their perceived periods (or strengths) differ by "
        "more than one standard deviation of that difference, the observer's criterion, or where "
        "only one of two rhythms is felt.",
    ),
    in_plane=(
        "Surfaces explored freely are called different where strengths in both directions, and "
        "periods where both are felt, differ by more than one standard deviation in the root of "
        "the mean square, whatever is judged.",
    ),
    adaptive=("bayesian",),
    series=lambda number, _: (number % 4 < 2, ("different", "same")[number % 2]),
    decides=_decides,
    model=DifferenceModel(
        difference=widest,
        criteria=_LARGEST_CRITERION * (np.arange(_CRITERIA) + 0.5) / _CRITERIA,
        rate=_rate,
        counts=1,
        sensitivity="differencing",
        criterion="criterion (standard deviations of a percept)",
    ),
)
"""Two surfaces, the same or different?"""
