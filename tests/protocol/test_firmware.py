"""The firmware in C, built on this machine, does what its Python twin does, byte for byte."""

import ctypes
import random
from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from squeezefilm.instruments.control.plate_loop import LOCKED, PROBING, SEARCHING
from squeezefilm.instruments.device.machine.limits import NO_LEVEL, level_of
from squeezefilm.instruments.device.machine.playing import Mode
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import LONGEST_PAYLOAD, Frame, State, cobs_encode

from .builds import Library, Sanitized
from .recording import (
    SESSIONS,
    Recording,
    adversarial,
    mauled,
    noise,
    tile_sweep,
)
from .test_frames import VECTORS

Bits = NDArray[np.uint32]
HIGHEST = 0x44FA0000  # 2000 V
# On one worker, so that what the twin did is made once.


def test_framing_in_c(library: Library) -> None:
    functions = library.functions
    assert functions.sf_crc32(b"123456789", ctypes.c_size_t(9)) == 0xCBF43926
    pick = random.Random(1)
    blocks = [data for data, _ in VECTORS] + [pick.randbytes(n) for n in range(0, 800, 7)]
    for data in blocks:
        room = ctypes.create_string_buffer(len(data) + len(data) // 254 + 1)
        count = functions.sf_cobs_encode(data, ctypes.c_size_t(len(data)), room)
        assert room.raw[:count] == cobs_encode(data)


def levels_in_c(library: Library, bits: Bits) -> NDArray[np.int32]:
    out = np.empty(bits.size, np.int32)
    library.functions.host_levels(
        ctypes.c_void_p(bits.ctypes.data),
        ctypes.c_size_t(bits.size),
        ctypes.c_void_p(out.ctypes.data),
    )
    return out


def levels_in_binary64(bits: Bits) -> NDArray[np.int32]:
    """`level_of`, of every element: the same operations on the same numbers."""
    volts = bits.view(np.float32)
    good = (volts >= 0) & (volts <= 2000)
    exact = np.where(good, volts, np.float32(0)).astype(float)
    return np.where(good, (exact * 1e6 + 0.5).astype(np.int32), NO_LEVEL)


def test_integers_give_the_microvolts_of_binary64(library: Library) -> None:
    pick = np.random.default_rng(3)
    # About every half of a uV up to 32 mV, about some up to 2000 V, and what may be odd.
    halves = np.concatenate([np.arange(32_768), pick.integers(0, 2_000_000_000, 20_000)]) + 0.5
    near = (halves * 1e-6).astype(np.float32).view(np.uint32)
    powers = np.arange(512, dtype=np.uint32) << np.uint32(23)
    edges = np.concatenate([powers, np.array([HIGHEST, 0x80000000, 0x7FC00000], np.uint32)])
    around = np.concatenate([near, edges])[:, None] + np.arange(-3, 4).astype(np.uint32)
    anywhere = pick.integers(0, 2**32, 100_000, dtype=np.uint32)
    accepted = pick.integers(0, HIGHEST + 1, 100_000, dtype=np.uint32)
    bits = np.concatenate([around.ravel(), anywhere, accepted])
    levels = levels_in_c(library, bits)
    assert np.array_equal(levels, levels_in_binary64(bits))
    some = slice(None, None, 40)
    one_by_one = [level_of(float(volts)) for volts in bits[some].view(np.float32)]
    assert levels[some].tolist() == one_by_one


@pytest.mark.parametrize(
    "parts",
    [pytest.param(8, marks=pytest.mark.nightly), pytest.param(1, marks=pytest.mark.campaign)],
    ids=["another eighth each night", "all"],
)
def test_integers_give_the_microvolts_of_binary64_for_every_binary32(
    library: Library, parts: int
) -> None:
    size, part = 1 << 24, random.SystemRandom().randrange(parts)
    print(f"part {part} of {parts}")
    for first in range(part * size, 2**32, parts * size):
        bits = np.arange(first, first + size, dtype=np.uint32)
        assert np.array_equal(levels_in_c(library, bits), levels_in_binary64(bits)), hex(first)


def framed(pick: random.Random) -> Recording:
    """A frame of every length, whose payload has no zero, some or nothing else; and of one more."""
    recording = Recording(1)
    for payload in range(LONGEST_PAYLOAD + 1):
        for data in (bytes(payload), pick.randbytes(payload), b"\xff" * payload):
            damaged = recording.twin.damaged
            recording.receive(Frame(0x7F, 1, data).encoded(), 0)
            assert recording.twin.damaged == damaged
            recording.look()
    too_long = cobs_encode(b"\x01\x7f\0\0" + bytes(LONGEST_PAYLOAD + 1 + 4)) + b"\0"
    for end in (b"\0", b"\x01\0", b"\xff" * 9 + b"\0"):
        recording.receive(too_long[:-1] + end, 0)
        recording.look()
    assert recording.twin.damaged == 3
    return recording


def test_frames_of_every_length(firmware: Library | Sanitized) -> None:
    recording = framed(random.Random(2))
    assert firmware.record(recording) == recording.record


@pytest.mark.parametrize("made", SESSIONS, ids=lambda m: m.__name__)
def test_what_the_twin_did(firmware: Library | Sanitized, made: Callable[[], Recording]) -> None:
    recording = made()
    assert firmware.record(recording) == recording.record
    if made is tile_sweep:
        assert len(recording.seen) > 40


def test_adversarial_streams(firmware: Library | Sanitized) -> None:
    seen = Counter[object]()
    for seed in (*range(8), 11):
        recording = adversarial(seed, 1_500)
        assert firmware.record(recording) == recording.record, f"seed {seed}"
        seen += recording.seen
    assert all(seen[state] > 100 for state in State), seen
    assert all(seen[mode] > 50 for mode in Mode), seen
    assert seen[m.Reading] > 500, seen
    assert min(seen["loops", mode] for mode in (SEARCHING, PROBING, LOCKED)) > 100, seen
    assert min(seen["dry"], seen["late"], seen["late ticks"]) > 100, seen


def test_noise(firmware: Library | Sanitized) -> None:
    recording = noise(9, 2_000)
    assert firmware.record(recording) == recording.record
    assert recording.twin.damaged > 200


@pytest.mark.slow
def test_mauled_sessions(firmware: Library | Sanitized) -> None:
    recording = mauled(10, 540_000)
    assert firmware.record(recording) == recording.record
    assert min(recording.twin.damaged, recording.twin.accepted) > 1_000
    # With the streams above it is a million bytes.
    others = [noise(9, 2_000), *(adversarial(seed, 1_500) for seed in range(8))]
    assert recording.received + sum(other.received for other in others) >= 1_000_000


@pytest.mark.nightly
@pytest.mark.parametrize("firmware", ["sanitized"], indirect=True)
def test_many_adversarial_streams(firmware: Library | Sanitized) -> None:
    first = random.SystemRandom().randrange(2**31)
    print(f"seeds {first} ... {first + 99}")
    for seed in range(first, first + 100):
        recording = adversarial.__wrapped__(seed, 3_000)
        assert firmware.record(recording) == recording.record, f"seed {seed}"
    recording = mauled.__wrapped__(first, 10_000_000)
    assert firmware.record(recording) == recording.record, f"seed {first}"
