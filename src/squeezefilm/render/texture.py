"""Textures: patterns of vibration amplitude that a finger moves over, as values.

A texture is anything called with position, speed and time that returns the vibration amplitude
wanted there. It commands an amplitude in metres, never a bare 0..1, so what a value means cannot
depend on the display it is played on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from squeezefilm.errors import InputError
from squeezefilm.quantities import (
    Dimensionless,
    FloatArray,
    Metre,
    MetreArray,
    MetreLike,
    MetrePerSecondLike,
    Radian,
    SecondLike,
    Unit,
    format_quantity,
    require,
)

_METRE = Unit("m")
# No vibrating plate reaches a millimetre and no display is ten metres long: what lies beyond is
# a slip of unit (2 for 2 um, 400 for 400 um) and worth a message.
_LONGEST_PERIOD: Metre = 10.0
_LARGEST_AMPLITUDE: Metre = 1e-3


class Texture(Protocol):
    """The seam between what is to be felt and what renders it.

    Called with the finger's position `x`, `y` (m), its speed `v` along its path (m/s, not
    negative) and the time `t` since the stroke began (s), it returns the vibration amplitude
    wanted there (m, zero-to-peak). The four broadcast against each other; the result has the
    broadcast shape.
    """

    def __call__(
        self, x: MetreLike, y: MetreLike, v: MetrePerSecondLike, t: SecondLike, /
    ) -> MetreArray:
        """The vibration amplitude wanted (m, zero-to-peak)."""
        ...


@dataclass(frozen=True, slots=True)
class Square:
    """A square grating along x: amplitude `high` over `duty` of each period, `low` over the rest.

    The amplitude is `high` where ``(x/spatial_period + phase/2π) mod 1 < duty``; a vibrating
    stretch is slippery, so it plays the groove, and the stretch at `low` plays the ridge.

    `spatial_period` is one whole period, groove plus ridge. The source paper calls 0.4 to 10 mm
    both the "space period" of its gratings and the width of their grooves *and* of their ridges;
    if the latter is meant (groove width = ridge width = w), the period is 2w. Build such a
    grating with `from_groove_and_ridge`, which leaves no doubt.

    Args:
        spatial_period: groove plus ridge (m); above 0, at most 10 m.
        low: vibration amplitude of the ridge (m, zero-to-peak); at least 0.
        high: vibration amplitude of the groove (m, zero-to-peak); above `low`, at most 1 mm.
        duty: share of the period at `high` (1); above 0, below 1.
        phase: shifts the pattern towards -x by phase/2π of a period (rad).

    Raises:
        InputError: a value outside its range.
    """

    spatial_period: Metre
    low: Metre
    high: Metre
    duty: Dimensionless = 0.5
    phase: Radian = 0.0

    def __post_init__(self) -> None:
        _require_grating(self.spatial_period, self.low, self.high, self.phase)
        require("duty", self.duty, above=0.0, below=1.0)

    @classmethod
    def from_groove_and_ridge(
        cls, groove: Metre, ridge: Metre, *, low: Metre, high: Metre, phase: Radian = 0.0
    ) -> Square:
        """The grating whose grooves (at `high`) and ridges (at `low`) have these widths (m).

        Its spatial period is groove + ridge: 0.8 mm for the paper's "0.4 mm" grating read as
        groove width = ridge width = 0.4 mm.

        Raises:
            InputError: a width that is not above 0, or a value outside its range.
        """
        require("groove", groove, _METRE, above=0.0)
        require("ridge", ridge, _METRE, above=0.0)
        period = groove + ridge
        return cls(period, low, high, duty=groove / period, phase=phase)

    def __call__(
        self, x: MetreLike, y: MetreLike, v: MetrePerSecondLike, t: SecondLike, /
    ) -> MetreArray:
        """The vibration amplitude wanted at `x` (m, zero-to-peak), in the broadcast shape.

        Raises:
            InputError: a position that is not finite, or shapes that do not broadcast.
        """
        cycles = _cycles(self.spatial_period, self.phase, x, y, v, t)
        return np.where(np.mod(cycles, 1.0) < self.duty, self.high, self.low)


@dataclass(frozen=True, slots=True)
class Sine:
    """A sine grating along x: amplitude between `low` and `high`, once per spatial period.

    ``(low + high)/2 + (high - low)/2 · sin(2πx/spatial_period + phase)``

    Args:
        spatial_period: one whole period (m); above 0, at most 10 m.
        low: least vibration amplitude (m, zero-to-peak); at least 0.
        high: greatest vibration amplitude (m, zero-to-peak); above `low`, at most 1 mm.
        phase: shifts the pattern towards -x by phase/2π of a period (rad).

    Raises:
        InputError: a value outside its range.
    """

    spatial_period: Metre
    low: Metre
    high: Metre
    phase: Radian = 0.0

    def __post_init__(self) -> None:
        _require_grating(self.spatial_period, self.low, self.high, self.phase)

    def __call__(
        self, x: MetreLike, y: MetreLike, v: MetrePerSecondLike, t: SecondLike, /
    ) -> MetreArray:
        """The vibration amplitude wanted at `x` (m, zero-to-peak), in the broadcast shape.

        Raises:
            InputError: a position that is not finite, or shapes that do not broadcast.
        """
        cycles = _cycles(self.spatial_period, self.phase, x, y, v, t)
        high_share = 0.5 + 0.5 * np.sin(2 * math.pi * cycles)
        # Weighted so, rounding cannot carry the value past either end (a negative amplitude).
        return np.asarray((1.0 - high_share) * self.low + high_share * self.high)


def _require_grating(spatial_period: Metre, low: Metre, high: Metre, phase: Radian) -> None:
    require("spatial_period", spatial_period, _METRE, above=0.0, at_most=_LONGEST_PERIOD)
    require("low", low, _METRE, at_least=0.0)
    require("high", high, _METRE, above=0.0, at_most=_LARGEST_AMPLITUDE)
    require("phase", phase, Unit("rad"))
    if not low < high:
        raise InputError(
            f"low = {format_quantity(low, _METRE)} and high = {format_quantity(high, _METRE)} "
            "make no texture: low must be below high; to exchange grooves and ridges, "
            "change duty and phase"
        )


def _cycles(
    spatial_period: Metre,
    phase: Radian,
    x: MetreLike,
    y: MetreLike,
    v: MetrePerSecondLike,
    t: SecondLike,
) -> FloatArray:
    """Periods passed since the origin, in the shape the four arguments broadcast to."""
    # A NaN would compare false and silently become `low`.
    require("position x", x, _METRE)
    try:
        shape = np.broadcast_shapes(*(np.shape(argument) for argument in (x, y, v, t)))
    except ValueError as error:
        shapes = ", ".join(str(np.shape(argument)) for argument in (x, y, v, t))
        raise InputError(
            f"x, y, v, t of shapes {shapes} do not broadcast; give equal shapes or scalars"
        ) from error
    cycles = np.asarray(x, dtype=float) / spatial_period + phase / (2 * math.pi)
    return np.broadcast_to(cycles, shape)
