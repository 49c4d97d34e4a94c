"""Messages in frames: one frozen dataclass per message, with its type's number and its layout.

Volts are IEEE binary32, everything else is integer; all little-endian. What is within the limits of
a session is for the host and the device to say. Refused here is what the layout cannot carry, and
what no device takes for volts: below zero, above 2000 V, not finite.
"""

from __future__ import annotations

import math
import struct
import typing
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Annotated, Any, ClassVar, Self, TypeVar

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.control.plate_loop import LoopGains
from squeezefilm.instruments.device.wire.frames import Frame, amplitudes, binary32_below

T = TypeVar("T")

MOST_LEVELS = 56
"""Amplitudes that fit one frame."""
LONGEST_TILE = 512
"""Amplitudes a device keeps of one tile."""
REVISION = 2
"""Of the messages; a session has 1 until its host asks for more."""

# How a field stands on the wire, as `struct` names it.
U8 = Annotated[int, "B"]
U16 = Annotated[int, "H"]
U32 = Annotated[int, "I"]
I32 = Annotated[int, "i"]
Binary32 = Annotated[si.Volt, "f"]
Levels = tuple[si.Volt, ...]
"""Amplitudes at a payload's end: their count in one byte, then one binary32 after the other."""
Gains = Annotated[LoopGains, "23i"]

COMMANDS: dict[int, type[Message]] = {}
"""What a host may send, by type."""
ANSWERS: dict[int, type[Answer]] = {}
"""What a device may send, by type."""


@dataclass(frozen=True, slots=True)
class Message:
    """A message; its fields are the payload in order."""

    TYPE: ClassVar[int] = -1
    LAYOUT: ClassVar[struct.Struct] = struct.Struct("<")

    def payload(self) -> bytes:
        """The payload's bytes. Raises `InputError` for a value the layout cannot carry."""
        return self._packed(*(getattr(self, field.name) for field in fields(self)))

    def frame(self, sequence: int) -> Frame:
        """The frame that carries this message."""
        return Frame(self.TYPE, sequence % 65536, self.payload())

    @classmethod
    def read(cls, payload: bytes) -> Self | None:
        """The message in a payload, or None if its length is wrong."""
        if len(payload) != cls.LAYOUT.size:
            return None
        return cls(*cls.LAYOUT.unpack(payload))

    def _packed(self, *values: Any) -> bytes:
        try:
            return self.LAYOUT.pack(*values)
        except (struct.error, OverflowError, TypeError) as error:
            raise InputError(f"{self} does not fit its layout: {error}") from error


@typing.dataclass_transform(frozen_default=True)
def _message(number: int, known: dict[int, Any] = COMMANDS) -> Callable[[type[T]], type[T]]:
    """Make a class the message of a type's number, its layout read from its annotations."""

    def made(owner: type[Any]) -> Any:
        kind = dataclass(frozen=True, slots=True)(owner)
        hints = typing.get_type_hints(kind, include_extras=True)
        codes = (hints[field.name] for field in fields(kind))
        letters = ("B" if code == Levels else code.__metadata__[-1] for code in codes)
        kind.TYPE, kind.LAYOUT = number, struct.Struct("<" + "".join(letters))
        known[number] = kind
        return kind

    return made


@_message(0x01)
class Hello(Message):
    """Opens a session and sets the sequence; taken in OFF and FAULT only."""

    session: U32


@_message(0x02)
class Stop(Message):
    """Ramps to zero and disarms. Taken in every state, whatever its sequence number."""


@_message(0x03)
class SetLimits(Message):
    """The limits, taken in OFF only, and only within the firmware's own; drops tile and envelope.

    V, V/s, V, V²·ms, mHz, mHz, permille, ms, and 1 where the touched side is insulated.
    """

    voltage: Binary32
    slew: U32
    continuous_voltage: Binary32
    heat: U32
    lowest_frequency: U32
    highest_frequency: U32
    duty: U16
    duty_window: U32
    insulated: U8

    def payload(self) -> bytes:
        """The payload's bytes. Raises `InputError` for what is no voltage or does not fit."""
        amplitudes((self.voltage, self.continuous_voltage))
        return Message.payload(self)


@_message(0x04)
class Arm(Message):
    """OFF → ARMED, with the token of the newest status; the token is good once."""

    token: U32


@_message(0x05)
class Start(Message):
    """ARMED → PLAYING at a carrier frequency (mHz)."""

    frequency: U32


@_message(0x06)
class SetFrequency(Message):
    """Moves the carrier (mHz) while PLAYING."""

    frequency: U32


class _Levels(Message):
    """Whole numbers, and amplitudes (V) behind them."""

    __slots__ = ()

    def payload(self) -> bytes:
        """The payload's bytes. Raises `InputError` for too many, or what is no amplitude."""
        *numbers, levels = (getattr(self, field.name) for field in fields(self))
        volts = amplitudes(levels)
        if not 1 <= len(levels) <= MOST_LEVELS:
            raise InputError(
                f"{len(levels)} amplitudes in one frame; 1 to {MOST_LEVELS} fit; send them in parts"
            )
        return self._packed(*numbers, len(levels)) + volts.astype("<f4").tobytes()

    @classmethod
    def read(cls, payload: bytes) -> Self | None:
        """The message in a payload, or None if its length is wrong."""
        size = cls.LAYOUT.size
        if len(payload) < size:
            return None
        *numbers, count = cls.LAYOUT.unpack_from(payload)
        if not 1 <= count <= MOST_LEVELS or len(payload) != size + 4 * count:
            return None
        values = *numbers, struct.unpack_from(f"<{count}f", payload, size)
        return cls(*values)


@_message(0x07)
class Envelope(_Levels):
    """Amplitudes (V) from now on, one every `period` µs; the last one holds. While PLAYING."""

    period: U16
    levels: Levels


@_message(0x08)
class TileBegin(Message):
    """Begins a tile: where its first amplitude lies and how far apart they are (µm); its size."""

    origin: I32
    pitch: U32
    size: U16


@_message(0x09)
class TileData(_Levels):
    """The tile's amplitudes (V) from number `first`, which must be how many are there already."""

    first: U16
    levels: Levels


@_message(0x0A)
class Position(Message):
    """Place of the finger (µm): plays the tile there. While PLAYING."""

    x: I32


@_message(0x0B)
class KeepAlive(Message):
    """Feeds the watchdog, and asks for a status."""


@_message(0x0C)
class ClearFault(Message):
    """FAULT → OFF, once the output is at zero; names the fault it clears."""

    fault: U8


@_message(0x0D)
class Report(Message):
    """A reading every `period` µs from now on (at least 200), or none for 0. In every state."""

    period: U32


@_message(0x0E)
class Follow(Message):
    """Plays the tile at the device's own sensor, and nothing while it is not touched. PLAYING."""


@_message(0x0F)
class AskInfo(Message):
    """Asks for an info, which follows the status. In every state."""


@_message(0x10)
class TimedEnvelope(_Levels):
    """Amplitudes (V), the first at `start` on the device's clock (µs), then one every `period` µs.

    Takes the place of what was queued from `start` on; the last one holds. While PLAYING.
    """

    start: U32
    period: U16
    levels: Levels


@_message(0x11)
class Negotiate(Message):
    """Asks for the messages of a revision; capabilities follow the status. In every state.

    The session then has the lower of that and the device's own. A device of revision 1 does not
    know this message. The three below are of revision 2.
    """

    revision: U16


@_message(0x12)
class SetLoops(Message):
    """The gains of the plate's loops, within the limits; OFF only, and off until switched on."""

    gains: Gains

    def payload(self) -> bytes:
        """The payload's bytes. Raises `InputError` for a gain beyond 32 bits."""
        return self._packed(*self.gains)

    @classmethod
    def read(cls, payload: bytes) -> Self | None:
        """The message in a payload, or None if its length is wrong."""
        if len(payload) != cls.LAYOUT.size:
            return None
        return cls(LoopGains(*cls.LAYOUT.unpack(payload)))


@_message(0x13)
class SwitchLoops(Message):
    """Loops off for 0; for 1 on, with a new search, also where one had ended. Not in FAULT."""

    on: U8


@_message(0x14)
class AskLoops(Message):
    """Asks how the loops are, which follows the status. In every state."""


@_message(0x81, ANSWERS)
class Status(Message):
    """The device's answer to every frame whose CRC was right; `time` is its clock (µs)."""

    answered_sequence: U16
    reason: U8
    state: U8
    fault: U8
    reserved: U8
    token: U32
    level: U32
    accepted: U32
    refused: U32
    damaged: U32
    session: U32
    time: U32


@_message(0x82, ANSWERS)
class Reading(Message):
    """Readings of the device: its clock (µs), the finger (µm), its output (µV), its pickup (µV).

    `flags`: bit 0 a sensor is there, 1 a pickup is there, 2 a timed envelope ran dry since the
    last reading, 3 some of it came late. `late_ticks` counts since boot.
    """

    time: U32
    x: I32
    y: I32
    touching: U8
    state: U8
    fault: U8
    flags: U8
    level: U32
    pickup: U32
    late_ticks: U32


@_message(0x83, ANSWERS)
class Info(Message):
    """The firmware's own limits (µV, V/s, µV, V²·ms, mHz, permille, ms), and what it has."""

    voltage: U32
    slew: U32
    continuous_voltage: U32
    heat: U32
    lowest_frequency: U32
    highest_frequency: U32
    duty: U32
    duty_window: U32
    tick_period: U32
    has_sensor: U8
    has_pickup: U8
    longest_tile: U16
    firmware_version: U32


@_message(0x84, ANSWERS)
class Capabilities(Message):
    """The revision of the session's messages, and 1 where the device has loops."""

    revision: U16
    has_loops: U8


@_message(0x85, ANSWERS)
class Loops(Message):
    """State of the loops: the device's clock (µs), mode, flags, locks lost and false (modulo 256),
    carrier (mHz), detuning (half-bandwidths, 2^16), the pickup's amplitude as asked for and what
    it has above that (µV), the drive's reserve (µV), the finger's loss over the plate's own (2^16),
    the plate's temperature (1/1000 °C)."""

    time: U32
    mode: U8
    flags: U8
    lost: U8
    false_locks: U8
    frequency: U32
    detuning: I32
    target: I32
    error: I32
    reserve: I32
    load: I32
    temperature: I32


SENSOR_PRESENT, PICKUP_PRESENT, RAN_DRY, CAME_LATE = 1, 2, 4, 8
"""Flags of a reading."""
LOOPS_ON, LEVEL_HELD, FREQUENCY_HELD, TEMPERATURE_KNOWN = 1, 2, 4, 8
"""Flags of the loops' answer."""

Answer = Status | Reading | Info | Capabilities | Loops


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
