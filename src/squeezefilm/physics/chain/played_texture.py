"""A texture on a display along a finger's way: what `rendered_stroke` asks at each step.

A loop knows one coordinate of the finger, the texture wants the plane: `PlayedTexture` turns the
one into the other and the texture's value, in whatever quantity, into the amplitude that makes it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import RENDER_STEPS, require_motion
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.plate.layout import Actuator, AnnularStator
from squeezefilm.physics.render.motion.stroke import (
    FingerPath,
    MinimumJerkStroke,
    OverPath,
    Stroke,
    Trajectory,
)
from squeezefilm.physics.render.program.inverse import FrictionInverse, WaveCompensation
from squeezefilm.physics.render.program.lowering import Program, lower
from squeezefilm.physics.render.program.renderer import evaluate
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.render.texture.image import Image
from squeezefilm.physics.render.texture.pattern import SpeedScaled
from squeezefilm.physics.texture_files.texture_file import TextureFile

_METRE = si.Unit("m")


@dataclass(frozen=True, slots=True, eq=False)
class FingerMotion:
    """A motion sampled at control steps: times (s), places (m) and the signed speed (m/s).

    `way` is the one coordinate a loop works with: x on a line, the length of the path in the plane.
    The speed is negative where x falls (where x stands still: where y falls).
    """

    trajectory: Trajectory
    time: si.SecondArray
    way: si.MetreArray
    x: si.MetreArray
    y: si.MetreArray
    speed: si.MetrePerSecondArray
    path: FingerPath | None

    @classmethod
    def of(cls, motion: Stroke | MinimumJerkStroke | FingerPath, rate: float) -> FingerMotion:
        """The motion at times 0, 1/rate, … (rate in Hz). Raises `InputError` for too few steps."""
        rounded = motion.duration * rate * (1 + 1e-12)
        require_motion(RENDER_STEPS, rounded, motion.duration, rate)
        steps = int(np.floor(rounded))
        time = np.minimum(np.arange(steps + 1) / rate, motion.duration)
        path = None
        trajectory: Trajectory = motion
        if isinstance(motion, FingerPath):
            x, y = motion.place(time)
            if not motion.along_x:
                path, trajectory = motion, OverPath(motion)
        else:
            x, y = motion.position(time), np.zeros(time.size)
        way = trajectory.position(time)
        if isinstance(motion, Stroke):
            # Turns at once: a difference over the turn would say that it stands still there.
            return cls(trajectory, time, way, x, y, motion.velocity(time), path)
        forward, sideways = np.gradient(x), np.gradient(y)
        sign = np.where(forward != 0.0, np.sign(forward), np.sign(sideways))
        speed = np.hypot(forward, sideways) * rate * sign
        return cls(trajectory, time, way, x, y, speed, path)


@dataclass(frozen=True, slots=True, eq=False)
class PlayedTexture:
    """The amplitude (m) a texture wants where the finger's way is `way`; see the module.

    A wanted friction becomes the amplitude that makes it at the speed the loop believes in. The
    velocity's sign is that of the true motion at the time asked: a loop's speed has none.
    Friction that cannot be reached is brought to the nearest that can.
    """

    name: str
    program: Program
    inverse: FrictionInverse
    motion: FingerMotion
    friction_coefficient: si.Dimensionless
    compensation: WaveCompensation | None = None
    spatial_period: si.Metre | None = None

    def __repr__(self) -> str:
        return self.name

    def __call__(
        self,
        way: si.MetreLike,
        _: si.MetreLike,
        speed: si.MetrePerSecondLike,
        time: si.SecondLike,
        /,
    ) -> si.MetreArray:
        """The amplitude wanted (m), in the shape of `way`."""
        x, y = self.place(way)
        t = np.maximum(np.broadcast_to(np.asarray(time, dtype=float), x.shape), 0.0)
        last = self.motion.time.size - 1
        step = np.clip(np.searchsorted(self.motion.time, t), 0, last)
        v = np.abs(speed) * np.where(self.motion.speed[step] < 0.0, -1.0, 1.0)
        amplitude = self.amplitude(evaluate(self.program, x, y, v, t), v)
        if self.compensation is not None:
            amplitude = amplitude / self.compensation.factor(x, y)
        return np.minimum(amplitude, self.program.largest_amplitude)

    def place(self, way: si.MetreLike) -> tuple[si.MetreArray, si.MetreArray]:
        """x and y (m) where the loop's coordinate is `way`."""
        if self.motion.path is None:
            return np.asarray(way, dtype=float), np.zeros(np.shape(way))
        return self.motion.path.place_after(way)

    def friction(self, values: si.FloatArray) -> si.DimensionlessArray:
        """Relative friction asked for by values of the texture in a frictional quantity (1)."""
        if self.program.quantity == "friction_reduction":
            return np.asarray(1.0 - values / self.friction_coefficient)
        return values

    def amplitude(self, values: si.FloatArray, speed: si.MetrePerSecondLike) -> si.MetreArray:
        """The amplitude (m) that makes values of the texture under a finger at speeds (m/s), as
        near as the display can."""
        if self.program.quantity == "amplitude":
            return np.clip(values, 0.0, self.program.largest_amplitude)
        least = self.inverse.least_friction_at(speed)
        return self.inverse.amplitude_for(np.clip(self.friction(values), least, 1.0), speed)


def single_period(texture: Composable, motion: Stroke | None = None) -> si.Metre | None:
    """The spatial period of a grating along x (m); None for any other texture.

    One that stretches with the speed has a period where the speed is steady, under a `Stroke`.
    """
    scaled = getattr(texture, "pattern", None)
    if isinstance(scaled, SpeedScaled):
        period = getattr(scaled.pattern, "spatial_period", None)
        if motion is None or period is None:
            return None
        speed = min(max(motion.speed, scaled.slowest), scaled.fastest)
        return float(period) * speed / scaled.reference_speed
    for holder in (texture, getattr(texture, "pattern", None)):
        along = getattr(holder, "along", None)
        period = getattr(holder, "spatial_period", None)
        if period is not None and (along is None or getattr(along, "type", "") == "x"):
            return float(period)
    return None


def require_on_image(texture: Composable, motion: FingerMotion) -> None:
    """Refuse a motion that leaves an image which does not say what lies outside of it."""
    for image in _images(texture):
        if image.outside != "hold":
            continue
        rows, columns = image._grid.shape
        left, bottom = image.left, image.bottom
        right, top = left + columns * image.pixel, bottom + rows * image.pixel
        slack = 1e-9
        beyond = (
            (motion.x < left - slack)
            | (motion.x > right + slack)
            | (motion.y < bottom - slack)
            | (motion.y > top + slack)
        )
        if np.any(beyond):
            k = int(np.flatnonzero(beyond)[0])
            raise InputError(
                f"the stroke leaves the image: at {motion.time[k]:.4g} s the finger is at "
                f"x = {_metres(motion.x[k])}, y = {_metres(motion.y[k])}, and the image ends at "
                f"x = {_metres(left)} to {_metres(right)}, y = {_metres(bottom)} to "
                f"{_metres(top)}; shorten the stroke, move the image (left, bottom), or say "
                'outside = "zero" or "repeat"'
            )


def _metres(value: float) -> str:
    return si.format_quantity(float(value), _METRE)


def _images(value: Any) -> Iterator[Image]:
    if isinstance(value, Image):
        yield value
    elif isinstance(value, tuple):
        for item in value:
            yield from _images(item)
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        for field in dataclasses.fields(value):
            if not field.name.startswith("_"):
                yield from _images(getattr(value, field.name))


def require_on_display(actuator: Actuator, motion: FingerMotion) -> None:
    """Refuse a motion that needs more surface than the display has, or a plane on a ring.

    A stator's coordinate runs along its circumference, as often round as one likes.
    """
    width, height = float(np.ptp(motion.x)), float(np.ptp(motion.y))
    if isinstance(actuator, AnnularStator):
        if np.any(motion.y != 0.0):
            raise InputError(
                "a stator renders along its circumference, the coordinate x; leave y_m out of the "
                "stroke, or take a plate for a motion in the plane"
            )
        return
    for name, used, there in zip("xy", (width, height), actuator.extent, strict=True):
        if used > there * (1 + 1e-9):
            raise InputError(
                f"the stroke covers {_metres(used)} along {name}, and the surface has "
                f"{_metres(there)}; shorten the stroke"
            )


def lowered(
    texture: TextureFile,
    p: Prediction,
    inverse: FrictionInverse,
    compensation: WaveCompensation | None = None,
) -> Program:
    """The program of a texture on a display whose largest amplitude and friction are predicted.

    `inverse` reads the display's friction backwards. Raises what `lower` raises.
    """
    quantity = texture.texture.quantity
    return lower(
        texture.texture,
        largest_amplitude=p.vibration_amplitude,
        inverse=None if quantity == "amplitude" else inverse,
        friction_coefficient=p.friction_coefficient if quantity == "friction_reduction" else None,
        compensation=compensation,
    )
