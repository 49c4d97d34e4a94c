"""A friction law as a table: what takes many samples asks it in place of the law."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import OutOfRangeError


@dataclass(frozen=True, slots=True, eq=False)
class FrictionTable:
    """A friction law as a table: called with amplitudes (m), it gives µ′/µ (1) in their shape.

    Linear between `amplitude`, rising from 0 (m), and `relative_friction` there (1).
    """

    amplitude: si.MetreArray
    relative_friction: si.DimensionlessArray

    @si.checked_numbers
    def __call__(self, amplitude: si.MetreArray) -> si.DimensionlessArray:
        """µ′/µ at amplitudes (m). Raises `OutOfRangeError` outside of the table."""
        values, highest = np.asarray(amplitude, dtype=float), float(self.amplitude[-1])
        # A hair of slack: an exponential envelope may overshoot its target by rounding.
        slack = 1e-9 * highest
        if values.size and (values.min() < -slack or values.max() > highest + slack):
            raise OutOfRangeError(
                f"the friction law was tabulated for amplitudes from 0 to {highest:.4g} m and "
                f"asked at {values.min():.4g} to {values.max():.4g} m; tabulate it higher"
            )
        return np.asarray(np.interp(values, self.amplitude, self.relative_friction))
