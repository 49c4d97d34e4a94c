"""Framing: published COBS vectors, byte scripts of the protocol's page, and a line that lies."""

import random
import re
import zlib
from pathlib import Path
from typing import Protocol

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.machine.held import HeldPlate
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import (
    LONGEST_PAYLOAD,
    Deframer,
    Frame,
    cobs_decode,
    cobs_encode,
    frame_from_bytes,
)

PAGE = Path(__file__).parents[2] / "docs" / "development" / "protocol.md"

# The examples of Cheshire & Baker's method as widely published (runs around 254 among them).
VECTORS = [
    (b"", "01"),
    (b"\0", "01 01"),
    (b"\0\0", "01 01 01"),
    (b"\0\x11\0", "01 02 11 01"),
    (bytes.fromhex("11220033"), "03 11 22 02 33"),
    (bytes.fromhex("11223344"), "05 11 22 33 44"),
    (bytes.fromhex("11000000"), "02 11 01 01 01"),
    (bytes(range(1, 255)), "FF" + bytes(range(1, 255)).hex()),
    (bytes(range(255)), "01 FF" + bytes(range(1, 255)).hex()),
    (bytes(range(1, 256)), "FF" + bytes(range(1, 255)).hex() + "02 FF"),
    (bytes(range(2, 256)) + b"\0", "FF" + bytes(range(2, 256)).hex() + "01 01"),
    (bytes(range(3, 256)) + b"\0\x01", "FE" + bytes(range(3, 256)).hex() + "02 01"),
]


@pytest.mark.parametrize(("data", "stuffed"), VECTORS)
def test_cobs_vectors(data: bytes, stuffed: str) -> None:
    assert cobs_encode(data) == bytes.fromhex(stuffed)
    assert cobs_decode(bytes.fromhex(stuffed)) == data


@given(st.binary(max_size=1100))
def test_cobs_round_trip(data: bytes) -> None:
    stuffed = cobs_encode(data)
    assert 0 not in stuffed
    assert len(stuffed) <= max(1, len(data) + -(-len(data) // 254))
    assert cobs_decode(stuffed) == data


@pytest.mark.parametrize("bad", ["00", "05 11 22", "03 00 11", "02 11 09"])
def test_cobs_refuses_what_is_no_block(bad: str) -> None:
    with pytest.raises(InputError, match="no COBS block"):
        cobs_decode(bytes.fromhex(bad))


def test_the_crc_is_the_one_the_page_names() -> None:
    assert zlib.crc32(b"123456789") == 0xCBF43926
    assert "0xCBF43926" in PAGE.read_text(encoding="utf-8")


FINGER = (12_000, 3_000, True, 250_000)
"""x and y (µm), touching, and the pickup (µV), as the page has them."""
PHASES, TEMPERATURE = (150_000, 200_000), 31_500
"""The pickup in phase with the drive and 90° ahead (µV); of the plate (1/1000 °C)."""


class Device(Protocol):
    """What plays the page's session: the machine in Python, or the firmware in C."""

    def receive(self, data: bytes, now: int) -> bytes: ...

    def tick(self, now: int) -> int: ...

    def outgoing(self) -> bytes: ...


def page_machine() -> Machine:
    loops = HeldPlate(lambda: PHASES, lambda: TEMPERATURE)
    return Machine(1, sensor=lambda: FINGER[:3], pickup=lambda: FINGER[3], loops=loops)


def script() -> list[tuple[str, bytes, int]]:
    """The page's session: ('>' host, '<' device or '@' a tick; bytes; the time in µs)."""
    steps, now = [], 0
    for way, text in re.findall(r"^([<>@]) ([0-9A-F ]+)$", PAGE.read_text("utf-8"), re.MULTILINE):
        now = int(text) if way == "@" else now
        steps.append((way, b"" if way == "@" else bytes.fromhex(text), now))
    return steps


def check_the_session(device: Device) -> None:
    said = b""
    for way, data, now in script():
        if way == "<":
            assert said[: len(data)] == data
            said = said[len(data) :]
            continue
        assert said == b""
        if way == "@":
            device.tick(now)
            said = device.outgoing()
        else:
            said = device.receive(data, now)
    assert said == b""


def test_the_page_holds_a_whole_session() -> None:
    types = [frame_from_bytes(data[:-1]).type for way, data, _ in script() if way == ">"]
    assert sorted(types) == sorted(m.COMMANDS.keys() - {6, 0x0C})
    answers = {frame_from_bytes(data[:-1]).type for way, data, _ in script() if way == "<"}
    assert answers == set(m.ANSWERS)


def test_the_session_of_the_page_byte_for_byte() -> None:
    check_the_session(page_machine())


def test_the_session_of_the_page_split_at_every_byte() -> None:
    whole = b"".join(data for way, data, _ in script() if way == "<")
    sent = sum(len(data) for way, data, _ in script() if way == ">")
    for cuts in (*({cut} for cut in range(sent + 1)), set(range(sent))):
        machine, said, at = page_machine(), b"", 0
        for way, data, now in script():
            if way == "@":
                machine.tick(now)
            elif way == ">":
                pieces = [0, *sorted(cut - at for cut in cuts if at < cut < at + len(data))]
                for piece, end in zip(pieces, [*pieces[1:], len(data)], strict=True):
                    said += machine.receive(data[piece:end], now)
                at += len(data)
            said += machine.outgoing()
        assert said == whole


def test_a_frame_too_long_is_damaged_and_the_next_is_read() -> None:
    good = Frame(0x0B, 5).encoded()
    deframer = Deframer()
    assert list(deframer.take(b"\x07" * 10_000 + b"\0" + good)) == [None, Frame(0x0B, 5)]
    assert deframer.damaged == 1
    longest = Frame(7, 65535, bytes(LONGEST_PAYLOAD))
    assert list(deframer.take(longest.encoded())) == [longest]
    with pytest.raises(InputError, match="at most 244"):
        Frame(7, 0, bytes(LONGEST_PAYLOAD + 1)).encoded()


@pytest.mark.parametrize("volts", [float("nan"), float("inf"), 1e39])
def test_a_host_cannot_send_what_is_no_voltage(volts: float) -> None:
    with pytest.raises(InputError):
        m.Envelope(1000, (1.0, volts)).payload()
    with pytest.raises(InputError):
        m.SetLimits(volts, 1, 1.0, 1, 1, 1, 1, 1, 1).payload()


def accepted_over_a_bad_line(frames: int, seed: int) -> tuple[int, int, int, int]:
    """(accepted, corrupt among them, damaged, sent) over bit errors, drops, doubles and swaps."""
    rng = np.random.default_rng(seed)
    order = random.Random(seed)
    deframer = Deframer()
    accepted = corrupt = sent = 0
    while sent < frames:
        batch = [
            Frame(order.randrange(256), (sent + i) % 65536, order.randbytes(order.randrange(40)))
            for i in range(500)
        ]
        sent += len(batch)
        known = set(batch)
        stream = [frame.encoded() for frame in batch]
        for i in range(0, 500, 50):
            stream.insert(i, stream[i])
            stream[i + 5], stream[i + 6] = stream[i + 6], stream[i + 5]
        wire = np.frombuffer(b"".join(stream), dtype=np.uint8)
        rate = 10 ** rng.uniform(-4, -2)
        flips = np.packbits(rng.random((wire.size, 8)) < rate, axis=1)[:, 0]
        wire = wire ^ flips
        if order.random() < 0.5:
            wire = wire[rng.random(wire.size) >= 0.01]
        for frame in deframer.take(wire.tobytes() + b"\0"):
            if frame is not None:
                accepted += 1
                corrupt += frame not in known
    return accepted, corrupt, deframer.damaged, sent


def check_the_bad_line(frames: int, seed: int) -> None:
    accepted, corrupt, damaged, sent = accepted_over_a_bad_line(frames, seed)
    assert corrupt == 0
    # The line is bad, and not so bad that nothing was tested.
    assert sent >= frames
    assert accepted > 0.3 * sent
    assert damaged > 0.2 * sent


@pytest.mark.slow
def test_no_corrupt_frame_of_a_hundred_thousand_is_accepted() -> None:
    check_the_bad_line(100_000, seed=1)


@pytest.mark.nightly
def test_no_corrupt_frame_of_a_million_is_accepted() -> None:
    check_the_bad_line(1_000_000, seed=2)


def test_a_device_takes_each_frame_once_and_never_backwards() -> None:
    order = random.Random(3)
    machine = Machine()
    machine.receive(m.Hello(1).frame(65_000).encoded(), 0)
    plan = list(range(65_001, 66_200))  # over the wrap
    for i in range(0, len(plan) - 4, 4):
        if order.random() < 0.5:
            plan[i : i + 4] = order.sample(plan[i : i + 4], 4)
    plan = [n for n in plan for _ in range(order.choice((1, 1, 2)))]
    taken = []
    for number in plan:
        before = machine.accepted
        machine.receive(m.KeepAlive().frame(number).encoded(), 0)
        if machine.accepted > before:
            taken.append(number)
    assert taken == sorted(set(taken))
    assert 0.5 * 1199 < len(taken) < 1199
    assert machine.accepted + machine.refused == len(plan) + 1
