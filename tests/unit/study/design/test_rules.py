"""Which explorations spoil a trial, and series that cannot move."""

from __future__ import annotations

import math

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.adaptive.bayesian import AdaptiveDesign
from squeezefilm.study.design.rules import AdaptiveCondition, TrialRules
from squeezefilm.study.psychometric.function import PsychometricPrior

RULES = TrialRules(
    slowest=0.02, fastest=0.2, lightest=0.2, hardest=1.0, shortest_way=0.01, least_touch=0.5
)
GOOD = (0.1, 0.08, 0.5, 0.9)


def test_what_is_within_the_rules_is_good_and_what_is_not_known_is_not_judged() -> None:
    assert RULES.broken(*GOOD) == ""
    assert RULES.broken(*(math.nan,) * 4) == ""
    assert TrialRules().broken(0.0, 9.0, 40.0, 0.0) == ""


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        (0, 0.001, "hardly moved (1 mm; at least 10 mm)"),
        (1, 0.01, "too slowly (10 mm/s; at least 20 mm/s)"),
        (1, 0.3, "too fast (300 mm/s; at most 200 mm/s)"),
        (2, 0.1, "too lightly (100 mN; at least 200 mN)"),
        (2, 2.0, "too hard (2 N; at most 1 N)"),
        (3, 0.2, "lifted"),
    ],
)
def test_each_rule_says_what_was_done_and_what_is_allowed(
    place: int, value: float, said: str
) -> None:
    given = list(GOOD)
    given[place] = value
    assert said in RULES.broken(*given)


def test_no_movement_is_said_before_the_speed_that_follows_from_it() -> None:
    assert "hardly moved" in RULES.broken(0.001, 0.001, 0.5, 0.9)


def test_limits_in_the_wrong_order_are_refused() -> None:
    with pytest.raises(InputError, match="fastest"):
        TrialRules(slowest=0.2, fastest=0.1)
    with pytest.raises(InputError, match="hardest"):
        TrialRules(lightest=1.0, hardest=1.0)


def test_a_series_that_cannot_move_is_refused() -> None:
    with pytest.raises(InputError, match="cannot move"):
        AdaptiveCondition("s", "staircase", start=0.4, lowest=0.39, highest=0.41, step=0.4)
    with pytest.raises(InputError, match="all of its forty choices are alike"):
        AdaptiveCondition("b", "bayesian", start=0.4, lowest=0.3, highest=0.5)
    far = PsychometricPrior((100.0, 101.0), (0.1, 1.0))
    with pytest.raises(InputError, match="no answer tells anything"):
        AdaptiveDesign((1.0, 2.0), far)
    with pytest.raises(InputError, match="nothing to be learned"):
        AdaptiveDesign((1.0, 2.0), PsychometricPrior((1.0, 2.0), (0.1, 1.0)), cells=(1, 1, 5))
