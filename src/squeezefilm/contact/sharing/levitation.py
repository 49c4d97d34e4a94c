"""The published levitation model of 2016 in closed form: one film over the whole contact.

Wiertlewski, Fenton Friesen and Colgate, PNAS 113 (2016) 9210, supporting information: the squeezed
film lifts a skin whose contact pressure falls off with the gap u as exp(−u/ℓ),

    p_s (1 − exp(−(u − u0)/ℓ)) = (5/4) p0 a²/u²,    µ′/µ = exp(−(u − u0)/ℓ),

with the finger's pressure p_s, ambient p0, and the gap u0 at rest. With z = (u − u0)/ℓ and the
scale g = ℓ √(p_s/(1.25 p0)) it is (1 − exp(−z)) (z + u0/ℓ)² = (a/g)². The film's asymptote is that
of a large squeeze number and a small excursion; the excursion is always small, since a/u stays
below √(p_s/(1.25 p0)), 0.15 for 2.8 kPa in air.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from squeezefilm import quantities as si

_STEPS = 60
_LEAST_LIFTED = 1 - math.exp(-1.0)


@si.checked_numbers
def levitation_friction(
    relative_amplitude: Annotated[si.DimensionlessArray, si.AtLeast(0.0), si.AtMost(1e6)],
    rest_gap: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1e6)] = 0.0,
) -> si.DimensionlessArray:
    """µ′/µ over the amplitude in scales g, any shape; `rest_gap` is u0/ℓ.

    Without a gap at rest friction falls at once, with one it falls as a Gaussian at first. Range:
    amplitudes small against the gap, a contact of many wavelengths of the squeezed film (a squeeze
    number of hundreds). Raises `InputError` for what is out of range.
    """
    wanted = relative_amplitude**2
    low = np.zeros(wanted.shape)
    # From z = 1 on the left side is at least (1 − 1/e) z².
    high = np.maximum(1.0, np.sqrt(wanted / _LEAST_LIFTED))
    for _ in range(_STEPS):
        middle = 0.5 * (low + high)
        lifted = -np.expm1(-middle) * (middle + rest_gap) ** 2 >= wanted
        low, high = np.where(lifted, low, middle), np.where(lifted, middle, high)
    return np.exp(-high)
