"""Published directions of friction under vibration, asked of each model at one frozen set.

What is compared are directions and orders of magnitude, from abstracts: see `frozen`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from squeezefilm.physics.contact.finger.fingertip import Skin
from squeezefilm.validation.frozen import FROZEN, MODELS
from squeezefilm.validation.values import ClaimValue

# 0.017 atm (Pa).
_THIN = 0.017 * 101325.0

DIRECTION_VALUES: dict[str, Callable[[str], ClaimValue]] = {}


def _direction(
    claim: str,
) -> Callable[[Callable[[str], ClaimValue]], Callable[[str], ClaimValue]]:
    """Enter a function of the model's name as what computes a published direction."""

    def register(function: Callable[[str], ClaimValue]) -> Callable[[str], ClaimValue]:
        DIRECTION_VALUES[claim] = function
        return function

    return register


@_direction("vacuum")
def _(model: str) -> ClaimValue:
    def left(slip: str, speed: float = FROZEN.speed) -> float:
        at = replace(FROZEN, slip=slip, speed=speed)
        inside = at.relative_friction(model, ambient_pressure=_THIN)
        return (1 - inside) / (1 - at.relative_friction(model))

    shares = left("fukui-kaneko"), left("veijola")
    if MODELS[model] == "closed form":
        return ClaimValue(shares)
    path = FROZEN.gas.at_pressure(_THIN).mean_free_path
    return ClaimValue(
        shares,
        note=f"the mean free path is {1e6 * path:.1f} µm there, about as wide as the gap: the laws "
        "of Fukui and Kaneko and of Veijola are in range, that of first order is not and would "
        f"give {left('first'):.3f}; at 300 mm/s {left('fukui-kaneko', 0.3):.3f}",
    )


@_direction("half-atmosphere")
def _(model: str) -> ClaimValue:
    half, whole = (FROZEN.relative_friction(model, ambient_pressure=p) for p in (5e4, 1e5))
    return ClaimValue((abs(half - whole),), note=f"signed, {half - whole:+.4f}")


@_direction("reach")
def _(model: str) -> ClaimValue:
    value = 1 - FROZEN.relative_friction(
        model, roughness=5e-9, amplitude=3e-6, plateau_pressure=2e3
    )
    rough = 1 - FROZEN.relative_friction(model, amplitude=3e-6)
    return ClaimValue(
        (value,),
        note="glass of 5 nm, 3 µm at 40.5 kHz, 2 kPa on the plateaus (0.14 N on 1 cm²), all of "
        f"them our choice; on the frozen roughness and load {rough:.3f}",
    )


def _gain(model: str, name: str, texts: tuple[str, str], values: tuple[float, float]) -> ClaimValue:
    """The fall of friction from the first to the second value of a parameter."""
    changed = (replace(FROZEN, **{name: value}) for value in values)  # type: ignore[arg-type]
    low, high = (one.relative_friction(model) for one in changed)
    return ClaimValue((low - high,), note=f"µ′/µ {low:.3f} at {texts[0]}, {high:.3f} at {texts[1]}")


@_direction("frequency")
def _(model: str) -> ClaimValue:
    return _gain(model, "frequency", ("30 kHz", "60 kHz"), (30e3, 60e3))


@_direction("amplitude")
def _(model: str) -> ClaimValue:
    return _gain(model, "amplitude", ("1 µm", "3 µm"), (1e-6, 3e-6))


@_direction("roughness")
def _(model: str) -> ClaimValue:
    return _gain(model, "roughness", ("0.6 µm", "0.2 µm"), (0.6e-6, 0.2e-6))


@_direction("speed")
def _(model: str) -> ClaimValue:
    return _gain(model, "speed", ("300 mm/s", "30 mm/s"), (0.3, 0.03))


@_direction("load")
def _(model: str) -> ClaimValue:
    light, hard = (
        FROZEN.relative_friction(model, plateau_pressure=factor * FROZEN.plateau_pressure)
        for factor in (1, 4)
    )
    return ClaimValue(
        (abs(hard / light - 1),),
        note=f"µ′/µ {light:.3f} at the frozen load, {hard:.3f} at four times it",
    )


@_direction("damping")
def _(model: str) -> ClaimValue:
    inertia = Skin().mass_per_area * (2 * math.pi * FROZEN.frequency) ** 2

    def gain(stiffness: float) -> float:
        free, damped = (
            FROZEN.relative_friction(
                model, skin=Skin(stiffness_per_area=stiffness, damping_per_area=damping)
            )
            for damping in (0.0, 1e6)
        )
        return free - damped

    return ClaimValue(
        (gain(1.1 * inertia),),
        note="a damping of 1 MPa·s/m on an elastic skin whose stiffness is 1.1 times its inertia; "
        f"with twice its inertia {gain(2 * inertia):+.4f}, and on the default skin, which is a "
        f"mass without stiffness, {gain(0.0):+.4f}",
    )


@_direction("orientation")
def _(model: str) -> ClaimValue:
    along, slanted, across = (
        FROZEN.pad_friction(model, math.radians(angle)) for angle in (0, 45, 90)
    )
    found = along, slanted, across
    return ClaimValue(
        (max(found) - min(found),),
        note=f"µ′/µ of the pad {along:.3f} with ridges along the nodal lines, {slanted:.3f} at "
        f"45°, {across:.3f} across them",
    )
