"""The film under small vibration: stiffness and damping.

The force of the film on a rigid surface vibrating with amplitude ε h over an area A at ambient
pressure p0 is p0 A ε Re[(−fk − i fd) exp(iT)]: fk is the relative stiffness, fd the relative
damping, both functions of the squeeze number σ = 12 η ω ℓ² / (p0 h²) and of the planform. ℓ is the
strip's width, the disc's radius or the rectangle's shorter side. A polytropic gas takes
n f(σ/n), first-order slip f(σ/(1 + 6 Kn)).

Sources: Langlois 1962, Quarterly of Applied Mathematics 20, 131; Blech 1983, 10.1115/1.3254692.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np

from squeezefilm.core import quantities as si

Planform = Literal["strip", "disc", "rectangle"]
_Exponent = Annotated[si.Dimensionless, si.AtLeast(1), si.AtMost(5 / 3)]

# Below: continued fraction. Above: exponential (strip) or asymptotic (disc) form.
_SWITCH = 900.0
_MODES = 301


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


def _rectangle(sigma: Any, beta: float) -> Any:
    """Blech's double series over odd m, n with the sum over n done in closed form:

    fk + i fd = strip(σ) − Σ_m 16 β/(π² m²) iσ/q³ tanh(q/2β),  q² = π² m² + iσ.

    Beyond m = 301 tanh is 1 and the tail is its integral with the first midpoint correction;
    the integral of 1/(m² q³) from M is 1/(M q (πM + q)²). The relative error is below 1e-9.
    """
    i_sigma = 1j * np.asarray(sigma, dtype=float)
    m = np.arange(1, _MODES + 1, 2, dtype=float)
    q2 = (np.pi * m) ** 2 + i_sigma[..., np.newaxis]
    q = np.sqrt(q2)
    ends = (i_sigma[..., np.newaxis] / q2) * np.tanh(q / (2 * beta)) / (m**2 * q)
    M = _MODES + 1.0
    Q2 = (np.pi * M) ** 2 + i_sigma
    Q = np.sqrt(Q2)
    integral = i_sigma / (np.pi * M + Q) / (np.pi * M + Q) / (M * Q)
    slope = -(2 / M + 3 * np.pi**2 * M / Q2) / (M**2 * Q) * (i_sigma / Q2)
    rest = np.sum(ends, axis=-1) + (integral + slope / 6) / 2
    return _strip(sigma) - 16 * beta / np.pi**2 * rest


def _force(planform: Planform, sigma: Any, aspect_ratio: float) -> Any:
    """fk + i fd of a planform; raises `InputError` for a rectangle's aspect ratio above 1."""
    if planform == "strip":
        return _strip(sigma)
    if planform == "disc":
        return _disc(sigma)
    si.require("aspect_ratio", aspect_ratio, above=0, at_most=1)
    return _rectangle(sigma, aspect_ratio)


def _plain(value: Any) -> Any:
    return float(value) if np.ndim(value) == 0 else value


def _effective(sigma: Any, n: float, knudsen: Any) -> Any:
    return sigma / (n * (1 + 6 * knudsen))


@si.closed_form(nonnegative="squeeze_number knudsen_number", positive="aspect_ratio")
def relative_stiffness(
    squeeze_number: si.DimensionlessLike,
    planform: Planform = "strip",
    aspect_ratio: si.Dimensionless = 1.0,
    polytropic_exponent: _Exponent = 1.0,
    knudsen_number: si.DimensionlessLike = 0.0,
) -> si.DimensionlessLike:
    """The film's stiffness over p0 A/h: n fk(σ / (n (1 + 6 Kn))) (dimensionless); broadcasts.

    Small amplitudes; first-order slip, Kn up to about 0.1; n from 1 (isothermal) to 1.4 (air,
    adiabatic). `aspect_ratio` (shorter/longer) counts for the rectangle only. Raises `InputError`
    for an unknown planform, n outside 1 to 5/3 or an aspect ratio outside (0, 1].
    """
    sigma = _effective(squeeze_number, polytropic_exponent, knudsen_number)
    value: si.DimensionlessLike = _plain(
        polytropic_exponent * np.real(_force(planform, sigma, aspect_ratio))
    )
    return value


@si.closed_form(nonnegative="squeeze_number knudsen_number", positive="aspect_ratio")
def relative_damping(
    squeeze_number: si.DimensionlessLike,
    planform: Planform = "strip",
    aspect_ratio: si.Dimensionless = 1.0,
    polytropic_exponent: _Exponent = 1.0,
    knudsen_number: si.DimensionlessLike = 0.0,
) -> si.DimensionlessLike:
    """The film's damping times ω over p0 A/h: n fd(σ / (n (1 + 6 Kn))) (dimensionless).

    Arguments, range and errors as `relative_stiffness`; broadcasts.
    """
    sigma = _effective(squeeze_number, polytropic_exponent, knudsen_number)
    value: si.DimensionlessLike = _plain(
        polytropic_exponent * np.imag(_force(planform, sigma, aspect_ratio))
    )
    return value
