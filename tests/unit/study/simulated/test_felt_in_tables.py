"""A surface that tables do not have is felt anew, by strokes or by a free hand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.study.simulated import chain_tables
from squeezefilm.study.simulated.chain_tables import ChainTables


@pytest.mark.parametrize("exploring", ["strokes", "free"])
def test_a_comparison_is_felt_as_the_study_explores(
    exploring: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []

    def feel(*said: Any) -> Any:
        return asked.append(said) or f"felt by {said[0]}"

    monkeypatch.setattr(chain_tables, "felt_virtually", feel)
    tables: Any = SimpleNamespace(
        design=SimpleNamespace(exploring=exploring), plates=("p0", "p1"), observer="people",
        fingers=("f0", "f1", "f2"), apparatus=("a0", "a1"),
    )  # fmt: skip
    stimulus: Any = "a surface"
    found: Any = ChainTables.felt(tables, 1, 2, stimulus)
    assert asked == [(exploring, "a surface", "p1", "people", "f2", "a1")]
    assert found == f"felt by {exploring}"
