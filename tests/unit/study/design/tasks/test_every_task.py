"""Every task's record: names, conditions, and how people who perceive clearly answer."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.design.tasks.same_different import SAME_DIFFERENT
from squeezefilm.study.design.tasks.surfaces import (
    MAGNITUDE_ESTIMATION,
    MATCH_TO_SAMPLE,
    TWO_INTERVAL,
)
from squeezefilm.study.design.tasks.task import Percepts, StudyTask, Task


def test_every_name_of_a_task_has_its_record() -> None:
    assert list(TASKS) == [TASKS[name].name for name in TASKS]
    assert set(TASKS) == set(get_args(Task))


@pytest.mark.parametrize("task", TASKS.values(), ids=lambda task: str(task.name))
def test_conditions_present_what_the_task_says(task: StudyTask) -> None:
    found = tuple(task.conditions("here", ("one", "two")))
    assert {len(names) for names in found} == {task.surfaces}
    assert 2 <= len(found) <= 20
    assert task.surfaces == 1 or all("here" in names or len(set(names)) == 1 for names in found)
    assert task.question("spatial_period").endswith(("?", "."))


@pytest.mark.parametrize("task", [TWO_INTERVAL, SAME_DIFFERENT])
def test_who_perceives_clearly_is_right(task: StudyTask) -> None:
    level = np.array([[9.0, 0.0], [0.0, 0.0]])
    assert task.decides is not None
    given = Percepts(level, np.ones((2, 2), dtype=bool), np.ones(2), 1.0)
    found = task.decides(given)
    assert task.answers[int(found.choice[0])] in ("first", "different")
    assert found.doubt[0] < 0.01


def test_tasks_of_one_surface_have_no_difference() -> None:
    for task in (MATCH_TO_SAMPLE, MAGNITUDE_ESTIMATION):
        assert task.model is None
        assert task.decides is None
        assert task.right((), lambda _: 0.0) == ""
