"""Patterns: dimensionless shapes between 0 and 1 over place, speed and time, their algebra, and the
coordinates along which they run.

A pattern alone says nothing about friction; `levels` gives it two ends with a quantity, and a
texture takes it as a mask. Patterns compose: with a, b patterns,

- ``a & b`` is the lesser, ``a | b`` the greater, ``a * b`` the product, ``~a`` is 1 − a;
- `a.scaled_by_speed(reference_speed)` stretches a with the finger's speed.

& and | form a lattice (commutative, associative, idempotent, absorbing, each distributive over
the other), * is commutative and associative and distributes over both; ~ swaps & and | (De
Morgan). There is no +: it would leave 0…1. Add textures, which have a quantity, instead.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar, Literal, TypeVar, dataclass_transform

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import TEXTURE_LENGTH
from squeezefilm.physics.render.opcodes import (
    ALONG,
    COMPLEMENT,
    END,
    ENTER_SCALE,
    GREATEST,
    LEAST,
    LEAVE_SCALE,
    MULTIPLY,
    RADIUS,
    Assembler,
)

MOST_PARTS = 64
"""Parts that one sum, product, sequence or lattice operation may have."""


_T = TypeVar("_T")
_LITERAL: Any = Literal


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def part(cls: type[_T]) -> type[_T]:
    """A part of a texture: a frozen dataclass whose numbers are checked, and may be texts with
    units.

    Files know it by its `type`, the class's name in small letters with underscores; a class whose
    name begins with one is but what others have in common.
    """
    made: Any = cls
    if not made.__name__.startswith("_"):
        name = re.sub(r"(?<!^)(?=[A-Z])", "_", made.__name__).lower()
        made.__annotations__["type"] = _LITERAL[name]
        made.type = field(default=name, repr=False)
    return reads_text(si.checked_numbers(dataclass(frozen=True, slots=True)(cls)))


class TexturePart:
    """Part with a value wherever a finger is: a pattern or a texture. Making one with a value
    outside its range raises `InputError`.

    Called with the finger's place `x`, `y` (m), its velocity `v` along its path (m/s; negative on
    the way back) and the time `t` (s), which broadcast; returns values in the broadcast shape.
    Raises `InputError` for an argument that is not finite, shapes that do not broadcast, or a
    pattern or texture too deep or too large to be rendered.
    """

    __slots__ = ()

    def __call__(
        self, x: si.MetreLike, y: si.MetreLike, v: si.MetrePerSecondLike, t: si.SecondLike, /
    ) -> si.FloatArray:
        """The values at these places, velocities and times (m for an amplitude, else 1)."""
        # Whoever only says what is to be felt does not load the compiler.
        from squeezefilm.physics.render.interpret import values_of

        assembler = Assembler()
        self._lower(assembler)
        assembler.emit(END)
        program = np.concatenate([assembler.code, *assembler.tables])
        return values_of(program, (0, len(assembler.code)), assembler.deepest, (x, y, v, t))

    def _lower(self, assembler: Assembler) -> None:
        raise NotImplementedError


class Pattern(TexturePart):
    """A dimensionless shape, 0 to 1; the base of every generator and composite."""

    __slots__ = ()
    WANTED: ClassVar[str] = (
        "pattern; give a dimensionless one like SquareWave, Band or Noise (a texture has a "
        "quantity of its own and can be no mask)"
    )

    def __invert__(self) -> Pattern:
        return self.pattern if isinstance(self, Complement) else Complement(self)

    def __and__(self, other: Pattern) -> Least:
        return Least(_parts(Least, self, other))

    def __or__(self, other: Pattern) -> Greatest:
        return Greatest(_parts(Greatest, self, other))

    def __mul__(self, other: Pattern) -> Times:
        # A texture on the right multiplies by this pattern itself.
        return Times(_parts(Times, self, other)) if isinstance(other, Pattern) else NotImplemented

    def __add__(self, other: object) -> Pattern:
        raise InputError(
            "patterns cannot be added: their sum would leave 0 to 1; take a | b for either and "
            "a * b for both, or add textures, whose values have a quantity"
        )

    @si.checked_numbers
    def scaled_by_speed(
        self,
        reference_speed: si.MetrePerSecond,
        slowest: si.MetrePerSecond = 0.001,
        fastest: si.MetrePerSecond = 1.0,
    ) -> SpeedScaled:
        """Pattern like this, stretched by speed/`reference_speed`; see `SpeedScaled`."""
        return SpeedScaled(self, reference_speed, slowest, fastest)


def _parts(kind: type[_Joined], *operands: Pattern) -> tuple[Pattern, ...]:
    """Operands with nested ones of the same kind flattened, so that brackets make no difference."""
    patterns: list[Pattern] = []
    for operand in operands:
        patterns += operand.patterns if isinstance(operand, kind) else [operand]
    return tuple(patterns)


@part
class Complement(Pattern):
    """1 − `pattern`: its ends exchanged."""

    pattern: Pattern

    def _lower(self, assembler: Assembler) -> None:
        self.pattern._lower(assembler)
        assembler.emit(COMPLEMENT)


@part
class _Joined(Pattern):
    """Any number of patterns joined by one operation, in which their order makes no difference."""

    patterns: tuple[Pattern, ...]
    _opcode: ClassVar[int]

    def __post_init__(self) -> None:
        if not 1 <= len(self.patterns) <= MOST_PARTS:
            raise InputError(
                f"{len(self.patterns)} patterns cannot be joined; give 1 to {MOST_PARTS}",
                quantity="patterns",
            )

    def _lower(self, assembler: Assembler) -> None:
        for index, pattern in enumerate(self.patterns):
            pattern._lower(assembler)
            if index:
                assembler.emit(self._opcode)


@part
class Least(_Joined):
    """The least of `patterns`: where masks overlap."""

    _opcode = LEAST


@part
class Greatest(_Joined):
    """The greatest of `patterns`: masks side by side."""

    _opcode = GREATEST


@part
class Times(_Joined):
    """The product of `patterns`: one fading another."""

    _opcode = MULTIPLY


@part
class SpeedScaled(Pattern):
    """`pattern` stretched about the origin in proportion to the finger's speed.

    At `reference_speed` (m/s) it is itself, at twice that its lengths are doubled: a grating then
    passes under a finger of steady speed at a frequency that does not depend on that speed. The
    factor is speed/reference_speed, held at its value for `slowest` below that speed and for
    `fastest` above it. The pattern slides under a finger that speeds up, the more the farther
    from the origin it is: this is a function of the present speed, with no memory.

    Raises:
        InputError: unless 1 µm/s ≤ slowest ≤ fastest ≤ 10 m/s, and for a reference speed
            outside 1 µm/s to 10 m/s.
    """

    pattern: Pattern
    reference_speed: Annotated[si.MetrePerSecond, si.AtLeast(1e-06), si.AtMost(10.0)]
    slowest: Annotated[si.MetrePerSecond, si.AtLeast(1e-06), si.AtMost(10.0)] = 0.001
    fastest: Annotated[si.MetrePerSecond, si.AtLeast("slowest"), si.AtMost(10.0)] = 1.0

    def _lower(self, assembler: Assembler) -> None:
        low, high = self.slowest / self.reference_speed, self.fastest / self.reference_speed
        assembler.emit(ENTER_SCALE, self.reference_speed, low, high)
        self.pattern._lower(assembler)
        assembler.emit(LEAVE_SCALE)


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
