"""Tasks of one surface: match to sample, and magnitude estimation."""

from __future__ import annotations

from squeezefilm.study.design.tasks.task import CLEARER, StudyTask, nothing_is_right, one_each

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
