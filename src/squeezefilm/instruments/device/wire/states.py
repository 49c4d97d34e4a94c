"""States of a device, faults, and the fate of a frame: numbers on the wire."""

from __future__ import annotations

from enum import IntEnum


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
