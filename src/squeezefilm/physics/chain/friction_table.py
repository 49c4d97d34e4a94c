"""A friction law as a table: what takes many samples asks it in place of the law."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.render.program.inverse import FrictionInverse, LawOverSpeeds

# By how much what a solver leaves may pass 0 and 1.
_ROUNDING = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class FrictionTable:
    """A friction law as a table: called with amplitudes (m), it gives µ′/µ (1) in their shape.

    `amplitude` rises from 0 (m), shape (n,); `speed` from 0 (m/s), shape (k,), is one place where
    the law does not depend on it. `relative_friction` there (1) has shape (k, n); linear between,
    and held beyond the last speed. `nominal_speed` (m/s) is taken where none is asked for.

    Raises `InputError` for arrays of other shapes, knots that do not rise, or friction beyond 0…1.
    """

    amplitude: si.MetreArray
    speed: si.MetrePerSecondArray
    relative_friction: si.DimensionlessArray
    nominal_speed: si.MetrePerSecond

    def __post_init__(self) -> None:
        a, v, known = self.amplitude, self.speed, self.relative_friction
        si.require("amplitude", a, si.Unit("m"), at_least=0.0)
        si.require("speed", v, si.Unit("m/s"), at_least=0.0)
        si.require("relative_friction", known, at_least=-_ROUNDING, at_most=1.0 + _ROUNDING)
        object.__setattr__(self, "relative_friction", np.clip(known, 0.0, 1.0))
        rise = a.ndim == v.ndim == 1 and np.all(np.diff(a) > 0.0) and np.all(np.diff(v) > 0.0)
        if not rise or a.size < 2 or a[0] != 0.0 or known.shape != (v.size, a.size):
            raise InputError(
                f"relative_friction of shape {known.shape} over {v.shape} speeds and {a.shape} "
                "amplitudes is no table; give speeds that rise, at least two amplitudes that rise "
                "from 0, and a row of frictions for each speed"
            )

    @classmethod
    def of_inverse(cls, inverse: FrictionInverse) -> FrictionTable:
        """The table that an inverse reads backwards: what a loop writes down, for a finger too."""
        return cls(
            inverse.amplitude, inverse.speed, inverse.relative_friction, inverse.nominal_speed
        )

    def inverse(
        self, law: LawOverSpeeds, largest_amplitude: si.Metre, share: si.Dimensionless = 1.0
    ) -> FrictionInverse:
        """The amplitude for a wanted µ′/µ at a finger's speed: this table read backwards.

        `law` is what was tabulated, by which the inverse's error is measured between the knots;
        `largest_amplitude` (m) is the largest that may be asked for, and `share` (1) what it is of
        the amplitude that the table knows. Raises `InputError` where friction does not fall.
        """
        if self.speed.size == 1:
            return FrictionInverse.from_function(lambda a: self(a / share), largest_amplitude)
        return FrictionInverse.over_speeds(
            lambda a, v: law(a / share, v),
            self.amplitude * share,
            self.speed,
            self.nominal_speed,
            known=self.relative_friction,
        )

    @si.checked_numbers
    def __call__(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecondLike | None = None
    ) -> si.DimensionlessArray:
        """Relative friction µ′/µ at amplitudes (m) and a finger's speeds (m/s, either sign; None:
        the nominal one); both broadcast. Raises `OutOfRangeError` outside of the table."""
        values, highest = np.asarray(amplitude, dtype=float), float(self.amplitude[-1])
        # A hair of slack: an exponential envelope may overshoot its target by rounding.
        slack = 1e-9 * highest
        if values.size and (values.min() < -slack or values.max() > highest + slack):
            raise OutOfRangeError(
                f"the friction law was tabulated for amplitudes from 0 to {highest:.4g} m and "
                f"asked at {values.min():.4g} to {values.max():.4g} m; tabulate it higher"
            )
        if self.speed.size == 1:
            return np.asarray(np.interp(values, self.amplitude, self.relative_friction[0]))
        pace = np.abs(self.nominal_speed if speed is None else speed)
        if np.ndim(pace) == 0:
            return np.asarray(np.interp(values, self.amplitude, self.at_speed(float(pace))))
        values, pace = np.broadcast_arrays(values, pace)
        row, along = _place(self.speed, pace)
        column, across = _place(self.amplitude, values)
        known = self.relative_friction
        below = known[row, column] * (1 - across) + known[row, column + 1] * across
        above = known[row + 1, column] * (1 - across) + known[row + 1, column + 1] * across
        return np.asarray(below * (1 - along) + above * along)

    @si.checked_numbers
    def over_speeds(self, amplitude: si.MetreArray) -> si.DimensionlessArray:
        """Relative friction µ′/µ at the table's speeds and amplitudes (m), shape (k, n)."""
        column, across = _place(self.amplitude, np.asarray(amplitude, dtype=float))
        known = self.relative_friction
        return np.asarray(known[:, column] * (1 - across) + known[:, column + 1] * across)

    @si.checked_numbers
    def at_speed(self, speed: si.MetrePerSecond) -> si.DimensionlessArray:
        """Relative friction µ′/µ at the table's amplitudes and one speed (m/s), shape (n,)."""
        if self.speed.size == 1:
            return np.asarray(self.relative_friction[0])
        row, along = _place(self.speed, np.array(abs(speed)))
        known = self.relative_friction
        return np.asarray(known[row] * (1 - along) + known[row + 1] * along)


def _place(knots: si.FloatArray, values: si.FloatArray) -> tuple[si.IntArray, si.FloatArray]:
    """Indices of the knots below values, and places up to the next (0 to 1); held at both ends."""
    at = np.clip(np.searchsorted(knots, values, side="right") - 1, 0, knots.size - 2)
    part = (values - knots[at]) / (knots[at + 1] - knots[at])
    return at, np.clip(part, 0.0, 1.0)
