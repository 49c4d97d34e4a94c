"""The seam `Texture`, and the two gratings most asked for: square and sine, in amplitude.

A texture is anything called with position, velocity and time that returns the vibration amplitude
wanted there. It commands an amplitude in metres, never a bare 0..1, so what a value means cannot
depend on the display it is played on. `composition` says how textures compose, `levels` makes
them of any pattern and in other quantities, `program` lowers them for the renderer.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, Literal, Protocol

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.from_text import reads_text
from squeezefilm.render.opcodes import ALONG, BETWEEN, SINE, SQUARE, Assembler
from squeezefilm.render.texture.composition import Composable, Quantity
from squeezefilm.render.texture.coordinate import FARTHEST, FINEST, METRE
from squeezefilm.render.texture.levels import LARGEST_AMPLITUDE


class Texture(Protocol):
    """The seam between what is to be felt and what renders it.

    Called with the finger's position `x`, `y` (m), its velocity `v` along its path (m/s; |v| is
    its speed, and v is negative on the way back, which only a `Bump` asks for) and the time `t`
    since the stroke began (s), it returns the vibration amplitude wanted there (m, zero-to-peak).
    The four broadcast against each other; the result has the broadcast shape. A `Composable`
    whose quantity is not the amplitude needs a renderer to become one.
    """

    def __call__(
        self, x: si.MetreLike, y: si.MetreLike, v: si.MetrePerSecondLike, t: si.SecondLike, /
    ) -> si.MetreArray:
        """The vibration amplitude wanted (m, zero-to-peak)."""
        ...


class _Grating:
    """What the gratings have in common: a period and two amplitudes."""

    __slots__ = ()
    spatial_period: si.Metre
    low: si.Metre
    high: si.Metre
    phase: si.Radian

    def __post_init__(self) -> None:
        si.require("spatial_period", self.spatial_period, METRE, at_least=FINEST, at_most=FARTHEST)
        si.require("low", self.low, METRE, at_least=0.0)
        si.require("high", self.high, METRE, above=0.0, at_most=LARGEST_AMPLITUDE)
        si.require("phase", self.phase, si.Unit("rad"))
        if not self.low < self.high:
            raise InputError(
                f"low = {si.format_quantity(self.low, METRE)} and high = "
                f"{si.format_quantity(self.high, METRE)} make no texture: low must be below high; "
                "to exchange grooves and ridges, change duty and phase"
            )


@reads_text
@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Square(_Grating, Composable):
    """A square grating along x: amplitude `high` over `duty` of each period, `low` over the rest.

    The amplitude is `high` where ``(x/spatial_period + phase/2π) mod 1 < duty``; a vibrating
    stretch is slippery, so it plays the groove, and the stretch at `low` plays the ridge.

    `spatial_period` is one whole period, groove plus ridge. The source paper calls 0.4 to 10 mm
    both the "space period" of its gratings and the width of their grooves *and* of their ridges;
    if the latter is meant (groove width = ridge width = w), the period is 2w. Build such a
    grating with `from_groove_and_ridge`, which leaves no doubt.

    Args:
        spatial_period: groove plus ridge (m); from 1 nm to 10 m.
        low: vibration amplitude of the ridge (m, zero-to-peak); at least 0.
        high: vibration amplitude of the groove (m, zero-to-peak); above `low`, at most 1 mm.
        duty: share of the period at `high` (1); above 0, below 1.
        phase: shifts the pattern towards -x by phase/2π of a period (rad).

    Raises:
        InputError: a value outside its range.
    """

    spatial_period: si.Metre
    low: si.Metre
    high: si.Metre
    duty: Annotated[si.Dimensionless, si.Above(0.0), si.Below(1.0)] = 0.5
    phase: si.Radian = 0.0
    type: Literal["square"] = field(default="square", repr=False)
    _quantity: ClassVar[Quantity] = "amplitude"

    @classmethod
    @reads_text
    @si.checked_numbers
    def from_groove_and_ridge(
        cls,
        groove: Annotated[si.Metre, si.Above(0.0)],
        ridge: Annotated[si.Metre, si.Above(0.0)],
        *,
        low: si.Metre,
        high: si.Metre,
        phase: si.Radian = 0.0,
    ) -> Square:
        """The grating whose grooves (at `high`) and ridges (at `low`) have these widths (m).

        Its spatial period is groove + ridge: 0.8 mm for the paper's "0.4 mm" grating read as
        groove width = ridge width = 0.4 mm.

        Raises:
            InputError: a width that is not above 0, or a value outside its range.
        """
        period = groove + ridge
        return cls(period, low, high, duty=groove / period, phase=phase)

    def _values(
        self, x: si.FloatArray, y: si.FloatArray, v: si.FloatArray, t: si.FloatArray
    ) -> si.FloatArray:
        cycles = x / self.spatial_period + self.phase / (2 * math.pi)
        return np.where(cycles - np.floor(cycles) < self.duty, self.high, self.low)

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(ALONG, 1.0, 0.0, 0.0)
        assembler.emit(SQUARE, self.spatial_period, self.phase / (2 * math.pi), self.duty)
        assembler.emit(BETWEEN, self.low, self.high)


@reads_text
@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Sine(_Grating, Composable):
    """A sine grating along x: amplitude between `low` and `high`, once per spatial period.

    ``(low + high)/2 + (high - low)/2 · sin(2πx/spatial_period + phase)``

    Args:
        spatial_period: one whole period (m); from 1 nm to 10 m.
        low: least vibration amplitude (m, zero-to-peak); at least 0.
        high: greatest vibration amplitude (m, zero-to-peak); above `low`, at most 1 mm.
        phase: shifts the pattern towards -x by phase/2π of a period (rad).

    Raises:
        InputError: a value outside its range.
    """

    spatial_period: si.Metre
    low: si.Metre
    high: si.Metre
    phase: si.Radian = 0.0
    type: Literal["sine"] = field(default="sine", repr=False)
    _quantity: ClassVar[Quantity] = "amplitude"

    def _values(
        self, x: si.FloatArray, y: si.FloatArray, v: si.FloatArray, t: si.FloatArray
    ) -> si.FloatArray:
        cycles = x / self.spatial_period + self.phase / (2 * math.pi)
        high_share = 0.5 + 0.5 * np.sin(2 * math.pi * cycles)
        # Weighted so, rounding cannot carry the value past either end (a negative amplitude).
        return np.asarray((1.0 - high_share) * self.low + high_share * self.high)

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(ALONG, 1.0, 0.0, 0.0)
        assembler.emit(SINE, self.spatial_period, self.phase / (2 * math.pi))
        assembler.emit(BETWEEN, self.low, self.high)
