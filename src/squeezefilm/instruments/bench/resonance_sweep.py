"""A device's resonance, swept with its own carrier and read at its own pickup.

Nobody may touch the plate meanwhile: a finger lowers the amplitude. The level is far below what
the display plays at, so that the sweep is safe even where the device is off.
"""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import DeviceError
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.wire.messages import Reading
from squeezefilm.instruments.session.play.plan import REPORT_PERIOD

READINGS = 16
"""Readings averaged at each carrier."""
PROMINENCE: si.Dimensionless = 1.1
"""A resonance is at least so many times what is read at the ends of the sweep."""
LIFT_LIMIT: si.Second = 10.0
"""Longest time of a finger on the plate before the sweep is given up."""
_DEAF_LIMIT: si.Second = 0.5
_MICROVOLT = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class ResonanceSweep:
    """Pickup amplitudes (V, less the floor heard in silence) at carriers (Hz), both shape (n,).

    `touched` says whether the device's sensor saw a finger at any of them.
    """

    carriers: si.HertzArray
    pickup: si.FloatArray
    touched: bool

    @property
    def peak(self) -> tuple[si.Hertz, si.Volt]:
        """The resonance (Hz) and the pickup's amplitude there (V), see `peak`.

        NaN where nothing stands out over the sweep's ends: far from its resonance a plate answers
        evenly, and the largest of even readings is noise.
        """
        if np.max(self.pickup) < PROMINENCE * max(self.pickup[0], self.pickup[-1]):
            return math.nan, math.nan
        return peak(self.carriers, self.pickup)


@si.checked_numbers
def sweep_resonance(
    host: DeviceHost,
    limits: Limits,
    carriers: Annotated[
        si.HertzArray, si.AtLeast("limits.lowest_frequency"), si.AtMost("limits.highest_frequency")
    ],
    voltage: Annotated[si.Volt, si.Above(0.0), si.AtMost("limits.voltage")],
    *,
    settle: si.Second,
    wait: Callable[[si.Second], None] = time.sleep,
) -> ResonanceSweep | None:
    """Sweep the carrier; None where the device has no pickup. Leaves it OFF.

    Args:
        host: of the device; opened here.
        limits: that the device is given.
        carriers: frequencies (Hz), shape (n,), rising in equal steps, within the limits.
        voltage: played at each (V, zero-to-peak), within the limits.
        settle: waited at each carrier before it is read (s).
        wait: lets time pass (s); no more than the watchdog's patience at once.

    Raises:
        InputError: a carrier or voltage outside the limits.
        DeviceError: a device that refuses, faults or goes silent, or a finger that stays on it.
    """
    if not host.open(limits).has_pickup:
        return None
    host.report(REPORT_PERIOD)
    _wait_for_lifting(host, wait)
    squares, touched = np.zeros(len(carriers)), False
    try:
        host.arm()
        host.start(float(carriers[0]))
        floor, _ = _mean_square(host, settle, wait)
        host.play([voltage], REPORT_PERIOD)
        for k, carrier in enumerate(carriers):
            host.set_frequency(float(carrier))
            squares[k], finger = _mean_square(host, settle, wait)
            touched = touched or finger
    except DeviceError:
        # Should this not reach it either, its watchdog is left.
        with contextlib.suppress(DeviceError):
            host.stop()
        raise
    host.stop()
    host.report(0.0)
    signal: si.FloatArray = np.sqrt(np.maximum(squares - floor, 0.0))
    return ResonanceSweep(carriers, signal, touched)


def peak(x: si.FloatArray, y: si.FloatArray) -> tuple[float, float]:
    """Place and height of the vertex of the parabola through the largest value and its
    neighbours; NaN where it lies at an end, so that nothing says where the peak is.

    `x` rises in equal steps; both have shape (n,) with n ≥ 3.
    """
    top = int(np.argmax(y))
    if top in (0, y.size - 1):
        return math.nan, math.nan
    left, middle, right = (float(value) for value in y[top - 1 : top + 2])
    bend = left - 2 * middle + right
    shift = 0.5 * (left - right) / bend if bend else 0.0
    step = float(x[1] - x[0])
    return float(x[top]) + shift * step, middle - 0.25 * (left - right) * shift


def _wait_for_lifting(host: DeviceHost, wait: Callable[[si.Second], None]) -> None:
    end = host.link.clock() + LIFT_LIMIT
    while any(reading.touching for reading in _readings(host, 1, wait)):
        if host.link.clock() > end:
            raise DeviceError(
                f"a finger was on the plate for {LIFT_LIMIT:g} s, and the resonance is measured "
                "without one; lift it, or look at the sensor, then try again"
            )


def _mean_square(
    host: DeviceHost, settle: si.Second, wait: Callable[[si.Second], None]
) -> tuple[float, bool]:
    """Mean square of the pickup's amplitude (V²) after settling, and whether a finger was there."""
    end = host.link.clock() + settle
    while host.link.clock() < end:
        host.pump()
        wait(REPORT_PERIOD)
    # What was on its way while the plate settled is left out.
    host.poll()
    heard = _readings(host, READINGS, wait)
    touched = any(reading.touching for reading in heard)
    return float(np.mean([(reading.pickup * _MICROVOLT) ** 2 for reading in heard])), touched


def _readings(host: DeviceHost, count: int, wait: Callable[[si.Second], None]) -> list[Reading]:
    heard: list[Reading] = []
    end = host.link.clock() + _DEAF_LIMIT
    while len(heard) < count:
        wait(REPORT_PERIOD)
        host.pump()
        heard += host.poll()
        if heard and heard[-1].fault:
            raise DeviceError(
                f"the device faulted while its resonance was measured (fault {heard[-1].fault}); "
                "run `squeezefilm device check`"
            )
        if host.link.clock() > end:
            raise DeviceError(
                f"the device sent {len(heard)} of {count} readings in {_DEAF_LIMIT:g} s; look at "
                "its power and its cable"
            )
    return heard
