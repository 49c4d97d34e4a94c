"""How easily gas moves through the gap: H³ P^{1/n} φ(Kn/(PH)), and its slope in P, compiled.

The flow factor φ takes the *local* Knudsen number, because the mean free path goes with 1/p.
"""

from __future__ import annotations

from typing import Any

import numba

from squeezefilm.errors import InputError
from squeezefilm.quantities import did_you_mean, require

# A stand-in with the names and signatures of `squeezefilm.film.slip`, which has all its laws:
# once that file is here, import `slip_factor` and `slip_law` from it and delete these.
NO_SLIP, FIRST, VEIJOLA = 0, 1, 4
SLIP_LAWS = {"first": FIRST, "veijola": VEIJOLA}


def slip_law(slip: str, knudsen_number: float) -> int:
    """The number of a slip law; `NO_SLIP` where the Knudsen number is zero.

    Raises `InputError` for an unknown name or a Knudsen number that is negative or not finite.
    """
    require("knudsen_number", knudsen_number, at_least=0.0)
    if slip not in SLIP_LAWS:
        raise InputError(
            f"slip = '{slip}' is no slip law; use one of {', '.join(SLIP_LAWS)}."
            + did_you_mean(slip, SLIP_LAWS)
        )
    return SLIP_LAWS[slip] if knudsen_number > 0.0 else NO_SLIP


@numba.njit(cache=True, nogil=True)
def slip_factor(law: int, k: float) -> Any:
    """φ and dφ/dk at the local Knudsen number k, for a law by its number."""
    if law == FIRST:
        return 1.0 + 6.0 * k, 6.0
    if law == VEIJOLA:
        power = 9.638 * k**0.159
        return 1.0 + power * k, 1.159 * power
    return 1.0, 0.0


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
