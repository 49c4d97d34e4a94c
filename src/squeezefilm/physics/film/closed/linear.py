"""The film under small vibration: stiffness and damping.

The force of the film on a rigid surface vibrating with amplitude ε h over an area A at ambient
pressure p0 is p0 A ε Re[(−fk − i fd) exp(iT)]: fk is the relative stiffness, fd the relative
damping, both functions of the squeeze number σ = 12 η ω ℓ² / (p0 h²) and of the planform. ℓ is the
strip's width or the disc's radius. A polytropic gas takes n f(σ/n),
first-order slip f(σ/(1 + 6 Kn)).

Source: Langlois 1962, Quarterly of Applied Mathematics 20, 131.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from squeezefilm.core import quantities as si

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
