"""The seams between a session and hardware, each one method wide, and a recording as a sensor.

A real device, its twin, a replay and a test's fake differ only below these. Nothing here raises
inside a real-time block: a fault zeroes the drive, and is raised on the caller's side.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from squeezefilm.core import quantities as si

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
