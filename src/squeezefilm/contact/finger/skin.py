"""The skin at ultrasonic frequency: nearly inertial, moved a little by the film's pressure.

A patch of skin over a ridge is a mass per area m on a stiffness k and a damping c per area. The
alternating pressure of film and asperities moves it by y = p/(k − m ω² + iωc), so that the gap
swings by b = a − y instead of a; in the mean the skin is soft and only carries the load.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.hard_limits import SKIN_DAMPING, SKIN_MASS, SKIN_STIFFNESS


@si.checked_numbers
@dataclass(frozen=True)
class Skin:
    """Mass, stiffness and damping of the skin per area, at ultrasonic frequency.

    The defaults are assumed: 3 mm of tissue of 1100 kg/m³ moving along, and no stiffness or
    damping, which at 40 kHz are taken to be below its inertia (0.2 MPa/µm).
    """

    mass_per_area: Annotated[si.KilogramPerSquareMetre, SKIN_MASS] = 3.3
    stiffness_per_area: Annotated[si.PascalPerMetre, SKIN_STIFFNESS] = 0.0
    damping_per_area: Annotated[si.PascalSecondPerMetre, SKIN_DAMPING] = 0.0

    @si.checked_numbers
    def dynamic_stiffness(self, frequency: Annotated[si.Hertz, si.Above(0.0)]) -> complex:
        """k − m ω² + iωc in Pa/m, ω = 2π frequency."""
        omega = 2 * np.pi * frequency
        return complex(
            self.stiffness_per_area - self.mass_per_area * omega**2,
            self.damping_per_area * omega,
        )
