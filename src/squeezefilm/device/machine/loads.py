"""Heat and time on, counted in integers, as the firmware counts them.

Heat is in mV²·µs above the continuous rating, never below zero; time on in µs·permille, as a
leaky bucket. Both count what the output really did, in every state and over any pause, so that
stopping and starting again does not reset them.
"""

from __future__ import annotations

from dataclasses import dataclass

MICROVOLTS = 1000
MOST = 1 << 62
"""Where the sums saturate; above every budget that the wire can carry."""


@dataclass(slots=True)
class Loads:
    """Sums of heat and of time on. Not thread-safe."""

    heat: int = 0
    used: int = 0

    def count(self, level: int, elapsed: int, continuous: int, duty: int) -> None:
        """Add `elapsed` µs at `level` µV; `continuous` µV and `duty` permille are the limits'."""
        # Rounded to the safe side: the level up, the rating down.
        volts = (level + MICROVOLTS - 1) // MICROVOLTS
        rating = continuous // MICROVOLTS
        self.heat = _moved(self.heat, volts * volts - rating * rating, elapsed)
        self.used = _moved(self.used, (1000 if level > 0 else 0) - duty, elapsed)


def _moved(total: int, rate: int, elapsed: int) -> int:
    return min(MOST, max(0, total + rate * elapsed))
