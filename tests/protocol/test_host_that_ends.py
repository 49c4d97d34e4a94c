"""A host that is killed, or stopped for 10 s, at any moment of a session on a device.

On a simulated clock; tests/faults does it to processes.
"""

from __future__ import annotations

import contextlib
import random
from dataclasses import dataclass, field

import pytest

from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import DeviceError
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.wire.frames import Fault, State
from squeezefilm.instruments.device.wire.link import Link

from .wire import TICK, Wire

LIMITS = Limits(60.0, 6000.0, 60.0, 0.0, 20e3, 60e3, insulation="glass")
ZERO_WITHIN = 60_000  # µs
STOPPED = 10_000_000  # µs


class Killed(BaseException):
    """The host is no more."""


@dataclass
class Mortal(Wire):
    """A wire whose host is killed at `moment` (µs), or stopped there for 10 s.

    What it was writing then arrives up to any byte. `late` are the times at which the output was
    not zero although no frame had been accepted for 60 ms.
    """

    moment: int = 1 << 62
    kill: bool = True
    late: list[int] = field(default_factory=list)
    accepted: tuple[int, int] = (0, 0)

    def write(self, data: bytes) -> None:
        if self.now >= self.moment and self.kill:
            part = data[: self.dice.randrange(len(data) + 1)]
            self.machine.receive(part, self.device_time)
            raise Killed
        super().write(data)

    def wait(self, duration: float) -> None:
        end = self.now + max(1, round(duration * 1e6))
        if self.now < self.moment <= end:
            self._watch((self.moment - self.now) * 1e-6)
            if self.kill:
                raise Killed
            self.be_silent()
            self.moment = 1 << 62
        self._watch(max(0, end - self.now) * 1e-6)

    def be_silent(self) -> None:
        """The device goes on for 10 s and nobody says anything."""
        self._watch(0.08)
        # At zero and not armed, nothing can happen in the rest of it.
        assert self.machine.level == 0
        assert self.machine.state in (State.OFF, State.FAULT)
        self.now += STOPPED - 80_000
        self._ticks = self.now // TICK
        self.machine.tick(self.device_time)

    def _watch(self, duration: float) -> None:
        if duration <= 0.0:
            return
        # As fine as a tick, so that it is known when a frame was accepted.
        for _ in range(max(1, round(duration * 1e6 / TICK))):
            super().wait(TICK * 1e-6)
            if self.machine.accepted != self.accepted[0]:
                self.accepted = self.machine.accepted, self.now
            if self.machine.level > 0 and self.now - self.accepted[1] > ZERO_WITHIN + TICK:
                self.late.append(self.now)


def session(wire: Wire) -> None:
    """All that a host does: open, load, arm, start, play by tile and by stream, stop."""
    link = Link(wire, wire.clock, wire.wait)
    host = DeviceHost(link, session=5)
    host.open(LIMITS)
    host.load_tile(0.0, 1e-3, [60.0, 30.0, 60.0])
    host.report(1e-3)
    host.arm()
    host.start(40e3)
    host.play_at(1e-3)
    for step in range(25):
        if step >= 10:
            due = host.clock.stamp(host.clock.device_time(link.clock() + 5e-3))
            host.play([60.0, 20.0, 60.0, 60.0, 60.0], 1e-3, due)
        wire.wait(1e-3)
        host.pump()
        host.poll()
        if host.state is State.FAULT:
            return
    host.stop()


def whole_session() -> int:
    wire = Mortal(Machine(3))
    session(wire)
    assert not wire.late
    assert max(level for _, level in wire.levels) == 60_000_000
    return wire.now


def check_a_moment(moment: int, kill: bool, seed: int) -> State:
    wire = Mortal(Machine(3), seed=seed, moment=moment, kill=kill, boot=2**32 - 50_000)
    with contextlib.suppress(Killed, DeviceError):
        session(wire)
    found = wire.machine.state
    wire.moment = 1 << 62
    wire._down.clear()  # what was on the wire when it died has arrived or is lost
    wire.be_silent()
    assert wire.late == [], (moment, seed)
    # The next host finds a device that plays.
    wire._up.clear()
    wire.levels.clear()
    session(wire)
    assert max(level for _, level in wire.levels) == 60_000_000
    assert wire.machine.fault is Fault.NONE
    return found


@pytest.mark.parametrize("kill", [True, False], ids=["killed", "stopped for 10 s"])
def test_a_host_that_ends_at_any_moment(kill: bool) -> None:
    duration, pick = whole_session(), random.Random(4)
    seen = {check_a_moment(pick.randrange(duration), kill, seed) for seed in range(6)}
    assert seen - {State.OFF}, seen


@pytest.mark.nightly
@pytest.mark.parametrize("kill", [True, False], ids=["killed", "stopped for 10 s"])
def test_a_host_that_ends_at_any_of_200_moments(kill: bool) -> None:
    first = random.SystemRandom().randrange(2**31)
    print(f"seed {first}")
    duration, pick = whole_session(), random.Random(first)
    for seed in range(first, first + 200):
        check_a_moment(pick.randrange(duration), kill, seed)
