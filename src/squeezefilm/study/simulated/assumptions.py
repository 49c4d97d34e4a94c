"""What simulated answers assume beyond the observer's file, in sentences that results repeat."""

from __future__ import annotations

from squeezefilm.physics.perception.free_hand import SAYS
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.simulated.recalled import ASSUMED as RECALLED


def assumed(design: StudyDesign) -> tuple[str, ...]:
    """What the simulated answers to a design assume beyond the observer's own file."""
    task = design.described
    found = task.assumed
    if design.exploring == "free":
        found = (SAYS, *(found if design.task != "same-different" else ()), *task.in_plane)
    return (*found, *(RECALLED if design.matched_with == "stimuli" else ()))
