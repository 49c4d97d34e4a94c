"""Odd one out of three surfaces: the triangular task, from its trials to its model.

Two of three surfaces are the same; which is the other? Each of the six orders of two surfaces comes
equally often. Whoever compares percepts names the one that is furthest from the other two, which
guesses give in a third of the trials and a difference of d′ in

    P(d′) = 2 ∫₀^∞ [Φ(−√3 z + √(2/3) d′) + Φ(−√3 z − √(2/3) d′)] φ(z) dz

(Ura 1960; Frijters 1979, 10.1111/j.2044-8317.1979.tb00595.x; Ennis 1993,
10.1111/j.1745-459X.1993.tb00222.x), for percepts of equal variance on one scale.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import ndtr

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
    kinds_of,
    widest,
)

_ANSWERS = ("first", "second", "third")
_CHANCE = 1.0 / 3.0
_LARGEST_D_PRIME = 20.0
# Gauss–Legendre in the angle's place: φ has died away at 9 deviations.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(96)
_Z = 4.5 * (_NODES + 1.0)
_DENSITY = 2.0 * 4.5 * _WEIGHTS * np.exp(-0.5 * _Z**2) / math.sqrt(2.0 * math.pi)


def correct_of_three(d_prime: si.DimensionlessLike) -> si.DimensionlessLike:
    """Share of right answers (1) to a difference of d′, the shape of `d_prime`; 1/3 at 0."""
    apart = math.sqrt(2.0 / 3.0) * np.asarray(d_prime, dtype=float)[..., None]
    inner = -math.sqrt(3.0) * _Z
    share = (ndtr(inner + apart) + ndtr(inner - apart)) @ _DENSITY
    return float(share) if np.ndim(share) == 0 else np.asarray(share)


def d_prime_of_three(correct: si.Dimensionless) -> si.Dimensionless:
    """d′ of a share of right answers (1): the inverse of `correct_of_three`; 0 from chance down."""
    from scipy.optimize import brentq

    if correct <= _CHANCE:
        return 0.0
    short = float(correct_of_three(_LARGEST_D_PRIME))
    if correct >= short:
        return _LARGEST_D_PRIME
    d_prime = brentq(lambda d: float(correct_of_three(d)) - correct, 0.0, _LARGEST_D_PRIME)
    return float(d_prime)


def _conditions(reference: str, others: Sequence[str]) -> tuple[Condition, ...]:
    orders = []
    for other in others:
        for twice, once in ((reference, other), (other, reference)):
            orders += [tuple(once if k == place else twice for k in range(3)) for place in range(3)]
    return tuple(orders)


def _right(surfaces: Sequence[Stimulus], judged: Judged) -> str:
    del judged
    kinds = kinds_of(surfaces)
    alone = [place for place, kind in enumerate(kinds) if kinds.count(kind) == 1]
    return _ANSWERS[alone[0]] if len(alone) == 1 else ""


def _decides(given: Percepts) -> Decision:
    """The percept that is furthest from the other two; where only one was felt, or only one was
    not, that one."""
    level, felt = given.level, given.felt
    apart = np.abs(level - level[[1, 2, 0]])
    # The pair (k, k + 1) leaves out k + 2.
    nearest = np.argmin(apart, axis=0)
    two = np.sort(apart, axis=0)[:2]
    sure = (two[1] - two[0]) / (math.sqrt(2.0) * given.deviation)
    count = felt.sum(axis=0)
    lonely = np.where(count == 1, np.argmax(felt, axis=0), np.argmin(felt, axis=0))
    choice = np.where(count == 3, (nearest + 2) % 3, lonely)
    doubt = np.where(count == 3, np.exp(-sure), 1.0)
    return Decision(choice.astype(np.int64), doubt, count > 0)


ODD_ONE_OUT = StudyTask(
    name="odd-one-out",
    surfaces=3,
    reference="presented",
    answers=_ANSWERS,
    question=lambda _: "Which of the three surfaces was different?",
    conditions=_conditions,
    right=_right,
    presents=(
        "On each trial three surfaces were presented one after the other, two of them the same, "
        "and the participant said which was different; the reference ({reference}) was among them "
        "once or twice"
    ),
    analysed=(
        "Each participant's answers were fitted by the model of the triangular method (Ennis 1993, "
        "10.1111/j.1745-459X.1993.tb00222.x), in which the percept furthest from the other two is "
        "named, with lapses; the Weber fraction is the difference with d′ = 0.954, which is told "
        "in 75 % of two intervals. "
        f"{POPULATION}"
    ),
    counted="Right",
    assumed=(
        "The surface is named whose perceived period (or strength) is furthest from the other two; "
        "where a rhythm is felt on only one, or on only two, the one that differs in that.",
        UNFELT,
    ),
    in_plane=(CLEARER,),
    decides=_decides,
    model=DifferenceModel(
        difference=widest,
        criteria=np.zeros(1),
        rate=lambda d_prime, _: np.asarray(correct_of_three(d_prime)),
        lapses=_CHANCE,
        d_prime=d_prime_of_three,
        counts=-1,
    ),
)
"""Odd one out of three surfaces."""
