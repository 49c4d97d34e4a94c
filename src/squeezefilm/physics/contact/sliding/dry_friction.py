"""The law of dry friction: how the friction force follows load, speed, place and contact time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class DryFriction:
    """Coulomb's law, set-valued at rest, with three options that each default to off.

    At rest the friction force is whatever holds the skin, up to `static_ratio` times the kinetic
    force; while the skin moves at a speed w it opposes it with

        µ F_ref (F/F_ref)^load_exponent · (1 + (static_ratio − 1) exp(−w/stribeck_speed)).

    With a `stribeck_speed` of 0 the drop from static to kinetic friction happens at once. How much
    static friction of skin exceeds kinetic friction and over which speeds it drops was not read in
    a source: both are yours to give. The coefficient of fingers was found independent of the load,
    except that it falls with load after more than 10 s on smooth impermeable surfaces (Dzidek et
    al. 2017, 10.1098/rsif.2016.0935, abstract), so an exponent below 1 belongs to those.

    Args:
        static_ratio: static over kinetic friction (1); at least 1.
        stribeck_speed: over which static falls to kinetic friction (m/s); at least 0.
        load_exponent: of the friction force in the normal force (1); above 0, at most 1.
        reference_force: normal force at which the coefficient is given (N); above 0. Without
            meaning at an exponent of 1.

    Raises:
        InputError: a value outside its range.
    """

    static_ratio: Annotated[si.Dimensionless, si.AtLeast(1.0)] = 1.0
    stribeck_speed: Annotated[si.MetrePerSecond, si.AtLeast(0.0)] = 0.0
    load_exponent: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)] = 1.0
    reference_force: Annotated[si.Newton, si.Above(0.0)] = 1.0

    @si.checked_numbers
    def kinetic_force(
        self,
        friction_coefficient: Annotated[si.DimensionlessLike, si.AtLeast(0.0)],
        normal_force: Annotated[si.NewtonLike, si.AtLeast(0.0)],
    ) -> si.NewtonLike:
        """Friction force of fast sliding (N) under a normal force (N); both broadcast.

        Raises:
            InputError: a negative or infinite coefficient or force.
        """
        relative = np.asarray(normal_force, dtype=float) / self.reference_force
        force: si.NewtonLike = (
            friction_coefficient * self.reference_force * relative**self.load_exponent
        )
        return force


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class SpeedFriction:
    """Friction that depends on the skin's own speed over the surface, and on time.

    Rows of friction coefficients over a common grid of speeds, linear between speeds and held
    beyond the last. What a contact under ultrasound gives rises with speed and levels off; rows may
    also fall, or do both.

    Args:
        speed: of the skin over the surface (m/s), shape (k,), k ≥ 2; from exactly 0, rising.
        coefficient: kinetic friction coefficient at those speeds (1), at least 0: shape (n, k), a
            row for each sample, linear between samples; or (k,), the same at all times. The first
            of a row is that towards the speed 0, and what limits sticking: where it is 0, nothing
            holds the skin, which creeps and never sticks.

    Raises:
        InputError: a value outside its range, speeds that do not rise from 0, or another shape.
    """

    speed: si.MetrePerSecondArray
    coefficient: Annotated[si.DimensionlessArray, si.AtLeast(0.0)]

    def __post_init__(self) -> None:
        speed, shape = np.asarray(self.speed, dtype=float), np.shape(self.coefficient)
        if speed.ndim != 1 or speed.size < 2:
            raise InputError(
                f"speed of shape {speed.shape} cannot be used: give a row of speeds, at least two",
                quantity="speed",
            )
        if speed[0] != 0 or np.any(np.diff(speed) <= 0):
            raise InputError(
                "speed must begin at 0, where the value that limits sticking stands, and rise from "
                "each to the next",
                quantity="speed",
            )
        if len(shape) not in (1, 2) or shape[-1] != speed.size:
            raise InputError(
                f"coefficient of shape {shape} does not fit {speed.size} speeds; give one row of "
                f"{speed.size} values per sample, or one row for all",
                quantity="coefficient",
            )


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class FrictionProfile:
    """Friction that belongs to places of the surface: a factor by skin position, linear between.

    For a surface that is itself rough in places; what a display renders follows the sensed finger
    and belongs into the coefficient over time.

    Args:
        start: place of the first value (m).
        spacing: between values (m); above 0.
        relative_friction: factor of the friction coefficient (1), shape (n,), n ≥ 2, at least 0.

    Raises:
        InputError: a value outside its range or fewer than two values.
    """

    start: si.Metre
    spacing: Annotated[si.Metre, si.Above(0.0)]
    relative_friction: Annotated[si.DimensionlessArray, si.AtLeast(0.0)]

    def __post_init__(self) -> None:
        if np.ndim(self.relative_friction) != 1 or np.size(self.relative_friction) < 2:
            raise InputError(
                f"relative_friction of shape {np.shape(self.relative_friction)} cannot be used: "
                "give one value per place, at least two",
                quantity="relative_friction",
            )

    @property
    def end(self) -> si.Metre:
        """Place of the last value (m)."""
        return self.start + self.spacing * (np.size(self.relative_friction) - 1)


EVIDENCE = {
    "time_constant": "first-order kinetics of the junction area on glass, saturated 'typically "
    "within 20 s' (Dzidek et al. 2017, 10.1073/pnas.1706233114, abstract): 95 % at 20 s",
    "rise": "unverified default: the drift of friction itself was not read in any source",
}
"""Where the defaults of `Occlusion` come from: sweat that cannot leave softens the skin, and the
contact grows."""


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Occlusion:
    """Friction that grows with the time a finger has been on a smooth, impermeable surface.

    A saturating exponential, 1 + rise · (1 − exp(−t/time_constant)), that multiplies the friction
    coefficient. The exponential and its time are those of the *junction area*; that friction
    follows the area is an assumption, and moving contacts, which leave their moisture behind, may
    drift less. **`rise` is an unverified default** (see `EVIDENCE`).

    Args:
        rise: relative growth after a long time (1); above −1.
        time_constant: (s); above 0.
        contact_time: how long the finger has already touched when the motion starts (s).

    Raises:
        InputError: a value outside its range.
    """

    rise: Annotated[si.Dimensionless, si.Above(-1.0)] = 0.5
    time_constant: Annotated[si.Second, si.Above(0.0)] = 20.0 / 3.0
    contact_time: Annotated[si.Second, si.AtLeast(0.0)] = 0.0

    @si.checked_numbers
    def factor(self, time: si.SecondLike) -> si.DimensionlessLike:
        """What the friction coefficient is multiplied by, `time` (s) after the motion starts (1).

        Raises `InputError` for a time before the finger touched.
        """
        touched = self.contact_time + time
        si.require("contact_time", touched, si.Unit("s"), at_least=0.0)
        factor: si.DimensionlessLike = 1 - self.rise * np.expm1(-touched / self.time_constant)
        return factor
