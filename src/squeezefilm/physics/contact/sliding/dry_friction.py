"""The law of dry friction: the friction force by load and speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class DryFriction:
    """Coulomb's law, set-valued at rest, with two options that each default to off.

    At rest the friction force is whatever holds the skin, up to `static_ratio` times the kinetic
    force; while the skin moves µ F_ref (F/F_ref)^load_exponent opposes it. How much static friction
    of skin exceeds kinetic friction was not read in a source. The coefficient of fingers was found
    independent of the load, except that it falls with load after more than 10 s on smooth
    impermeable surfaces (Dzidek et al. 2017, 10.1098/rsif.2016.0935, abstract), so an exponent
    below 1 belongs to those.

    Args:
        static_ratio: static over kinetic friction (1); at least 1.
        load_exponent: of the friction force in the normal force (1); above 0, at most 1.
        reference_force: normal force at which the coefficient is given (N); above 0. Without
            meaning at an exponent of 1.

    Raises:
        InputError: a value outside its range.
    """

    static_ratio: Annotated[si.Dimensionless, si.AtLeast(1.0)] = 1.0
    load_exponent: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)] = 1.0
    reference_force: Annotated[si.Newton, si.Above(0.0)] = 1.0

    @si.checked_numbers
    def kinetic_force(
        self,
        friction_coefficient: Annotated[si.DimensionlessLike, si.AtLeast(0.0)],
        normal_force: Annotated[si.NewtonLike, si.AtLeast(0.0)],
    ) -> si.NewtonLike:
        """Friction force of sliding (N) under a normal force (N); both broadcast.

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
