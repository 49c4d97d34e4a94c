"""A stream of blocks stamped with the device's time: no gap and no repetition, in C and Python."""

import random
from collections.abc import Callable, Iterator

import pytest

from squeezefilm.core.drive_limits import Limits
from squeezefilm.instruments.device.machine.playing import CLOCK
from squeezefilm.instruments.device.wire import messages as m

from .builds import Library
from .recording import Recording

FAST = Limits(60.0, 1e9, 60.0, 0.0, 20e3, 60e3, insulation="glass")
PERIOD, LEAD = 200, 5_000


@pytest.fixture
def boot(library: Library) -> Iterator[Callable[[], Recording]]:
    """Makes a device that has just booted; what it did, the firmware in C does as well."""
    made: list[Recording] = []

    def booted() -> Recording:
        made.append(Recording(1))
        return made[-1]

    yield booted
    assert made
    for recording in made:
        assert library.record(recording) == recording.record


def played(
    device: Recording, blocks: list[tuple[int, m.TimedEnvelope]], start: int, end: int
) -> list[int]:
    """The samples (mV) that `device` plays at its ticks; `blocks` arrive at their times."""
    now, sequence = start, 0
    device.tick(now & CLOCK)
    for message in (m.Hello(1), m.limits_message(FAST), m.Arm(1), m.Start(40_000_000)):
        sequence += 1
        device.receive(message.frame(sequence).encoded(), now & CLOCK)
    levels, waiting = [], sorted(blocks, key=lambda block: block[0])
    while now < end:
        now += 100
        while waiting and waiting[0][0] <= now:
            at, message = waiting.pop(0)
            sequence += 1
            device.receive(message.frame(sequence).encoded(), at & CLOCK)
        levels.append(device.tick(now & CLOCK) // 1000)
    return levels


def stream(
    start: int, count: int, size: int, overlap: int, dice: random.Random
) -> list[tuple[int, m.TimedEnvelope]]:
    """Samples 1, 2, 3, … (mV) in blocks that arrive 1 to 5 ms ahead of their first new one."""
    blocks, last = [], 0
    for first in range(0, count, size):
        begin = max(0, first - overlap)
        values = tuple((n + 1) * 1e-3 for n in range(begin, min(count, first + size)))
        sent = start + first * PERIOD
        last = max(last, sent + dice.randrange(4_000))  # a line keeps the order
        stamp = (start + LEAD + begin * PERIOD) & CLOCK
        blocks.append((last, m.TimedEnvelope(stamp, PERIOD, values)))
    return blocks


@pytest.mark.parametrize("size", [5, 25])
@pytest.mark.parametrize("start", [1_000, 2**32 - 300_000])
def test_every_sample_is_played_for_its_time(
    boot: Callable[[], Recording], size: int, start: int
) -> None:
    count = 3_000
    blocks = stream(start, count, size, 0, random.Random(size))
    levels = played(boot(), blocks, start, start + LEAD + count * PERIOD - 100)
    assert [level for level in levels if level] == [n for n in range(1, count + 1) for _ in (1, 2)]
    assert levels.index(1) == LEAD // 100 - 1


def test_a_lost_block_is_a_held_sample_and_shifts_nothing(boot: Callable[[], Recording]) -> None:
    blocks = stream(0, 100, 5, 0, random.Random(1))
    del blocks[10]
    levels = [level for level in played(boot(), blocks, 0, LEAD + 100 * PERIOD - 100) if level]
    assert levels == [50 if 51 <= n <= 55 else n for n in range(1, 101) for _ in (1, 2)]


def test_overlapping_blocks_survive_any_one_lost_block(boot: Callable[[], Recording]) -> None:
    blocks = stream(0, 500, 5, 5, random.Random(2))[:-1]
    kept = [block for number, block in enumerate(blocks) if number % 2 == 0]
    levels = [level for level in played(boot(), kept, 0, LEAD + 495 * PERIOD - 100) if level]
    assert levels == [n for n in range(1, 496) for _ in (1, 2)]


def test_what_was_queued_can_be_corrected_and_what_was_played_cannot(
    boot: Callable[[], Recording],
) -> None:
    first = m.TimedEnvelope(1_000, 1_000, (0.001, 0.002, 0.003, 0.004))
    second = m.TimedEnvelope(1_000, 1_000, (0.009, 0.008, 0.007))
    levels = played(boot(), [(0, first), (2_500, second)], 0, 6_000)
    assert levels[9::10] == [1, 2, 7, 7, 7, 7]
    assert levels == [0] * 9 + [1] * 10 + [2] * 10 + [7] * 31


def test_a_block_that_comes_late_plays_the_rest_of_it(boot: Callable[[], Recording]) -> None:
    late = m.TimedEnvelope(1_000, 1_000, (0.001, 0.002, 0.003, 0.004))
    levels = played(boot(), [(2_950, late)], 0, 5_000)
    assert levels == [0] * 29 + [3] * 10 + [4] * 11
