"""How easily gas moves through the gap: H³ P^{1/n} φ(Kn/(PH)), and its slope in P, compiled.

The flow factor φ takes the *local* Knudsen number, because the mean free path goes with 1/p.
"""

from __future__ import annotations

from typing import Any

import numba

from squeezefilm.film.slip import NO_SLIP
from squeezefilm.film.slip_kernel import slip_factor


@numba.njit(cache=True, nogil=True, inline="always")
def mobility(H: float, P: float, n: float, knudsen: float, law: int) -> Any:
    """H³ P^{1/n} φ(Kn/(PH)) and its derivative in P, at one point."""
    base = H * H * H
    if n == 1.0:
        power = P
        slope = 1.0
    else:
        power = P ** (1.0 / n)
        slope = power / (n * P)
    if law == NO_SLIP:
        return base * power, base * slope
    k = knudsen / (P * H)
    factor, change = slip_factor(law, k)
    return base * power * factor, base * (slope * factor - power * change * k / P)
