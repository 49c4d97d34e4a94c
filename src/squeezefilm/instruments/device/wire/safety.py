"""Voltages that a display may be driven with, and which drives may play above touch-safe voltage.

The limits are refused, never clipped. They are set on the device, and the device holds them: the
host's copy only tells a mistake earlier.
"""

from __future__ import annotations

from typing import Literal

from squeezefilm.core.drive_limits import TOUCH_VOLTAGE, Limits
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.device.ports import Drive

Use = Literal["own hand", "study", "bench"]
"""Who touches the plate: its user, participants, or nobody."""


def require_safe_drive(drive: Drive, limits: Limits, use: Use = "own hand") -> None:
    """Refuse a drive that does not stop by itself where that could hurt.

    A sound card plays on when its program hangs. It may be used on a bench that nobody is asked
    to touch, up to 42 V peak, by somebody who says so; never in a study.

    Args:
        drive: what drives the plate.
        limits: what it may give.
        use: whose hand touches the plate: the user's, participants' in a study, or nobody's on a
            bench, which the user has said (`--bench-only`).

    Raises:
        InputError: a drive that does not stop by itself, above 42 V peak or where a hand touches
            the plate.
    """
    if drive.stops_by_itself:
        return
    hangs = "this drive does not stop by itself when the program hangs"
    if limits.voltage > TOUCH_VOLTAGE:
        raise InputError(
            f"{hangs}, and voltage is {limits.voltage:g} V; such a drive may have at most "
            f"{TOUCH_VOLTAGE:g} V peak; lower it, or use a device with a watchdog",
            quantity="voltage",
        )
    if use == "study":
        raise InputError(
            f"{hangs}; in a study, where people touch the plate, it is not allowed at any "
            "voltage; use a device with a watchdog",
            quantity="drive",
        )
    if use != "bench":
        raise InputError(
            f"{hangs}; it is allowed on a bench that nobody touches by chance: say so with "
            "bench_only, or use a device with a watchdog",
            quantity="drive",
        )
