"""How easily gas moves through the gap: H³ P^{1/n} φ(Kn/(PH)), and its slope in P, compiled.

The flow factor φ takes the *local* Knudsen number, because the mean free path goes with 1/p.
"""

from __future__ import annotations

from typing import Any, Literal

import numba
import numpy as np

from squeezefilm.errors import InputError
from squeezefilm.quantities import did_you_mean

SlipModel = Literal["first_order", "veijola"]
SLIP_MODELS: dict[str, int] = {"first_order": 1, "veijola": 2}


def slip_code(knudsen_number: float, model: str) -> int:
    """The compiled kernels' number for a slip model; 0 where the Knudsen number is zero.

    Raises `InputError` for an unknown model.
    """
    if model not in SLIP_MODELS:
        raise InputError(
            f"slip_model = '{model}' is not known; allowed: {', '.join(SLIP_MODELS)}."
            + did_you_mean(model, SLIP_MODELS)
        )
    return SLIP_MODELS[model] if knudsen_number > 0 else 0


@numba.njit(cache=True, nogil=True, inline="always")
def mobility(H: float, P: float, n: float, knudsen: float, model: int) -> Any:
    """H³ P^{1/n} φ(Kn/(PH)) and its derivative in P, at one point.

    φ is 1 (model 0), 1 + 6 k (1, Burgdorfer 1959) or 1 + 9.638 k^1.159 (2, Veijola 1995).
    """
    base = H * H * H
    if n == 1.0:
        power = P
        slope = 1.0
    else:
        power = P ** (1.0 / n)
        slope = power / (n * P)
    if model == 0:
        return base * power, base * slope
    k = knudsen / (P * H)
    if model == 1:
        factor = 1.0 + 6.0 * k
        change = 6.0
    else:
        factor = 1.0 + 9.638 * k**1.159
        change = 9.638 * 1.159 * k**0.159
    return base * power * factor, base * (slope * factor - power * change * k / P)


@numba.njit(cache=True, nogil=True)
def mobility_field(
    H: np.ndarray[Any, Any], P: np.ndarray[Any, Any], n: float, knudsen: float, model: int
) -> Any:
    """`mobility` over two arrays of the same shape; returns value and slope."""
    value = np.empty_like(P)
    slope = np.empty_like(P)
    h, p, v, s = H.ravel(), P.ravel(), value.ravel(), slope.ravel()
    for i in range(p.size):
        v[i], s[i] = mobility(h[i], p[i], n, knudsen, model)
    return value, slope
