"""What frames say: one frozen dataclass per message, with its type's number and its layout.

Volts are IEEE binary32, everything else is integer; all little-endian. What is within the limits of
a session is for the host and the device to say. Refused here is what the layout cannot carry, and
what no device takes for volts: below zero, above 2000 V, not finite.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Self

from squeezefilm import quantities as si
from squeezefilm.device.wire.arguments import amplitudes, binary32_below
from squeezefilm.device.wire.frames import Frame
from squeezefilm.device.wire.safety import Limits
from squeezefilm.errors import InputError

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
        try:
            return self.LAYOUT.pack(*(getattr(self, field.name) for field in fields(self)))
        except (struct.error, OverflowError, TypeError) as error:
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
    voltage: si.Volt
    slew: int
    continuous_voltage: si.Volt
    heat: int
    lowest_frequency: int
    highest_frequency: int
    duty: int
    duty_window: int
    insulated: int

    def payload(self) -> bytes:
        """The payload's bytes. Raises `InputError` for what is no voltage or does not fit."""
        amplitudes((self.voltage, self.continuous_voltage))
        return Message.payload(self)


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


class _Levels(Message):
    """A number of 16 bits, and amplitudes (V) behind it."""

    __slots__ = ()

    def payload(self) -> bytes:
        """The payload's bytes. Raises `InputError` for too many, or what is no amplitude."""
        return _levels_payload(*(getattr(self, field.name) for field in fields(self)))

    @classmethod
    def read(cls, payload: bytes) -> Self | None:
        """The message in a payload, or None if its length is wrong."""
        parts = _levels_read(payload)
        return None if parts is None else cls(*parts)


@dataclass(frozen=True, slots=True)
class Envelope(_Levels):
    """Amplitudes (V) from now on, one every `period` µs; the last one holds. While PLAYING."""

    TYPE: ClassVar[int] = 0x07
    period: int
    levels: tuple[si.Volt, ...]


@dataclass(frozen=True, slots=True)
class TileBegin(Message):
    """Begins a tile: where its first amplitude lies and how far apart they are (µm); its size."""

    TYPE: ClassVar[int] = 0x08
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<iIH")
    origin: int
    pitch: int
    size: int


@dataclass(frozen=True, slots=True)
class TileData(_Levels):
    """The tile's amplitudes (V) from number `first`, which must be how many are there already."""

    TYPE: ClassVar[int] = 0x09
    first: int
    levels: tuple[si.Volt, ...]


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
class Report(Message):
    """A reading every `period` µs from now on (at least 200), or none for 0. In every state."""

    TYPE: ClassVar[int] = 0x0D
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<I")
    period: int


@dataclass(frozen=True, slots=True)
class Follow(Message):
    """Plays the tile at the device's own sensor, and nothing while it is not touched. PLAYING."""

    TYPE: ClassVar[int] = 0x0E


@dataclass(frozen=True, slots=True)
class AskInfo(Message):
    """Asks for an info, which follows the status. In every state."""

    TYPE: ClassVar[int] = 0x0F


@dataclass(frozen=True, slots=True)
class TimedEnvelope(Message):
    """Amplitudes (V), the first at `start` on the device's clock (µs), then one every `period` µs.

    Takes the place of what was queued from `start` on; the last one holds. While PLAYING.
    """

    TYPE: ClassVar[int] = 0x10
    start: int
    period: int
    levels: tuple[si.Volt, ...]

    def payload(self) -> bytes:
        """The payload's bytes. Raises `InputError` for too many, or what is no amplitude."""
        try:
            start = struct.pack("<I", self.start)
        except (struct.error, TypeError) as error:
            raise InputError(f"{self.start} us is not on the device's clock: {error}") from error
        return start + _levels_payload(self.period, self.levels)

    @classmethod
    def read(cls, payload: bytes) -> Self | None:
        """The message in a payload, or None if its length is wrong."""
        parts = _levels_read(payload[4:])
        return None if parts is None else cls(int.from_bytes(payload[:4], "little"), *parts)


@dataclass(frozen=True, slots=True)
class Status(Message):
    """The device's answer to every frame whose CRC was right; `time` is its clock (µs)."""

    TYPE: ClassVar[int] = 0x81
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<HBBBBIIIIIII")
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
    time: int


@dataclass(frozen=True, slots=True)
class Reading(Message):
    """What the device measures: its clock (µs), the finger (µm), its output (µV), its pickup (µV).

    `flags`: bit 0 a sensor is there, 1 a pickup is there, 2 a timed envelope ran dry since the
    last reading, 3 some of it came late. `late_ticks` counts since boot.
    """

    TYPE: ClassVar[int] = 0x82
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<IiiBBBBIII")
    time: int
    x: int
    y: int
    touching: int
    state: int
    fault: int
    flags: int
    level: int
    pickup: int
    late_ticks: int


@dataclass(frozen=True, slots=True)
class Info(Message):
    """The firmware's own limits (µV, V/s, µV, V²·ms, mHz, permille, ms), and what it has."""

    TYPE: ClassVar[int] = 0x83
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<IIIIIIIIIBBHI")
    voltage: int
    slew: int
    continuous_voltage: int
    heat: int
    lowest_frequency: int
    highest_frequency: int
    duty: int
    duty_window: int
    tick_period: int
    has_sensor: int
    has_pickup: int
    longest_tile: int
    firmware_version: int


SENSOR_PRESENT, PICKUP_PRESENT, RAN_DRY, CAME_LATE = 1, 2, 4, 8
"""Flags of a reading."""

COMMANDS: dict[int, type[Message]] = {
    kind.TYPE: kind
    for kind in (
        Hello,
        Stop,
        SetLimits,
        Arm,
        Start,
        SetFrequency,
        Envelope,
        TileBegin,
        TileData,
        Position,
        KeepAlive,
        ClearFault,
        Report,
        Follow,
        AskInfo,
        TimedEnvelope,
    )
}
"""What a host may send, by type."""

Answer = Status | Reading | Info
ANSWERS: dict[int, type[Status] | type[Reading] | type[Info]] = {
    Status.TYPE: Status,
    Reading.TYPE: Reading,
    Info.TYPE: Info,
}
"""What a device may send, by type."""


def limits_message(limits: Limits) -> SetLimits:
    """The limits as the wire carries them, each rounded to the safe side."""
    return SetLimits(
        float(binary32_below(limits.voltage)),
        int(limits.slew),
        float(binary32_below(limits.continuous_voltage)),
        int(limits.heat * 1e3),
        math.ceil(limits.lowest_frequency * 1e3),
        int(limits.highest_frequency * 1e3),
        int(limits.duty * 1e3),
        int(limits.duty_window * 1e3),
        1 if limits.insulation.strip() else 0,
    )


def _levels_payload(number: int, levels: tuple[float, ...]) -> bytes:
    volts = amplitudes(levels)
    if not 1 <= len(levels) <= MOST_LEVELS:
        raise InputError(
            f"{len(levels)} amplitudes in one frame; 1 to {MOST_LEVELS} fit; send them in parts"
        )
    try:
        return struct.pack("<HB", number, len(levels)) + volts.astype("<f4").tobytes()
    except (struct.error, TypeError) as error:
        raise InputError(f"{number} before the amplitudes does not fit: {error}") from error


def _levels_read(payload: bytes) -> tuple[Any, ...] | None:
    """The number and the amplitudes, or None if the length is wrong."""
    if len(payload) < 3:
        return None
    number, count = struct.unpack_from("<HB", payload)
    if not 1 <= count <= MOST_LEVELS or len(payload) != 3 + 4 * count:
        return None
    return number, struct.unpack_from(f"<{count}f", payload, 3)
