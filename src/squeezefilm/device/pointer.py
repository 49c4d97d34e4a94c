"""A pointer whose events come from outside: a browser, a touch screen, a tracker's own program."""

from __future__ import annotations

import math
import threading

from squeezefilm.device.ports import FingerSample
from squeezefilm.errors import InputError


class PointerSensor:
    """Hands the newest event that was fed to whoever reads. `feed` and `read` may be two threads.

    `dropped` counts events that a newer one replaced before they were read, `stale` those that
    came out of order and were left out.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._newest: FingerSample | None = None
        self._last = -math.inf
        self.fed = self.dropped = self.stale = 0

    def feed(self, sample: FingerSample) -> None:
        """Take an event.

        Raises:
            InputError: a time or place that is not finite; the event is not taken.
        """
        if not all(math.isfinite(value) for value in (sample.time, sample.x, sample.y)):
            raise InputError(f"{sample} is no place at a time; feed finite numbers")
        with self._lock:
            if sample.time <= self._last:
                self.stale += 1
                return
            self.dropped += self._newest is not None
            self.fed += 1
            self._newest, self._last = sample, sample.time

    def read(self) -> FingerSample | None:
        """The newest event since the last call, or None."""
        with self._lock:
            newest, self._newest = self._newest, None
        return newest
