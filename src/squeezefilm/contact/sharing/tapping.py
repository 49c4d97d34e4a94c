"""The competing mechanism: intermittent contact without gas, and a skin that shears between taps.

A skin that cannot follow the vibration is tapped by the plate once a period. While in contact it
is dragged along and shears like a spring until it slips; whenever contact is lost the shear is
released. Friction falls where the taps are too short for the shear to build up to slip.

Vezzoli et al. 2017, Part 1 (10.1109/TOH.2017.2671432), of which the abstract was read, study this
with finite elements and a spring and Coulomb slider, and find a reduction that depends on
amplitude, frequency, friction coefficient and the inverse of the finger's speed through one
dimensionless group, and not on the normal force or the moduli once contact is well intermittent.
The model here is our own derivation of such a spring and slider, not theirs: the tangential element
of `shear` without gas, behind a contact whose pressure is in proportion to the overlap.

Assumptions: no gas; the skin's mean position does not move within a period (inertial); contact
pressure is that of a linear spring of normal stiffness k_n per area in proportion to the overlap;
tangential stiffness k_t = `stiffness_ratio` k_n (Mindlin, incompressible skin: 2/3); Coulomb
friction with one coefficient; shear starts from zero at each tap.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.compiled import announce
from squeezefilm.contact.asperities import (
    LINEAR_OVERLAP,
    MINDLIN_RATIO,
    NO_CUBICS,
    AsperityLaw,
    CompiledAsperities,
)


@si.closed_form(positive="friction_coefficient amplitude frequency speed")
def tapping_number(
    friction_coefficient: si.DimensionlessLike,
    amplitude: si.MetreLike,
    frequency: si.HertzLike,
    speed: si.MetrePerSecondLike,
) -> si.DimensionlessLike:
    """ψ = µ a ω/U (dimensionless): how the plate's speed compares with the finger's; broadcasts.

    Where it is large, the shear of a tap stays below slip: friction falls with amplitude, frequency
    and friction coefficient and rises with the finger's speed U.
    """
    return friction_coefficient * amplitude * (2 * np.pi * frequency) / speed


@dataclass(frozen=True)
class Tapping:
    """Friction under intermittent contact at one working point.

    `contact_fraction` is the part of the period in contact, `penetration` how deep the plate
    presses into the skin at most (m). `intermittent` is False where the skin never leaves the
    plate.
    """

    relative_friction: si.Dimensionless
    contact_fraction: si.Dimensionless
    penetration: si.Metre
    tapping_number: si.Dimensionless
    intermittent: bool
    amplitude: si.Metre
    frequency: si.Hertz
    speed: si.MetrePerSecond
    pressure: si.Pascal
    model: str = "intermittent contact, spring and Coulomb slider, no gas"


@si.checked_numbers
def contact_angle(
    amplitude: Annotated[si.Metre, si.AtLeast(0.0)],
    rest_penetration: Annotated[si.Metre, si.Above(0.0)],
) -> float:
    """Half the phase (rad) in contact, θ0, at which taps of a linear skin carry the load.

    a (sin θ0 − θ0 cos θ0)/π = `rest_penetration` = p/k_n: the mean of a (cos T − cos θ0) over the
    taps. π where the skin never leaves the plate (amplitude ≤ rest_penetration).
    """
    from scipy.optimize import brentq

    if amplitude <= rest_penetration:
        return float(np.pi)
    wanted = np.pi * rest_penetration / amplitude
    return float(brentq(lambda t: np.sin(t) - t * np.cos(t) - wanted, 0.0, np.pi, xtol=1e-14))


def _sheared(
    half: float, amplitude: si.Metre, rest: si.Metre, pressure: si.Pascal, advance: float
) -> float:
    """µ′/µ by the tangential element of `shear`, behind contact in proportion to the overlap."""
    from squeezefilm.contact.sharing import shear_kernel as kernel

    announce(kernel.sheared_rows, "shear of what touches", 20)
    law = CompiledAsperities(LINEAR_OVERLAP, np.array([pressure, 0.0, rest]), NO_CUBICS, NO_CUBICS)
    found = np.empty((1, 1))
    kernel.sheared_rows(
        law,
        np.array([[amplitude * np.cos(half), amplitude, pressure]]),
        kernel.CompiledShear(kernel.CONSTANT, np.array([advance * amplitude])),
        found,
    )
    return float(found[0, 0])


@si.checked_numbers
def tapping_friction(
    amplitude: Annotated[si.Metre, si.AtLeast(0.0)],
    frequency: Annotated[si.Hertz, si.Above(0.0)],
    speed: Annotated[si.MetrePerSecond, si.Above(0.0)],
    pressure: Annotated[si.Pascal, si.Above(0.0)],
    *,
    friction_coefficient: Annotated[si.Dimensionless, si.Above(0.0)] = 0.9,
    normal_stiffness: Annotated[si.PascalPerMetre, si.Above(0.0)] | None = None,
    stiffness_ratio: Annotated[si.Dimensionless, si.Above(0.0)] = MINDLIN_RATIO,
) -> Tapping:
    """Friction of a patch of skin under a mean `pressure` (Pa), tapped at `amplitude` (m).

    `normal_stiffness` is that of the asperities per area, at the load (None: that of exponential
    asperities, p/λ_r with the λ_r that `AsperityLaw` assumes; the skin is then λ_r deep into the
    plate at rest, whatever the load). Within a tap the shear stress q follows the finger,
    dq/dt = k_t U, capped by µ p_c(t). Raises `InputError` for values that cannot be used.
    """
    if normal_stiffness is None:
        normal_stiffness = pressure / AsperityLaw().decay_length
    rest = pressure / normal_stiffness
    half = contact_angle(amplitude, rest)
    intermittent = half < np.pi
    number = (
        float(tapping_number(friction_coefficient, amplitude, frequency, speed))
        if amplitude > 0
        else 0.0
    )
    friction = 1.0
    if intermittent:
        friction = _sheared(half, amplitude, rest, pressure, stiffness_ratio / number)
    return Tapping(
        relative_friction=min(friction, 1.0),
        contact_fraction=half / np.pi,
        penetration=amplitude * (1 - np.cos(half)) if intermittent else rest + amplitude,
        tapping_number=number,
        intermittent=intermittent,
        amplitude=amplitude,
        frequency=frequency,
        speed=speed,
        pressure=pressure,
    )
