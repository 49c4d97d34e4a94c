"""Time that is left of long work in steps."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from squeezefilm.core.progress import SayProgress, ShareProgress, about

PLATE_TAKES, DRAW_TAKES = 1.5, 0.008
"""Seconds of one solved plate, and of one drawn finger."""
_TOO_EARLY, _TOO_SHORT = 0.05, 1.0


class Steps:
    """Work in steps, which are told in words with the time that is left of all of them.

    `seconds` is how long each step is expected to take, in order. What is left of the present one
    is told from the shares that it took so far, and of those after it what is expected.
    """

    def __init__(
        self,
        say: SayProgress,
        seconds: Sequence[float],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._say, self._seconds, self._clock = say, list(seconds), clock

    def next(self) -> ShareProgress:
        """The listener to the next step; those before it are over."""
        expected, begun = self._seconds.pop(0), self._clock()

        def tell(text: str, fraction: float) -> None:
            passed, left = self._clock() - begun, sum(self._seconds)
            if fraction >= _TOO_EARLY:
                left += passed * (1 - fraction) / fraction
            else:
                left += max(expected - passed, 0.0)
            self._say(text if left < _TOO_SHORT else f"{text} ({about(left)} left)")

        return tell
