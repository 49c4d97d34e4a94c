"""Slip at the walls: how much more gas flows than the viscous film alone would let through.

The factor φ multiplies H³ in the Reynolds equation. It depends on the *local* Knudsen number,
mean free path over gap. The free path goes with 1/p, so it is Kn/(P H) where the film is
compressed to P and H.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from squeezefilm.errors import InputError
from squeezefilm.quantities import DimensionlessLike, FloatLike, require

NO_SLIP, FIRST, SECOND, FUKUI_KANEKO, VEIJOLA = range(5)

SLIP_LAWS = {
    "first": FIRST,
    "second": SECOND,
    "fukui-kaneko": FUKUI_KANEKO,
    "veijola": VEIJOLA,
}
"""The names users write, and the numbers the compiled code knows them by."""


@njit(nogil=True, cache=True)  # type: ignore[untyped-decorator]
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


@njit(nogil=True, cache=True)  # type: ignore[untyped-decorator]
def slip_factor(law: int, k: float) -> tuple[float, float]:
    """φ and dφ/dk at the local Knudsen number k, for a law by its number."""
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
            value, slope = _ratio(1, D)
            if D > 5.0 / 1.2:
                above, above_slope = _ratio(0, D)
                width = math.log(1.44)
                s = math.log(D * 1.2 / 5.0) / width
                blend, turn = s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / (width * D)
                slope += blend * (above_slope - slope) + turn * (above - value)
                value += blend * (above - value)
        else:
            value, slope = _ratio(2, D)
            if D > 0.15 / 1.2:
                above, above_slope = _ratio(1, D)
                width = math.log(1.44)
                s = math.log(D * 1.2 / 0.15) / width
                blend, turn = s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / (width * D)
                slope += blend * (above_slope - slope) + turn * (above - value)
                value += blend * (above - value)
        return value, -slope * D / k
    return 1.0, 0.0


def slip_law(slip: str, knudsen_number: float) -> int:
    """The number of a slip law; `NO_SLIP` where the Knudsen number is zero.

    Raises `InputError` for an unknown name or a Knudsen number that is negative or not finite.
    """
    require("knudsen_number", knudsen_number, at_least=0.0)
    if slip not in SLIP_LAWS:
        raise InputError(f"slip = '{slip}' is no slip law; use one of {', '.join(SLIP_LAWS)}")
    return SLIP_LAWS[slip] if knudsen_number > 0.0 else NO_SLIP


def flow_factor(local_knudsen_number: DimensionlessLike, slip: str = "first") -> FloatLike:
    """The factor φ by which slip raises the flow of a film at a local Knudsen number λ/h.

    - ``"first"``: 1 + 6 Kn, Burgdorfer 1959 (10.1115/1.4008018); good below Kn ≈ 0.1.
    - ``"second"``: 1 + 6 Kn + 6 Kn², Hsia & Domoto 1983 (10.1115/1.3254526).
    - ``"fukui-kaneko"``: the fitted Poiseuille flow rates of the linearised Boltzmann equation,
      full accommodation, Fukui & Kaneko 1990 (10.1115/1.2920234), for 0.01 ≤ √π/(2 Kn); their
      three ranges are blended over ±20 % of the joints at 0.15 and 5.
    - ``"veijola"``: 1 + 9.638 Kn^1.159, a fit for 0 ≤ Kn ≤ 880, Veijola et al. 1995
      (10.1016/0924-4247(95)00995-7).

    Takes and returns scalars or arrays. Raises `InputError` for an unknown law or a Knudsen
    number that is negative or not finite.
    """
    require("local_knudsen_number", local_knudsen_number, at_least=0.0)
    law = slip_law(slip, 1.0)
    given = np.asarray(local_knudsen_number, dtype=float)
    flat = [slip_factor(law, float(k))[0] for k in given.ravel()]
    if given.ndim == 0:
        return float(flat[0])
    return np.array(flat).reshape(given.shape)
