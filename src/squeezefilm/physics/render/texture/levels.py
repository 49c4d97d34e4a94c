"""A pattern between two values of a quantity: what makes a shape a texture."""

from __future__ import annotations

import typing
from typing import Annotated, Any, ClassVar, Self

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.opcodes import BETWEEN, Assembler
from squeezefilm.physics.render.texture.composition import Composable, Quantity
from squeezefilm.physics.render.texture.pattern import METRE, X_AXIS, Pattern, part
from squeezefilm.physics.render.texture.shapes import Constant

LARGEST_AMPLITUDE: si.Metre = 1e-3
"""Largest amplitude (m) of a vibrating plate; what lies beyond is a slip of unit (2 for 2 um)."""

VibrationAmplitude = Annotated[si.Metre, si.AtLeast(0.0), si.AtMost(LARGEST_AMPLITUDE)]
FrictionShare = Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)]
FrictionLoss = Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(10.0)]


class _Level(Composable):
    """`low` where the pattern is 0, `high` where it is 1."""

    __slots__ = ()
    pattern: Pattern
    low: Any
    high: Any
    _unit: ClassVar[si.Unit] = si.Unit("1")

    def __post_init__(self) -> None:
        if self.low > self.high:
            raise InputError(
                f"low = {si.format_quantity(self.low, self._unit)} lies above high = "
                f"{si.format_quantity(self.high, self._unit)}; to exchange them, complement the "
                "pattern (~pattern)",
                quantity="low",
            )

    @classmethod
    def constant(cls, value: float) -> Self:
        """The same `value` (m for an amplitude, else 1) everywhere."""
        made: Any = cls
        return typing.cast(Self, made(Constant(), value, value))

    @property
    def spatial_period(self) -> si.Metre | None:
        """The period of a grating along x (m); None for any other pattern."""
        along_x = getattr(self.pattern, "along", None) == X_AXIS
        return getattr(self.pattern, "spatial_period", None) if along_x else None

    def _lower(self, assembler: Assembler) -> None:
        self.pattern._lower(assembler)
        assembler.emit(BETWEEN, self.low, self.high)


@part
class Amplitude(_Level):
    """A vibration amplitude: `low` (m, zero-to-peak) where the pattern is 0, `high` where it is 1.

    Slipperier where the pattern is greater. Raises `InputError` unless 0 ≤ low ≤ high ≤ 1 mm.
    """

    pattern: Pattern
    low: VibrationAmplitude
    high: VibrationAmplitude
    _quantity: ClassVar[Quantity] = "amplitude"
    _unit: ClassVar[si.Unit] = METRE


@part
class RelativeFriction(_Level):
    """Friction over that of the surface at rest (1): `low` where the pattern is 0, else `high`.

    Stickier where the pattern is greater. Raises `InputError` unless 0 ≤ low ≤ high ≤ 1:
    vibration takes friction away and adds none. What a display cannot reach, the renderer counts.
    """

    pattern: Pattern
    low: FrictionShare
    high: FrictionShare
    _quantity: ClassVar[Quantity] = "relative_friction"


@part
class FrictionReduction(_Level):
    """Friction coefficient taken away, µ − µ′ (1): `low` where the pattern is 0, else `high`.

    Slipperier where the pattern is greater. A renderer needs the friction coefficient µ of the
    surface at rest to play it. Raises `InputError` unless 0 ≤ low ≤ high ≤ 10.
    """

    pattern: Pattern
    low: FrictionLoss
    high: FrictionLoss
    _quantity: ClassVar[Quantity] = "friction_reduction"
