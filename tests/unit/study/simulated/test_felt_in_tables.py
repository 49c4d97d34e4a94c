"""A surface that tables do not have is felt anew, by strokes or by a free hand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.perception.senses import Candidates
from squeezefilm.study.simulated import chain_tables
from squeezefilm.study.simulated.chain_tables import ChainTables


@pytest.mark.parametrize("exploring", ["strokes", "free"])
def test_a_comparison_is_felt_as_the_study_explores(
    exploring: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    along = Candidates(np.array([4e-3, 2e-3]), np.array([3.0, 1.0]))
    across = Candidates(np.array([5e-3, 1e-3]), np.array([2.0, 0.5]))
    asked: list[Any] = []

    def feel(name: str, other: Candidates | None) -> Any:
        def felt(*said: Any) -> Any:
            asked.append((name, *said))
            return SimpleNamespace(candidates=along, across=other)

        return felt

    monkeypatch.setattr(chain_tables, "felt_by_strokes", feel("strokes", None))
    monkeypatch.setattr(chain_tables, "felt_freely", feel("free", across))
    tables: Any = SimpleNamespace(
        design=SimpleNamespace(exploring=exploring), plates=("p0", "p1"), observer="people",
        fingers=("f0", "f1", "f2"), apparatus=("a0", "a1"),
    )  # fmt: skip
    stimulus: Any = "a surface"
    found = ChainTables.felt(tables, 1, 2, stimulus)
    assert asked == [(exploring, "a surface", "p1", "people", "f2", "a1")]
    if exploring == "strokes":
        assert found is along
    else:
        assert found.period.tolist() == [[4e-3, 2e-3], [5e-3, 1e-3]]
        assert found.d_prime.tolist() == [[3.0, 1.0], [2.0, 0.5]]
