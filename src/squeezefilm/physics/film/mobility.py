"""Mobility of gas in the gap: H³ P^{1/n} φ(Kn/(PH)), and its slope in P, compiled.

The flow factor φ takes the *local* Knudsen number, because the mean free path goes with 1/p.
"""

from __future__ import annotations

import math
from typing import Any

from squeezefilm.core.compiled import compiled
from squeezefilm.physics.film.gas import FIRST, FUKUI_KANEKO, NO_SLIP, SECOND, VEIJOLA


@compiled()
def _ratio(part: int, D: float) -> tuple[float, float]:
    """Fukui–Kaneko flow rate over the viscous one, D/6, and its slope in D, in one fitted range."""
    if part == 0:
        a, b, c, d = 1.0 / 6.0, 1.0162, 1.0653, -2.1354
    elif part == 1:
        a, b, c, d = 0.13852, 1.25087, 0.15653, -0.00969
    else:
        a, b, c, d = -2.22919, 2.10673, 0.01653, -0.0000694
    value = 6.0 * (a + (b + (c + d / D) / D) / D)
    slope = -6.0 * (b + (2.0 * c + 3.0 * d / D) / D) / (D * D)
    return value, slope


@compiled()
def _blended(part: int, D: float, joint: float) -> tuple[float, float]:
    """`_ratio` below a joint, blended into that of the range above it within ±20 %."""
    value, slope = _ratio(part, D)
    if joint / 1.2 < D:
        above, above_slope = _ratio(part - 1, D)
        width = math.log(1.44)
        s = math.log(D * 1.2 / joint) / width
        blend, turn = s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / (width * D)
        slope += blend * (above_slope - slope) + turn * (above - value)
        value += blend * (above - value)
    return value, slope


@compiled()
def slip_factor(law: int, k: float) -> tuple[float, float]:
    """φ and dφ/dk at the local Knudsen number k, for a law by its number (see `gas.SLIP_LAWS`)."""
    if law == FIRST:
        return 1.0 + 6.0 * k, 6.0
    if law == SECOND:
        return 1.0 + 6.0 * k + 6.0 * k * k, 6.0 + 12.0 * k
    if law == VEIJOLA:
        if k <= 0.0:
            return 1.0, 0.0
        power = 9.638 * k**0.159
        return 1.0 + power * k, 1.159 * power
    if law == FUKUI_KANEKO:
        if k < 1e-12:
            return 1.0, 6.0
        D = 0.5 * math.sqrt(math.pi) / k
        # The published ranges meet with a step of 0.1 %, on which Newton would chatter; they are
        # blended over ±20 % of the joints instead.
        if D > 6.0:
            value, slope = _ratio(0, D)
        elif D > 0.18:
            value, slope = _blended(1, D, 5.0)
        else:
            value, slope = _blended(2, D, 0.15)
        return value, -slope * D / k
    return 1.0, 0.0


@compiled(inline="always")
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
