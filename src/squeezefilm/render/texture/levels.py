"""A pattern between two values of a quantity: what makes a shape a texture."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.from_text import reads_text
from squeezefilm.render.opcodes import BETWEEN, Assembler
from squeezefilm.render.texture.composition import Composable, Quantity
from squeezefilm.render.texture.pattern import Pattern, require_pattern
from squeezefilm.render.texture.shapes import Constant

LARGEST_AMPLITUDE: si.Metre = 1e-3
"""No vibrating plate reaches a millimetre (m): what lies beyond is a slip of unit (2 for 2 um)."""

_LARGEST_REDUCTION: si.Dimensionless = 10.0


class _Level(Composable):
    """`low` where the pattern is 0, `high` where it is 1."""

    __slots__ = ()
    pattern: Any
    low: Any
    high: Any

    def _values(
        self, x: si.FloatArray, y: si.FloatArray, v: si.FloatArray, t: si.FloatArray
    ) -> si.FloatArray:
        share = self.pattern._values(x, y, v, t)
        # Weighted so, rounding cannot carry the value past either end.
        return np.asarray((1.0 - share) * self.low + share * self.high)

    def _lower(self, assembler: Assembler) -> None:
        self.pattern._lower(assembler)
        assembler.emit(BETWEEN, self.low, self.high)

    def _require(self, unit: si.Unit, largest: float) -> None:
        require_pattern("pattern", self.pattern)
        si.require("low", self.low, unit, at_least=0.0, at_most=largest)
        si.require("high", self.high, unit, at_least=0.0, at_most=largest)
        if self.low > self.high:
            raise InputError(
                f"low = {si.format_quantity(self.low, unit)} lies above high = "
                f"{si.format_quantity(self.high, unit)}; to exchange them, complement the pattern "
                "(~pattern)",
                quantity="low",
            )


@reads_text
@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Amplitude(_Level):
    """A vibration amplitude: `low` (m, zero-to-peak) where the pattern is 0, `high` where it is 1.

    Slipperier where the pattern is greater. Raises `InputError` unless 0 ≤ low ≤ high ≤ 1 mm.
    """

    pattern: Pattern
    low: si.Metre
    high: si.Metre
    type: Literal["amplitude"] = field(default="amplitude", repr=False)
    _quantity: ClassVar[Quantity] = "amplitude"

    def __post_init__(self) -> None:
        self._require(si.Unit("m"), LARGEST_AMPLITUDE)

    @classmethod
    @reads_text
    @si.checked_numbers
    def constant(cls, value: si.Metre) -> Amplitude:
        """The same amplitude (m, zero-to-peak) everywhere."""
        return cls(Constant(), value, value)


@reads_text
@si.checked_numbers
@dataclass(frozen=True, slots=True)
class RelativeFriction(_Level):
    """Friction over that of the surface at rest (1): `low` where the pattern is 0, else `high`.

    Stickier where the pattern is greater. Raises `InputError` unless 0 ≤ low ≤ high ≤ 1:
    vibration takes friction away and adds none. What a display cannot reach, the renderer counts.
    """

    pattern: Pattern
    low: si.Dimensionless
    high: si.Dimensionless
    type: Literal["relative_friction"] = field(default="relative_friction", repr=False)
    _quantity: ClassVar[Quantity] = "relative_friction"

    def __post_init__(self) -> None:
        self._require(si.Unit("1"), 1.0)

    @classmethod
    @reads_text
    @si.checked_numbers
    def constant(cls, value: si.Dimensionless) -> RelativeFriction:
        """The same relative friction (1) everywhere."""
        return cls(Constant(), value, value)


@reads_text
@si.checked_numbers
@dataclass(frozen=True, slots=True)
class FrictionReduction(_Level):
    """Friction coefficient taken away, µ − µ′ (1): `low` where the pattern is 0, else `high`.

    Slipperier where the pattern is greater. A renderer needs the friction coefficient µ of the
    surface at rest to play it. Raises `InputError` unless 0 ≤ low ≤ high ≤ 10.
    """

    pattern: Pattern
    low: si.Dimensionless
    high: si.Dimensionless
    type: Literal["friction_reduction"] = field(default="friction_reduction", repr=False)
    _quantity: ClassVar[Quantity] = "friction_reduction"

    def __post_init__(self) -> None:
        self._require(si.Unit("1"), _LARGEST_REDUCTION)

    @classmethod
    @reads_text
    @si.checked_numbers
    def constant(cls, value: si.Dimensionless) -> FrictionReduction:
        """The same reduction (1) everywhere."""
        return cls(Constant(), value, value)
