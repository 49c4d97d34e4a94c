"""A line with bit errors, dropped bytes, doubled and swapped frames: nothing corrupt gets through.

The figures are printed; a bad line must be bad enough to test something, and good enough too.
"""

import random
from collections import Counter
from collections.abc import Iterable

import pytest

from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.machine.limits import DeviceLimits
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Deframer
from squeezefilm.instruments.device.wire.link import Link

RATES = (1e-4, 1e-3, 1e-2)
"""Bit error rates; bytes are dropped at 1 %, frames doubled and swapped at 2 % on top."""


def mixed(number: int, salt: int = 0) -> int:
    """31 bits that no neighbour of `number` shares."""
    return ((number + salt) * 2_654_435_761 & 0xFFFFFFFF) >> 1


def damaged(frames: Iterable[bytes], rate: float, dice: random.Random) -> bytes:
    """The frames on a bad line."""
    sent = list(frames)
    for at in range(len(sent) - 1):
        if dice.random() < 0.02:
            sent[at], sent[at + 1] = sent[at + 1], sent[at]
        if dice.random() < 0.02:
            sent[at] += sent[at]
    wire = bytearray(b"".join(sent))
    at = int(dice.expovariate(rate))
    while at < 8 * len(wire):
        wire[at // 8] ^= 1 << at % 8
        at += 1 + int(dice.expovariate(rate))
    at = int(dice.expovariate(0.01))
    while at < len(wire):
        del wire[at]
        at += int(dice.expovariate(0.01))
    return bytes(wire)


def to_the_device(frames: int, rate: float, seed: int) -> Counter[str]:
    """Each frame opens the session that belongs to its number; so a status proves its frame."""
    dice, machine, count = random.Random(seed), Machine(), Counter[str]()
    answers = Deframer()
    for first in range(0, frames, 100):
        batch = [
            m.Hello(mixed(number)).frame(number).encoded() for number in range(first, first + 100)
        ]
        wire = damaged(batch, rate, dice)
        cut = dice.randrange(len(wire) + 1)
        for part in (wire[:cut], wire[cut:]):
            for frame in answers.take(machine.receive(part, 0)):
                assert frame is not None
                status = m.Status.read(frame.payload)
                assert status is not None
                if status.reason == 0:
                    number = first + (status.answered_sequence - first) % 65536
                    count["accepted"] += 1
                    count["corrupt"] += status.session != mixed(number) or number >= first + 100
        count["sent"] += 100
    count["damaged"] = machine.damaged
    return count


class Lines:
    """A stream of what a test puts on it."""

    def __init__(self) -> None:
        self.data = b""

    def read(self) -> bytes:
        data, self.data = self.data, b""
        return data

    def write(self, data: bytes) -> None:
        """Nobody listens."""

    def close(self) -> None:
        """Nothing to close."""


def to_the_host(frames: int, rate: float, seed: int) -> Counter[str]:
    """The finger's place and the pickup belong to the reading's time; so it proves itself."""
    dice, count, lines, now = random.Random(seed), Counter[str](), Lines(), [0]
    machine = Machine(
        sensor=lambda: (mixed(now[0]), mixed(now[0], 1), True), pickup=lambda: mixed(now[0], 2)
    )
    link = Link(lines, lambda: now[0] * 1e-6)
    machine.receive(m.Hello(1).frame(1).encoded() + m.Report(200).frame(2).encoded(), 0)
    newest = 0
    while count["sent"] < frames:
        batch = []
        for _ in range(100):
            now[0] += 200
            machine.tick(now[0] & 0xFFFFFFFF)
            batch.append(machine.outgoing())
        count["sent"] += 100
        wire = damaged(batch, rate, dice)
        cut = dice.randrange(len(wire) + 1)
        for part in (wire[:cut], wire[cut:]):
            lines.data = part
            for reading in link.poll():
                count["accepted"] += 1
                if not isinstance(reading, m.Reading):
                    count["corrupt"] += 1
                    continue
                seen = (reading.x, reading.y, reading.pickup)
                true = tuple(mixed(reading.time, salt) for salt in range(3))
                assert reading.time > newest
                newest = reading.time
                count["corrupt"] += seen != true or reading.time % 200 != 0
    count["damaged"] = link.statistics.damaged
    count["doubled"], count["stale"] = link.statistics.doubled, link.statistics.stale
    return count


def check(frames: int, seed: int) -> None:
    for way in (to_the_device, to_the_host):
        for rate in RATES:
            count = way(frames, rate, seed)
            print(f"{way.__name__}, bit errors {rate:g}: {dict(count)}")
            assert count["corrupt"] == 0
            assert count["damaged"] > 0.05 * frames
            assert count["accepted"] > 0.01 * frames


@pytest.mark.slow
def test_nothing_corrupt_gets_through_a_bad_line() -> None:
    check(4_000, seed=1)


@pytest.mark.nightly
def test_nothing_corrupt_of_a_million_frames_gets_through_a_bad_line() -> None:
    check(170_000, seed=2)  # three rates, both ways


def test_what_the_host_hears_split_at_every_byte() -> None:
    machine = Machine(3, DeviceLimits(), lambda: (1, -2, True), lambda: 3)
    said = b""
    for number, message in enumerate((m.Hello(1), m.AskInfo(), m.Report(500), m.KeepAlive())):
        said += machine.receive(message.frame(number).encoded(), number)
    for now in (500, 1000, 1500):
        machine.tick(now + 3)
        said += machine.outgoing()
    lines = Lines()
    lines.data = said
    whole = Link(lines, lambda: 0.0).poll()
    kinds = [type(message) for message in whole]
    assert kinds == [m.Status, m.Status, m.Info, m.Status, m.Status, *[m.Reading] * 3]
    for cut in range(len(said) + 1):
        link = Link(lines, lambda: 0.0)
        lines.data = said[:cut]
        heard = link.poll()
        lines.data = said[cut:]
        assert heard + link.poll() == whole
        assert link.statistics.damaged == 0
