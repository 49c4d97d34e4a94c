"""Frames: a header, a payload and a CRC-32, stuffed by COBS and ended by a zero byte; and
the numbers that a host may send in one.

Before stuffing a frame is `version u8, type u8, sequence u16, payload, CRC-32 u32`, little-endian;
the CRC (that of zlib) covers everything before it, in every frame. `docs/development/protocol.md`
is the description byte by byte.
"""

from __future__ import annotations

import operator
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import HIGHEST_VOLTAGE
from squeezefilm.core.errors import InputError

VERSION = 1
LONGEST_FRAME = 252
"""Bytes of a frame before stuffing; one COBS block, so stuffing adds one byte."""
_HEADER = struct.Struct("<BBH")
_CRC = struct.Struct("<I")
OVERHEAD = _HEADER.size + _CRC.size
LONGEST_PAYLOAD = LONGEST_FRAME - OVERHEAD
_FULL_RUN = 254


def cobs_encode(data: bytes) -> bytes:
    """`data` without zero bytes, at most ⌈len/254⌉ bytes longer (one byte for no data).

    Consistent overhead byte stuffing, so that a zero can end a frame (Cheshire & Baker 1999,
    IEEE/ACM Trans. Networking 7, 159, 10.1109/90.769765).
    """
    out = bytearray()
    runs = data.split(b"\0")
    for number, run in enumerate(runs, start=1):
        rest = run
        while len(rest) > _FULL_RUN or (len(rest) == _FULL_RUN and number < len(runs)):
            out += b"\xff" + rest[:_FULL_RUN]
            rest = rest[_FULL_RUN:]
        out += bytes([len(rest) + 1]) + rest
    return bytes(out)


def cobs_decode(data: bytes) -> bytes:
    """Bytes that were encoded.

    Raises:
        InputError: a zero inside, or a code that points past the end.
    """
    out = bytearray()
    at = 0
    while at < len(data):
        code = data[at]
        end = at + code
        if code == 0 or end > len(data) or 0 in data[at + 1 : end]:
            raise InputError(f"{len(data)} bytes are no COBS block: bad code at byte {at}")
        out += data[at + 1 : end]
        if code < 255 and end < len(data):
            out.append(0)
        at = end
    return bytes(out)


@dataclass(frozen=True, slots=True)
class Frame:
    """One frame: its type, its sequence number (0…65535), what it carries, and its version."""

    type: int
    sequence: int
    payload: bytes = b""
    version: int = VERSION

    def encoded(self) -> bytes:
        """The bytes on the wire, the ending zero included.

        Raises:
            InputError: a payload or a number that does not fit.
        """
        if len(self.payload) > LONGEST_PAYLOAD:
            raise InputError(
                f"a payload of {len(self.payload)} bytes; at most {LONGEST_PAYLOAD} fit a frame; "
                "send it in parts"
            )
        try:
            body = _HEADER.pack(self.version, self.type, self.sequence) + self.payload
        except struct.error as error:
            raise InputError(f"a frame's type is one byte, its sequence two: {error}") from error
        return cobs_encode(body + _CRC.pack(zlib.crc32(body))) + b"\0"


def frame_from_bytes(stuffed: bytes) -> Frame:
    """The frame in the bytes between two zeros.

    Raises:
        InputError: bytes that are no frame, or whose CRC differs.
    """
    body = cobs_decode(stuffed)
    if not OVERHEAD <= len(body) <= LONGEST_FRAME:
        raise InputError(
            f"a frame of {len(body)} bytes; {OVERHEAD} to {LONGEST_FRAME} are allowed; read on"
        )
    (crc,) = _CRC.unpack_from(body, len(body) - _CRC.size)
    if zlib.crc32(body[: -_CRC.size]) != crc:
        raise InputError("a frame's CRC-32 differs from its bytes; drop it and read on")
    version, kind, sequence = _HEADER.unpack_from(body)
    return Frame(kind, sequence, body[_HEADER.size : -_CRC.size], version)


@dataclass(slots=True)
class Deframer:
    """Cuts a stream of bytes into frames, in any pieces. Not thread-safe.

    `damaged` counts what stood between two zeros and was no frame. Nothing is raised and memory
    is bounded: bytes past the longest frame are dropped until the next zero.
    """

    damaged: int = 0
    _bytes: bytes = b""

    def take(self, data: bytes) -> Iterator[Frame | None]:
        """Every frame that `data` completes; None for one that was damaged."""
        *whole, rest = (self._bytes + data).split(b"\0")
        self._bytes = rest[: LONGEST_FRAME + 2]
        for stuffed in filter(None, whole):
            try:
                yield frame_from_bytes(stuffed[: LONGEST_FRAME + 2])
            except InputError:
                self.damaged += 1
                yield None


class State(IntEnum):
    """State of the device."""

    OFF = 0
    ARMED = 1
    PLAYING = 2
    FAULT = 3


class Fault(IntEnum):
    """Reason of a fault."""

    NONE = 0
    WATCHDOG = 1
    HEAT = 2
    DUTY = 3
    LATE_TICK = 4
    TRIPPED = 5


class Reason(IntEnum):
    """Answer of the device to a frame."""

    ACCEPTED = 0
    VERSION = 1
    TYPE = 2
    LENGTH = 3
    SEQUENCE = 4
    STATE = 5
    VALUE = 6
    TOKEN = 7
    NO_LIMITS = 8
    TILE = 9
    FULL = 10
    NO_LOOPS = 11


# Anything else than what the wire can carry is refused here. The device refuses a whole frame for
# one bad number, when it is too late to say whose it was.
def number(name: str, value: Any, unit: si.Unit, at_least: float, at_most: float) -> float:
    """One finite number between two bounds in SI. Raises `InputError` for anything else."""
    array = _numbers(name, value, 0, f"one number in {unit.symbol}")
    # Every command of a loop in real time comes here: what is in order costs no more than this.
    if not at_least <= array <= at_most:
        si.require(name, array, unit, at_least=at_least, at_most=at_most)
    return float(array)


def whole_number(name: str, value: Any) -> int:
    """An integer. Raises `InputError` for anything else."""
    try:
        return operator.index(value)
    except TypeError as error:
        raise InputError(f"{name} is {value!r}; give a whole number", quantity=name) from error


def amplitudes(levels: Any, at_most: si.Volt = HIGHEST_VOLTAGE) -> si.FloatArray:
    """Amplitudes (V, zero-to-peak), shape (n,), each from 0 to `at_most`.

    Raises `InputError` for anything else.
    """
    array = _numbers("levels", levels, 1, "a row of amplitudes in V")
    if not (array.size and array.min() >= 0.0 and array.max() <= at_most):
        si.require("levels", array, si.Unit("V"), at_least=0.0, at_most=at_most)
    return array


def binary32_below(values: Any) -> np.ndarray[Any, np.dtype[np.float32]]:
    """The largest binary32 not above each value, which is not negative and below 1e38."""
    exact = np.asarray(values, dtype=float)
    near = exact.astype(np.float32)
    return np.where(near > exact, np.nextafter(near, np.float32(0)), near).astype(np.float32)


def _numbers(name: str, value: Any, dimensions: int, wanted: str) -> si.FloatArray:
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        array = np.asarray(None)
    if array.dtype.kind not in "biuf" or array.ndim != dimensions:
        raise InputError(f"{name} is {value!r:.60}; give {wanted}", quantity=name)
    return array.astype(float)
