"""The seams between a session and hardware, each one method wide, and a recording as a sensor.

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
from squeezefilm.core.errors import InputError


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
