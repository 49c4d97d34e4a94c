"""Demands of a task on a design: what it is matched with, compared with, and asked about."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.design.tasks.task import StudyTask

MatchedWith = Literal["real gratings", "stimuli"]
"""Answers that match-to-sample offers."""
Exploring = Literal["strokes", "free"]
"""Ways to explore: to and fro along x, or over the whole face."""


def require_matching(
    task: str,
    matched_with: MatchedWith,
    exploring: Exploring,
    stimuli: Sequence[Stimulus],
    alternatives: Sequence[Grating],
    names: Sequence[str],
) -> None:
    """Refuse answers that do not fit the task, or the way in which they are explored; `names` are
    those that may be given. Raises `InputError` that says what fits."""
    matching, among = task == "match-to-sample", matched_with == "stimuli"
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
    if alternatives and exploring == "free":
        raise InputError(
            'real gratings are explored by strokes along x; for exploring = "free" take '
            'matched_with = "stimuli"',
            quantity="exploring",
        )
    for stimulus in stimuli:
        if stimulus.matches and stimulus.matches not in names:
            raise InputError(
                f"stimulus '{stimulus.name}' matches '{stimulus.matches}', which is no "
                f"alternative.{si.did_you_mean(stimulus.matches, names)} "
                f"Alternatives: {', '.join(names)}",
                quantity="stimuli",
            )


def require_amounts(
    task: StudyTask,
    judged: str,
    stimuli: Sequence[Stimulus],
    amounts: Sequence[float],
    reference: str,
    in_amounts: bool,
) -> None:
    """Refuse a task that compares amounts where a surface has none of what is judged (NaN): a
    shape has no period; and a reference that is not flat where one is detected against it."""
    flat = task.reference == "flat"
    of_reference = dict(zip((one.name for one in stimuli), amounts, strict=True)).get(reference)
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
            amount <= 0 and (task.ranks or task.model is not None) and not in_amounts
        ):
            raise InputError(
                f"stimulus '{stimulus.name}' ({stimulus.kind}) has no {judged}, which "
                f'{task.name} asks about; judge another, like judged = "friction_depth", or take '
                "same-different or match-to-sample",
                quantity="judged",
            )


def require_comparison(
    task: StudyTask,
    reference: str,
    stimuli: int,
    is_adaptive: bool,
    practice: int,
    practice_criterion: si.Dimensionless,
    modulus: si.Dimensionless,
) -> None:
    """Refuse a task without what it compares with, and numbers that it does not take."""
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
    if task.reference and stimuli < 2 and not is_adaptive:
        raise InputError(
            "only the reference is there; add a stimulus to compare with it, or [[adaptive]]",
            quantity="stimuli",
        )
    if task.name == "adjustment" and not is_adaptive:
        raise InputError(
            'an adjustment is a series of steps: give [[adaptive]] with method = "adjustment", its '
            "highest difference, step and count",
            quantity="adaptive",
        )
    if is_adaptive and not task.adaptive:
        taking = ", ".join(name for name, other in TASKS.items() if other.adaptive)
        raise InputError(
            f"adaptive series compare with a reference, in task = {taking}; '{task.name}' does not",
            quantity="adaptive",
        )
    if task.reference and practice and stimuli < 2:
        raise InputError(
            "practice needs a stimulus to compare with the reference; add one (adaptive "
            "series use it for practice only), or practice = 0",
            quantity="practice",
        )
    if practice_criterion and (not practice or task.name == "magnitude-estimation"):
        raise InputError(
            f"practice_criterion = {practice_criterion:g} needs practice with right "
            "answers; give practice = 8 or so, or leave it out (numbers are never right)",
            quantity="practice_criterion",
        )
    if modulus and (task.name != "magnitude-estimation" or not reference):
        raise InputError(
            "a modulus needs magnitude-estimation and a reference that it is given to",
            quantity="modulus",
        )
