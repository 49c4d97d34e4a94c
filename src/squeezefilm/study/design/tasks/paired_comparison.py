"""Paired comparison of all pairs: which of two surfaces has more?

No surface is the reference: each is compared with each other, in either order. By who is named each
has a strength (Bradley and Terry 1952, 10.1093/biomet/39.3-4.324; `tasks.choices`), whether or not
the surfaces have an amount in common. Where they have, the difference that is told in 75 % of the
pairs is that of two intervals.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator, Sequence

from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.tasks.task import POPULATION, STRENGTHS, Condition, Judged
from squeezefilm.study.design.tasks.two_interval import TWO_INTERVAL


def _conditions(catch: str, others: Sequence[str]) -> Iterator[Condition]:
    every = others if catch in ("", *others) else (catch, *others)
    return (pair for pair in itertools.permutations(every, 2) if every is others or catch in pair)


def _right(surfaces: Sequence[Stimulus], judged: Judged) -> str:
    first, second = map(judged, surfaces)
    alike = first == second or math.isnan(first) or math.isnan(second)
    return "" if alike else "first" if first > second else "second"


PAIRED_COMPARISON = dataclasses.replace(
    TWO_INTERVAL,
    name="paired-comparison",
    reference="",
    conditions=_conditions,
    right=_right,
    presents=(
        "On each trial two surfaces were presented one after the other, each with each other in "
        "either order, and the participant said which had the greater {judged}"
    ),
    analysed=(
        f"{STRENGTHS} For the Weber fraction, what is told in 75 % of the pairs, each "
        "participant's answers were fitted with a cumulative Gaussian of the difference of "
        f"logarithms, with a bias for an interval and lapses. {POPULATION}"
    ),
    counted="Strength",
    adaptive=(),
    ranks=((0, 1), (1, 0)),
)
"""Two of all surfaces, which has more?"""
