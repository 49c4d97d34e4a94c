"""The whole bench on a simulated clock: loop, player, link, device, plate and finger, in step.

The player, the link's code and the device's state machine are those of a session in real time; only
time is made. The same inputs give the same record and the same truth, bit for bit.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.simulated_loop import SimulatedLoop

from squeezefilm.core import quantities as si
from squeezefilm.core.results import to_json
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.wire.link import Link
from squeezefilm.instruments.session.play.plan import PlayPlan
from squeezefilm.instruments.session.play.player import Player
from squeezefilm.instruments.session.play.real_time import PAUSE, PlayOutcome, played
from squeezefilm.instruments.session.record.trace_file import TraceWriter
from squeezefilm.instruments.twin.device import TwinDevice


@dataclass(slots=True)
class VirtualStream:
    """A wire to a twin on a simulated clock: what is written arrives `latency` (s) later.

    `now` is the simulated time (s); moving it by `wait` moves the twin and, where one is given,
    whatever `together` moves.
    """

    device: TwinDevice
    latency: si.Second = 0.5e-3
    now: si.Second = 0.0
    together: Callable[[si.Second], None] | None = None
    _under_way: deque[tuple[int, bytes]] = field(default_factory=deque)
    _arrived: bytearray = field(default_factory=bytearray)

    def clock(self) -> si.Second:
        """The simulated time (s)."""
        return self.now

    def wait(self, duration: si.Second) -> None:
        """Let time pass (s)."""
        self.now += duration
        if self.together is not None:
            self.together(self.now)
        until = round(self.now * 1e6)
        while self._under_way and self._under_way[0][0] <= until:
            at, data = self._under_way.popleft()
            self.device.receive(data, max(at, self.device.now))
        self._arrived += self.device.advance(max(until, self.device.now))

    def read(self) -> bytes:
        """Bytes that have arrived from the device."""
        data = bytes(self._arrived)
        self._arrived.clear()
        return data

    def write(self, data: bytes) -> None:
        """Send bytes to the device."""
        self._under_way.append((round((self.now + self.latency) * 1e6), data))

    def close(self) -> None:
        """Close nothing."""


def virtual_play(
    plan: PlayPlan,
    device: TwinDevice,
    trace: Path,
    metadata: Mapping[str, Any],
    *,
    duration: si.Second,
    latency: si.Second = 0.5e-3,
    step: si.Second = PAUSE,
) -> PlayOutcome:
    """Play on a twin for a time, as fast as the computer can; the truth is in `device.truth`.

    Args:
        plan: what to play.
        device: the twin, with a hand on it.
        trace: the record to write, which must not exist.
        metadata: of the record.
        duration: for which to play (s, simulated).
        latency: of the link to the device (s).
        step: between two looks of the player (s).

    Raises:
        DeviceError: a device that refuses to begin.
        RecordError: a record that cannot be written.
    """
    si.require("duration", duration, si.Unit("s"), above=0.0)
    si.require("step", step, si.Unit("s"), above=0.0, at_most=20e-3)
    loop = SimulatedLoop(plan.loop)
    stream = VirtualStream(device, latency, device.now * 1e-6)
    start = stream.now

    def clock() -> si.Second:
        return stream.now - start

    stream.together = lambda now: loop.advance(now - start)
    with TraceWriter(trace, plan.columns, metadata) as writer:
        link = Link(stream, clock, stream.wait)
        player = Player(plan, loop, DeviceHost(link), writer, clock)
        ending, message = played(player, lambda: stream.wait(step), duration)
        player.end(ending, stream.wait, message)
        writer.event("loop", {"lateness": loop.lateness.to_json()})
        writer.event("link", to_json(link.statistics))
        verdict = player.judge()
        return PlayOutcome(ending, message, trace, writer.acknowledged, usability=verdict)
