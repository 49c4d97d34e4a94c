"""The gap over a surface in the plane: mean, flexural wave, ridges, or any function given."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError, InputError

# A thousand waves on the surface; some twenty cells a wave make a grid of it.
_HIGHEST_WAVE_NUMBER = 2000 * np.pi

GapFunction = Callable[[si.FloatArray, si.FloatArray, si.FloatArray], si.FloatArray]
"""H(X, Y, T): takes X and Y (places, 1) and T (1, times), returns what broadcasts with them."""


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
    def __call__(
        self, X: si.DimensionlessLike, Y: si.DimensionlessLike, T: si.DimensionlessLike
    ) -> si.FloatArray:
        """H at places X, Y and times T, broadcast."""
        return self._at(np.asarray(X), np.asarray(Y), np.asarray(T))

    def _at(self, X: si.FloatArray, Y: si.FloatArray, T: si.FloatArray) -> si.FloatArray:
        """The same for a grid's own places and times, of which it is called dozens of times."""
        wave = np.cos(self.wave_number * X) * np.cos(T)
        ridges = np.cos(self.ridge_wave_number * X)
        return np.asarray(1.0 + self.excursion_ratio * wave + self.ridge_height * ridges)


def gap_values(
    gap: GapFunction, X: si.FloatArray, Y: si.FloatArray, T: si.FloatArray
) -> si.FloatArray:
    """H at every place and time, (places, times), checked: finite and open."""
    values = gap._at if isinstance(gap, PlanarGap) else gap
    x, y, t = X[:, None], Y[:, None], T[None, :]
    shape = (X.size, T.size)
    try:
        H = np.broadcast_to(np.asarray(values(x, y, t), dtype=float), shape)
    except ValueError as error:
        raise InputError(
            f"the gap must return what broadcasts to {shape} for X {x.shape}, Y {y.shape}, "
            f"T {t.shape}: {error}"
        ) from error
    # One pass on the way through; the place is looked for only where something is wrong.
    if H.min() > 0.0 and H.max() < np.inf:
        return np.ascontiguousarray(H)
    finite = np.isfinite(H)
    k, j = np.unravel_index(int(np.argmin(np.where(finite, H, -np.inf))), shape)
    place = f"X = {X[k]:.4g}, Y = {Y[k]:.4g}, T = {T[j]:.4g}"
    if not finite.all():
        raise InputError(f"gap = {H[k, j]} at {place} cannot be used: it must be finite")
    raise GeometryError(
        f"the gap closes: H = {H[k, j]:.4g} at {place}; it must stay above 0. "
        "Reduce the vibration or the ridges, or raise the mean gap."
    )


def require_periodic(gap: GapFunction, X: si.FloatArray, Y: si.FloatArray) -> None:
    """Refuse a gap that is not 2π-periodic in T."""
    T = np.array([0.0, 1.0, 2.5, 4.5])
    now, later = gap_values(gap, X, Y, T), gap_values(gap, X, Y, T + 2 * np.pi)
    off = np.abs(later - now)
    if off.max() > 1e-9 * now.max():
        i, k = np.unravel_index(int(np.argmax(off)), off.shape)
        raise InputError(
            f"the gap is not periodic: H = {now[i, k]:.6g} at T = {T[k]} but {later[i, k]:.6g} "
            f"one period 2π later (X = {X[i]:.4g}, Y = {Y[i]:.4g}); only periodic films are solved"
        )
