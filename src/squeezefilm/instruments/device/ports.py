"""The seams between a session and hardware, each one method wide: a sensor and a drive.

A real device, its twin, a replay and a test's fake differ only below these. Here are a recording as
a sensor, a device as a drive, and which drives may play where. Nothing here raises inside a
real-time block: a fault zeroes the drive, and is raised on the caller's side.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import TOUCH_VOLTAGE, Limits
from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.machine.playing import LONGEST_QUEUE, MOST_AHEAD
from squeezefilm.instruments.device.wire.frames import number
from squeezefilm.instruments.device.wire.messages import MOST_LEVELS

_REPLAY_PERIOD: si.Second = 1e-3


@dataclass(frozen=True, slots=True)
class FingerSample:
    """Place of the finger (m, in the plate's axes), its time (s, device clock), and contact."""

    time: si.Second
    x: si.Metre
    y: si.Metre
    touching: bool


class Sensor(Protocol):
    """A finger's position sensor."""

    def read(self) -> FingerSample | None:
        """The newest sample, or None if none came since the last call. Does not wait."""
        ...


class Drive(Protocol):
    """Converter of drive amplitudes into voltage on the plate."""

    @property
    def stops_by_itself(self) -> bool:
        """True where the output goes to zero on its own within 60 ms when the host falls silent."""
        ...

    def write(self, block: si.FloatArray) -> int:
        """Play the amplitudes (V, zero-to-peak) in `block`, shape (n,); returns how many fitted."""
        ...


class ReplaySensor:
    """Plays a recorded motion by a clock, a sample every millisecond. Not thread-safe.

    The first sample comes at the first `read`; samples carry times on that clock.

    Args:
        place: x and y (m) at times (s) since the motion began.
        duration: of the motion (s).
        clock: the time (s).
    """

    def __init__(
        self,
        place: Callable[[si.SecondArray], tuple[si.MetreArray, si.MetreArray]],
        duration: si.Second,
        clock: Callable[[], si.Second],
    ) -> None:
        self._time = np.arange(0.0, duration, _REPLAY_PERIOD)
        self._x, self._y = place(self._time)
        self._clock = clock
        self._began = math.nan
        self._given = 0

    def read(self) -> FingerSample | None:
        """The newest sample whose time has come since the last call, or None."""
        now = self._clock()
        if math.isnan(self._began):
            self._began = now
        come = int(np.searchsorted(self._time, now - self._began + 1e-12, side="right"))
        if come <= self._given:
            return None
        self._given = come
        at = come - 1
        time = self._began + float(self._time[at])
        return FingerSample(time, float(self._x[at]), float(self._y[at]), True)


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


LEAD: si.Second = 5e-3
"""How far ahead of its time an amplitude is sent: the jitter of the line that leaves no gap."""
STEERING: si.Dimensionless = 1e-3
"""Relative rate at which the stream follows the clocks' drift and better knowledge of them."""


class SerialDrive:
    """A stream of amplitudes, one every `period` (s), played on the device's clock without gaps.

    Blocks follow one another in time whenever they are sent, as long as that is before their time.
    A writer that was too late starts again `lead` ahead, and `gaps` counts it. For the thread that
    owns the host, which also calls `DeviceHost.pump`.

    Args:
        host: an open device, which must be PLAYING when `write` is called.
        period: between amplitudes (s); 20 µs to 65 ms.
        lead: how far ahead of its time the first amplitude is sent (s); at most 0.5 s, and at
            most half of what the device's queue holds.
    """

    def __init__(self, host: DeviceHost, period: si.Second, lead: si.Second = LEAD) -> None:
        self.host, self.period = host, number("period", period, si.Unit("s"), 20e-6, 65e-3)
        most = max(self.period, min(0.5, LONGEST_QUEUE * self.period / 2))
        self.lead = number("lead", lead, si.Unit("s"), 0.0, most)
        self.gaps = 0
        self._next = self._end = math.nan

    @property
    def stops_by_itself(self) -> bool:
        """True: the device's watchdog takes the output to zero within 60 ms."""
        return True

    def write(self, block: si.FloatArray) -> int:
        """Queue the amplitudes (V, zero-to-peak) in `block`, shape (n,); returns how many fitted.

        Raises:
            InputError: an amplitude that is not finite, below zero or above the limits.
            DeviceError: the device is gone, or no round trip has told its clock yet.
        """
        clock, now = self.host.clock, self.host.link.clock()
        if not clock.known:
            raise DeviceError(
                "the device's clock is not known yet; open and start the device first"
            )
        if math.isnan(self._next) or self._next < now:
            self.gaps += not math.isnan(self._next)
            self._next, self._end = now + self.lead, math.nan
        longest = min(LONGEST_QUEUE * self.period, MOST_AHEAD * 1e-6) - self.period
        room = max(0, math.floor((longest - (self._next - now)) / self.period))
        count = min(len(block), room)
        for first in range(0, count, MOST_LEVELS):
            part = block[first : min(count, first + MOST_LEVELS)]
            duration = len(part) * self.period
            start = clock.device_time(self._next)
            if not math.isnan(self._end):
                # Time is kept on the host's clock, so the queue neither fills nor empties by the
                # quartzes' drift; what is learnt of the device's clock is followed slowly, so
                # that no block runs into the next.
                most = STEERING * duration
                start = self._end + min(most, max(-most, start - self._end))
            self.host.play(part, self.period, clock.stamp(start))
            self._next, self._end = self._next + duration, start + duration
        return count
