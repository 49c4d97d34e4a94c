"""The gap over a surface in the plane: mean, flexural wave and ridges."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError

# A thousand waves on the surface; some twenty cells a wave make a grid of it.
_HIGHEST_WAVE_NUMBER = 2000 * np.pi


@si.checked_numbers
@dataclass(frozen=True)
class PlanarGap:
    """H = 1 + ε cos(k1 X) cos T + δ cos(k2 X): a standing wave under static ridges.

    `excursion_ratio` ε (0 < ε < 1), `wave_number` k1 (0: the surface moves as one),
    `ridge_height` δ and `ridge_wave_number` k2, all in units of H0 and of the reference length.
    Grooves run along Y and are open where the surface ends. Even in X and in Y.
    Raises `InputError` for values out of range, `GeometryError` where the gap would close.
    """

    excursion_ratio: Annotated[si.Dimensionless, si.Above(0.0), si.Below(1.0)]
    wave_number: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(_HIGHEST_WAVE_NUMBER)] = 0.0
    ridge_height: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(1.0)] = 0.0
    ridge_wave_number: Annotated[
        si.Dimensionless, si.AtLeast(0.0), si.AtMost(_HIGHEST_WAVE_NUMBER)
    ] = 0.0

    @si.checked_numbers
    def __call__(self, X: si.DimensionlessLike, T: si.DimensionlessLike) -> si.FloatArray:
        """H at places X, whatever Y, and times T, broadcast."""
        return self._at(np.asarray(X), np.asarray(T))

    @si.checked_numbers
    def mean(self, X: si.DimensionlessArray) -> si.DimensionlessArray:
        """The mean of H over a period at places X."""
        return np.asarray(1.0 + self.ridge_height * np.cos(self.ridge_wave_number * X))

    def _at(self, X: si.FloatArray, T: si.FloatArray) -> si.FloatArray:
        """The same for a grid's own places and times, of which it is called dozens of times."""
        wave = np.cos(self.wave_number * X) * np.cos(T)
        ridges = np.cos(self.ridge_wave_number * X)
        return np.asarray(1.0 + self.excursion_ratio * wave + self.ridge_height * ridges)


def gap_values(gap: PlanarGap, X: si.FloatArray, T: si.FloatArray) -> si.FloatArray:
    """H at every place and time, (places, times). Raises `GeometryError` where it closes."""
    H = gap._at(X[:, None], T[None, :])
    if H.min() > 0.0:
        return np.ascontiguousarray(H)
    k, j = np.unravel_index(int(np.argmin(H)), H.shape)
    raise GeometryError(
        f"the gap closes: H = {H[k, j]:.4g} at X = {X[k]:.4g}, T = {T[j]:.4g}; it must stay above "
        "0. Reduce the vibration or the ridges, or raise the mean gap."
    )
