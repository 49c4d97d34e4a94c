"""Direction: does one surface have more or less than the reference, which is known from before?

The method of single stimuli: P(more) = Φ((Δ − b)/s), with Δ the difference from the reference, of
logarithms or of an orientation, and b the person's middle between the two answers. The threshold is
told in 75 % of the trials by somebody whose middle is the reference.
"""

from __future__ import annotations

from squeezefilm.study.design.tasks.task import (
    CLEARER,
    POPULATION,
    UNFELT,
    Decision,
    DifferenceModel,
    Percepts,
    StudyTask,
    alone,
    from_reference,
    nothing_is_right,
    one_each,
)
from squeezefilm.study.design.tasks.two_interval import BIASES, QUARTILE

_QUESTIONS = {
    "spatial_period": "coarser than the reference (more) or finer (less)",
    "friction_depth": "felt more strongly than the reference (more) or less (less)",
    "ridge_share": "made of wider ridges than the reference (more) or narrower ones (less)",
    "orientation": "turned to the left from the reference (more) or to the right (less)",
}


def _decides(given: Percepts) -> Decision:
    return Decision.by_sign((given.level[0] - given.reference) / given.deviation, given.felt[0])


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
    decides=_decides,
    model=DifferenceModel(
        difference=from_reference,
        criteria=BIASES,
        threshold=QUARTILE,
        criterion="bias of the middle between the answers",
    ),
)
"""One surface: more or less than the reference?"""
