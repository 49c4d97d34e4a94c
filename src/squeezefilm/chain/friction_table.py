"""A friction law as a table: what takes many samples asks it in place of the law."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import OutOfRangeError


@dataclass(frozen=True, slots=True, eq=False)
class FrictionTable:
    """A friction law as a table: called with amplitudes (m), it gives µ′/µ (1) in their shape.

    `amplitude` rises from 0 (m), shape (n,); `speed` from 0 (m/s), shape (k,), is one place where
    the law does not depend on it. `relative_friction` there (1) has shape (k, n); linear between,
    and held beyond the last speed. `nominal_speed` (m/s) is taken where none is asked for.
    """

    amplitude: si.MetreArray
    speed: si.MetrePerSecondArray
    relative_friction: si.DimensionlessArray
    nominal_speed: si.MetrePerSecond

    @si.checked_numbers
    def __call__(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecondLike | None = None
    ) -> si.DimensionlessArray:
        """µ′/µ at amplitudes (m) and a finger's speeds (m/s, either sign; None: the nominal one);
        both broadcast. Raises `OutOfRangeError` outside of the table."""
        values, highest = np.asarray(amplitude, dtype=float), float(self.amplitude[-1])
        # A hair of slack: an exponential envelope may overshoot its target by rounding.
        slack = 1e-9 * highest
        if values.size and (values.min() < -slack or values.max() > highest + slack):
            raise OutOfRangeError(
                f"the friction law was tabulated for amplitudes from 0 to {highest:.4g} m and "
                f"asked at {values.min():.4g} to {values.max():.4g} m; tabulate it higher"
            )
        if self.speed.size == 1:
            return np.interp(values, self.amplitude, self.relative_friction[0])
        pace = np.abs(self.nominal_speed if speed is None else speed)
        if np.ndim(pace) == 0:
            return np.interp(values, self.amplitude, self.at_speed(float(pace)))
        values, pace = np.broadcast_arrays(values, pace)
        row, along = _place(self.speed, pace)
        column, across = _place(self.amplitude, values)
        known = self.relative_friction
        below = known[row, column] * (1 - across) + known[row, column + 1] * across
        above = known[row + 1, column] * (1 - across) + known[row + 1, column + 1] * across
        return np.asarray(below * (1 - along) + above * along)

    @si.checked_numbers
    def over_speeds(self, amplitude: si.MetreArray) -> si.DimensionlessArray:
        """µ′/µ at the table's speeds and amplitudes (m), shape (k, n)."""
        return np.stack(
            [np.interp(amplitude, self.amplitude, row) for row in self.relative_friction]
        )

    @si.checked_numbers
    def at_speed(self, speed: si.MetrePerSecond) -> si.DimensionlessArray:
        """µ′/µ at the table's amplitudes and one speed (m/s), shape (n,)."""
        if self.speed.size == 1:
            return self.relative_friction[0]
        row, along = _place(self.speed, np.array(abs(speed)))
        known = self.relative_friction
        return np.asarray(known[row] * (1 - along) + known[row + 1] * along)


def _place(knots: si.FloatArray, values: si.FloatArray) -> tuple[si.IntArray, si.FloatArray]:
    """Between which knots values lie, and where between them (0 to 1); held at both ends."""
    at = np.clip(np.searchsorted(knots, values, side="right") - 1, 0, knots.size - 2)
    part = (values - knots[at]) / (knots[at + 1] - knots[at])
    return at, np.clip(part, 0.0, 1.0)
