"""The gap of a 1-D film as it varies along the film and over a period, and the grid it needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError, InputError

_TIMES = 128
_MOST_ORDERS = 40
_NEGLIGIBLE = 1e-12

Harmonics = Callable[[si.FloatArray], si.ComplexArray]
GapFunction = Callable[[si.FloatArray, si.FloatArray], ArrayLike]
"""H(X, T) at places and times that broadcast."""


@dataclass(frozen=True, eq=False)
class GapProfile:
    """A gap H(X, T) = Re Σ h_k(X) e^{ikT} over −1/2 ≤ X ≤ 1/2, relative to the reference gap H0.

    `harmonics(X)` returns the h_k, shape (orders, len(X)). Made by `flexural_profile` or
    `profile_from_function`; making one checks that the gap never closes. `excursion` is the largest
    |h_1|, `depth` the largest relative excursion (max − min)/(max + min) over a period at any X,
    `mean_depth` its mean along X, `features` the number of waves along X.
    """

    harmonics: Harmonics
    description: str
    symmetric: bool = field(init=False)
    excursion: float = field(init=False)
    depth: float = field(init=False)
    mean_depth: float = field(init=False)
    features: float = field(init=False)
    orders: int = field(init=False)
    _map: Callable[..., si.FloatArray] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        x = np.linspace(-0.5, 0.5, 2049)
        h = np.asarray(self.harmonics(x), dtype=complex)
        if h.ndim != 2 or h.shape[1] != len(x) or not np.all(np.isfinite(h)):
            raise InputError(
                f"gap harmonics of {self.description} have shape {h.shape} or values that are not "
                f"finite; they must be finite and of shape (orders, {len(x)})"
            )
        mean = h[0].real
        waves = max(_extrema(mean), _extrema(np.abs(h[1])) if len(h) > 1 else 0)
        if waves > 100:
            x = np.linspace(-0.5, 0.5, 40 * waves + 1)
            h = np.asarray(self.harmonics(x), dtype=complex)
            mean = h[0].real
        times = 2.0 * np.pi * np.arange(64) / 64
        gap = evaluate(h, times)
        if gap.min() <= 0.0:
            at, when = np.unravel_index(int(np.argmin(gap)), gap.shape)
            raise GeometryError(
                f"the gap of {self.description} closes: H = {gap.min():.4g} at X = {x[at]:.4g}, "
                f"T = {times[when]:.4g}. It must stay above 0; reduce the amplitude or raise the "
                f"mean gap"
            )
        high, low = gap.max(axis=1), gap.min(axis=1)
        put = object.__setattr__
        put(self, "symmetric", bool(np.abs(h - h[:, ::-1]).max() < 1e-10 * np.abs(h).max()))
        put(self, "excursion", float(np.abs(h[1]).max()) if len(h) > 1 else 0.0)
        put(self, "depth", float(((high - low) / (high + low)).max()))
        put(self, "mean_depth", float(((high - low) / (high + low)).mean()))
        put(self, "features", 0.5 * waves)
        put(self, "orders", len(h))
        put(self, "_map", self._density(max(1024, int(128 * waves))))

    def gap(self, X: ArrayLike, T: ArrayLike) -> si.FloatArray:
        """H at positions X and times T, shape (len(X), len(T))."""
        return evaluate(self.harmonics(np.atleast_1d(np.asarray(X, float))), np.atleast_1d(T))

    def _density(self, cells: int) -> Callable[..., si.FloatArray]:
        """X over the cumulated density of grid points.

        The pressure turns where the gap is small: 60 % of the points go by 1/H, the others
        evenly. The density is a smooth function of X alone, so that errors stay a series in h².
        """
        from scipy.interpolate import CubicHermiteSpline

        x = np.linspace(-0.5, 0.5, 2 * cells + 1)
        inverse = 1.0 / self.harmonics(x)[0].real
        inverse /= (inverse[:-2:2] + 4.0 * inverse[1:-1:2] + inverse[2::2]).sum() / (6.0 * cells)
        density = 0.4 + 0.6 * inverse
        parts = (density[:-2:2] + 4.0 * density[1:-1:2] + density[2::2]) / (6.0 * cells)
        cumulated = np.concatenate([[0.0], np.cumsum(parts)]) - 0.5
        return CubicHermiteSpline(cumulated, x[::2], 1.0 / density[::2])

    def grid(self, xi: si.FloatArray, grading: float) -> tuple[si.FloatArray, si.FloatArray]:
        """X and dX/dξ for ξ in [−1, 1], graded to the edges and to where the gap is small."""
        eta = 0.5 * xi * (1.0 + grading * (1.0 - xi * xi))
        slope = 0.5 * (1.0 + grading - 3.0 * grading * xi * xi)
        return self._map(eta), self._map(eta, 1) * slope


@lru_cache(maxsize=16)
def sampled_grid(
    profile: GapProfile, cells: int, closed: bool, grading: float
) -> tuple[si.FloatArray, si.FloatArray, si.ComplexArray]:
    """X, dX/dξ and the gap's harmonics at the 2·cells + 1 nodes and faces; kept for sweeps.

    `closed`: from the plane of symmetry to the edge, otherwise from edge to edge.
    """
    x, slope = profile.grid(np.linspace(0.0 if closed else -1.0, 1.0, 2 * cells + 1), grading)
    harmonics = np.asarray(profile.harmonics(x), dtype=complex)
    for array in (x, slope, harmonics):
        array.setflags(write=False)
    return x, slope, harmonics


def evaluate(harmonics: si.ComplexArray, times: ArrayLike) -> si.FloatArray:
    """Re Σ h_k e^{ikT}, shape (positions, times)."""
    orders = np.arange(len(harmonics))
    wave = np.exp(1j * np.outer(orders, np.asarray(times, float)))
    return np.asarray((harmonics.T @ wave).real)


@lru_cache(maxsize=64)
def interpolant(times: int, count: int) -> si.FloatArray:
    """The weight of each of the times, an odd number, at each of `count` times of a period."""
    from scipy.special import diric

    apart = np.arange(count) / count - np.arange(times)[:, None] / times
    return np.asarray(diric(2.0 * np.pi * apart, times))


def _extrema(values: si.FloatArray) -> int:
    rise = np.diff(values)
    rise = rise[np.abs(rise) > 1e-9 * (np.abs(values).max() + 1e-300)]
    return int(np.count_nonzero(rise[1:] * rise[:-1] < 0.0))


# What a gap's harmonics are computed from: values and not closures, so that a film can be pickled.


@dataclass(frozen=True, slots=True)
class _Flexural:
    """H = 1 + τ·2X + δ cos k2X + ε cos k1X cos T."""

    excursion_ratio: float
    wavenumber: float
    ridge_depth: float
    ridge_wavenumber: float
    tilt: float

    def __call__(self, x: si.FloatArray) -> si.ComplexArray:
        ridges = self.ridge_depth * np.cos(self.ridge_wavenumber * x)
        wave = self.excursion_ratio * np.cos(self.wavenumber * x)
        return np.array([1.0 + 2.0 * self.tilt * x + ridges, wave], dtype=complex)


@dataclass(frozen=True, slots=True)
class _GivenGap:
    """A function H(X, T), sampled over a period."""

    gap: GapFunction
    orders: int

    def __call__(self, x: si.FloatArray) -> si.ComplexArray:
        times = 2.0 * np.pi * np.arange(_TIMES) / _TIMES
        h = np.fft.rfft(_sampled(self.gap, x, times), axis=1)[:, : self.orders].T / _TIMES
        h[1:] *= 2.0
        return np.asarray(h)


def _sampled(gap: GapFunction, x: si.FloatArray, times: si.FloatArray) -> si.FloatArray:
    given = np.asarray(gap(x[:, None], times[None, :]), dtype=float)
    return np.array(np.broadcast_to(given, (len(x), len(times))))


@si.checked_numbers
def flexural_profile(
    excursion_ratio: Annotated[float, si.Above(-1.0), si.Below(1.0)],
    *,
    wavenumber: float = 0.0,
    ridge_depth: float = 0.0,
    ridge_wavenumber: float = 0.0,
    tilt: float = 0.0,
) -> GapProfile:
    """A flexural wave under ridges, tilted: H = 1 + τ·2X + δ cos k2X + ε cos k1X cos T.

    With `excursion_ratio` ε, `wavenumber` k1 = 2π l0/λ, `ridge_depth` δ, `ridge_wavenumber`
    k2 = 2π l0/L and `tilt` τ this is eq. 2 of Biet, Giraud & Lemaire-Semail (2008), with static
    roughness. Raises `InputError` for values that are not finite or ε ≥ 1, and `GeometryError`
    for a gap that closes.
    """
    harmonics = _Flexural(excursion_ratio, wavenumber, ridge_depth, ridge_wavenumber, tilt)
    text = f"flexural profile ε = {excursion_ratio:.4g}, k1 = {wavenumber:.4g}"
    if ridge_depth:
        text += f", δ = {ridge_depth:.4g}, k2 = {ridge_wavenumber:.4g}"
    if tilt:
        text += f", tilt {tilt:.4g}"
    return GapProfile(harmonics, text)


def profile_from_function(gap: GapFunction, description: str = "given function") -> GapProfile:
    """A gap H(X, T) given as a function that broadcasts, T in radians.

    Raises `InputError` for a gap that is not periodic in T with period 2π, not finite or with
    more than 40 harmonics, and `GeometryError` for one that closes.
    """

    x = np.linspace(-0.5, 0.5, 101)
    times = 2.0 * np.pi * np.arange(_TIMES) / _TIMES
    now, later = _sampled(gap, x, times), _sampled(gap, x, times + 2.0 * np.pi)
    _check_periodic(now, later, x, times, description)
    spectrum = np.abs(np.fft.rfft(now, axis=1)).max(axis=0)
    significant = np.flatnonzero(spectrum > _NEGLIGIBLE * spectrum.max())
    orders = int(significant.max()) + 1
    if orders > _MOST_ORDERS:
        raise InputError(
            f"the gap of {description} has {orders} harmonics in time; at most {_MOST_ORDERS} can "
            f"be used: smooth its motion"
        )
    return GapProfile(_GivenGap(gap, orders), description)


def _check_periodic(
    now: si.FloatArray, later: si.FloatArray, x: si.FloatArray, t: si.FloatArray, description: str
) -> None:
    if not (np.all(np.isfinite(now)) and np.all(np.isfinite(later))):
        raise InputError(f"the gap of {description} has values that are not finite (NaN or inf)")
    apart = np.abs(later - now)
    if apart.max() > 1e-6 * np.abs(now).max():
        i, j = np.unravel_index(int(np.argmax(apart)), apart.shape)
        raise InputError(
            f"the gap of {description} is not periodic in time: at X = {x[i]:.4g} it is "
            f"{now[i, j]:.6g} at T = {t[j]:.4g} and {later[i, j]:.6g} a period of 2π later. Give "
            f"a gap that repeats after 2π"
        )
