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
from squeezefilm.compiled import announce
from squeezefilm.contact.asperities import MINDLIN_RATIO, TangentialStiffness
from squeezefilm.contact.sharing.balance import LoadSharing


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class AsperityShear:
    """The tangential element behind the asperities under a finger that slides at `speed`.

    `speed` may be an array. `stiffness` is "rigid" (all that touches slips), "constant" (k_t = κ
    times the normal stiffness at rest under the same load) or "following" (κ times that at every
    moment, as many small contacts have it; those that part take their share of the shear with
    them). κ is `stiffness_ratio`.
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
    """µ′/µ (dimensionless) of balanced plateaus at a frequency (Hz): of the shape of the speeds,
    then that of the plateaus. The balance does not depend on the speed, nor does what shear sees
    along the period: many speeds in one call cost little more than one.

    The mean over a period of what is held in shear, over what the same load holds at rest. With
    "rigid" shear and `AsperityLaw` it is `LoadSharing.relative_friction` to the residual of the
    balance. It never falls with the speed, and at a finite one it is what rigid shear has: with a
    stiffness k that follows the load from U = µ ω a/κ on, a the amplitude of the gap, and with a
    constant one from µ ω max|dp_a/dT|/(κ k) on; below that the difference goes with the square of
    what is lacking. Toward U = 0 a constant stiffness keeps the least pressure of the period, one
    that follows keeps nothing: what it has then is in proportion to U. Within 1e-6 of µ′/µ (5e-6
    of a rough interface that is pressed nearly flat). Raises `InputError` for what cannot be used.
    """
    from squeezefilm.contact.sharing import shear_kernel as kernel

    announce(kernel.sheared_rows, "shear of what touches", 20)
    kind = {"rigid": kernel.RIGID, "constant": kernel.CONSTANT, "following": kernel.FOLLOWING}
    speed = np.asarray(shear.speed, dtype=float)
    advance = shear.stiffness_ratio * speed.ravel()
    advance /= shear.friction_coefficient * 2 * math.pi * frequency
    element = kernel.CompiledShear(kind[shear.stiffness], advance)
    columns = np.broadcast_arrays(shared.mean_gap, shared.gap_amplitude, shared.plateau_pressure)
    found = np.empty((speed.size, columns[0].size))
    rows: Any = np.stack([np.ravel(one) for one in columns], axis=1)
    kernel.sheared_rows(shared.asperities.compiled(), rows, element, found)
    # Without vibration all of it is held, to rounding.
    return np.clip(found, 0.0, 1.0).reshape(speed.shape + columns[0].shape)
