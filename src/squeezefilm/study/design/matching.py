"""Demands of a task on surfaces: what match-to-sample matches with, and amounts to compare."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.stimuli import Grating, Stimulus

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
) -> None:
    """Refuse answers that do not fit the task, or the way in which they are explored.

    Raises `InputError` that says what fits.
    """
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


def require_amounts(
    task: str, judged: str, stimuli: Sequence[Stimulus], amounts: Sequence[float]
) -> None:
    """Refuse a task that compares amounts where a surface has none of what is judged (NaN): a
    shape has no period. Raises `InputError`."""
    if task in ("match-to-sample", "same-different"):
        return
    for stimulus, amount in zip(stimuli, amounts, strict=True):
        if math.isnan(amount):
            raise InputError(
                f"stimulus '{stimulus.name}' ({stimulus.kind}) has no {judged}, which {task} asks "
                'about; judge another, like judged = "friction_depth", or take same-different or '
                "match-to-sample",
                quantity="judged",
            )
