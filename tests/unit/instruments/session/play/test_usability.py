"""Whether a session can be used: ticks made, the longest gap, commands that came too late."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.play.usability import (
    LEAST_MADE,
    LONGEST_GAP,
    MOST_LATE,
    TickCount,
    Usability,
)

PERIOD = 1e-3


def rows(ticks: np.ndarray, period: float = PERIOD, flags: int = 0) -> np.ndarray:
    made = np.zeros((ticks.size, len(column.COLUMNS)))
    made[:, column.TICK], made[:, column.TIME] = ticks, ticks * period
    made[:, column.FLAGS] = flags
    return made


def judged(*blocks: np.ndarray, period: float = PERIOD, late: int = 0) -> Usability:
    count = TickCount(period)
    for block in blocks:
        count.take(block)
    return count.judged(late)


def test_all_ticks_made_in_time_are_usable() -> None:
    found = judged(rows(np.arange(500, 700)), rows(np.arange(700, 1500)))
    assert found.usable
    assert found.sentence == ""
    assert (found.ticks, found.share_made, found.share_late) == (1000, 1.0, 0.0)
    assert found.longest_gap == pytest.approx(PERIOD)


def test_ten_seconds_in_which_everything_stood_still_are_told() -> None:
    """The fault as it was found: 9 % of the ticks, and a session that ended as it should."""
    found = judged(rows(np.arange(0, 500)), rows(np.arange(10_500, 11_000)))
    assert not found.usable
    assert found.share_made == pytest.approx(1000 / 11_000)
    assert found.longest_gap == pytest.approx(10.001)
    assert "9.09 % of 11000 ticks were made (at least 90 %)" in found.sentence
    assert "nothing was played for 10 s (at most 50 ms)" in found.sentence
    assert "play again" in found.sentence


def test_a_host_that_was_not_heard_played_nothing() -> None:
    silent = rows(np.arange(500, 700), flags=column.HOST_SILENT)
    found = judged(rows(np.arange(0, 500)), silent, rows(np.arange(700, 1000)))
    assert found.share_made == pytest.approx(0.8)
    assert found.longest_gap == pytest.approx(0.201)
    assert not found.usable
    # Also where it never came back.
    assert judged(rows(np.arange(0, 500)), silent).longest_gap == pytest.approx(0.2)


@pytest.mark.parametrize(("gap", "usable"), [(0.9 * LONGEST_GAP, True), (1.1 * LONGEST_GAP, False)])
def test_the_limit_of_a_gap(gap: float, usable: bool) -> None:
    after = 1000 + round(gap / PERIOD)
    assert judged(rows(np.arange(0, 1000)), rows(np.arange(after, 3000))).usable is usable


def test_the_limits_of_lost_ticks_and_of_late_commands() -> None:
    for share, usable in ((LEAST_MADE + 0.02, True), (LEAST_MADE - 0.02, False)):
        ticks = np.arange(1000)
        lost = (ticks * (1 - share)) % 1 < 1 - share
        assert judged(rows(ticks[~lost])).usable is usable
    for late, usable in ((0.9 * MOST_LATE, True), (1.1 * MOST_LATE, False)):
        assert judged(rows(np.arange(1000)), late=round(1000 * late)).usable is usable


def test_a_slow_loop_has_no_gap_in_every_period() -> None:
    assert judged(rows(np.arange(50), period=0.1), period=0.1).usable


def test_what_never_played_is_not_usable_and_says_so() -> None:
    found = judged()
    assert not found.usable
    assert math.isnan(found.share_made)
    assert "never played" in found.sentence
    assert found.to_json()["share_made"] is None


def test_the_record_keeps_the_limits_beside_the_numbers() -> None:
    kept = judged(rows(np.arange(100))).to_json()
    assert kept["limits"] == {
        "least_share_made": LEAST_MADE, "longest_gap_s": LONGEST_GAP, "most_share_late": MOST_LATE,
    }  # fmt: skip
    assert kept["usable"] is True
    assert kept["longest_gap_s"] == pytest.approx(PERIOD)
