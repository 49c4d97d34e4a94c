"""A finger's free motion over the plane: places at times, straight lines between them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import MOTION_SAMPLES, require_within

_FARTHEST: si.Metre = 10.0
_ROUNDING = 1e-12


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class FingerPath:
    """A finger's recorded or drawn motion; between two samples it goes straight at constant speed.

    Its first time becomes 0. As a `Trajectory` it is what `rendered_stroke` needs of a motion
    along x; `OverPath` is the same motion along its own path.

    Args:
        time: rising (s), shape (n,), n ≥ 2.
        x, y: places (m), shape (n,), within ±10 m.

    Raises:
        InputError: arrays of other shapes, values that are not finite or too far, times that do
            not rise, or a finger that does not move at all.
    """

    time: si.SecondArray
    x: Annotated[si.MetreArray, si.AtLeast(-_FARTHEST), si.AtMost(_FARTHEST)]
    y: Annotated[si.MetreArray, si.AtLeast(-_FARTHEST), si.AtMost(_FARTHEST)]
    _way: si.FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        shapes = {np.shape(self.time), np.shape(self.x), np.shape(self.y)}
        if len(shapes) > 1 or len(self.time.shape) != 1 or self.time.size < 2:
            raise InputError(
                f"time, x and y of shapes {sorted(shapes)} are no motion; give three lists of one "
                "length, at least 2"
            )
        require_within(MOTION_SAMPLES, self.time.size)
        if np.any(np.diff(self.time) <= 0.0):
            raise InputError("the times of a motion must rise from each sample to the next")
        steps = np.hypot(np.diff(self.x), np.diff(self.y))
        way = np.concatenate([[0.0], np.cumsum(steps)])
        if way[-1] == 0.0:
            raise InputError("the finger does not move at all, so it meets no texture")
        object.__setattr__(self, "time", np.array(self.time, dtype=float) - float(self.time[0]))
        object.__setattr__(self, "_way", way)

    @property
    def duration(self) -> si.Second:
        """Time the whole motion takes (s)."""
        return float(self.time[-1])

    @property
    def length(self) -> si.Metre:
        """Length of the whole path (m)."""
        return float(self._way[-1])

    @property
    def along_x(self) -> bool:
        """True where the motion keeps to the line y = 0."""
        return not np.any(self.y)

    @si.checked_numbers
    def position(self, t: si.SecondLike) -> si.MetreArray:
        """x at time `t` since the motion began (m), in the shape of `t`.

        Raises:
            InputError: a time before the motion or after its end.
        """
        return self.place(t)[0]

    @si.checked_numbers
    def place(self, t: si.SecondLike) -> tuple[si.MetreArray, si.MetreArray]:
        """x and y at time `t` since the motion began (m). Raises as `position` does."""
        times = self._within(t)
        return (
            np.asarray(np.interp(times, self.time, self.x)),
            np.asarray(np.interp(times, self.time, self.y)),
        )

    @si.checked_numbers
    def travelled(self, t: si.SecondLike) -> si.MetreArray:
        """Length of the path up to time `t` (m); never falls. Raises as `position` does."""
        return np.asarray(np.interp(self._within(t), self.time, self._way))

    @si.checked_numbers
    def place_after(self, way: si.MetreLike) -> tuple[si.MetreArray, si.MetreArray]:
        """x and y once `way` of the path is done (m); straight on before its start and past its
        end, as one who has only heard of the motion so far would have it."""
        s = np.asarray(way, dtype=float)
        axes = []
        for places in (self.x, self.y):
            inside = np.interp(s, self._way, places)
            moving = np.flatnonzero(np.diff(self._way) > 0.0)
            for k, beyond in (
                (moving[0], np.minimum(s, 0.0)),
                (moving[-1], np.maximum(s - self.length, 0.0)),
            ):
                slope = (places[k + 1] - places[k]) / (self._way[k + 1] - self._way[k])
                inside = inside + slope * beyond
            axes.append(np.asarray(inside))
        return axes[0], axes[1]

    def _within(self, t: si.SecondLike) -> si.FloatArray:
        si.require("t", t, si.Unit("s"), at_least=0.0, at_most=self.duration * (1 + _ROUNDING))
        return np.asarray(t, dtype=float)


@dataclass(frozen=True, slots=True, eq=False)
class OverPath:
    """A motion in the plane as a `Trajectory` along its own path: its position is the way done.

    So a loop that knows one coordinate (sensor, estimator, compensation) renders a free motion;
    the sensor's errors then lie along the path.
    """

    path: FingerPath

    @property
    def duration(self) -> si.Second:
        """Time the whole motion takes (s)."""
        return self.path.duration

    @si.checked_numbers
    def position(self, t: si.SecondLike) -> si.MetreArray:
        """The way done at time `t` (m). Raises `InputError` for a time outside the motion."""
        return self.path.travelled(t)

    def __repr__(self) -> str:
        return (
            f"FingerPath of {self.path.time.size} samples, {self.path.length:.4g} m in "
            f"{self.path.duration:.4g} s"
        )
