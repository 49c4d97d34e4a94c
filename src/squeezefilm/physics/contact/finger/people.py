"""How fingers differ from person to person, as far as friction on vibrating glass was published.

Seventy free strokes of 14 people, each fitted by its authors with a Gaussian of the amplitude:
Monnoyer, Diaz, Bourdin and Wiertlewski, IEEE Trans. Haptics 11 (2018) 579. Decay lengths ℓ of the
levitation model that fall to half at the same amplitude, and frictions at rest µ0, are log-normal
as far as these strokes can tell, and correlated. Who made which stroke was not published, so that a
stroke counts as a person. `tools/levitation_fit.py` prints the numbers.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si

PEOPLE = 14
"""How many made the strokes."""
DECAY_LENGTH_SPREAD: si.Dimensionless = 0.345
"""Standard deviation of ln ℓ over the strokes."""
REST_FRICTION_SPREAD: si.Dimensionless = 0.491
"""Standard deviation of ln µ0 over the strokes."""
CORRELATION: si.Dimensionless = 0.34
"""Of ln ℓ with ln µ0 over the strokes."""
MEAN_SPREAD: si.Dimensionless = DECAY_LENGTH_SPREAD / math.sqrt(PEOPLE)
"""Standard error of the mean of ln ℓ, with each person counted once."""


@si.checked_numbers
def rest_friction_factor(
    share: Annotated[si.DimensionlessArray, si.Above(0.0), si.Below(1.0)],
    decay_ratio: Annotated[si.DimensionlessArray, si.Above(0.0)],
) -> si.DimensionlessArray:
    """µ0 of people over the median µ0, not exceeded with probability `share` by people whose ℓ is
    `decay_ratio` times the median ℓ; all of shape (n,). Raises `InputError` for other shapes."""
    from scipy.special import ndtri

    si.require_alike(share=share, decay_ratio=decay_ratio)
    apart = math.sqrt(1 - CORRELATION**2) * ndtri(share)
    along = CORRELATION * np.log(decay_ratio) / DECAY_LENGTH_SPREAD
    return np.exp(REST_FRICTION_SPREAD * (along + apart))
