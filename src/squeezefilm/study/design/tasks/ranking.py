"""Ranking of three surfaces: in which order do they have more?

All triples come, each surface once in each place. Of the surfaces that are left the one put next
has its strength over the sum of theirs for a probability (Plackett 1975, 10.2307/2346567; Luce
1959; `tasks.scales`), so that an order counts as two choices, and is not split into three pairs.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.tasks.task import (
    CLEARER,
    STRENGTHS,
    UNFELT,
    Condition,
    Decision,
    Judged,
    Percepts,
    StudyTask,
)

_RANKS = tuple(itertools.permutations(range(3)))
_ANSWERS = tuple("".join(str(place + 1) for place in rank) for rank in _RANKS)


def _conditions(catch: str, others: Sequence[str]) -> Iterator[Condition]:
    every = others if catch in ("", *others) else (catch, *others)
    for one, two, three in itertools.combinations(every, 3):
        if every is others or catch in (one, two, three):
            yield from ((one, two, three), (two, three, one), (three, one, two))


def _right(surfaces: Sequence[Stimulus], judged: Judged) -> str:
    amounts = [judged(surface) for surface in surfaces]
    falls = [all(amounts[a] > amounts[b] for a, b in itertools.pairwise(rank)) for rank in _RANKS]
    return _ANSWERS[falls.index(True)] if any(falls) else ""


def _decides(given: Percepts) -> Decision:
    order = np.argsort(-given.level, axis=0)
    # Orders are numbered as `itertools.permutations` has them.
    choice = 2 * order[0] + (order[1] > order[2])
    gaps = np.diff(np.sort(given.level, axis=0), axis=0).min(axis=0) / given.deviation
    return Decision(choice.astype(np.int64), np.exp(-gaps), np.asarray(given.felt.all(axis=0)))


RANKING = StudyTask(
    name="ranking",
    surfaces=3,
    reference="",
    answers=_ANSWERS,
    question=lambda judged: (
        f"In which order were they {'coarser' if judged == 'spatial_period' else 'stronger'}? "
        "213 says: the second most, then the first, the third least."
    ),
    conditions=_conditions,
    right=_right,
    presents=(
        "On each trial three surfaces were presented one after the other, and the participant put "
        "them in the order of their {judged}"
    ),
    analysed=(
        f"{STRENGTHS} Each participant's exponent is that of the power of {{judged}} with which "
        "strengths grow; its mean has Student's interval over participants."
    ),
    counted="Strength",
    assumed=("Surfaces are put in the order of their perceived periods (or strengths).", UNFELT),
    in_plane=(CLEARER,),
    decides=_decides,
    ranks=_RANKS,
)
"""Three surfaces, in which order do they have more?"""
