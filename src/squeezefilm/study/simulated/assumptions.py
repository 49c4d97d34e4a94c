"""What simulated answers assume beyond the observer's file, in sentences that results repeat."""

from __future__ import annotations

from squeezefilm.physics.perception.free_hand import SAYS
from squeezefilm.study.design.study_design import StudyDesign, Task
from squeezefilm.study.simulated.recalled import ASSUMED as RECALLED

ASSUMED: dict[Task, tuple[str, ...]] = {
    "two-interval": (
        "The coarser surface is the one whose clearest rhythm has the longer period, the deeper "
        "one the one whose clearest rhythm is the more evident.",
        "A person who does not feel both rhythms guesses which is coarser.",
    ),
    "same-different": (
        "Two surfaces are called different where their perceived periods (or strengths) differ by "
        "more than one standard deviation of that difference, the observer's criterion, or where "
        "only one of two rhythms is felt.",
    ),
    "magnitude-estimation": (
        "Numbers are in proportion to the perceived period (or strength): an exponent of 1 for "
        "clear rhythms, rounded to two digits.",
        "A surface on which no rhythm is felt gets the number of the finest period.",
        "The reference is remembered with one error a person; people without a modulus have "
        "scales that spread by a factor of 1.65.",
    ),
    "match-to-sample": (),
}
"""What simulated answers assume beyond the observer's own file, by task."""

_CLEARER = "Of the two directions the one in which a rhythm is clearer decides."
_IN_PLANE: dict[Task, tuple[str, ...]] = {
    "two-interval": (_CLEARER,),
    "magnitude-estimation": (_CLEARER,),
    "same-different": (
        "Surfaces explored freely are called different where strengths in both directions, and "
        "periods where both are felt, differ by more than one standard deviation in the root of "
        "the mean square, whatever is judged.",
    ),
    "match-to-sample": (),
}


def assumed(design: StudyDesign) -> tuple[str, ...]:
    """What the simulated answers to a design assume beyond the observer's own file."""
    found = ASSUMED[design.task]
    if design.exploring == "free":
        found = (SAYS, *(found if design.task != "same-different" else ()), *_IN_PLANE[design.task])
    return (*found, *(RECALLED if design.matched_with == "stimuli" else ()))
