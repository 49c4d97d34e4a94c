"""Every task by its name."""

from __future__ import annotations

from squeezefilm.study.design.tasks.same_different import (
    ODD_ONE_OUT,
    ODD_ONE_OUT_OF_FIVE,
    ODD_ONE_OUT_OF_FOUR,
    SAME_DIFFERENT,
)
from squeezefilm.study.design.tasks.surfaces import (
    ADJUSTMENT,
    DETECTION,
    DIRECTION,
    MAGNITUDE_ESTIMATION,
    MATCH_TO_SAMPLE,
    PAIRED_COMPARISON,
    RANKING,
    TWO_INTERVAL,
    YES_NO,
)
from squeezefilm.study.design.tasks.task import StudyTask

TASKS: dict[str, StudyTask] = {
    task.name: task
    for task in (
        MATCH_TO_SAMPLE,
        SAME_DIFFERENT,
        TWO_INTERVAL,
        ODD_ONE_OUT,
        ODD_ONE_OUT_OF_FOUR,
        ODD_ONE_OUT_OF_FIVE,
        MAGNITUDE_ESTIMATION,
        DIRECTION,
        YES_NO,
        DETECTION,
        PAIRED_COMPARISON,
        RANKING,
        ADJUSTMENT,
    )
}
"""Every task, as designs name it."""
