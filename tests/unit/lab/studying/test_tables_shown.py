"""The tables that the page shows of an analysis."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.made_results import made_result

from squeezefilm.lab.studying.jobs import _tables
from squeezefilm.study.report import answer_tables
from squeezefilm.study.tasks.findings import TaskAnalysis


def test_a_task_has_its_stimuli_and_people_and_no_confusions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name in ("condition_head", "condition_rows"):
        monkeypatch.setattr(answer_tables, name, lambda _, name=name: name)
    monkeypatch.setattr(answer_tables, "person_rows", lambda _: ("head", "rows"))
    people = {"title": "People", "head": "head", "rows": "rows"}
    alone = _tables("plate", made_result(TaskAnalysis, measure="d", conditions=()))
    assert alone == {"tables": [people], "confusion": None}
    both = _tables("plate", made_result(TaskAnalysis, measure="d", conditions=("4 mm",)))
    stimuli = {"title": "Stimuli", "head": "condition_head", "rows": "condition_rows"}
    assert both == {"tables": [stimuli, people], "confusion": None}


def test_a_matching_study_has_its_confusions_alone() -> None:
    matrix = SimpleNamespace(
        answers=("a", "b"), stimuli=("c",), counts=np.array([[3], [1]], dtype=int)
    )
    analysis: Any = SimpleNamespace(matrix=matrix)
    assert _tables("plate", analysis) == {
        "tables": [],
        "confusion": {
            "display": "plate", "rows": ["a", "b"], "columns": ["c"], "counts": [[3], [1]],
        },
    }  # fmt: skip
