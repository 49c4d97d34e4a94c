"""Friction of what touches in bursts: elastic until it slips, anew in every period.

Film and asperities share the normal load (`balance`); what remains in contact touches once a
period. Shear q (over µ) builds up while the finger moves on at a speed U, dq/dt = k_t U/µ, until it
reaches what friction can hold: the pressure of the asperities, or, of a rough elastic interface,
what is in proportion to its real contact area. Where a period is too short for it the mean friction
is less than the asperities' share of the load. Our own derivation; the element without gas is
`tapping`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.contact.asperities import MINDLIN_RATIO, TangentialStiffness
from squeezefilm.contact.rough_contact import RoughContact
from squeezefilm.contact.sharing.balance import LoadSharing


@si.checked_numbers
@dataclass(frozen=True)
class AsperityShear:
    """The tangential element behind the asperities under a finger that slides at `speed`.

    `stiffness` is "rigid" (all that touches slips), "constant" (k_t = κ times the normal stiffness
    at rest under the same load) or "following" (κ times that at every moment, as many small
    contacts have it; those that part take their share of the shear with them). κ is
    `stiffness_ratio`.
    """

    speed: Annotated[si.MetrePerSecondLike, si.AtLeast(0.0)]
    friction_coefficient: Annotated[si.Dimensionless, si.Above(0.0)] = 0.9
    stiffness: TangentialStiffness = "following"
    stiffness_ratio: Annotated[si.Dimensionless, si.Above(0.0)] = MINDLIN_RATIO

    @property
    def words(self) -> str:
        """What it is, for the name of a model."""
        if self.stiffness == "rigid":
            return "what touches slips"
        return f"what touches is elastic until it slips ({self.stiffness} tangential stiffness)"


@si.checked_numbers
def sheared_friction(
    shared: LoadSharing, shear: AsperityShear, frequency: Annotated[si.Hertz, si.Above(0.0)]
) -> si.DimensionlessArray:
    """µ′/µ (dimensionless) of balanced plateaus at a frequency (Hz): the shape of the speed, then
    that of the plateaus.

    The mean over a period of what is held in shear, over what the same load holds at rest. With
    "rigid" shear and `AsperityLaw` it is `LoadSharing.relative_friction` to the residual of the
    balance. It never falls with the speed; with a stiffness that follows the load all slips, and
    no more is gained, from U = µ ω a/κ on, a the amplitude of the gap. Toward U = 0 a constant
    stiffness keeps the least pressure of the period, one that follows keeps nothing.
    """
    from squeezefilm.contact.sharing import shear_kernel as kernel

    law: Any = shared.asperities
    full = law.modulus * law.rms_slope if isinstance(law, RoughContact) else 0.0
    kind = {"rigid": kernel.RIGID, "constant": kernel.CONSTANT, "following": kernel.FOLLOWING}
    per_speed = shear.stiffness_ratio / (shear.friction_coefficient * 2 * math.pi * frequency)
    columns = np.broadcast_arrays(shared.mean_gap, shared.gap_amplitude, shared.plateau_pressure)
    rows = np.stack([np.ravel(one) for one in columns], axis=1)
    speeds = np.ravel(np.asarray(shear.speed, dtype=float))
    found = np.empty((speeds.size, rows.shape[0]))
    for row, speed in zip(found, speeds, strict=True):
        element = kernel.CompiledShear(kind[shear.stiffness], per_speed * speed, 0.0, full)
        kernel.sheared_rows(law.compiled(), rows, element, row)
    # Without vibration all of it is held, to rounding.
    found = np.clip(found, 0.0, 1.0)
    return found.reshape(np.shape(shear.speed) + columns[0].shape)
