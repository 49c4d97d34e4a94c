"""Tasks of one surface, of two and of three: felt alone, beside a reference, or ranked."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.tasks.task import (
    CLEARER,
    FELT,
    POPULATION,
    SETTINGS,
    STRENGTHS,
    UNFELT,
    Condition,
    Decision,
    DifferenceModel,
    Judged,
    Percepts,
    StudyTask,
    alone,
    from_reference,
    nothing_is_right,
    one_each,
)

QUARTILE: si.Dimensionless = 0.6744897501960817
"""Quartile of a normal deviate: 75 % lie below."""
BIASES: si.DimensionlessArray = np.linspace(-0.5, 0.5, 41)
"""Biases for an answer that are held possible, in parts of the greatest difference (1)."""


def _conditions(reference: str, others: Sequence[str]) -> tuple[Condition, ...]:
    return tuple(pair for other in others for pair in ((reference, other), (other, reference)))


def _right(surfaces: Sequence[Stimulus], judged: Judged) -> str:
    first, second = map(judged, surfaces)
    # Surfaces that are ranked may have no amount.
    alike = first == second or math.isnan(first) or math.isnan(second)
    return "" if alike else "first" if first > second else "second"


def _decides(given: Percepts) -> Decision:
    apart = (given.level[0] - given.level[1]) / (math.sqrt(2.0) * given.deviation)
    return Decision.by_sign(apart, given.felt[0] & given.felt[1])


TWO_INTERVAL = StudyTask(
    name="two-interval",
    surfaces=2,
    reference="presented",
    answers=("first", "second"),
    question=lambda judged: (
        "Which of the two surfaces was "
        f"{'coarser' if judged == 'spatial_period' else 'more strongly felt'}?"
    ),
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


# d′ grows with the amount x: P(first) = Φ((x₁ − x₂ − b)/s), with the person's bias b for an
# interval (Macmillan and Creelman 2005, chapter 7). The threshold is told in 75 % of the trials.
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
    decides=lambda given: Decision.by_sign((given.level[0] - given.level[1]) / given.deviation),
)
"""Two surfaces, one of them flat: which had something to feel?"""


# The method of single stimuli: P(more) = Φ((Δ − b)/s), with Δ the difference from the reference, of
# logarithms or of an orientation, and b the person's middle between the two answers. The threshold
# is told in 75 % of the trials by somebody whose middle is the reference.
_QUESTIONS = {
    "spatial_period": "coarser than the reference (more) or finer (less)",
    "friction_depth": "felt more strongly than the reference (more) or less (less)",
    "ridge_share": "made of wider ridges than the reference (more) or narrower ones (less)",
    "orientation": "turned to the left from the reference (more) or to the right (less)",
}


DIRECTION = StudyTask(
    name="direction",
    surfaces=1,
    reference="remembered",
    answers=("more", "less"),
    question=lambda judged: f"Was the surface {_QUESTIONS[judged]}?",
    conditions=one_each,
    right=nothing_is_right,
    presents=(
        "On each trial one surface was presented, and the participant said whether it had more or "
        "less {judged} than the reference ({reference}), which they knew from before"
    ),
    analysed=(
        "Each participant's answers were fitted with a cumulative Gaussian of the difference from "
        "the reference, with a middle of their own and lapses; the threshold is what is told in "
        f"75 % of the trials by somebody whose middle is the reference. {POPULATION}"
    ),
    counted="More",
    assumed=("The reference is remembered without error.", UNFELT),
    in_plane=(CLEARER,),
    adaptive=("limits", "bayesian"),
    series=lambda *_: (False, ""),
    arranges=alone,
    decides=lambda given: Decision.by_sign(
        (given.level[0] - given.reference) / given.deviation, given.felt[0]
    ),
    model=DifferenceModel(
        difference=from_reference,
        criteria=BIASES,
        threshold=QUARTILE,
        criterion="bias of the middle between the answers",
    ),
)
"""One surface: more or less than the reference?"""


# No surface is the reference: each is compared with each other, in either order. By who is named
# each has a strength (Bradley and Terry 1952, 10.1093/biomet/39.3-4.324; `tasks.scales`), whether
# or not the surfaces have an amount in common. Where they have, the difference that is told in 75 %
# of the pairs is that of two intervals.
def _paired_comparison_conditions(catch: str, others: Sequence[str]) -> Iterator[Condition]:
    every = others if catch in ("", *others) else (catch, *others)
    return (pair for pair in itertools.permutations(every, 2) if every is others or catch in pair)


PAIRED_COMPARISON = dataclasses.replace(
    TWO_INTERVAL,
    name="paired-comparison",
    reference="",
    conditions=_paired_comparison_conditions,
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


# After each pair the participant asks for more, for less, or says that it is equal. The mean of the
# settings is the point of equality, and 0.6745 of their deviation the difference that is just told
# (`adaptive.staircase`, `tasks.thresholds`).
def _adjustment_right(surfaces: Sequence[Stimulus], judged: Judged) -> str:
    first, second = map(judged, surfaces)
    return "equal" if first == second else "less" if second > first else "more"


def _adjustment_decides(given: Percepts) -> Decision:
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
    right=_adjustment_right,
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
    decides=_adjustment_decides,
)
"""The second surface is made equal to the first."""


# All triples come, each surface once in each place. Of the surfaces that are left the one put next
# has its strength over the sum of theirs for a probability (Plackett 1975, 10.2307/2346567; Luce
# 1959; `tasks.scales`), so that an order counts as two choices, and is not split into three pairs.
_RANKS = tuple(itertools.permutations(range(3)))
_ANSWERS = tuple("".join(str(place + 1) for place in rank) for rank in _RANKS)


def _ranking_conditions(catch: str, others: Sequence[str]) -> Iterator[Condition]:
    every = others if catch in ("", *others) else (catch, *others)
    for one, two, three in itertools.combinations(every, 3):
        if every is others or catch in (one, two, three):
            yield from ((one, two, three), (two, three, one), (three, one, two))


def _ranking_right(surfaces: Sequence[Stimulus], judged: Judged) -> str:
    amounts = [judged(surface) for surface in surfaces]
    falls = [all(amounts[a] > amounts[b] for a, b in itertools.pairwise(rank)) for rank in _RANKS]
    return _ANSWERS[falls.index(True)] if any(falls) else ""


def _ranking_decides(given: Percepts) -> Decision:
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
    conditions=_ranking_conditions,
    right=_ranking_right,
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
    decides=_ranking_decides,
    ranks=_RANKS,
)
"""Three surfaces, in which order do they have more?"""


MATCH_TO_SAMPLE = StudyTask(
    name="match-to-sample",
    surfaces=1,
    reference="",
    answers=(),
    question=lambda _: "Which of the gratings does the surface feel like?",
    conditions=one_each,
    # What is right is the design's: it says what each stimulus matches.
    right=nothing_is_right,
    presents=(
        "On each trial one virtual surface was presented, and the participant named the one of "
        "{alternatives} {matched} that it felt like"
    ),
    analysed=(
        "Proportions correct have intervals by a bootstrap over participants; information transfer "
        "is corrected for its bias. Sensitivity is the equal-variance Thurstone model's."
    ),
    counted="Right",
)
"""Task: which of the real gratings (or of the stimuli) is a virtual surface like?"""

MAGNITUDE_ESTIMATION = StudyTask(
    name="magnitude-estimation",
    surfaces=1,
    reference="",
    answers=(),
    question=lambda _: "Give a number for how coarse the surface feels.",
    conditions=one_each,
    right=nothing_is_right,
    presents=(
        "On each trial one surface was presented, and the participant gave a number for its "
        "{judged}"
    ),
    analysed=(
        "The exponent of Stevens' power law was fitted to each participant's logarithms, and its "
        "mean has Student's interval over participants. Means of numbers are geometric, with the "
        "scales of participants taken out (Lane, Catania and Stevens 1961, 10.1121/1.1908600)."
    ),
    counted="Number",
    assumed=(
        "Numbers are in proportion to the perceived period (or strength): an exponent of 1 for "
        "clear rhythms, rounded to two digits.",
        "A surface on which no rhythm is felt gets the number of the finest period.",
        "The reference is remembered with one error a person; people without a modulus have "
        "scales that spread by a factor of 1.65.",
    ),
    in_plane=(CLEARER,),
)
"""Task: a number for how much a surface has of what is judged."""


# "Yes" comes from a percept above the person's criterion, P(yes | x) = Φ((x − b)/σ), so that d′ =
# x/σ grows with the amount x, and b is the amount at which half of the answers are "yes" (Macmillan
# and Creelman 2005, chapter 1). The threshold has d′ = 0.954, whatever the criterion.
YES_NO = StudyTask(
    name="yes-no",
    surfaces=1,
    reference="flat",
    answers=("yes", "no"),
    question=lambda _: "Was there anything to feel on the surface?",
    conditions=lambda reference, others: (
        *((other,) for other in others),
        *((reference,) for _ in others),
    ),
    right=lambda surfaces, judged: "yes" if judged(surfaces[0]) > 0 else "no",
    presents=(
        "On each trial one surface was presented, in half of the trials a flat one ({reference}), "
        "and the participant said whether there was anything to feel"
    ),
    analysed=(
        "Each participant's answers were fitted with a cumulative Gaussian of the {judged}, with a "
        "criterion and lapses; the threshold is the amount with d′ = 0.954, which is told from the "
        f"flat surface in 75 % of two intervals (Macmillan and Creelman 2005). {POPULATION}"
    ),
    counted="Yes",
    assumed=("“Yes” is said where the clearest rhythm passes the observer's criterion.", FELT),
    adaptive=("limits", "bayesian"),
    # Runs present a level each time.
    series=lambda k, method: (False, "no" if method == "bayesian" and k % 2 else "yes"),
    arranges=alone,
    in_amounts=True,
    decides=lambda given: Decision.by_sign(given.level[0] / given.deviation - given.criterion),
    model=DifferenceModel(
        difference=from_reference,
        criteria=np.linspace(-0.5, 1.5, 41),
        criterion="half of the answers are “yes” at",
    ),
)
"""One surface: was there anything to feel?"""
