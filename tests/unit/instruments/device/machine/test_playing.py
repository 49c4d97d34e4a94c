"""Timed amplitudes in the device's queue: what plays when, what is kept, and what is marked."""

from __future__ import annotations

from typing import Any

import pytest

from squeezefilm.instruments.device.machine.playing import (
    LONGEST_QUEUE,
    MOST_AHEAD,
    Mode,
    Playing,
    Tile,
    until,
)
from squeezefilm.instruments.device.wire.frames import Reason
from squeezefilm.instruments.device.wire.messages import RAN_DRY

# The device's clock wraps within a block that begins here.
WRAPS = 2**32 - 250
TILE = Tile(0, 1000, 2)
TILE.levels += [100, 300]


def level(playing: Playing, now: int, finger: Any = None) -> int:
    return playing.level(now % 2**32, TILE, finger)


def timed(playing: Playing, now: int, start: int, *levels: int, held: int = 7) -> Reason:
    return playing.play_timed(now % 2**32, held, start % 2**32, 100, levels)


def test_time_is_counted_across_the_wrap() -> None:
    assert [until(5, 3), until(3, 5), until(2, 2**32 - 3), until(2**32 - 3, 2)] == [2, -2, 5, -5]
    assert until(2**31 - 1, 0) == 2**31 - 1
    assert until(2**31, 0) == -(2**31)


@pytest.mark.parametrize("start", [1_000, WRAPS])
def test_a_block_plays_from_its_time_and_the_output_holds_until_then(start: int) -> None:
    playing = Playing()
    assert timed(playing, start - 300, start, 10, 20, 30) is Reason.ACCEPTED
    assert playing.mode is Mode.TIMED
    seen = [level(playing, start + after) for after in (-1, 0, 99, 100, 199, 200)]
    assert seen == [7, 10, 10, 20, 20, 30]
    assert (playing.dry, playing.late) == (False, False)
    # The last one is due for one period; held past it the queue ran dry.
    assert level(playing, start + 299) == 30
    assert not playing.dry
    assert level(playing, start + 300) == 30
    assert playing.dry
    assert playing.take_marks() == RAN_DRY
    assert not playing.dry


def test_blocks_follow_each_other_and_a_newer_one_takes_the_place_of_what_is_queued() -> None:
    playing = Playing()
    timed(playing, 0, 1_000, 10, 20, 30, 40)
    timed(playing, 500, 1_400, 50, 60)
    # From 1200 on it is another, of which the rest of the queue is nothing.
    timed(playing, 1_050, 1_200, 70)
    assert [level(playing, now) for now in (1_050, 1_100, 1_200, 1_450)] == [10, 20, 70, 70]


def test_nothing_is_played_twice_or_backwards() -> None:
    playing = Playing()
    timed(playing, 0, 1_000, 10, 20, 30)
    assert level(playing, 1_150) == 20
    # What was due at 1000 and 1100 was played; of the rest only what lies ahead is new.
    assert timed(playing, 1_150, 1_000, 1, 2, 3, 4) is Reason.ACCEPTED
    assert not playing.late
    assert [level(playing, now) for now in (1_160, 1_200, 1_300)] == [20, 3, 4]
    # A microsecond after the newest that was played is new.
    assert timed(playing, 1_310, 1_301, 9) is Reason.ACCEPTED
    assert level(playing, 1_310) == 9


def test_what_comes_after_its_time_is_marked_and_skipped_to_the_present() -> None:
    playing = Playing()
    assert timed(playing, 1_250, 1_000, 10, 20, 30, 40) is Reason.ACCEPTED
    assert playing.late
    assert level(playing, 1_250) == 30
    on_time = Playing()
    timed(on_time, 1_000, 1_000, 10)
    assert not on_time.late
    assert level(on_time, 1_000) == 10


def test_a_queue_that_is_full_takes_nothing_of_a_block() -> None:
    playing = Playing()
    for first in range(0, LONGEST_QUEUE, 32):
        assert timed(playing, 0, 1_000 + 100 * first, *range(first, first + 32)) is Reason.ACCEPTED
    end = 1_000 + 100 * LONGEST_QUEUE
    assert timed(playing, 0, end, 5) is Reason.FULL
    # In place of one that is queued there is room; as one is played, too.
    assert timed(playing, 0, end - 100, 5) is Reason.ACCEPTED
    assert timed(playing, 0, end - 100, 5, 6) is Reason.FULL
    assert level(playing, 1_000) == 0
    assert timed(playing, 1_000, end, 6) is Reason.ACCEPTED


def test_a_block_too_far_away_or_without_a_period_is_refused() -> None:
    # A second.
    assert MOST_AHEAD == 1_000_000
    playing = Playing()
    for start in (MOST_AHEAD + 1, -MOST_AHEAD - 1):
        assert timed(playing, 0, start, 1) is Reason.VALUE
    assert playing.play_timed(0, 0, 10, 0, (1,)) is Reason.VALUE
    assert playing.mode is Mode.NOTHING
    for start in (MOST_AHEAD, -MOST_AHEAD):
        assert timed(Playing(), 0, start, 1) is Reason.ACCEPTED


def test_an_amplitude_that_holds_for_long_outlives_the_clocks_wrap() -> None:
    playing = Playing()
    timed(playing, 0, 0, 10)
    assert level(playing, 0) == 10
    assert level(playing, 2 * MOST_AHEAD + 1) == 10
    # 71 minutes later the clock shows the time at which it was played again: it is not new.
    assert level(playing, 2**32) == 10
    assert timed(playing, 2**32 + 50, 2**32, 20) is Reason.ACCEPTED
    assert level(playing, 2**32 + 60) == 20


def test_an_envelope_plays_from_now_and_holds_its_last() -> None:
    playing = Playing()
    timed(playing, 0, 100, 99)
    playing.play_envelope(WRAPS, 100, (1, 2, 3))
    assert [level(playing, WRAPS + after) for after in (0, 99, 100, 250, 100_000)] == [
        1, 1, 2, 3, 3,
    ]  # fmt: skip
    playing.play_place(500)
    assert level(playing, 0) == 200
    playing.play_finger()
    assert level(playing, 0, (500, 0, True)) == 200
    assert level(playing, 0, (500, 0, False)) == level(playing, 0, None) == 0
    playing.stop()
    assert (playing.mode, level(playing, 0)) == (Mode.NOTHING, 0)
    # What was queued before is forgotten with it.
    timed(playing, 0, 200, 5)
    playing.stop()
    timed(playing, 0, 300, 6, held=0)
    assert level(playing, 250) == 0
