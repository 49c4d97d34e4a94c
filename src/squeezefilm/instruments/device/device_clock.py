"""The device's clock against the host's: 32 bits of µs that wrap, against seconds.

A status says when the device answered; that was after the host sent the frame and before it heard
the answer. Each round trip so bounds the offset between the clocks from both sides (the method of
NTP, RFC 5905 §8, without its assumption that both ways take equally long: that is only the middle
of the bounds). A reading bounds it from one side. Bounds loosen with time, as quartzes drift.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from squeezefilm.core import quantities as si
from squeezefilm.instruments.device.machine.playing import CLOCK

WORST_DRIFT: si.Dimensionless = 200e-6
"""Relative rate between the clocks that is allowed for; a quartz has below 100e-6."""
# The device counts whole µs: bounds may cross by that much and contradict nothing.
_RESOLUTION: si.Second = 2e-6


@dataclass(slots=True)
class DeviceClock:
    """Estimate of the offset host − device. Not thread-safe.

    Times of the device are unwrapped: seconds since the first message, on from the device's own
    clock then. They may come out of order by less than 35 minutes.
    """

    lowest: si.Second = -math.inf
    highest: si.Second = math.inf
    _unwrapped: int = 0
    _last: int | None = None
    _widened: si.Second = -math.inf

    @property
    def known(self) -> bool:
        """True where a round trip has been seen."""
        return math.isfinite(self.lowest) and math.isfinite(self.highest)

    @property
    def error(self) -> si.Second:
        """Largest error of the offset (s); infinite before a round trip."""
        return (self.highest - self.lowest) / 2

    @property
    def offset(self) -> si.Second:
        """Host minus device (s), the middle of its bounds; not finite before a round trip."""
        return (self.highest + self.lowest) / 2

    def unwrapped(self, device: int) -> si.Second:
        """The device's time (s) of a stamp (µs, 32 bits), which never wraps."""
        if self._last is None:
            self._unwrapped = device
        else:
            ahead = (device - self._last + 0x80000000) & CLOCK
            self._unwrapped += ahead - 0x80000000
        self._last = device
        return self._unwrapped * 1e-6

    def answered(self, sent: si.Second, device: int, heard: si.Second) -> None:
        """A frame sent at `sent` (s) was answered at `device` (µs); heard at `heard` (s)."""
        self.heard(device, heard)
        time = self._unwrapped * 1e-6
        self.lowest = max(self.lowest, sent - time)
        if self.highest < self.lowest <= self.highest + _RESOLUTION:
            self.lowest = self.highest
        if self.lowest > self.highest:
            # The clocks drift faster than allowed, or one was set: believe the newest alone.
            self.lowest, self.highest = sent - time, heard - time

    def heard(self, device: int, heard: si.Second) -> None:
        """A message stamped `device` (µs) was heard at `heard` (s)."""
        time = self.unwrapped(device)
        if heard > self._widened:
            if math.isfinite(self._widened):
                drift = WORST_DRIFT * (heard - self._widened)
                self.lowest, self.highest = self.lowest - drift, self.highest + drift
            self._widened = heard
        self.highest = min(self.highest, heard - time)
        if self.lowest > self.highest + _RESOLUTION:
            self.lowest = -math.inf
        self.lowest = min(self.lowest, self.highest)

    def device_time(self, host: si.Second) -> si.Second:
        """The device's unwrapped time (s) at a time of the host (s)."""
        return host - self.offset

    def stamp(self, device: si.Second) -> int:
        """The 32 bits of µs of an unwrapped time of the device (s)."""
        return round(device * 1e6) & CLOCK
