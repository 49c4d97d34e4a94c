"""A staircase's steps and its threshold, played by hand."""

from __future__ import annotations

import math
from typing import Any

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.adaptive.staircase import Staircase, StaircaseRule

RULE: dict[str, Any] = {"start": 8.0, "step": 2.0, "smallest_step": 0.5}


def test_three_in_a_row_go_down_and_one_error_goes_up() -> None:
    stairs = Staircase(StaircaseRule(**RULE, down_after=3, highest=9.0))
    levels = []
    for correct in (True, True, True, False, False, False, False):
        stairs.update(stairs.next_stimulus(), correct)
        levels.append(stairs.next_stimulus())
    # Down by 2 after three; the turn halves the step, and the highest is never left.
    assert levels == [8.0, 8.0, 6.0, 7.0, 8.0, 9.0, 9.0]


def test_an_odd_reversal_is_left_out_with_the_first_ones() -> None:
    stairs = Staircase(StaircaseRule(**RULE | {"axis": "log", "start": 8.0}, down_after=1))
    turns = []
    for correct in (True, False, True, True, False, True, False):
        intensity = stairs.next_stimulus()
        stairs.update(intensity, correct)
        turns += [intensity] if stairs.trials[-1].reversal else []
    assert len(turns) == 5
    for discard, left in ((0, turns[1:]), (1, turns[1:]), (2, turns[3:]), (3, turns[3:])):
        geometric = math.exp(sum(map(math.log, left)) / len(left))
        assert stairs.threshold(discard) == pytest.approx(geometric)
    with pytest.raises(InputError, match="no two reversals"):
        stairs.threshold(4)


@pytest.mark.parametrize("lowest", [-math.inf, 0.0])
def test_stairs_of_logarithms_have_no_end_below_where_none_is_above_nothing(lowest: float) -> None:
    rule = StaircaseRule(8.0, 1.0, 1.0, down_after=1, lowest=lowest, axis="log")
    stairs = Staircase(rule)
    for _ in range(5):
        stairs.update(stairs.next_stimulus(), True)
    assert stairs.next_stimulus() == pytest.approx(8.0 * math.exp(-5.0))
