"""The firmware in C, built on this machine, does what its Python twin does, byte for byte."""

import ctypes
import os
import random
import shutil
import subprocess
from collections import Counter
from dataclasses import astuple
from pathlib import Path

import pytest

from squeezefilm.device import messages as m
from squeezefilm.device.cobs import cobs_encode
from squeezefilm.device.frames import Deframer
from squeezefilm.device.machine import TICK_PERIOD, DeviceLimits, Machine, State
from squeezefilm.device.playing import Mode

from .adversary import LIMITS, Adversary
from .test_frames import FINGER, VECTORS, check_the_session

SOURCES = Path(__file__).parents[2] / "firmware"
FLAGS = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2", "-shared", "-fPIC")


@pytest.fixture(scope="module")
def firmware(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """The firmware as a library. Without a C compiler it is skipped, but fails where CI=true."""
    compiler = next((path for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None)
    if compiler is None:
        reason = (
            "no C compiler found (looked for cc, gcc, clang) to build the firmware; install one"
        )
        if os.environ.get("CI") == "true":
            pytest.fail(f"CI=true must not skip this: {reason}")
        pytest.skip(reason)
    library = tmp_path_factory.mktemp("firmware") / "firmware.so"
    sources = [str(SOURCES / name) for name in ("squeezefilm_fw.c", "host_harness.c")]
    done = subprocess.run(
        [compiler, *FLAGS, *sources, "-o", str(library)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    loaded = ctypes.CDLL(str(library))
    loaded.host_answers.restype = ctypes.POINTER(ctypes.c_uint8)
    loaded.host_outgoing.restype = ctypes.c_size_t
    loaded.host_tick.restype = ctypes.c_uint32
    loaded.sf_crc32.restype = ctypes.c_uint32
    loaded.sf_cobs_encode.restype = ctypes.c_size_t
    return loaded


class Finger:
    """A sensor and a pickup that both sides read."""

    def __init__(self) -> None:
        self.x = self.y = self.pickup = 0
        self.touching = False

    def sensor(self) -> tuple[int, int, bool]:
        return self.x, self.y, self.touching

    def read_pickup(self) -> int:
        return self.pickup


class Compiled:
    """The firmware with the twin's methods; a `finger` gives it a sensor and a pickup."""

    def __init__(
        self,
        library: ctypes.CDLL,
        seed: int,
        own: DeviceLimits,
        finger: Finger | None = None,
        period: int = TICK_PERIOD,
    ) -> None:
        self.library, self.finger = library, finger
        has = ctypes.c_int(finger is not None)
        limits = (ctypes.c_uint32 * 8)(*astuple(own))
        library.host_boot(limits, ctypes.c_uint32(seed), has, has, ctypes.c_uint32(period))

    def _feed(self) -> None:
        if self.finger is not None:
            x, y, touching = self.finger.sensor()
            level = ctypes.c_uint32(self.finger.pickup)
            self.library.host_feed(ctypes.c_int32(x), ctypes.c_int32(y), int(touching), level)

    def receive(self, data: bytes, now: int) -> bytes:
        self._feed()
        self.library.host_receive(data, ctypes.c_size_t(len(data)), ctypes.c_uint32(now))
        return self.outgoing()

    def outgoing(self) -> bytes:
        count = self.library.host_outgoing()
        return ctypes.string_at(self.library.host_answers(), count)

    def tick(self, now: int) -> int:
        self._feed()
        return int(self.library.host_tick(ctypes.c_uint32(now)))

    def snapshot(self) -> list[int]:
        room = (ctypes.c_int64 * 19)()
        self.library.host_snapshot(room)
        return list(room)


MODES = list(Mode)


def snapshot(twin: Machine) -> list[int]:
    playing = twin.playing
    return [
        twin.state, twin.fault, twin.level, twin.frequency, twin.loads.heat, twin.loads.used,
        twin.token, twin.session, twin.accepted, twin.refused, twin.damaged, twin.late_ticks,
        MODES.index(playing.mode), len(playing._queue), int(playing.dry), int(playing.late),
        int(twin.enabled), twin.level, twin.frequency,
    ]  # fmt: skip


def compare(firmware: ctypes.CDLL, seed: int, steps: int) -> Counter[object]:
    own = DeviceLimits(voltage=100_000_000, highest_frequency=100_000_000)
    host, pick = Adversary(random.Random(seed)), random.Random(-seed - 1)
    finger = Finger() if seed % 4 else None
    period = pick.choice((50, 100, 500, 1000))
    twin = Machine(seed, own, finger and finger.sensor, finger and finger.read_pickup, period)
    compiled = Compiled(firmware, seed, own, finger, period)
    now, seen = 2**32 - pick.randrange(2_000_000), Counter[object]()
    for step in range(steps):
        if finger is not None:
            finger.x = pick.choice((0, -1000, 333, 777, 2**31 - 1, -(2**31), pick.randrange(9999)))
            finger.y, finger.touching = pick.randrange(-5000, 5000), pick.random() < 0.8
            finger.pickup = pick.randrange(2**32)
        data = host.step(twin)
        cut = pick.randrange(len(data) + 1)
        for part in (data[:cut], data[cut:]):
            assert compiled.receive(part, now) == twin.receive(part, now), (seed, step)
        if pick.random() < 0.002:
            firmware.host_trip()
            twin.trip()
        for elapsed in (host.pause(), 500):
            now = (now + elapsed) % 2**32
            assert compiled.tick(now) == twin.tick(now), (seed, step)
            said = twin.outgoing()
            assert compiled.outgoing() == said, (seed, step)
            for frame in Deframer().take(said):
                assert frame is not None
                seen[m.ANSWERS[frame.type]] += 1
        assert compiled.snapshot() == snapshot(twin), (seed, step)
        seen[twin.state] += 1
        seen[twin.playing.mode] += 1
        seen["dry"] += twin.playing.dry
        seen["late"] += twin.playing.late
        seen["late ticks"] += twin.late_ticks
    return seen


def test_the_session_of_the_page_in_c(firmware: ctypes.CDLL) -> None:
    finger = Finger()
    finger.x, finger.y, finger.touching, finger.pickup = FINGER
    check_the_session(Compiled(firmware, 1, DeviceLimits(), finger))


def test_framing_in_c(firmware: ctypes.CDLL) -> None:
    assert firmware.sf_crc32(b"123456789", ctypes.c_size_t(9)) == 0xCBF43926
    pick = random.Random(1)
    blocks = [data for data, _ in VECTORS] + [pick.randbytes(n) for n in range(0, 800, 7)]
    for data in blocks:
        room = ctypes.create_string_buffer(len(data) + len(data) // 254 + 1)
        count = firmware.sf_cobs_encode(data, ctypes.c_size_t(len(data)), room)
        assert room.raw[:count] == cobs_encode(data)
        back = ctypes.create_string_buffer(max(1, len(data)))
        assert firmware.sf_cobs_decode(room.raw[:count], ctypes.c_size_t(count), back) == len(data)
        assert back.raw[: len(data)] == data


def test_c_and_python_do_the_same_on_adversarial_streams(firmware: ctypes.CDLL) -> None:
    seen = sum((compare(firmware, seed, 1_500) for seed in range(8)), Counter[object]())
    assert all(seen[state] > 100 for state in State), seen
    assert all(seen[mode] > 50 for mode in Mode), seen
    assert seen[m.Reading] > 500, seen
    assert min(seen["dry"], seen["late"], seen["late ticks"]) > 100, seen


def test_c_and_python_do_the_same_on_noise(firmware: ctypes.CDLL) -> None:
    pick = random.Random(9)
    twin, compiled = Machine(seed=9), Compiled(firmware, 9, DeviceLimits())
    for now in range(2_000):
        data = pick.choices((pick.randbytes(50), bytes(3), b"\xff" * 60), (8, 1, 1))[0]
        assert compiled.receive(data, now) == twin.receive(data, now)
        compiled.tick(now)
        assert compiled.snapshot() == snapshot(twin)
    assert twin.damaged > 200


@pytest.mark.nightly
def test_c_and_python_do_the_same_on_many_adversarial_streams(firmware: ctypes.CDLL) -> None:
    for seed in range(100, 200):
        compare(firmware, seed, 3_000)


def test_c_and_python_read_a_tile_and_jump_in_sequence_alike(firmware: ctypes.CDLL) -> None:
    twin, compiled = Machine(seed=1), Compiled(firmware, 1, DeviceLimits())
    levels = (0.0, 60.0, 59.5, 0.1, 33.3)
    sequence = now = 0
    opening = [m.Hello(1), m.limits_message(LIMITS), m.Arm(1), m.Start(30_000_000)]
    tile = [m.TileBegin(-1000, 333, 5), m.TileData(0, levels)]
    knots = range(-1333, 1000, 333)  # the amplitudes themselves, and past either end
    sweep = [m.Position(x) for x in (*knots, *range(-1100, 500, 7))]
    reached = set()
    for message in (*opening, *tile, *sweep):
        for ahead in (1, 0x8000, 0) if isinstance(message, m.Position) else (0x7FFF,):
            frame = message.frame(sequence + ahead).encoded()
            assert compiled.receive(frame, now) == twin.receive(frame, now)
            sequence += ahead if ahead < 0x8000 else 0
        now += 1000
        assert compiled.tick(now) == twin.tick(now)
        assert compiled.snapshot() == snapshot(twin)
        reached.add(twin.level)
    assert len(reached) > 40
