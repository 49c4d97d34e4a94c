"""Adjustment: the second surface is made as strong, or coarse, as the first, step by step.

After each pair the participant asks for more, for less, or says that it is equal. The mean of the
settings is the point of equality, and 0.6745 of their deviation the difference that is just told
(`adaptive.runs`, `tasks.settings`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.tasks.task import (
    CLEARER,
    SETTINGS,
    UNFELT,
    Condition,
    Decision,
    Judged,
    Percepts,
    StudyTask,
)


def _conditions(reference: str, others: Sequence[str]) -> Iterator[Condition]:
    for other in others:
        yield from ((reference, other), (other, reference))


def _right(surfaces: Sequence[Stimulus], judged: Judged) -> str:
    first, second = map(judged, surfaces)
    return "equal" if first == second else "less" if second > first else "more"


def _decides(given: Percepts) -> Decision:
    apart = (given.level[1] - given.level[0]) / (math.sqrt(2.0) * given.deviation)
    choice = np.where(np.abs(apart) < given.criterion, 2, np.where(apart > 0, 1, 0))
    doubt = np.exp(-np.abs(np.abs(apart) - given.criterion))
    return Decision(choice.astype(np.int64), doubt, np.asarray(given.felt.all(axis=0)))


ADJUSTMENT = StudyTask(
    name="adjustment",
    surfaces=2,
    reference="presented",
    answers=("more", "less", "equal"),
    question=lambda judged: (
        "What does the second surface need to be as "
        f"{'coarse' if judged == 'spatial_period' else 'strong'} as the first?"
    ),
    conditions=_conditions,
    right=_right,
    presents=(
        "On each trial the reference ({reference}) and then a second surface were presented, of "
        "which the participant asked for more or less {judged} until it was equal"
    ),
    analysed=SETTINGS,
    counted="Setting",
    assumed=(
        "The second surface is called equal where the perceived periods (or strengths) differ by "
        "less than one standard deviation of that difference, the observer's criterion.",
        UNFELT,
    ),
    in_plane=(CLEARER,),
    adaptive=("adjustment",),
    series=lambda *_: (True, ""),
    decides=_decides,
)
"""The second surface is made equal to the first."""
