"""A device on a simulated clock, behind a wire that may lose, double, swap and damage."""

from __future__ import annotations

import random
from dataclasses import dataclass, field

from squeezefilm.core.errors import DeviceError
from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.machine.playing import CLOCK

TICK = 100


@dataclass
class Faults:
    """What a wire does to bytes and frames; probabilities."""

    flip: float = 0.0
    """Of a bit."""
    drop: float = 0.0
    """Of a byte."""
    lose: float = 0.0
    """Of a frame; the same for doubling and delaying one past those behind it."""
    double: float = 0.0
    swap: float = 0.0

    def applied(self, data: bytes, dice: random.Random) -> list[tuple[int, bytes]]:
        """(extra µs, bytes) of every frame that is left of `data`."""
        out = []
        for part in data.split(b"\0")[:-1]:
            frame = part + b"\0"
            if dice.random() < self.lose:
                continue
            late = dice.randrange(200, 2000) if dice.random() < self.swap else 0
            for _ in range(2 if dice.random() < self.double else 1):
                out.append((late, self._damaged(frame, dice)))
        return out

    def _damaged(self, frame: bytes, dice: random.Random) -> bytes:
        if self.flip:
            bits = int.from_bytes(frame, "little")
            at = int(dice.expovariate(self.flip))
            while at < 8 * len(frame):
                bits ^= 1 << at
                at += 1 + int(dice.expovariate(self.flip))
            frame = bits.to_bytes(len(frame), "little")
        if self.drop:
            frame = bytes(byte for byte in frame if dice.random() >= self.drop)
        return frame


@dataclass
class Wire:
    """A stream to a machine; `wait` lets simulated time pass, and the machine ticks.

    `drift` is the device's clock against the host's; `latency` is one way, plus up to `jitter`.
    """

    machine: Machine
    seed: int = 1
    to_device: Faults = field(default_factory=Faults)
    to_host: Faults = field(default_factory=Faults)
    latency: int = 300
    jitter: int = 0
    drift: float = 0.0
    boot: int = 12_345
    unplugged: bool = False
    now: int = 0
    levels: list[tuple[int, int]] = field(default_factory=list)
    closed: bool = False
    _ticks: int = 0

    def __post_init__(self) -> None:
        self.dice = random.Random(self.seed)
        self._down: list[tuple[int, int, bytes]] = []
        self._up: list[tuple[int, int, bytes]] = []
        self._last_down = self._last_up = self._number = 0
        self.machine.tick(self.device_time)

    @property
    def device_time(self) -> int:
        return self._device_at(self.now)

    def _device_at(self, host: int) -> int:
        return (self.boot + round(host * (1 + self.drift))) & CLOCK

    def clock(self) -> float:
        return self.now * 1e-6

    def write(self, data: bytes) -> None:
        self._check()
        for late, part in self.to_device.applied(data, self.dice):
            at = max(self._last_down, self.now + self.latency + self._jittered())
            self._last_down = at  # a wire keeps order, but for what `swap` delays
            self._number += 1
            self._down.append((at + late, self._number, part))

    def read(self) -> bytes:
        self._check()
        come = sorted(one for one in self._up if one[0] <= self.now)
        self._up = [one for one in self._up if one[0] > self.now]
        return b"".join(part for _, _, part in come)

    def close(self) -> None:
        self.closed = True

    def wait(self, duration: float) -> None:
        end = self.now + max(1, round(duration * 1e6))
        while True:
            tick = (self._ticks + 1) * TICK
            arrival = min((one[0] for one in self._down), default=end + 1)
            at = min(tick, arrival)
            if at > end:
                break
            self.now = max(self.now, at)
            if at == arrival:
                first = min(self._down)
                self._down.remove(first)
                self._say(self.machine.receive(first[2], self.device_time))
            if at == tick:
                self._ticks += 1
                self.levels.append((self.device_time, self.machine.tick(self.device_time)))
                self._say(self.machine.outgoing())
        self.now = end

    def _say(self, data: bytes) -> None:
        for late, part in self.to_host.applied(data, self.dice):
            at = max(self._last_up, self.now + self.latency + self._jittered())
            self._last_up = at
            self._number += 1
            self._up.append((at + late, self._number, part))

    def _jittered(self) -> int:
        return self.dice.randrange(self.jitter + 1) if self.jitter else 0

    def _check(self) -> None:
        if self.unplugged:
            raise DeviceError("could not read from the wire: it was unplugged; plug it in")
