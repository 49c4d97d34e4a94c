"""From a wanted friction to the amplitude that makes it: the display's friction curve, inverted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError

_METRE = si.Unit("m")
_MOST_KNOTS = 65_536
# Friction at rest is 1 by its definition; a curve may miss that by what a solver leaves.
_AT_REST = 1e-4
# Two knots closer than this in friction cannot be told apart by the inverse.
_FLAT = 1e-12


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class FrictionInverse:
    """Knots of a falling friction curve, read backwards with straight lines between them.

    Build it with `from_function`.

    Attributes:
        amplitude: rising from 0 (m, zero-to-peak), shape (n,).
        relative_friction: strictly falling from 1 (1), shape (n,).
        max_error: how far the friction at an amplitude found here may be from the one wanted (1),
            measured between the knots on the curve itself.
    """

    amplitude: si.MetreArray
    relative_friction: si.DimensionlessArray
    max_error: si.Dimensionless

    @classmethod
    @si.checked_numbers
    def from_function(
        cls,
        relative_friction: Callable[[si.MetreArray], si.DimensionlessArray],
        largest_amplitude: Annotated[si.Metre, si.Above(0.0), si.AtMost(1e-3)],
        *,
        knots: Annotated[int, si.AtLeast(3), si.AtMost(_MOST_KNOTS)] = 257,
        rise_allowed: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(0.1)] = 1e-9,
    ) -> FrictionInverse:
        """The inverse of a friction law up to an amplitude.

        Args:
            relative_friction: vibration amplitudes (m, zero-to-peak; shape (n,)) → relative
                friction (1; the same shape). Called once, with some 4 × `knots` amplitudes.
            largest_amplitude: the largest that may be asked for (m); above 0, at most 1 mm.
            knots: amplitudes in the table, evenly spaced; from 3 to 65 536.
            rise_allowed: by how much friction may rise from a knot to the next (1) and be taken
                for rounding; the rise is flattened and enters `max_error`.

        Raises:
            InputError: a value outside its range, or a friction that is not finite, is not 1 at
                rest or rises with amplitude.
        """
        fine = np.linspace(0.0, largest_amplitude, 4 * (knots - 1) + 1)
        values = relative_friction(fine)
        found = si.returned("relative_friction", values, fine, "one value per amplitude")
        amplitude, friction = _knots(fine[::4], found[::4], rise_allowed)
        back = np.interp(fine, amplitude, friction)
        error = float(np.max(np.abs(back - found)))
        return cls(amplitude, friction, error)

    @property
    def largest_amplitude(self) -> si.Metre:
        """The amplitude of the least friction (m, zero-to-peak)."""
        return float(self.amplitude[-1])

    @property
    def least_friction(self) -> si.Dimensionless:
        """The least relative friction that can be reached (1)."""
        return float(self.relative_friction[-1])

    @si.checked_numbers
    def amplitude_for(self, relative_friction: si.DimensionlessLike) -> si.MetreArray:
        """The amplitude (m, zero-to-peak) that makes a relative friction (1), in its shape.

        Raises:
            InputError: a friction above 1 or below `least_friction`.
        """
        si.require(
            "relative_friction", relative_friction, at_least=self.least_friction, at_most=1.0
        )
        found = np.interp(
            np.asarray(relative_friction, dtype=float),
            self.relative_friction[::-1],
            self.amplitude[::-1],
        )
        return np.asarray(found)


def _knots(
    amplitude: si.MetreArray, friction: si.DimensionlessArray, rise_allowed: float
) -> tuple[si.MetreArray, si.DimensionlessArray]:
    si.require("relative_friction", friction, at_least=0.0)
    if abs(friction[0] - 1.0) > _AT_REST:
        raise InputError(
            f"the relative friction at rest is {friction[0]:.6g}; it must be 1: divide the curve "
            "by its value at amplitude 0"
        )
    falling = np.minimum.accumulate(np.append(1.0, friction[1:]))
    rise = np.diff(friction)
    if np.any(rise > rise_allowed):
        place = int(np.argmax(rise > rise_allowed))
        raise InputError(
            f"friction rises by {rise[place]:.3g} from "
            f"{si.format_quantity(amplitude[place], _METRE)} to "
            f"{si.format_quantity(amplitude[place + 1], _METRE)}, so an amplitude for it is not "
            "unique; end the curve there, or allow the rise if it is noise (rise_allowed)"
        )
    # Of a flat stretch the least amplitude is kept; what that costs is in the error stated.
    keep = np.append(True, np.diff(falling) < -_FLAT)
    if np.count_nonzero(keep) < 2:
        raise InputError("friction does not fall with amplitude, so nothing can be rendered by it")
    return amplitude[keep], falling[keep]
