"""Tasks of same and other: same or different, and odd one out of several surfaces."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.tasks.task import (
    CLEARER,
    POPULATION,
    UNFELT,
    Condition,
    Decision,
    DifferenceModel,
    Judged,
    Percepts,
    StudyTask,
    Surface,
    Task,
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


def called_different(d_prime: si.FloatLike, criterion: si.FloatLike) -> si.DimensionlessArray:
    """Share of "different" (1) to two surfaces that differ by d′, by the differencing model of
    somebody who calls so what differs by more than a criterion (deviations of a percept)."""
    far, root = np.asarray(d_prime), math.sqrt(2.0)
    return np.asarray(ndtr((far - criterion) / root) + ndtr((-far - criterion) / root))


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
        rate=called_different,
        counts=1,
        sensitivity="differencing",
        criterion="criterion (standard deviations of a percept)",
    ),
)
"""Two surfaces, the same or different?"""


# All surfaces but one are the same; which is the other? Each place of the other one comes equally
# often, and each of the two surfaces is as often alone. Whoever compares percepts names the one
# that is furthest from the mean of the rest (of three the triangular task: Ura 1960; Frijters 1979,
# 10.1111/j.2044-8317.1979.tb00595.x; Ennis 1993, 10.1111/j.1745-459X.1993.tb00222.x; of more Craven
# 1992, Perception & Psychophysics 51, 379), with percepts of equal variance on one scale. With y
# the deviations of the n − 1 alike percepts from their mean, the odd one is named where it lies
# above that mean by more than u = max(max y, −min y n/(n − 2)), or below it by as much of −y, so
# that
#
# P(d′) = E[Φ((d′ − u)/s) + Φ((−d′ − u)/s)], s² = n/(n − 1),
#
# and guesses give 1/n.
_PLACES = ("first", "second", "third", "fourth", "fifth")
_LARGEST_D_PRIME = 20.0
# Gauss–Legendre of |z|: φ has died away at 9 deviations.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(96)
_Z = 4.5 * (_NODES + 1.0)
_DENSITY = 2.0 * 4.5 * _WEIGHTS * np.exp(-0.5 * _Z**2) / math.sqrt(2.0 * math.pi)
_POINTS, _NODES_OF_MORE = 2**17, 512


@functools.cache
def _distances(surfaces: int) -> tuple[si.DimensionlessArray, si.DimensionlessArray]:
    """Nodes of u/s and their weights: of three exact, of more from a Sobol sequence, whose sorted
    values are taken together by their means (P errs by less than 5e-5)."""
    if surfaces == 3:
        return math.sqrt(3.0) * _Z, _DENSITY
    # Only the shares of trials in a design need it, and a plan does not load it.
    from scipy.linalg import helmert
    from scipy.stats import qmc

    basis = helmert(surfaces - 1)
    points = qmc.Sobol(surfaces - 2, scramble=True, rng=1).random(_POINTS)
    apart = ndtri(points) @ basis
    u = np.maximum(apart.max(axis=1), -apart.min(axis=1) * surfaces / (surfaces - 2))
    nodes = np.sort(u).reshape(_NODES_OF_MORE, -1).mean(axis=1)
    return nodes / math.sqrt(surfaces / (surfaces - 1)), np.full(nodes.size, 1 / nodes.size)


def share_right(d_prime: si.DimensionlessLike, surfaces: int = 3) -> si.DimensionlessLike:
    """Share of right answers (1) to a difference of d′, the shape of `d_prime`; 1/`surfaces` at
    0."""
    nodes, weights = _distances(surfaces)
    apart = np.asarray(d_prime, dtype=float)[..., None] / math.sqrt(surfaces / (surfaces - 1))
    share = (ndtr(apart - nodes) + ndtr(-apart - nodes)) @ weights
    return float(share) if np.ndim(share) == 0 else np.asarray(share)


def d_prime_of_share(correct: si.Dimensionless, surfaces: int = 3) -> si.Dimensionless:
    """d′ of a share of right answers (1): the inverse of `share_right`; 0 from chance down."""
    from scipy.optimize import brentq

    def off(d_prime: float) -> float:
        return float(share_right(d_prime, surfaces)) - correct

    if off(0.0) >= 0.0:
        return 0.0
    if off(_LARGEST_D_PRIME) <= 0.0:
        return _LARGEST_D_PRIME
    return float(brentq(off, 0.0, _LARGEST_D_PRIME))


def _arranged(
    reference: Surface, comparison: Surface, reference_first: bool, answer: str, surfaces: int
) -> tuple[Surface, ...]:
    """The surfaces of a trial of a series: the comparison alone among the reference, or the other
    way round."""
    often, once = (reference, comparison) if reference_first else (comparison, reference)
    return tuple(once if place == answer else often for place in _PLACES[:surfaces])


def _odd_one_out_conditions(
    reference: str, others: Sequence[str], surfaces: int
) -> tuple[Condition, ...]:
    return tuple(
        _arranged(reference, other, is_alone, place, surfaces)
        for other in others
        for is_alone in (True, False)
        for place in _PLACES[:surfaces]
    )


def _odd_one_out_right(surfaces: Sequence[Stimulus], judged: Judged) -> str:
    del judged
    kinds = kinds_of(surfaces)
    alone = [place for place, kind in enumerate(kinds) if kinds.count(kind) == 1]
    return _PLACES[alone[0]] if len(alone) == 1 else ""


def _odd_one_out_decides(given: Percepts) -> Decision:
    """The percept that is furthest from the mean of the rest; where only one was felt, or only one
    was not, that one."""
    level, felt = given.level, given.felt
    count, surfaces = felt.sum(axis=0), len(level)
    away = np.abs(level - level.mean(axis=0)) * surfaces / (surfaces - 1)
    furthest = np.sort(away, axis=0)[-2:]
    sure = math.sqrt(2.0) * (furthest[1] - furthest[0]) / given.deviation
    lonely = np.where(count == 1, np.argmax(felt, axis=0), np.argmin(felt, axis=0))
    choice = np.where(count == surfaces, np.argmax(away, axis=0), lonely)
    doubt = np.where(count == surfaces, np.exp(-sure), 1.0)
    decided: NDArray[np.bool_] = (count == 1) | (count >= surfaces - 1)
    return Decision(choice.astype(np.int64), doubt, decided)


def _odd_one_out(name: Task, surfaces: int, number: str) -> StudyTask:
    """The task of so many surfaces, three to five; `number` in words."""
    places = _PLACES[:surfaces]
    model = "the triangular method (Ennis 1993, 10.1111/j.1745-459X.1993.tb00222.x)"
    if surfaces > 3:
        model = "the odd one of several (Craven 1992, Perception & Psychophysics 51, 379)"
    return StudyTask(
        name=name,
        surfaces=surfaces,
        reference="presented",
        answers=places,
        question=lambda _: f"Which of the {number} surfaces was different?",
        conditions=functools.partial(_odd_one_out_conditions, surfaces=surfaces),
        right=_odd_one_out_right,
        presents=(
            f"On each trial {number} surfaces were presented one after the other, all but one the "
            "same, and the participant said which was different; the reference ({reference}) was "
            "that one, or all of the others"
        ),
        analysed=(
            f"Each participant's answers were fitted by the model of {model}, in which the percept "
            "furthest from the others is named, with lapses; the Weber fraction is the difference "
            f"with d′ = 0.954, which is told in 75 % of two intervals. {POPULATION}"
        ),
        counted="Right",
        assumed=(
            "The surface is named whose perceived period (or strength) is furthest from the "
            "others; where a rhythm is felt on only one, or on all but one, the one that differs "
            "in that.",
            UNFELT,
        ),
        in_plane=(CLEARER,),
        adaptive=("bayesian",),
        series=lambda number, _: (number // surfaces % 2 == 0, places[number % surfaces]),
        arranges=functools.partial(_arranged, surfaces=surfaces),
        decides=_odd_one_out_decides,
        model=DifferenceModel(
            difference=widest,
            criteria=np.zeros(1),
            rate=lambda d_prime, _: np.asarray(share_right(d_prime, surfaces)),
            lapses=1 / surfaces,
            d_prime=functools.partial(d_prime_of_share, surfaces=surfaces),
            counts=-1,
        ),
    )


ODD_ONE_OUT = _odd_one_out("odd-one-out", 3, "three")
"""Odd one out of three surfaces."""
ODD_ONE_OUT_OF_FOUR = _odd_one_out("odd-one-out-of-four", 4, "four")
"""Odd one out of four surfaces."""
ODD_ONE_OUT_OF_FIVE = _odd_one_out("odd-one-out-of-five", 5, "five")
"""Odd one out of five surfaces."""
