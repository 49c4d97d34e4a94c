"""Two intervals: which of two surfaces has more? Its model is `tasks.two_interval`."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.tasks.task import (
    CLEARER,
    POPULATION,
    Condition,
    Decision,
    DifferenceModel,
    Judged,
    Percepts,
    StudyTask,
)

QUARTILE: si.Dimensionless = 0.6744897501960817
"""Quartile of a normal deviate: 75 % lie below."""
BIASES: si.DimensionlessArray = np.linspace(-0.5, 0.5, 41)
"""Biases for an answer that are held possible, in parts of the greatest difference (1)."""


def _question(judged: str) -> str:
    more = "coarser" if judged == "spatial_period" else "more strongly felt"
    return f"Which of the two surfaces was {more}?"


def _conditions(reference: str, others: Sequence[str]) -> tuple[Condition, ...]:
    return tuple(pair for other in others for pair in ((reference, other), (other, reference)))


def _right(surfaces: Sequence[Stimulus], judged: Judged) -> str:
    first, second = map(judged, surfaces)
    return "" if first == second else "first" if first > second else "second"


def _decides(given: Percepts) -> Decision:
    apart = (given.level[0] - given.level[1]) / (math.sqrt(2.0) * given.deviation)
    return Decision.by_sign(apart, given.felt[0] & given.felt[1])


TWO_INTERVAL = StudyTask(
    name="two-interval",
    surfaces=2,
    reference="presented",
    answers=("first", "second"),
    question=_question,
    conditions=_conditions,
    right=_right,
    presents=(
        "On each trial two surfaces were presented one after the other, one of them the reference "
        "({reference}), and the participant said which had the greater {judged}"
    ),
    analysed=(
        "Each participant's answers were fitted with a cumulative Gaussian of the difference of "
        "logarithms, with a bias for an interval and lapses; the Weber fraction is what is told in "
        f"75 % of two intervals. {POPULATION} d′ follows Macmillan and Creelman (2005)."
    ),
    counted="Has more",
    assumed=(
        "The coarser surface is the one whose clearest rhythm has the longer period, the deeper "
        "one the one whose clearest rhythm is the more evident.",
        "A person who does not feel both rhythms guesses which is coarser.",
    ),
    in_plane=(CLEARER,),
    adaptive=("staircase", "bayesian"),
    decides=_decides,
    model=DifferenceModel(
        difference=lambda levels, _: np.asarray(levels[0] - levels[1]),
        criteria=BIASES,
        threshold=QUARTILE,
        sensitivity="two-interval",
    ),
)
"""Two surfaces, which has more?"""
