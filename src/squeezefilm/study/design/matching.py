"""Demands of a task on a design: what it is matched with, compared with, and asked about."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.design.tasks.every_task import TASKS

if TYPE_CHECKING:
    from squeezefilm.study.design.study_design import StudyDesign

MatchedWith = Literal["real gratings", "stimuli"]
"""Answers that match-to-sample offers."""
Exploring = Literal["strokes", "free"]
"""Ways to explore: to and fro along x, or over the whole face."""


def require_matching(design: StudyDesign) -> None:
    """Refuse answers that do not fit the task, or the way in which they are explored. Raises
    `InputError` that says what fits."""
    task, stimuli, alternatives = design.task, design.stimuli, design.alternatives
    matching, among = task == "match-to-sample", design.matched_with == "stimuli"
    if among and (not matching or alternatives or len(stimuli) < 2):
        raise InputError(
            'matched_with = "stimuli" is for match-to-sample among two or more stimuli without '
            f"[[alternatives]]; here are {len(stimuli)} stimuli and {len(alternatives)} "
            f"alternatives in a study of {task}",
            quantity="matched_with",
        )
    if matching and not among and len(alternatives) < 2:
        raise InputError(
            "match-to-sample needs two or more [[alternatives]], the real gratings; there are "
            f"{len(alternatives)}. Where the answers are the stimuli themselves, say matched_with "
            '= "stimuli"',
            quantity="alternatives",
        )
    if not matching and alternatives:
        raise InputError(
            f"task = '{task}' has no alternatives; remove them or take match-to-sample",
            quantity="alternatives",
        )
    if alternatives and design.exploring == "free":
        raise InputError(
            'real gratings are explored by strokes along x; for exploring = "free" take '
            'matched_with = "stimuli"',
            quantity="exploring",
        )
    names = design.answers
    for stimulus in stimuli:
        if stimulus.matches and stimulus.matches not in names:
            raise InputError(
                f"stimulus '{stimulus.name}' matches '{stimulus.matches}', which is no "
                f"alternative.{si.did_you_mean(stimulus.matches, names)} "
                f"Alternatives: {', '.join(names)}",
                quantity="stimuli",
            )


def require_amounts(design: StudyDesign) -> None:
    """Refuse a task that compares amounts where a surface has none of what is judged (NaN): a
    shape has no period; and a reference that is not flat where one is detected against it."""
    task, judged = design.described, design.judged
    stimuli, reference = design.stimuli, design.reference
    amounts = [design.judged_value(stimulus) for stimulus in stimuli]
    flat, of_reference = task.reference == "flat", design.reference_value
    if flat and (judged != "friction_depth" or of_reference != 0.0):
        raise InputError(
            f"task = '{task.name}' detects a surface against a flat one: say judged = "
            '"friction_depth", and name a stimulus with waveform = "constant" as the reference',
            quantity="reference",
        )
    if task.name in ("match-to-sample", "same-different"):
        return
    if task.ranks and any(map(math.isnan, amounts)):
        return
    for stimulus, amount in zip(stimuli, amounts, strict=True):
        if (
            task.ordered
            and task.surfaces > 1
            and stimulus.name != reference
            and amount == of_reference
        ):
            raise InputError(
                f"stimulus '{stimulus.name}' has the same {judged} as the reference: no answer "
                "would be right; change it, or `judged`",
                quantity="stimuli",
            )
        if math.isnan(amount) or (
            amount <= 0 and (task.ranks or task.model is not None) and not design.in_amounts
        ):
            raise InputError(
                f"stimulus '{stimulus.name}' ({stimulus.kind}) has no {judged}, which "
                f'{task.name} asks about; judge another, like judged = "friction_depth", or take '
                "same-different or match-to-sample",
                quantity="judged",
            )


def require_comparison(design: StudyDesign) -> None:
    """Refuse a task without what it compares with, and numbers that it does not take."""
    task, reference, stimuli = design.described, design.reference, len(design.stimuli)
    if task.reference and not reference:
        raise InputError(
            f"task = '{task.name}' compares with a reference; name one of the stimuli",
            quantity="reference",
        )
    if task.ranks and stimuli < 3:
        raise InputError(
            f"task = '{task.name}' compares all surfaces with each other; give three or more "
            f"[[stimuli]], there are {stimuli}",
            quantity="stimuli",
        )
    if task.reference and stimuli < 2 and not design.adaptive:
        raise InputError(
            "only the reference is there; add a stimulus to compare with it, or [[adaptive]]",
            quantity="stimuli",
        )
    if task.name == "adjustment" and not design.adaptive:
        raise InputError(
            'an adjustment is a series of steps: give [[adaptive]] with method = "adjustment", its '
            "highest difference, step and count",
            quantity="adaptive",
        )
    if design.adaptive and not task.adaptive:
        taking = ", ".join(name for name, other in TASKS.items() if other.adaptive)
        raise InputError(
            f"adaptive series compare with a reference, in task = {taking}; '{task.name}' does not",
            quantity="adaptive",
        )
    if task.reference and design.practice and stimuli < 2:
        raise InputError(
            "practice needs a stimulus to compare with the reference; add one (adaptive "
            "series use it for practice only), or practice = 0",
            quantity="practice",
        )
    if design.practice_criterion and (not design.practice or task.name == "magnitude-estimation"):
        raise InputError(
            f"practice_criterion = {design.practice_criterion:g} needs practice with right "
            "answers; give practice = 8 or so, or leave it out (numbers are never right)",
            quantity="practice_criterion",
        )
    if design.modulus and (task.name != "magnitude-estimation" or not reference):
        raise InputError(
            "a modulus needs magnitude-estimation and a reference that it is given to",
            quantity="modulus",
        )
