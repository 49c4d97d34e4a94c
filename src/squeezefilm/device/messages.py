"""What frames say: one frozen dataclass per message, with its type's number and its layout.

Volts are IEEE binary32, everything else is integer; all little-endian. A message checks nothing of
its own: the host's `Limits` and the device both refuse what is out of range. Only what the layout
cannot carry is refused here.
"""

from __future__ import annotations

import math
import struct
from dataclasses import astuple, dataclass
from typing import ClassVar, Self

import numpy as np

from squeezefilm.device.frames import Frame
from squeezefilm.device.safety import Limits
from squeezefilm.errors import InputError
from squeezefilm.quantities import Volt

MOST_LEVELS = 56
"""Amplitudes that fit one frame."""
LONGEST_TILE = 512
"""Amplitudes a device keeps of one tile."""


@dataclass(frozen=True, slots=True)
class Message:
    """A message of fixed layout; its fields are the payload in order."""

    TYPE: ClassVar[int] = -1
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<")

    def payload(self) -> bytes:
        """The payload's bytes. Raises `InputError` for a value the layout cannot carry."""
        values = astuple(self)
        if any(isinstance(value, float) and not math.isfinite(value) for value in values):
            raise InputError(f"{self} holds a voltage that is not finite; send a finite one")
        try:
            return self.LAYOUT.pack(*values)
        except (struct.error, OverflowError) as error:
            raise InputError(f"{self} does not fit its layout: {error}") from error

    def frame(self, sequence: int) -> Frame:
        """The frame that carries this message."""
        return Frame(self.TYPE, sequence % 65536, self.payload())

    @classmethod
    def read(cls, payload: bytes) -> Self | None:
        """The message in a payload, or None if its length is wrong."""
        if len(payload) != cls.LAYOUT.size:
            return None
        return cls(*cls.LAYOUT.unpack(payload))


@dataclass(frozen=True, slots=True)
class Hello(Message):
    """Opens a session and sets the sequence; taken in OFF and FAULT only."""

    TYPE: ClassVar[int] = 0x01
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<I")
    session: int


@dataclass(frozen=True, slots=True)
class Stop(Message):
    """Ramps to zero and disarms. Taken in every state, whatever its sequence number."""

    TYPE: ClassVar[int] = 0x02


@dataclass(frozen=True, slots=True)
class SetLimits(Message):
    """The limits, taken in OFF only, and only within the firmware's own; drops tile and envelope.

    V, V/s, V, V²·ms, mHz, mHz, permille, ms, and 1 where the touched side is insulated.
    """

    TYPE: ClassVar[int] = 0x03
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<fIfIIIHIB")
    voltage: Volt
    slew: int
    continuous_voltage: Volt
    heat: int
    lowest_frequency: int
    highest_frequency: int
    duty: int
    duty_window: int
    insulated: int


@dataclass(frozen=True, slots=True)
class Arm(Message):
    """OFF → ARMED, with the token of the newest status; the token is good once."""

    TYPE: ClassVar[int] = 0x04
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<I")
    token: int


@dataclass(frozen=True, slots=True)
class Start(Message):
    """ARMED → PLAYING at a carrier frequency (mHz)."""

    TYPE: ClassVar[int] = 0x05
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<I")
    frequency: int


@dataclass(frozen=True, slots=True)
class SetFrequency(Message):
    """Moves the carrier (mHz) while PLAYING."""

    TYPE: ClassVar[int] = 0x06
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<I")
    frequency: int


@dataclass(frozen=True, slots=True)
class Envelope(Message):
    """Amplitudes (V) from now on, one every `period` µs; the last one holds. While PLAYING."""

    TYPE: ClassVar[int] = 0x07
    period: int
    levels: tuple[Volt, ...]

    def payload(self) -> bytes:
        """The payload's bytes. Raises `InputError` for too many or not finite amplitudes."""
        return _levels_payload(self.period, self.levels)

    @classmethod
    def read(cls, payload: bytes) -> Self | None:
        """The message in a payload, or None if its length is wrong."""
        parts = _levels_read(payload)
        return None if parts is None else cls(*parts)


@dataclass(frozen=True, slots=True)
class TileBegin(Message):
    """Begins a tile: where its first amplitude lies and how far apart they are (µm); its size."""

    TYPE: ClassVar[int] = 0x08
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<iIH")
    origin: int
    pitch: int
    size: int


@dataclass(frozen=True, slots=True)
class TileData(Message):
    """The tile's amplitudes (V) from number `first`, which must be how many are there already."""

    TYPE: ClassVar[int] = 0x09
    first: int
    levels: tuple[Volt, ...]

    def payload(self) -> bytes:
        """The payload's bytes. Raises `InputError` for too many or not finite amplitudes."""
        return _levels_payload(self.first, self.levels)

    @classmethod
    def read(cls, payload: bytes) -> Self | None:
        """The message in a payload, or None if its length is wrong."""
        parts = _levels_read(payload)
        return None if parts is None else cls(*parts)


@dataclass(frozen=True, slots=True)
class Position(Message):
    """Where the finger is (µm): plays the tile there. While PLAYING."""

    TYPE: ClassVar[int] = 0x0A
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<i")
    x: int


@dataclass(frozen=True, slots=True)
class KeepAlive(Message):
    """Feeds the watchdog, and asks for a status."""

    TYPE: ClassVar[int] = 0x0B


@dataclass(frozen=True, slots=True)
class ClearFault(Message):
    """FAULT → OFF, once the output is at zero; names the fault it clears."""

    TYPE: ClassVar[int] = 0x0C
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<B")
    fault: int


@dataclass(frozen=True, slots=True)
class Status(Message):
    """The device's answer to every frame whose CRC was right."""

    TYPE: ClassVar[int] = 0x81
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<HBBBBIIIIII")
    answered_sequence: int
    reason: int
    state: int
    fault: int
    reserved: int
    token: int
    level: int
    accepted: int
    refused: int
    damaged: int
    session: int


COMMANDS: dict[int, type[Message]] = {
    kind.TYPE: kind
    for kind in (
        Hello, Stop, SetLimits, Arm, Start, SetFrequency, Envelope, TileBegin, TileData, Position,
        KeepAlive, ClearFault,
    )
}  # fmt: skip
"""What a host may send, by type."""


def limits_message(limits: Limits) -> SetLimits:
    """The limits as the wire carries them, each rounded to the safe side."""
    return SetLimits(
        _below(limits.voltage),
        int(limits.slew),
        _below(limits.continuous_voltage),
        int(limits.heat * 1e3),
        math.ceil(limits.lowest_frequency * 1e3),
        int(limits.highest_frequency * 1e3),
        int(limits.duty * 1e3),
        int(limits.duty_window * 1e3),
        1 if limits.insulation.strip() else 0,
    )


def _below(value: float) -> float:
    """The largest binary32 that is not above `value`."""
    near = np.float32(value)
    return float(near if float(near) <= value else np.nextafter(near, np.float32(0)))


def _levels_payload(number: int, levels: tuple[float, ...]) -> bytes:
    if not 1 <= len(levels) <= MOST_LEVELS:
        raise InputError(
            f"{len(levels)} amplitudes in one frame; 1 to {MOST_LEVELS} fit; send them in parts"
        )
    if not all(math.isfinite(level) for level in levels):
        raise InputError("an amplitude is not finite; the device refuses the whole frame")
    try:
        return struct.pack(f"<HB{len(levels)}f", number, len(levels), *levels)
    except (struct.error, OverflowError) as error:
        raise InputError(f"amplitudes that do not fit the layout: {error}") from error


def _levels_read(payload: bytes) -> tuple[int, tuple[float, ...]] | None:
    if len(payload) < 3:
        return None
    number, count = struct.unpack_from("<HB", payload)
    if not 1 <= count <= MOST_LEVELS or len(payload) != 3 + 4 * count:
        return None
    return number, struct.unpack_from(f"<{count}f", payload, 3)
