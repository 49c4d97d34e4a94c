"""What tables say of exploration, and nothing where nothing was recorded."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

from squeezefilm.study.report.page import exploration_rows


def mean(name: str, value: float, low: float = math.nan, high: float = math.nan) -> Any:
    return SimpleNamespace(name=name, mean=value, low=low, high=high)


def test_each_stimulus_has_its_own_means_in_the_order_of_the_quantities() -> None:
    analysis: Any = SimpleNamespace(
        exploration={
            "duration_s": (mean("a", 2.34567, 2.0, 3.0), mean("b", 4.0, 3.5, 4.56789)),
            "passes": (),
            "speed_m_s": (mean("b", 0.08), mean("c", 0.05, 0.04, 0.07)),
        }
    )
    head, rows = exploration_rows(analysis)
    assert head == ("Stimulus", "duration (s)", "speed m (s)")
    assert rows == [
        ("a", "2.35 (2 to 3)", "–"),
        ("b", "4 (3.5 to 4.57)", "0.08"),
        ("c", "–", "0.05 (0.04 to 0.07)"),
    ]
