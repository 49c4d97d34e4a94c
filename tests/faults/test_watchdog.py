"""The output is at zero within 60 ms of the last accepted frame, on the device's own clock."""

import random

import pytest

from squeezefilm.core.drive_limits import Limits
from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.machine.playing import CLOCK
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Deframer, Fault

# The slowest ramp that limits may have: 10 ms from the top.
SLOWEST = Limits(60.0, 6000.0, 60.0, 0.0, 20e3, 60e3, insulation="glass")
PLAYS = {
    "envelope": m.Envelope(1000, (60.0,)),
    "timed envelope": None,
    "position": m.Position(500),
    "follow": m.Follow(),
}


class Deaf:
    """A playing device whose host goes wrong; `heard` is when it last accepted a frame."""

    def __init__(self, plays: str, seed: int) -> None:
        self.dice = random.Random(seed)
        self.now = self.dice.randrange(2**32)
        self.machine = Machine(4, sensor=lambda: (500, 0, True), tick_period=100)
        self.sequence = self.heard = 0
        self.answers = Deframer()
        self.machine.tick(self.now & CLOCK)
        for message in (
            m.Hello(1), m.limits_message(SLOWEST), m.TileBegin(0, 1000, 2),
            m.TileData(0, (60.0, 60.0)), m.Arm(self.machine.token), m.Start(40_000_000),
        ):  # fmt: skip
            assert self.say(message) == 0
        timed = m.TimedEnvelope((self.now + 1000) & CLOCK, 1000, (60.0,) * 56)
        assert self.say(PLAYS[plays] or timed) == 0
        for _ in range(300):
            self.tick()
            if self.dice.random() < 0.2:
                assert self.say(m.KeepAlive()) == 0
        assert self.machine.level == 60_000_000

    def say(self, message: m.Message) -> int:
        self.sequence += 1
        return self.hear(message.frame(self.sequence).encoded())

    def hear(self, data: bytes) -> int:
        reason = -1
        for frame in self.answers.take(self.machine.receive(data, self.now & CLOCK)):
            assert frame is not None
            status = m.Status.read(frame.payload)
            assert status is not None
            reason = status.reason
            if reason == 0:
                self.heard = self.now
        return reason

    def tick(self) -> None:
        self.now += 100
        self.machine.tick(self.now & CLOCK)

    def nothing(self) -> None:
        """A host that stopped."""

    def garbage(self) -> None:
        """Noise, damaged frames and bits of frames."""
        good = m.KeepAlive().frame(self.sequence + 1).encoded()
        broken = bytearray(good)
        broken[self.dice.randrange(len(good) - 1)] ^= 1 << self.dice.randrange(8)
        noise = self.dice.randbytes(self.dice.randrange(40)) + b"\0"
        assert self.hear(self.dice.choice((noise, bytes(broken), good[:5] + b"\0"))) == -1

    def refused(self) -> None:
        """Whole frames that the device may not take."""
        late = (self.now - 2_000_000) & CLOCK
        bad = self.dice.choice(
            (
                m.Arm(0), m.Start(40_000_000), m.SetFrequency(1), m.Envelope(1000, (61.0,)),
                m.TimedEnvelope(late, 1000, (1.0,)), m.Report(1), m.ClearFault(2),
                m.TileData(9, (1.0,)), m.limits_message(SLOWEST),
            )
        )  # fmt: skip
        assert self.say(bad) > 0
        assert self.hear(m.KeepAlive().frame(self.sequence).encoded()) > 0  # an old one


@pytest.mark.parametrize("host", ["nothing", "garbage", "refused"])
@pytest.mark.parametrize("plays", list(PLAYS))
def test_zero_within_60_ms_of_the_last_accepted_frame(host: str, plays: str) -> None:
    worst = 0
    for seed in range(4):
        device = Deaf(plays, seed)
        while device.machine.level:
            if device.dice.random() < 0.5:
                getattr(device, host)()
            device.tick()
            assert device.now - device.heard <= 60_000
        worst = max(worst, device.now - device.heard)
        assert device.machine.fault is Fault.WATCHDOG
        for _ in range(200):
            getattr(device, host)()
            device.tick()
            assert device.machine.level == 0
    print(f"{plays}, host gives {host}: zero after {worst / 1000:g} ms at most")
    assert 50_000 < worst <= 60_000
