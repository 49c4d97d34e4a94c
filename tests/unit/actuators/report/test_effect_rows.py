"""Rows of what values do: the strongest first, and nothing that does nothing."""

from __future__ import annotations

import math

from squeezefilm.actuators.analysis.effects import Effect
from squeezefilm.actuators.report.effect_rows import effect_head, effect_rows

ANSWERS = {"force_N": "force"}


def effect(path: str, low: float, high: float) -> Effect:
    return Effect(path, "a guess", "m", 1e-3, 0.8e-3, 1.2e-3, False, {"force_N": (low, high)})


def test_the_strongest_come_first_and_nothing_is_left_out_of_sight() -> None:
    found = [effect("a.weak", 1.99, 2.01), effect("a.none", 2.0, 2.0), effect("a.both", 1.0, 3.0)]
    found.append(effect("a.stalls", 2.1, math.nan))
    rows = effect_rows(found, {"force_N": 2.0}, ANSWERS)
    assert [row[0] for row in rows] == ["stalls", "both", "weak"]
    assert rows[0][2] == "+5.0 %; does not work"
    assert rows[1][1:] == ("0.8 mm; 1.2 mm", "−50.0 %; +50.0 %")
    assert effect_head(ANSWERS) == ("value", "moved to", "force")
