"""When a device sends its next reading."""

from __future__ import annotations

from dataclasses import dataclass

from squeezefilm.device.machine.playing import CLOCK, until
from squeezefilm.device.wire.states import Reason

SHORTEST_REPORT = 200
"""µs; readings more often than this would fill the wire."""
LONGEST_REPORT = 1_000_000_000
"""µs; 32 bits of µs cannot tell a longer one from one that has passed."""


@dataclass(slots=True)
class Reports:
    """A reading every `period` µs, none for 0; `due` is when the next one is. Not thread-safe."""

    period: int = 0
    due: int = 0

    def begin(self, now: int, period: int) -> Reason:
        """Every `period` µs from now on."""
        if period and not SHORTEST_REPORT <= period <= LONGEST_REPORT:
            return Reason.VALUE
        self.period, self.due = period, (now + period) & CLOCK
        return Reason.ACCEPTED

    def take(self, now: int) -> bool:
        """Whether one is due now. One that was missed is not made up; the phase is kept."""
        if self.period == 0:
            return False
        late = -until(self.due, now)
        if late < 0:
            return False
        self.due = (self.due + (late // self.period + 1) * self.period) & CLOCK
        return True
