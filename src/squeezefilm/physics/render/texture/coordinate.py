"""Coordinate of a one-dimensional pattern: x, y, any direction, or the distance from a point."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import TEXTURE_LENGTH
from squeezefilm.physics.render.opcodes import ALONG, RADIUS, Assembler

METRE = si.Unit("m")
FARTHEST: si.Metre = 10.0
"""Farthest place (m): no display is ten metres long, and a place beyond is a slip of unit."""

Place = Annotated[si.Metre, si.AtLeast(-FARTHEST), si.AtMost(FARTHEST)]
"""A place on a display, in annotations: at most 10 m from the origin."""

FINEST: si.Metre = 1e-9
"""Finest width (m): no texture is finer than a nanometre, and less is a slip of unit."""

Length = Annotated[si.Metre, TEXTURE_LENGTH]
"""A period or a width on a display, in annotations: from 1 nm to 0.5 m."""


class Coordinate:
    """A length (m) read off the finger's place; the base of the family `AlongX`, `AlongY`,
    `AlongDirection` and `FromPoint`."""

    __slots__ = ()
    WANTED: ClassVar[str] = (
        "coordinate; give AlongX(), AlongY(), AlongDirection(angle) or FromPoint(x, y)"
    )

    def at(self, x: si.MetreArray, y: si.MetreArray) -> si.MetreArray:
        """The coordinate (m) at places `x`, `y` (m), in their shape."""
        raise NotImplementedError

    def _lower(self, assembler: Assembler) -> None:
        raise NotImplementedError


class _Straight(Coordinate):
    """The way along a line through the origin."""

    __slots__ = ()

    @property
    def _direction(self) -> tuple[float, float]:
        """Components along x and y."""
        raise NotImplementedError

    def at(self, x: si.MetreArray, y: si.MetreArray) -> si.MetreArray:
        """The way along the line (m)."""
        p, q = self._direction
        return np.asarray(p * x + q * y)

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(ALONG, *self._direction, 0.0)


@dataclass(frozen=True, slots=True)
class AlongX(_Straight):
    """The coordinate x."""

    type: Literal["x"] = field(default="x", repr=False)
    _direction = (1.0, 0.0)


X_AXIS = AlongX()
"""The coordinate that patterns run along unless they are told another."""


@dataclass(frozen=True, slots=True)
class AlongY(_Straight):
    """The coordinate y."""

    type: Literal["y"] = field(default="y", repr=False)
    _direction = (0.0, 1.0)


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class AlongDirection(_Straight):
    """x cos(angle) + y sin(angle): the way along a line at `angle` (rad) from x towards y.

    Raises `InputError` for an angle that is not finite.
    """

    angle: si.Radian
    type: Literal["direction"] = field(default="direction", repr=False)

    @property
    def _direction(self) -> tuple[float, float]:
        return math.cos(self.angle), math.sin(self.angle)


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class FromPoint(Coordinate):
    """The distance from the point (`x`, `y`), for rings and discs; never negative.

    Raises `InputError` for a point that is not within ±10 m.
    """

    x: Place = 0.0
    y: Place = 0.0
    type: Literal["radius"] = field(default="radius", repr=False)

    def at(self, x: si.MetreArray, y: si.MetreArray) -> si.MetreArray:
        """The distance (m)."""
        # Not hypot: a plain root is the same operation in every interpreter of a program.
        return np.sqrt((x - self.x) ** 2 + (y - self.y) ** 2)

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(RADIUS, self.x, self.y)


def require_fade(value: si.Metre, at_most: si.Metre) -> None:
    """Refuse a fade (m) that is neither 0 nor between a nanometre and `at_most`."""
    if value != 0.0:
        si.require("fade", value, METRE, at_least=FINEST, at_most=at_most)
