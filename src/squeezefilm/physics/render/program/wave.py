"""The standing wave under the finger: how much of its amplitude a contact meets, place by place.

A plate in a standing wave |cos(πx/λ½)| vibrates at antinodes and rests at nodes, so a texture
that asks for one amplitude is felt with a ripple of period λ½, half the wavelength.
`WaveCompensation` gives the share of the amplitude that a contact meets to the renderer, which
divides by it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.program.inverse import FrictionInverse
from squeezefilm.physics.render.texture.coordinate import FARTHEST, X_AXIS, Coordinate, FromPoint

_MOST_FACTORS = 65_536


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class WaveCompensation:
    """Compensation of the wave's weakness, place by place; a renderer divides amplitudes by it.

    Build it with `from_ripple`.

    Args:
        half_wavelength: the period (m); from 1 µm to 10 m.
        factors: local amplitude over that at the strongest place (1), evenly spaced over one
            period from coordinate 0; above 0, at most 1. The least is the greatest gain's inverse.
        along: the coordinate across the nodal lines; no distance from a point.

    Raises:
        InputError: a value outside its range.
    """

    half_wavelength: Annotated[si.Metre, si.AtLeast(1e-06), si.AtMost(FARTHEST)]
    factors: Annotated[tuple[si.Dimensionless, ...], si.Above(0.0), si.AtMost(1.0)]
    along: Coordinate = X_AXIS

    def __post_init__(self) -> None:
        if not 2 <= len(self.factors) <= _MOST_FACTORS:
            raise InputError(f"{len(self.factors)} factors cannot be used; give 2 to 65 536")
        if isinstance(self.along, FromPoint):
            raise InputError("a wave runs along a direction; give AlongX, AlongY, AlongDirection")

    @classmethod
    @si.checked_numbers
    def from_ripple(
        cls,
        position: si.MetreArray,
        relative_friction: si.DimensionlessArray,
        inverse: FrictionInverse,
        half_wavelength: si.Metre,
        *,
        least: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)] = 0.1,
        along: Coordinate = X_AXIS,
    ) -> WaveCompensation:
        """Compensation by friction, computed or measured, of a pad that crosses the wave at a
        drive.

        `position` (m) are evenly spaced places over one `half_wavelength` from 0 on, its end left
        out; `relative_friction` (1) the friction there; `inverse` that of the pad where friction
        falls most. The amplitude that explains the friction at each place, over the largest such,
        is the factor. Exact where the place acts as a factor on the amplitude.

        Raises:
            InputError: places that are not such, or a friction the inverse does not reach.
        """
        places = np.asarray(position, dtype=float)
        friction = np.asarray(relative_friction, dtype=float)
        even = np.arange(places.size) / max(places.size, 1) * half_wavelength
        if places.ndim != 1 or places.shape != friction.shape or places.size < 4:
            raise InputError("position and relative_friction must be two lists of one length, ≥ 4")
        if np.max(np.abs(places - even)) > 1e-6 * half_wavelength:
            raise InputError(
                "position must be evenly spaced from 0 over one half wavelength, its end left out"
            )
        amplitude = inverse.amplitude_for(friction)
        largest = float(np.max(amplitude))
        if largest == 0.0:
            raise InputError("nothing vibrates at any of these places, so there is no ripple")
        factors = np.clip(amplitude / largest, least, 1.0)
        return cls(half_wavelength, tuple(factors.tolist()), along)

    @si.checked_numbers
    def factor(self, x: si.MetreLike, y: si.MetreLike = 0.0) -> si.DimensionlessArray:
        """The factor at places (1), as the renderer reads it: linear between those of a period."""
        where = self.along.at(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        places = np.arange(len(self.factors)) / len(self.factors)
        return np.asarray(np.interp(where / self.half_wavelength, places, self.factors, period=1))
