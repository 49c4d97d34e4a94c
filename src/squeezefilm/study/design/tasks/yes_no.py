"""Yes or no: was there anything to feel? One surface, the flat one in half of the trials.

"Yes" comes from a percept above the person's criterion, P(yes | x) = Φ((x − b)/σ), so that d′ = x/σ
grows with the amount x, and b is the amount at which half of the answers are "yes" (Macmillan and
Creelman 2005, chapter 1). The threshold has d′ = 0.954, whatever the criterion.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.tasks.task import (
    FELT,
    POPULATION,
    Condition,
    Decision,
    DifferenceModel,
    Judged,
    Percepts,
    StudyTask,
    alone,
    from_reference,
)


def _conditions(reference: str, others: Sequence[str]) -> tuple[Condition, ...]:
    return (*((other,) for other in others), *((reference,) for _ in others))


def _right(surfaces: Sequence[Stimulus], judged: Judged) -> str:
    return "yes" if judged(surfaces[0]) > 0 else "no"


def _decides(given: Percepts) -> Decision:
    return Decision.by_sign(given.level[0] / given.deviation - given.criterion)


YES_NO = StudyTask(
    name="yes-no",
    surfaces=1,
    reference="flat",
    answers=("yes", "no"),
    question=lambda _: "Was there anything to feel on the surface?",
    conditions=_conditions,
    right=_right,
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
    decides=_decides,
    model=DifferenceModel(
        difference=from_reference,
        criteria=np.linspace(-0.5, 1.5, 41),
        criterion="half of the answers are “yes” at",
    ),
)
"""One surface: was there anything to feel?"""
