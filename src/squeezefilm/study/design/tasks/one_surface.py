"""Tasks of one surface: match to sample, magnitude estimation, and yes or no."""

from __future__ import annotations

import numpy as np

from squeezefilm.study.design.tasks.task import (
    CLEARER,
    FELT,
    POPULATION,
    Decision,
    DifferenceModel,
    StudyTask,
    alone,
    from_reference,
    nothing_is_right,
    one_each,
)

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
