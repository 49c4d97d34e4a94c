"""The device's clock and the host's: 32 bits of microseconds that wrap, against seconds.

A message cannot come before it was sent. So of all arrivals the one that took least time bounds the
offset between the clocks best, and what took longer is the link's jitter. Quartzes differ by some
hundred millionths at most: the bound is let creep by so much, to follow a drift either way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from squeezefilm.device.machine import CLOCK
from squeezefilm.quantities import Dimensionless, Second

WORST_DRIFT: Dimensionless = 300e-6
"""Relative rate between two quartz clocks that is followed; far above what crystals have."""


@dataclass(slots=True)
class DeviceClock:
    """Turns the device's time into the host's and back, from messages that came. Not thread-safe.

    What it calls the time of a reading is late by the shortest time a message takes on the link,
    which nobody can measure from one side.
    """

    offset: Second = math.nan
    _device: int = 0
    _last: int | None = None
    _heard: Second = math.nan

    def heard(self, device: int, host: Second) -> Second:
        """A message stamped `device` (µs) came at `host` (s); returns its time on the host's clock.

        Times may come out of order by less than 36 minutes.
        """
        unwrapped = self._unwrapped(device) * 1e-6
        bound = host - unwrapped
        if math.isnan(self.offset):
            self.offset, self._heard = bound, host
        else:
            self.offset += WORST_DRIFT * max(0.0, host - self._heard)
            self._heard = max(host, self._heard)
            self.offset = min(self.offset, bound)
        return unwrapped + self.offset

    def device_time(self, host: Second) -> int:
        """The device's clock (µs, 32 bits) at a time of the host (s). Needs one message before.

        Raises:
            ValueError: before the first message.
        """
        return round((host - self.offset) * 1e6) & CLOCK

    def _unwrapped(self, device: int) -> int:
        if self._last is None:
            self._device = device
        else:
            ahead = (device - self._last) & CLOCK
            self._device += ahead if ahead <= CLOCK // 2 else ahead - CLOCK - 1
        self._last = device
        return self._device
