"""The paper's friction model: the film carries part of the finger, the surface the rest.

Biet et al., equations 13 and 14. Model "paper2008" is the corrected form, "paper2008-printed" the
equations as they stand. Both take σ → ∞, which the paper's σ ≈ 20 is far from: ask
`physics.film.validity.film_validity`.
"""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import UnreachableError
from squeezefilm.physics.film.closed import PaperModel, contact_mean_pressure
from squeezefilm.physics.film.gap import PaperGap


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
    *,
    highest: Annotated[si.Metre, si.AtLeast(1e-12)] = 50e-6,
) -> si.Metre:
    """The least vibration amplitude (m, zero-to-peak) that brings µ′/µ down to a wanted value.

    `relative_friction` in [0, 1]; the amplitude in `gap` is disregarded. Searched up to `highest`
    (m). Raises `InputError` for values out of bounds and `UnreachableError` where no amplitude up
    to `highest` brings the friction that low.
    """
    from scipy.optimize import brentq

    def excess(amplitude: Any) -> Any:
        friction = _unclipped(gap.with_amplitude(amplitude), normal_force, ambient_pressure, model)
        return friction - relative_friction

    amplitudes = np.concatenate([[0.0], np.geomspace(highest * 1e-5, highest, 120)])
    values = excess(amplitudes)
    below = np.flatnonzero(values <= 0)
    if below.size == 0:
        best = int(np.argmin(values))
        closest = si.format_quantity(float(amplitudes[best]), si.Unit("m"))
        raise UnreachableError(
            f"relative_friction = {relative_friction:.4g} is not reached by any vibration "
            f"amplitude up to {si.format_quantity(highest, si.Unit('m'))}: the model '{model}' "
            f"gives {values[best] + relative_friction:.4g} at {closest}"
            " at the least; press less, take a smoother surface or ask for less"
        )
    index = int(below[0])
    if index == 0:
        return 0.0
    low, high = float(amplitudes[index - 1]), float(amplitudes[index])
    return float(brentq(excess, low, high, xtol=1e-16, rtol=1e-12))
