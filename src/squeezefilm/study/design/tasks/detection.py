"""Detection: which of two surfaces, one of them flat, had something to feel?

d′ grows with the amount x: P(first) = Φ((x₁ − x₂ − b)/s), with the person's bias b for an interval
(Macmillan and Creelman 2005, chapter 7). The threshold is told in 75 % of the trials.
"""

from __future__ import annotations

import dataclasses

from squeezefilm.study.design.tasks.task import FELT, POPULATION, Decision, Percepts
from squeezefilm.study.design.tasks.two_interval import TWO_INTERVAL


def _decides(given: Percepts) -> Decision:
    return Decision.by_sign((given.level[0] - given.level[1]) / given.deviation)


DETECTION = dataclasses.replace(
    TWO_INTERVAL,
    name="detection",
    reference="flat",
    question=lambda _: "On which of the two surfaces was there something to feel?",
    presents=(
        "On each trial two surfaces were presented one after the other, one of them flat "
        "({reference}), and the participant said on which there was something to feel"
    ),
    analysed=(
        "Each participant's answers were fitted with a cumulative Gaussian of the {judged}, with a "
        "bias for an interval and lapses; the threshold is what is told from the flat surface in "
        f"75 % of two intervals. {POPULATION}"
    ),
    assumed=("The surface is named whose clearest rhythm is the more evident.", FELT),
    in_amounts=True,
    decides=_decides,
)
"""Two surfaces, one of them flat: which had something to feel?"""
