"""Paths of a finger: strokes to and fro at constant speed or softly, and sampled paths."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Protocol

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import (
    FINGER_SPEED,
    MOTION_SAMPLES,
    PASS_DURATION,
    STROKE_LENGTH,
    STROKE_START,
    require_within,
)

# Times made by dividing integers by a rate may pass the end by a rounding error.
_ROUNDING = 1e-12


class Trajectory(Protocol):
    """A finger's motion along x: how long it lasts and where it is. `Stroke` is one."""

    @property
    def duration(self) -> si.Second:
        """Time the motion takes (s)."""
        ...

    @si.checked_numbers
    def position(self, t: si.SecondLike, /) -> si.MetreArray:
        """Position at time t (m), 0 ≤ t ≤ duration, in the shape of `t`."""
        ...


class _Passes:
    """Passes of one length along x, there and back."""

    __slots__ = ()
    length: si.Metre
    passes: int
    start: si.Metre
    pass_duration: si.Second

    @property
    def duration(self) -> si.Second:
        """Time the whole motion takes (s)."""
        return self.passes * self.pass_duration

    def _within(self, t: si.SecondLike) -> si.FloatArray:
        latest = self.duration * (1 + _ROUNDING)
        si.require("t", t, si.Unit("s"), at_least=0.0, at_most=latest)
        return np.asarray(t, dtype=float)

    def _placed(self, along: si.FloatArray, done: si.FloatArray) -> si.MetreArray:
        """x (m) where a pass is done up to `along` (m), after whole passes `done`."""
        return np.asarray(self.start + np.where(done % 2 == 0, along, self.length - along))


@reads_text
@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Stroke(_Passes):
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

    speed: Annotated[si.MetrePerSecond, FINGER_SPEED]
    length: Annotated[si.Metre, STROKE_LENGTH] = 0.04
    passes: Annotated[int, si.AtLeast(1)] = 1
    start: Annotated[si.Metre, STROKE_START] = 0.0

    @property
    def pass_duration(self) -> si.Second:  # type: ignore[override]
        """Time one pass takes (s)."""
        return self.length / self.speed

    @si.checked_numbers
    def position(self, t: si.SecondLike) -> si.MetreArray:
        """Position x of the finger at time `t` since the stroke began (m), in the shape of `t`.

        Raises:
            InputError: a time before the stroke or after its end.
        """
        path, done = self._path(t)
        along = np.clip(path - done * self.length, 0.0, self.length)
        return self._placed(along, done)

    @si.checked_numbers
    def velocity(self, t: si.SecondLike) -> si.MetrePerSecondArray:
        """Velocity along x at time `t` (m/s), in the shape of `t`: ±`speed`, negative on the way
        back; at a turn that of the pass that begins, at the end that of the last.

        Raises:
            InputError: a time before the stroke or after its end.
        """
        _, done = self._path(t)
        return np.asarray(np.where(done % 2 == 0, self.speed, -self.speed))

    def _path(self, t: si.SecondLike) -> tuple[si.MetreArray, si.FloatArray]:
        """The way gone (m) and the whole passes done by the time `t`."""
        path = np.minimum(self._within(t), self.duration) * self.speed
        return np.asarray(path), np.minimum(np.floor(path / self.length), self.passes - 1)


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class MinimumJerkStroke(_Passes):
    """A hand's motion along x: `passes` passes of `length`, each of least jerk, to and fro.

    Passes speed up, slow down and turn softly. Reaching movements of a hand follow x =
    L (10 s³ − 15 s⁴ + 6 s⁵), s = t/T, closely (T. Flash and N. Hogan 1985,
    10.1523/JNEUROSCI.05-07-01688.1985). As a trajectory it is what an estimator that believes in
    white jerk has to live with.

    Args:
        length: of one pass (m); above 0, at most 10 m.
        pass_duration: time one pass takes (s); above 0.
        passes: 1 is there, 2 there and back, and so on.
        start: x where the first pass begins (m); it goes towards +x.

    Raises:
        InputError: a value outside its range.
    """

    length: Annotated[si.Metre, STROKE_LENGTH] = 0.04
    pass_duration: Annotated[si.Second, PASS_DURATION] = 0.4
    passes: Annotated[int, si.AtLeast(1)] = 2
    start: Annotated[si.Metre, STROKE_START] = 0.0

    @si.checked_numbers
    def position(self, t: si.SecondLike) -> si.MetreArray:
        """Position x of the finger at time `t` since the motion began (m), in the shape of `t`.

        Raises:
            InputError: a time before the motion or after its end.
        """
        passed = self._within(t) / self.pass_duration
        done = np.minimum(np.floor(passed), self.passes - 1)
        s = np.clip(passed - done, 0.0, 1.0)
        along = self.length * s**3 * (10 + s * (6 * s - 15))
        return self._placed(along, done)


_FARTHEST: si.Metre = 10.0


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

    time: Annotated[si.SecondArray, si.Rising(2)]
    x: Annotated[si.MetreArray, si.AtLeast(-_FARTHEST), si.AtMost(_FARTHEST)]
    y: Annotated[si.MetreArray, si.AtLeast(-_FARTHEST), si.AtMost(_FARTHEST)]
    _way: si.FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        si.require_alike(time=self.time, x=self.x, y=self.y)
        require_within(MOTION_SAMPLES, self.time.size)
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
