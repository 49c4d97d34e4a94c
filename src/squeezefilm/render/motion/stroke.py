"""The stroke: a finger moving to and fro over a straight line at constant speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.errors import InputError
from squeezefilm.from_text import reads_text
from squeezefilm.hard_limits import (
    FINGER_SPEED,
    MOTION_SAMPLES,
    STROKE_LENGTH,
    STROKE_START,
)
from squeezefilm.quantities import (
    Above,
    AtLeast,
    FloatArray,
    Hertz,
    Metre,
    MetreArray,
    MetrePerSecond,
    MetrePerSecondArray,
    Second,
    SecondArray,
    SecondLike,
    Unit,
    checked_numbers,
    format_quantity,
    require,
)

# Times made by dividing integers by a rate may pass the end by a rounding error.
_ROUNDING = 1e-12


@reads_text
@checked_numbers
@dataclass(frozen=True, slots=True)
class Stroke:
    """A finger's motion along x: `passes` passes of `length` at constant `speed`, turning at once.

    Fingers explore at 10 to 200 mm/s; 77 to 86 mm/s were measured (Smith, Gosselin & Houde 2002,
    PHYSICS §5). The immediate turn is a simplification: a hand takes some 100 ms to reverse, in
    which speed, and so the lag in mm, is lower than here.

    Args:
        speed: along the path (m/s); above 0, at most 5 m/s.
        length: of one pass (m); above 0, at most 10 m.
        passes: 1 is there, 2 there and back, and so on.
        start: x where the first pass begins (m); it goes towards +x.

    Raises:
        InputError: a value outside its range.
    """

    speed: Annotated[MetrePerSecond, FINGER_SPEED]
    length: Annotated[Metre, STROKE_LENGTH] = 0.04
    passes: Annotated[int, AtLeast(1)] = 1
    start: Annotated[Metre, STROKE_START] = 0.0

    @property
    def pass_duration(self) -> Second:
        """Time one pass takes (s)."""
        return self.length / self.speed

    @property
    def duration(self) -> Second:
        """Time the whole stroke takes (s)."""
        return self.passes * self.pass_duration

    @checked_numbers
    def position(self, t: SecondLike) -> MetreArray:
        """Position x of the finger at time `t` since the stroke began (m), in the shape of `t`.

        Raises:
            InputError: a time before the stroke or after its end.
        """
        path, done = self._path(t)
        along = np.clip(path - done * self.length, 0.0, self.length)
        return np.asarray(self.start + np.where(done % 2 == 0, along, self.length - along))

    @checked_numbers
    def velocity(self, t: SecondLike) -> MetrePerSecondArray:
        """Velocity along x at time `t` (m/s), in the shape of `t`: ±`speed`, negative on the way
        back; at a turn that of the pass that begins, at the end that of the last.

        Raises:
            InputError: a time before the stroke or after its end.
        """
        _, done = self._path(t)
        return np.asarray(np.where(done % 2 == 0, self.speed, -self.speed))

    def _path(self, t: SecondLike) -> tuple[MetreArray, FloatArray]:
        """The way gone (m) and the whole passes done by the time `t`."""
        latest = self.duration * (1 + _ROUNDING)
        require("t", t, Unit("s"), at_least=0.0, at_most=latest)
        path = np.minimum(np.asarray(t, dtype=float), self.duration) * self.speed
        return np.asarray(path), np.minimum(np.floor(path / self.length), self.passes - 1)

    @checked_numbers
    def sampled(self, rate: Annotated[Hertz, Above(0.0)]) -> tuple[SecondArray, MetreArray]:
        """Times 0, 1/rate, 2/rate … within the stroke (s), and the positions at them (m).

        The last sample lies less than 1/rate before the stroke's end.

        Raises:
            InputError: a rate that is not above 0, too low for two samples, or so high that the
                stroke would take more than 20 million samples.
        """
        steps = self.duration * rate * (1 + _ROUNDING)
        if not 1 <= steps < MOTION_SAMPLES.most:
            lowest = format_quantity(1 / self.duration, Unit("Hz"))
            highest = format_quantity(MOTION_SAMPLES.most / self.duration, Unit("Hz"))
            raise InputError(
                f"rate = {format_quantity(rate, Unit('Hz'))} cannot be used for a stroke of "
                f"{format_quantity(self.duration, Unit('s'))}: it must be at least {lowest} and "
                f"below {highest}"
            )
        times = np.arange(math.floor(steps) + 1) / rate
        return times, self.position(times)
