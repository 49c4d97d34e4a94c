"""Closed forms of the film: at large squeeze number (Salbu's limit, the edge layer, the paper's
pressure), and under small vibration.

As σ → ∞ the gas is trapped: Ψ = P H (isothermal) no longer changes in time, except in an edge
layer of thickness ~σ^-1/2 through which the film breathes. P is pressure over ambient, X = x/l0 in
[-1/2, 1/2], T = ωt; ε, δ, k1, k2 as in `physics.film.gap`.

Sources: Salbu 1964, 10.1115/1.3653080; Biet et al., equations 5 to 12.

The film under small vibration: the force on a rigid surface vibrating with amplitude ε h over an
area A at ambient pressure p0 is p0 A ε Re[(−fk − i fd) exp(iT)]: fk is the relative stiffness, fd
the relative damping, both functions of the squeeze number σ = 12 η ω ℓ² / (p0 h²) and of the
planform. ℓ is the strip's width or the disc's radius. A polytropic gas takes n f(σ/n), first-order
slip f(σ/(1 + 6 Kn)).

Source: Langlois 1962, Quarterly of Applied Mathematics 20, 131.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Any, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError, OutOfRangeError
from squeezefilm.physics.film.gap import PaperGap

PaperModel = Literal["paper2008", "paper2008-printed"]


@si.closed_form(nonnegative="amplitude_ratio ridge_ratio", positive="wave_number ridge_number")
def paper_mean_pressure(
    X: si.DimensionlessLike,
    amplitude_ratio: si.DimensionlessLike,
    ridge_ratio: si.DimensionlessLike,
    wave_number: si.Dimensionless,
    ridge_number: si.Dimensionless,
) -> si.DimensionlessLike:
    """The mean over a period of the pressure as σ → ∞, P̄(X) over ambient, paper eqs 11 and 12
    corrected; broadcasts.

    P = (a/a_B) √(a_B² + 1.5 b_B²) / (a + b cos T), a = 1 + δ cos k2X, b = ε cos k1X, B at
    X = ½; its mean has √(a² − b²) below. Symmetric contact, static roughness; needs ε + δ < 1 (the
    gap stays open) and raises `OutOfRangeError` where it would not be. Valid for σ → ∞ only.
    """
    a, b, trapped = _trapped(X, amplitude_ratio, ridge_ratio, wave_number, ridge_number)
    value: si.DimensionlessLike = trapped / np.sqrt(a**2 - b**2)
    return value


@si.closed_form(nonnegative="amplitude_ratio ridge_ratio", positive="wave_number ridge_number")
def paper_mean_pressure_printed(
    X: si.DimensionlessLike,
    amplitude_ratio: si.DimensionlessLike,
    ridge_ratio: si.DimensionlessLike,
    wave_number: si.Dimensionless,
    ridge_number: si.Dimensionless,
) -> si.DimensionlessLike:
    """Paper eq 12 as printed, over ambient: √(a² − ε² cos(k1/2)) in the denominator.

    Printed: cos(k1/2) where cos²(k1 X) belongs. Kept to reproduce the paper; use
    `paper_mean_pressure`. Raises `OutOfRangeError` where the printed root is of a number ≤ 0.
    """
    a = 1 + ridge_ratio * np.cos(ridge_number * X)
    a_edge = 1 + ridge_ratio * np.cos(ridge_number / 2)
    b_edge = amplitude_ratio * np.cos(wave_number / 2)
    radicand = a**2 - amplitude_ratio**2 * np.cos(wave_number / 2)
    _require_positive("the printed a² − ε² cos(k1/2)", radicand)
    value: si.DimensionlessLike = (
        a * np.sqrt(a_edge**2 + 1.5 * b_edge**2) / (a_edge * np.sqrt(radicand))
    )
    return value


def _trapped(X: Any, epsilon: Any, delta: Any, k1: Any, k2: Any) -> tuple[Any, Any, Any]:
    """a, b and the gas that stays, P(a + b cos T) = (a/a_B) √(a_B² + 1.5 b_B²), at X."""
    _require_positive("the least gap 1 − ε − δ", 1 - epsilon - delta)
    a, b = 1 + delta * np.cos(k2 * X), epsilon * np.cos(k1 * X)
    a_edge, b_edge = 1 + delta * np.cos(k2 / 2), epsilon * np.cos(k1 / 2)
    return a, b, a / a_edge * np.sqrt(a_edge**2 + 1.5 * b_edge**2)


def _require_positive(what: str, value: Any) -> None:
    least = float(np.min(np.asarray(getattr(value, "magnitude", value), dtype=float)))
    if not least > 0:
        raise OutOfRangeError(
            f"{what} = {least:.4g} must be above 0; take a smaller amplitude or a larger roughness"
        )


@lru_cache(maxsize=8)
def _gauss(count: int) -> tuple[si.FloatArray, si.FloatArray]:
    """Gauss points and weights: finding them takes longer than using them."""
    node, weight = np.polynomial.legendre.leggauss(count)
    return node, weight


def _column(value: si.DimensionlessLike) -> Any:
    """A scalar as it is, an array of amplitudes as a column, so that positions run along rows."""
    return np.asarray(value, dtype=float)[..., np.newaxis]


def _eccentric(theta: Any, e: Any) -> Any:
    """Kepler's eccentric anomaly of θ, continuous in θ: 1 + e cos θ = (1 − e²)/(1 − e cos E)."""
    beta = e / (1 + np.sqrt(1 - e**2))
    return theta - 2 * np.arctan(beta * np.sin(theta) / (1 + beta * np.cos(theta)))


def _true(E: Any, e: Any) -> Any:
    beta = e / (1 + np.sqrt(1 - e**2))
    return E + 2 * np.arctan(beta * np.sin(E) / (1 - beta * np.cos(E)))


@si.checked_numbers
def mean_pressure_profile(
    X: Annotated[si.DimensionlessLike, si.AtLeast(-0.5), si.AtMost(0.5)],
    gap: PaperGap,
    model: PaperModel = "paper2008",
) -> si.DimensionlessArray:
    """The mean over a period of the pressure over ambient, P̄(X), as σ → ∞ (dimensionless).

    `X` = x/l0 in [-1/2, 1/2], of any shape for a single amplitude; for an array of A amplitudes X
    is 1-D or a scalar, and the result has the shape (A, len(X)).

    "paper2008" is `paper_mean_pressure`, "paper2008-printed" the printed eq 12 with the printed ε
    of eq 2. Raises `InputError` for an X outside the contact or an unknown model, `OutOfRangeError`
    where the printed root fails.
    """
    X = np.asarray(X, dtype=float)
    array = np.ndim(gap.vibration_amplitude) == 1
    if array:
        X = np.atleast_1d(X)
        if X.ndim > 1:
            raise InputError("X must be a number or one-dimensional for an array of amplitudes")
    lift = _column if array else np.asarray
    k1, k2, delta = gap.wave_number, gap.ridge_number, lift(gap.ridge_ratio)
    if model == "paper2008-printed":
        ratio = lift(gap.amplitude_ratio_printed)
        return np.asarray(paper_mean_pressure_printed(X, ratio, delta, k1, k2))
    return np.asarray(paper_mean_pressure(X, lift(gap.amplitude_ratio), delta, k1, k2))


def _panels(gap: PaperGap) -> tuple[si.FloatArray, float]:
    """Panel edges in the eccentric anomaly, and its eccentricity, that resolve the ridge crests.

    Over a crest the pressure has complex singularities at a distance √(2(1−δ−ε)/δ) in phase; an
    eccentricity (1−q)/(1+q) with q = (1−δ−ε)/2δ spreads them. Edges lie at crests, grooves,
    antinodes and nodes.
    """
    delta = float(np.max(gap.ridge_ratio))
    open_gap = gap.roughness / float(np.max(gap.reference_thickness))
    q = open_gap / (2 * delta) if delta > 0 else 1.0
    e = (1 - q) / (1 + q) if q < 1 else 0.0
    low, high = (float(_eccentric(gap.ridge_number * x, e)) for x in (-0.5, 0.5))
    ridges = np.pi * np.arange(np.ceil(low / np.pi), np.floor(high / np.pi) + 1)
    last = np.floor(gap.wave_number / np.pi)
    positions = np.pi / 2 * np.arange(-last, last + 1) / gap.wave_number
    inner = np.concatenate([ridges, _eccentric(gap.ridge_number * positions, e)])
    inner = inner[(inner > low) & (inner < high)]
    return np.unique(np.concatenate([[low], inner, [high]])), e


@si.checked_numbers
def contact_mean_pressure(
    gap: PaperGap, model: PaperModel = "paper2008", *, tolerance: float = 1e-10
) -> si.DimensionlessLike:
    """The mean ⟨P̄⟩ over the contact of `mean_pressure_profile`; scalar, or (A,) as the amplitudes.

    Composite Gauss–Legendre quadrature between ridge crests, grooves, antinodes and nodes, with
    points gathered at the crests, doubled until the over-pressure ⟨P̄⟩ − 1 changes by less than
    `tolerance` of itself (or 1e-13). Raises `ConvergenceError` where 256 points a panel are not
    enough, and whatever `mean_pressure_profile` raises.

    The printed model gives less than 1 on the paper's own stator (0.9959 at 2 µm), against its
    Fig 4.
    """
    edges, e = _panels(gap)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    previous: Any = None
    change = np.inf
    for count in (8, 16, 32, 64, 128, 256):
        node, weight = _gauss(count)
        E = (middle[:, np.newaxis] + half[:, np.newaxis] * node).ravel()
        theta = _true(E, e)
        dX = np.sqrt(1 - e**2) / (1 - e * np.cos(E)) / gap.ridge_number
        X = theta / gap.ridge_number
        weights = (half[:, np.newaxis] * weight).ravel() * dX
        mean = 1 + (mean_pressure_profile(np.clip(X, -0.5, 0.5), gap, model) - 1) @ weights
        if previous is not None:
            allowed = tolerance * np.abs(mean - 1) + 1e-13
            change = float(np.max(np.abs(mean - previous) / allowed, initial=0.0))
            if change <= 1:
                return mean if np.ndim(mean) else float(mean)
        previous = mean
    raise ConvergenceError(
        f"the mean pressure over the contact did not settle within {tolerance:.1g} at 256 points "
        "a panel; take a larger roughness or a larger tolerance",
        partial=previous,
        residual=change * tolerance,
        iterations=6,
    )


Planform = Literal["strip", "disc"]

# Below: continued fraction. Above: exponential (strip) or asymptotic (disc) form.
_SWITCH = 900.0


def _continued_fraction(u: Any, first: int, step: int) -> Any:
    """u / (u + c1 + u/(c2 + u/(c3 + …))) with c = first, first + step, …

    Every partial sum has positive real and imaginary parts, so that neither part of the result
    cancels however small |u|.
    """
    tail = first + step * 120.0 + 0 * u
    for k in range(119, 0, -1):
        tail = first + step * k + u / tail
    return u / (u + first + u / tail)


def _strip(sigma: Any) -> Any:
    """fk + i fd = 1 − tanh z / z with z = √(iσ)/2; either part's relative error is below 1e-12."""
    u = 1j * np.minimum(sigma, _SWITCH) / 4
    z = np.sqrt(1j * np.maximum(sigma, _SWITCH)) / 2
    decay = np.exp(-2 * z)
    return np.where(
        sigma <= _SWITCH, _continued_fraction(u, 3, 2), 1 - (1 - decay) / ((1 + decay) * z)
    )


def _bessel_ratio_coefficients(count: int) -> list[float]:
    """c of I1(s)/I0(s) ~ Σ c_k s^-k, from the Riccati equation r' = 1 − r/s − r²."""
    c = [1.0]
    for m in range(1, count):
        products = sum(c[j] * c[m - j] for j in range(1, m))
        c.append(((m - 2) * c[m - 1] - products) / 2)
    return c


_RATIO = _bessel_ratio_coefficients(20)


def _disc(sigma: Any) -> Any:
    """fk + i fd = 1 − 2 I1(s) / (s I0(s)) with s = √(iσ); relative error as `_strip`."""
    u = 1j * np.minimum(sigma, _SWITCH) / 4
    s = np.sqrt(1j * np.maximum(sigma, _SWITCH))
    ratio = np.zeros_like(s)
    for c in reversed(_RATIO):
        ratio = c + ratio / s
    return np.where(sigma <= _SWITCH, _continued_fraction(u, 2, 1), 1 - 2 * ratio / s)


def _plain(value: Any) -> Any:
    return float(value) if np.ndim(value) == 0 else value


def _force(planform: Planform, sigma: Any) -> Any:
    return _strip(sigma) if planform == "strip" else _disc(sigma)


@si.closed_form(nonnegative="squeeze_number")
def relative_stiffness(
    squeeze_number: si.DimensionlessLike, planform: Planform = "strip"
) -> si.DimensionlessLike:
    """The stiffness of an isothermal film over p0 A/h, fk(σ) (dimensionless); broadcasts.

    Small amplitudes, no slip. Raises `InputError` for an unknown planform.
    """
    value: si.DimensionlessLike = _plain(np.real(_force(planform, squeeze_number)))
    return value


@si.closed_form(nonnegative="squeeze_number")
def relative_damping(
    squeeze_number: si.DimensionlessLike, planform: Planform = "strip"
) -> si.DimensionlessLike:
    """The film's damping times ω over p0 A/h, fd(σ) (dimensionless); broadcasts, as
    `relative_stiffness`."""
    value: si.DimensionlessLike = _plain(np.imag(_force(planform, squeeze_number)))
    return value
