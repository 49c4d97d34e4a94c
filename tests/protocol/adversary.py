"""A host that means no good: mostly sensible commands, some absurd, late, twice or damaged."""

from __future__ import annotations

import random
import struct
from dataclasses import dataclass, field

from squeezefilm.core.drive_limits import Limits
from squeezefilm.instruments.control.gains import IdentifiedPlate, LoopAims, loop_gains
from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Frame

LIMITS = Limits(
    voltage=60.0,
    slew=20_000.0,
    continuous_voltage=30.0,
    heat=40.0,
    lowest_frequency=20e3,
    highest_frequency=60e3,
    duty=0.5,
    duty_window=0.1,
    insulation="0.5 mm glass",
)
GAINS = loop_gains(
    IdentifiedPlate(30e3, 100.0, 0.01, 1.0, 1e-5),
    LoopAims(29.5e3, 30.5e3, 60.0, 20.0, interval=5e-4, tracking_bandwidth=150.0, noise=1e-3),
)
"""For a pickup that shows 0.2 V in a search."""
ODD_VOLTS = (float("nan"), float("inf"), -1.0, -0.0, 60.000004, 1e30, 5e-324, 0.0, 60.0)


@dataclass
class Adversary:
    """Makes the bytes of one step after the other, from a seed."""

    random: random.Random
    sequence: int = 0
    sent: list[bytes] = field(default_factory=list)

    def step(self, machine: Machine) -> bytes:
        """Bytes to send to `machine` (whose token a status would have told the host)."""
        dice = self.random.random()
        if dice < 0.04 and self.sent:
            return self.random.choice(self.sent)  # again, or late
        data = self._frame(machine)
        self.sent = [*self.sent[-20:], data]
        if dice < 0.08:
            return self._damaged(data)
        if dice < 0.10:
            return self.random.randbytes(self.random.randrange(300))
        return data

    def sensible(self, message: m.Message) -> bytes:
        """A message as a good host would send it."""
        self.sequence += 1
        return message.frame(self.sequence % 65536).encoded()

    def _frame(self, machine: Machine) -> bytes:
        pick = self.random
        self.sequence += 1 if pick.random() < 0.97 else pick.randrange(65536)
        sequence = self.sequence % 65536
        if pick.random() < 0.05:  # a good frame of any type, any length, any version
            payload = pick.randbytes(pick.choice((0, 1, 2, 3, 4, 7, 10, 31, 244)))
            version = 1 if pick.random() < 0.9 else 2
            return Frame(pick.randrange(256), sequence, payload, version).encoded()
        if pick.random() < 0.5:
            return self._next_of_a_session(machine).frame(sequence).encoded()
        kind = pick.choice(list(m.COMMANDS.values()))
        return Frame(kind.TYPE, sequence, self._payload(kind, machine)).encoded()

    def _next_of_a_session(self, machine: Machine) -> m.Message:
        if machine.state == 3:
            return m.ClearFault(machine.fault)
        if machine.state == 0:
            if machine.limits is None:
                return self.random.choice((m.Hello(7), m.limits_message(LIMITS)))
            if machine.loops.revision < 2 or machine.loops.gains is None:
                dice = self.random.random()
                if dice < 0.7:
                    return m.Negotiate(2) if machine.loops.revision < 2 else m.SetLoops(GAINS)
            elif not machine.loops.on and self.random.random() < 0.7:
                return m.SwitchLoops(1)
            return m.Arm(machine.token) if self.random.random() < 0.8 else m.Hello(8)
        if machine.state == 1:
            return m.Start(self.random.choice((20_000_000, 60_000_000, 60_000_001)))
        dice = self.random.random()
        if dice < 0.4:
            return self._timed(machine)
        if dice < 0.7:
            return self._next_of_a_tile(machine)
        return m.Envelope(
            self.random.choice((1, 500, 65535)), (0.0, 60.0, 12.5)[: self.random.randint(1, 3)]
        )

    def _next_of_a_tile(self, machine: Machine) -> m.Message:
        if machine.tile.ready:
            return self.random.choice((m.Follow(), m.Position(self.random.randrange(-1000, 500))))
        if machine.tile.size == 0 or machine.tile.levels:
            return m.TileBegin(-1000, 250, 4)
        return m.TileData(0, (60.0, 0.0, *[30.0] * 54)[: machine.tile.size])

    def _timed(self, machine: Machine) -> m.TimedEnvelope:
        ahead = self.random.choice((0, 0, 500, 2_000, -700, -3_000, 20_000, 999_999, 1_000_001))
        levels = [self.random.uniform(0, 60) for _ in range(self.random.choice((1, 5, 25, 56)))]
        period = self.random.choice((1, 50, 200, 500, 1_000, 65535))
        return m.TimedEnvelope((machine._now + ahead) % 2**32, period, tuple(levels))

    def _payload(self, kind: type[m.Message], machine: Machine) -> bytes:
        pick = self.random
        if kind in (m.Envelope, m.TileData):
            number = pick.choice((0, len(machine.tile.levels), 300))
            levels = [pick.uniform(0, 60) for _ in range(pick.choice((1, 2, 56)))]
            if pick.random() < 0.2:
                levels[pick.randrange(len(levels))] = pick.choice(ODD_VOLTS)
            count = len(levels) if pick.random() < 0.95 else pick.randrange(256)
            return struct.pack(f"<HB{len(levels)}f", number, count, *levels)
        if kind is m.TimedEnvelope:
            payload = bytearray(self._timed(machine).payload())
            if pick.random() < 0.4:
                payload[pick.randrange(len(payload))] = pick.randrange(256)
            return bytes(payload)
        if kind is m.Negotiate:
            return m.Negotiate(pick.choice((0, 1, 2, 2, 2, 2, 2, 65535))).payload()
        if kind is m.SwitchLoops:
            return m.SwitchLoops(pick.choice((0, 1, 1, 1, 2))).payload()
        if kind is m.SetLoops:
            payload = bytearray(m.SetLoops(GAINS).payload())
            for _ in range(pick.choice((0, 1, 1, 2, 4))):
                payload[pick.randrange(len(payload))] = pick.randrange(256)
            return bytes(payload)
        if kind is m.Report:
            return m.Report(pick.choice((0, 200, 1_000, 7_777, 199, 10**9, 10**9 + 1))).payload()
        if kind is m.SetLimits:
            payload = bytearray(m.limits_message(LIMITS).payload())
            if pick.random() < 0.7:
                payload[pick.randrange(len(payload))] = pick.randrange(256)
            return bytes(payload)
        if kind is m.TileBegin:
            begun = m.TileBegin(
                pick.choice((-1000, 0)), pick.choice((1, 250, 0)), pick.choice((1, 4, 56))
            )
            return begun.payload()
        if kind is m.Position:
            return m.Position(pick.choice((-1000, 0, 777, -(2**31), 2**31 - 1, 13000))).payload()
        return pick.randbytes(kind.LAYOUT.size)

    def _damaged(self, data: bytes) -> bytes:
        broken = bytearray(data)
        for _ in range(self.random.randint(1, 3)):
            at = self.random.randrange(len(broken))
            match self.random.randrange(3):
                case 0:
                    broken[at] ^= 1 << self.random.randrange(8)
                case 1:
                    del broken[at]
                    if not broken:
                        return b"\0"
                case _:
                    broken.insert(at, self.random.randrange(256))
        return bytes(broken)

    def pause(self) -> int:
        """µs to the next tick: mostly 0.5 ms, now and then none, long, or past the watchdog."""
        pick = self.random
        return pick.choices((500, 0, 1, 3_000, 12_000, 51_000, 300_000), (80, 4, 4, 6, 2, 2, 1))[0]
