"""The paper's friction model: the film carries part of the finger, the surface the rest.

Biet et al., equations 13 and 14. Model "paper2008" is the corrected form, "paper2008-printed" the
equations as they stand. Both take σ → ∞, which the paper's σ ≈ 20 is far from: ask
`physics.film.validity.film_validity`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError, UnreachableError
from squeezefilm.physics.film.closed import PaperModel, contact_mean_pressure
from squeezefilm.physics.film.gap import PaperGap

HIGHEST_AMPLITUDE: si.Metre = 50e-6


def _unclipped(gap: PaperGap, force: Any, ambient: float, model: PaperModel) -> Any:
    """1 − (⟨P̄⟩ − 1)/P_f, below zero where the finger would float away."""
    over_pressure = contact_mean_pressure(gap, model) - 1
    pressure = force / gap.contact_length**2
    return 1 - over_pressure / (pressure if model == "paper2008-printed" else pressure / ambient)


@si.checked_numbers
def relative_friction(
    gap: PaperGap,
    normal_force: Annotated[si.NewtonLike, si.Above(0.0)],
    ambient_pressure: Annotated[si.Pascal, si.Above(0.0)],
    model: PaperModel = "paper2008",
) -> si.DimensionlessLike:
    """The relative friction µ′/µ (dimensionless) of the paper's model at the amplitude(s) of `gap`.

    Scalar, or one value for each amplitude; `normal_force` in N broadcasts against them. The
    contact is l0 × l0, and the pressure that of σ → ∞. "paper2008-printed" takes eqs 1, 2, 12, 13
    and 14 as they stand, P∞ being the normalised pressure that the text calls it: it gives
    practically 1 at every amplitude.

    Raises `InputError` for values that are not finite or positive, or an unknown model.
    """
    value = np.maximum(0.0, _unclipped(gap, normal_force, ambient_pressure, model))
    return value if np.ndim(value) else float(value)


@si.checked_numbers
def vibration_amplitude_for(
    relative_friction: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)],
    gap: PaperGap,
    normal_force: Annotated[si.Newton, si.Above(0.0)],
    ambient_pressure: Annotated[si.Pascal, si.Above(0.0)],
    model: PaperModel = "paper2008",
) -> si.Metre:
    """The least vibration amplitude (m, zero-to-peak) that brings µ′/µ down to a wanted value.

    `relative_friction` in [0, 1]; the amplitude in `gap` is disregarded. Raises `InputError` for
    values out of bounds and `UnreachableError` where no amplitude up to 50 µm brings the friction
    that low.
    """

    def friction(amplitude: float) -> float:
        at = gap.with_amplitude(amplitude)
        return float(_unclipped(at, normal_force, ambient_pressure, model))

    return least_amplitude(friction, relative_friction, model)


@si.checked_numbers
def least_amplitude(
    friction: Callable[[float], float],
    wanted: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)],
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
