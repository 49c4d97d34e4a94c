"""The least amplitude that brings a friction down, where no formula has it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError, UnreachableError

HIGHEST_AMPLITUDE: si.Metre = 50e-6


def least_amplitude(
    friction: Callable[[float], float],
    wanted: si.Dimensionless,
    model: str,
    highest: Annotated[si.Metre, si.Above(2e-8)] = HIGHEST_AMPLITUDE,
) -> si.Metre:
    """The least amplitude (m) at which `friction` of an amplitude falls to `wanted`.

    Raises `UnreachableError` where none up to `highest` (m, 50 µm) does.
    """
    from scipy.optimize import brentq

    if wanted == 1:
        return 0.0

    def excess(amplitude: float) -> float:
        return friction(amplitude) - wanted

    # What is asked for may be within the rounding of what a still surface has.
    if excess(0.0) <= 0:
        return 0.0
    low, least = 0.0, 1.0
    for high in np.geomspace(2e-8, highest, 24):
        try:
            left = excess(float(high))
        except OutOfRangeError:
            # So strong a vibration closes the gap at some ridge: it is no way to get there.
            break
        if left <= 0:
            return float(brentq(excess, low, high, xtol=1e-20, rtol=1e-12))
        low, least = float(high), min(least, left + wanted)
    raise UnreachableError(
        f"relative_friction = {wanted:.4g} is not reached by any vibration amplitude up to "
        f"{si.format_quantity(highest, si.Unit('m'))}: the model '{model}' "
        f"gives {least:.4g} at the least; press less, take a smoother surface or ask for less"
    )
