"""What a display may be driven with, and which drives may play above touch-safe voltage.

The limits are refused, never clipped. They are set on the device, and the device holds them: the
host's copy only tells a mistake earlier.
"""

from __future__ import annotations

from squeezefilm.core.drive_limits import TOUCH_VOLTAGE, Limits
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.device.ports import Drive


def require_safe_drive(
    drive: Drive, limits: Limits, *, study: bool = False, bench_only: bool = False
) -> None:
    """Refuse a drive that does not stop by itself where that could hurt.

    A sound card plays on when its program hangs. It may be used on a bench that nobody is asked
    to touch, up to 42 V peak, by somebody who says so; never in a study.

    Args:
        drive: what drives the plate.
        limits: what it may give.
        study: whether participants touch it.
        bench_only: whether the user has said that this is a bench (`--bench-only`).

    Raises:
        InputError: a drive that does not stop by itself, above 42 V peak, in a study, or without
            `bench_only`.
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
    if study:
        raise InputError(
            f"{hangs}; in a study, where people touch the plate, it is not allowed at any "
            "voltage; use a device with a watchdog",
            quantity="drive",
        )
    if not bench_only:
        raise InputError(
            f"{hangs}; it is allowed on a bench that nobody touches by chance: say so with "
            "bench_only, or use a device with a watchdog",
            quantity="drive",
        )
