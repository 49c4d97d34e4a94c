"""Seams between a session and hardware, one method wide: a drive on a device, a recorded sensor.

A real device, its twin, a replay and a test's fake differ only below these. Nothing here raises
inside a real-time block: a fault zeroes the drive, and is raised on the caller's side.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic
from typing import Protocol

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.machine.playing import LONGEST_QUEUE, MOST_AHEAD
from squeezefilm.instruments.device.wire.arguments import number
from squeezefilm.instruments.device.wire.messages import MOST_LEVELS


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
    """Plays a recording's samples by a clock. Not thread-safe.

    The first sample comes at the first `read`; the others as much later as they were recorded.
    Samples carry times on that clock.

    Args:
        time: of each sample (s), shape (n,), rising.
        x, y: positions (m), shape (n,).
        touching: whether the finger touched, shape (n,); always where None.
        clock: the time (s).

    Raises:
        InputError: no samples, shapes that differ, times that do not rise, or values that are not
            finite.
    """

    def __init__(
        self,
        time: si.SecondArray,
        x: si.MetreArray,
        y: si.MetreArray,
        touching: si.FloatArray | None = None,
        clock: Callable[[], si.Second] = monotonic,
    ) -> None:
        if touching is None:
            touching = np.ones(np.shape(time))
        self._time, self._x, self._y = (np.asarray(values, dtype=float) for values in (time, x, y))
        self._touching = np.asarray(touching) != 0
        shapes = {a.shape for a in (self._time, self._x, self._y, self._touching)}
        if len(shapes) != 1 or self._time.ndim != 1 or self._time.size == 0:
            raise InputError(
                "a recording needs time, x, y and touching of one shape (n,) with n at least 1; "
                f"these have shapes {sorted(shapes)}"
            )
        si.require("time", self._time, si.Unit("s"))
        si.require("x", self._x, si.Unit("m"))
        si.require("y", self._y, si.Unit("m"))
        if np.any(np.diff(self._time) <= 0):
            at = int(np.argmax(np.diff(self._time) <= 0)) + 1
            raise InputError(
                f"the recording's time does not rise at sample {at} ({self._time[at]:g} s after "
                f"{self._time[at - 1]:g} s); sort it and drop doubled samples",
                quantity="time",
            )
        self._clock = clock
        self._began = math.nan
        self._given = 0

    @property
    def ended(self) -> bool:
        """True where the last sample has been read."""
        return self._given == self._time.size

    def read(self) -> FingerSample | None:
        """The newest sample whose time has come since the last call, or None."""
        now = self._clock()
        if math.isnan(self._began):
            self._began = now - float(self._time[0])
        come = int(np.searchsorted(self._time, now - self._began + 1e-12, side="right"))
        if come <= self._given:
            return None
        self._given = come
        at = come - 1
        return FingerSample(
            self._began + float(self._time[at]),
            float(self._x[at]),
            float(self._y[at]),
            bool(self._touching[at]),
        )


# It is called from the thread that owns the host, which also calls `DeviceHost.pump`.
LEAD: si.Second = 5e-3
"""How far ahead of its time an amplitude is sent: the jitter of the line that leaves no gap."""
STEERING: si.Dimensionless = 1e-3
"""Relative rate at which the stream follows the clocks' drift and better knowledge of them."""


class SerialDrive:
    """A stream of amplitudes, one every `period` (s), played on the device's clock without gaps.

    Blocks follow one another in time whenever they are sent, as long as that is before their time.
    A writer that was too late starts again `lead` ahead, and `gaps` counts it.

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
