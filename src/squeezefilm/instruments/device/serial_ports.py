"""A drive on a device, by its `DeviceHost`.

It is called from the thread that owns the host, which also calls `DeviceHost.pump`.
"""

from __future__ import annotations

import math

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import DeviceError
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.machine.playing import LONGEST_QUEUE, MOST_AHEAD
from squeezefilm.instruments.device.wire.arguments import number
from squeezefilm.instruments.device.wire.messages import MOST_LEVELS

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
