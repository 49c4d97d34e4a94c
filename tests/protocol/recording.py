"""What the Python twin did, as a script of calls and a record, to play to the firmware in C.

`firmware/host_harness.c` runs the script and gives a record of its own: on this computer, under
sanitizers, or built for Arm in an emulator.
"""

from __future__ import annotations

import cmath
import functools
import math
import random
import struct
from collections import Counter
from dataclasses import astuple, replace

from squeezefilm.instruments.control.gains import IdentifiedPlate, LoopAims, loop_gains
from squeezefilm.instruments.control.plate_loop import LOCKED
from squeezefilm.instruments.device.machine.device import TICK_PERIOD, Machine, next_token
from squeezefilm.instruments.device.machine.held import HeldPlate
from squeezefilm.instruments.device.machine.limits import DeviceLimits
from squeezefilm.instruments.device.machine.playing import Mode
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Deframer, State

from .adversary import GAINS, LIMITS, Adversary
from .test_frames import FINGER, PHASES, TEMPERATURE, check_the_session

MODES = list(Mode)
WIDE = DeviceLimits(voltage=100_000_000, highest_frequency=100_000_000)


class Finger:
    """A sensor and a pickup that both sides read."""

    def __init__(self) -> None:
        self.x = self.y = self.pickup = self.temperature = 0
        self.phases = (0, 0)
        self.touching = False

    def sensor(self) -> tuple[int, int, bool]:
        return self.x, self.y, self.touching

    def read_pickup(self) -> int:
        return self.pickup


class Recording:
    """A twin and what it was told; a `finger` gives it a sensor and a pickup."""

    def __init__(
        self,
        seed: int,
        own: DeviceLimits | None = None,
        finger: Finger | None = None,
        period: int = TICK_PERIOD,
    ) -> None:
        own = own or DeviceLimits()
        has = finger is not None
        self.twin = Machine(
            seed, own, finger and finger.sensor, finger and finger.read_pickup, period
        )
        if finger is not None:
            self.twin.loops = HeldPlate(lambda: finger.phases, lambda: finger.temperature)
        self.finger = finger
        self.script = bytearray(struct.pack("<B11I", ord("B"), *astuple(own), seed, has, period))
        self.record = bytearray()
        self.received = self.ticks = 0
        """How many bytes and ticks the twin was given."""
        self.seen = Counter[object]()
        """What it went through, where the stream counts that."""

    def receive(self, data: bytes, now: int) -> bytes:
        self._feed()
        self.script += struct.pack("<BII", ord("R"), now, len(data)) + data
        self.received += len(data)
        said = self.twin.receive(data, now)
        self.record += struct.pack("<I", len(said)) + said
        return said

    def tick(self, now: int) -> int:
        self._feed()
        self.script += struct.pack("<BI", ord("T"), now)
        self.ticks += 1
        level = self.twin.tick(now)
        self._said = self.twin.outgoing()
        self.record += struct.pack("<I", len(self._said)) + self._said + struct.pack("<I", level)
        return level

    def outgoing(self) -> bytes:
        """What it said in its last tick."""
        return self._said

    def trip(self) -> None:
        self.script += b"X"
        self.twin.trip()

    def look(self) -> None:
        """Compare the whole state here, and not only what it says."""
        self.script += b"S"
        twin, playing, loops = self.twin, self.twin.playing, self.twin.loops
        values = [
            twin.state, twin.fault, twin.level, twin.frequency, twin.loads.heat, twin.loads.used,
            twin.token, twin.session, twin.accepted, twin.refused, twin.damaged, twin.late_ticks,
            MODES.index(playing.mode), len(playing._queue), int(playing.dry), int(playing.late),
            int(twin.enabled), twin.level, twin.frequency, loops.revision, loops.gains is not None,
            loops.on, loops.wanted, *loops.state, *loops.command,
        ]  # fmt: skip
        self.record += struct.pack("<38q", *values)

    def _feed(self) -> None:
        if self.finger is not None:
            x, y, touching = self.finger.sensor()
            shown = (self.finger.pickup, *self.finger.phases, self.finger.temperature)
            fed = struct.pack("<BiiIIiii", ord("F"), x, y, touching, *shown)
            self.script += fed


@functools.cache
def page_session() -> Recording:
    """The session at the end of the protocol's page, whose answers are checked here as well."""
    finger = Finger()
    finger.x, finger.y, finger.touching, finger.pickup = FINGER
    finger.phases, finger.temperature = PHASES, TEMPERATURE
    recording = Recording(1, finger=finger)
    check_the_session(recording)
    recording.look()
    return recording


@functools.cache
def adversarial(seed: int, steps: int) -> Recording:
    """A host that means no good, with its finger anywhere and its clock over the wrap.

    Half of the searches of its loops it leaves alone until they have locked.
    """
    host, pick = Adversary(random.Random(seed)), random.Random(-seed - 1)
    finger = Finger() if seed % 4 else None
    recording = Recording(seed, WIDE, finger, pick.choice((50, 100, 500, 500, 500, 1000)))
    twin, seen = recording.twin, recording.seen
    now = 2**32 - pick.randrange(2_000_000)
    resonator, patient, started = Resonator(), False, False
    resonator.now = now
    for _ in range(steps):
        searching = twin.loops.on and twin.state is State.PLAYING and twin.loops.state.mode < LOCKED
        patient = searching and (patient if started else pick.random() < 0.5)
        started = searching
        if finger is not None:
            finger.x = pick.choice((0, -1000, 333, 777, 2**31 - 1, -(2**31), pick.randrange(9999)))
            finger.y, finger.touching = pick.randrange(-5000, 5000), pick.random() < 0.8
            finger.pickup = pick.randrange(2**32)
            finger.temperature = pick.randrange(-(2**31), 2**31)
        data = host.sensible(m.Envelope(500, (30.0,))) if patient else host.step(twin)
        cut = pick.randrange(len(data) + 1)
        for part in (data[:cut], data[cut:]):
            recording.receive(part, now)
        if pick.random() < 0.002:
            recording.trip()
        for elapsed in (500, 500) if patient else (host.pause(), 500):
            if finger is not None:
                finger.phases = resonator.shown(pick, twin, (now + elapsed) % 2**32)
            now = (now + elapsed) % 2**32
            recording.tick(now)
            for frame in Deframer().take(recording.outgoing()):
                assert frame is not None
                seen[m.ANSWERS[frame.type]] += 1
        recording.look()
        seen[twin.state] += 1
        seen[twin.playing.mode] += 1
        if twin.loops.on and twin.state is State.PLAYING:
            seen["loops", twin.loops.state.mode] += 1
        seen["dry"] += twin.playing.dry
        seen["late"] += twin.playing.late
        seen["late ticks"] += twin.late_ticks
    return recording


class Resonator:
    """The plate that `GAINS` are for, driven by a device, and the pickup's two phases of it (µV):
    what they are, most of the time, or whatever an input can show."""

    def __init__(self) -> None:
        self.z, self.now = 0j, 0

    def shown(self, pick: random.Random, twin: Machine, now: int) -> tuple[int, int]:
        half_bandwidth, ratio = GAINS.half_bandwidth * 1e-3, GAINS.ratio / 2**24
        off = (twin.frequency - GAINS.reference) * 1e-3
        rate = 1 + 1j * off / half_bandwidth
        rest = ratio * twin.level / rate
        elapsed = (now - self.now) % 2**32 * 1e-6
        self.z = rest + (self.z - rest) * cmath.exp(-rate * elapsed * 2 * math.pi * half_bandwidth)
        self.now = now
        if pick.random() < 0.01:
            return pick.choice((0, 2**31 - 1, -(2**31))), pick.choice((0, 2**31 - 1, -(2**31)))
        shown = self.z * cmath.exp(1j * (1.0 - 2 * math.pi * 1e-5 * off))
        return round(shown.real), round(shown.imag)


@functools.cache
def noise(seed: int, count: int) -> Recording:
    """Bytes that mean nothing, and runs of zeros and of what is longer than any frame."""
    pick = random.Random(seed)
    recording = Recording(seed)
    for now in range(count):
        data = pick.choices((pick.randbytes(50), bytes(3), b"\xff" * 60), (8, 1, 1))[0]
        recording.receive(data, now)
        recording.tick(now)
        recording.look()
    return recording


@functools.cache
def mauled(seed: int, size: int) -> Recording:
    """`size` bytes and more: good frames of sessions, cut, doubled, spliced and with bits flipped,
    in pieces of any size."""
    pick = random.Random(seed)
    host, sender = Adversary(random.Random(seed)), Machine(seed)
    frames = []
    for step in range(400):
        frames.append(host.step(sender))
        sender.receive(frames[-1], 500 * step)
        sender.tick(500 * step)
    recording, now = Recording(seed, WIDE, Finger()), pick.randrange(2**32)
    while recording.received < size:
        block = bytearray(b"".join(pick.choices(frames, k=40)))
        for _ in range(pick.randrange(30)):
            at, length = pick.randrange(len(block)), pick.randrange(300)
            match pick.randrange(4):
                case 0:
                    block[at] ^= 1 << pick.randrange(8)
                case 1:
                    del block[at : at + length % 7]
                case 2:
                    block[at:at] = block[at : at + length]
                case _:
                    block[at:at] = pick.randbytes(length % 9)
        at = 0
        while at < len(block):
            piece = block[at : at + pick.choice((1, 7, 60, 254, 500))]
            recording.receive(bytes(piece), now)
            at += len(piece)
            now = (now + pick.choice((0, 100, 500, 1_000, 60_000))) % 2**32
            recording.tick(now)
        recording.look()
    return recording


def _playing(own: DeviceLimits | None = None, finger: Finger | None = None) -> Recording:
    recording = Recording(1, own, finger)
    opening = [m.Hello(1), m.limits_message(LIMITS), m.Arm(1), m.Start(30_000_000)]
    for number, message in enumerate(opening, start=1):
        recording.receive(message.frame(number).encoded(), 0)
    return recording


@functools.cache
def tile_sweep() -> Recording:
    """A tile read everywhere, and sequence numbers that jump, stand and go back."""
    recording, sequence, now = _playing(), 4, 0
    tile = [m.TileBegin(-1000, 333, 5), m.TileData(0, (0.0, 60.0, 59.5, 0.1, 33.3))]
    knots = range(-1333, 1000, 333)  # the amplitudes themselves, and past either end
    sweep = [m.Position(x) for x in (*knots, *range(-1100, 500, 7))]
    for message in (*tile, *sweep):
        for ahead in (1, 0x8000, 0) if isinstance(message, m.Position) else (0x7FFF,):
            recording.receive(message.frame(sequence + ahead).encoded(), now)
            sequence += ahead if ahead < 0x8000 else 0
        now += 1000
        recording.tick(now)
        recording.look()
        recording.seen[recording.twin.level] += 1
    return recording


@functools.cache
def held_plate() -> Recording:
    """Loops that find a plate, hold it under a finger, rest, and lose it: it breaks off, and a
    search that ended is begun anew by the host."""
    plate = IdentifiedPlate(30e3, 150.0, 0.01, 1.0)
    gains = loop_gains(plate, LoopAims(29.7e3, 30.2e3, 60.0, 20.0))
    limits = replace(LIMITS, continuous_voltage=60.0, duty=1.0)
    finger = Finger()
    recording, now = Recording(1, WIDE, finger), 0
    opening = [m.Hello(1), m.limits_message(limits), m.Negotiate(2), m.SetLoops(gains)]
    opening += [m.SwitchLoops(1), m.Arm(1), m.Start(30_000_000), m.Envelope(1000, (30.0,))]
    later = {4000: m.Stop(), 4200: m.Arm(next_token(1)), 4210: m.Start(30_000_000)}
    later |= {4220: m.Envelope(1000, (30.0,)), 5000: m.Envelope(1000, (0.0,))}
    later |= {5200: m.Envelope(1000, (30.0,)), 9500: m.SwitchLoops(1)}
    turn, z, sequence = cmath.exp(1j), 0j, 0
    for tick in range(12_000):
        says = opening if tick == 0 else [later.get(tick, m.AskLoops())] if tick % 10 == 0 else []
        for message in says:
            sequence += 1
            recording.receive(message.frame(sequence).encoded(), now)
        load = 0.4 if 2500 < tick < 7000 else 0.0
        at = 40e3 if tick > 7000 else 29.9e3
        rate = 1.0 + load + 1j * (recording.twin.frequency * 1e-3 - at) / 100.0
        rest = 0.01 * recording.twin.level / rate
        z = rest + (z - rest) * cmath.exp(-rate * 0.063)
        shown = z * turn
        finger.phases, finger.temperature = (round(shown.real), round(shown.imag)), tick
        now += 100
        recording.tick(now)
        recording.seen["loops", recording.twin.loops.state.mode] += 1
        if tick % 100 == 0:
            recording.look()
    return recording


@functools.cache
def longest_work() -> Recording:
    """What takes a device longest: every call that is long, with the longest frame, queue, tile."""
    finger = Finger()
    finger.touching, finger.x, finger.pickup = True, 55_555, 2**32 - 1
    recording, sequence, now = _playing(WIDE, finger), 4, 0
    levels = tuple(1.0 + 1.03 * i for i in range(m.MOST_LEVELS))  # most bits of a binary32 are set
    tile = [m.TileData(first, levels) for first in range(0, 504, m.MOST_LEVELS)]
    messages = [m.Report(200), m.TileBegin(-77, 999, 512), *tile, m.TileData(504, levels[:8])]
    messages += [m.Envelope(1, levels), m.Follow(), m.AskInfo(), m.Envelope(65_535, levels)]
    # A queue of 504, one µs apart, is filled, then put in the place of itself, then passed at once.
    for start in (46_000, 46_000, 46_200):
        messages += [m.TimedEnvelope(start + at, 1, levels) for at in range(0, 504, m.MOST_LEVELS)]
    for message in messages:
        sequence += 1
        now += 1_000
        # It advances the device as a tick does, with a reading, and then has a tick of its own.
        recording.receive(message.frame(sequence).encoded(), now)
        recording.tick(now + 400)
        recording.look()
    for now in (46_000, 46_250, 55_000):
        recording.tick(now)
        recording.look()
    for junk in (b"\x01" * 253 + b"\0", b"\xff" * 600 + b"\0"):
        recording.receive(junk, now)
    recording.look()
    return recording


SESSIONS = (page_session, tile_sweep, longest_work, held_plate)
"""Those that a test plays to whatever runs the firmware."""
