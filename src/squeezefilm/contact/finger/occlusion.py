"""Slow drift of dry friction: sweat that cannot leave softens the skin, and the contact grows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm import quantities as si

EVIDENCE = {
    "time_constant": "first-order kinetics of the junction area on glass, saturated 'typically "
    "within 20 s' (Dzidek et al. 2017, 10.1073/pnas.1706233114, abstract): 95 % at 20 s",
    "rise": "unverified default: the drift of friction itself was not read in any source",
}
"""Where the defaults of `Occlusion` come from."""


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
