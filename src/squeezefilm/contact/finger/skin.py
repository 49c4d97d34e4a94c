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

PUBLISHED_IMPEDANCE: si.NewtonSecondPerMetre = 55.0
"""Mechanical impedance of fingertips that clearly perceive an ultrasonic switch: Monnoyer, Diaz,
Bourdin and Wiertlewski 2017, 10.1109/WHC.2017.7989889, abstract. No more of it could be read: it
gives neither frequency, force nor area, nor whether this is a magnitude or a real part."""


@si.checked_numbers
@dataclass(frozen=True)
class Skin:
    """Mass, stiffness and damping of the skin per area of plateau, at ultrasonic frequency.

    The mass is assumed: 3 mm of tissue of 1100 kg/m³ moving along; so is that there is no
    stiffness, which is taken to be below its inertia (0.2 MPa/µm at 40 kHz).

    The damping is `PUBLISHED_IMPEDANCE`, taken for the real part that a plate feels of a finger
    pressed on so firmly that film and asperities are stiff against it, over 5/7 (the default
    plateaus) of 1 cm²; that reading and that area are assumed. Were it the magnitude, the damping
    would be 0.6 times as large at 30 kHz; an area of half or twice a square centimetre makes it
    twice or half. A lighter touch lets the plate feel less: see `load.finger_impedance`.
    """

    mass_per_area: Annotated[si.KilogramPerSquareMetre, SKIN_MASS] = 3.3
    stiffness_per_area: Annotated[si.PascalPerMetre, SKIN_STIFFNESS] = 0.0
    damping_per_area: Annotated[si.PascalSecondPerMetre, SKIN_DAMPING] = 7.7e5

    @si.checked_numbers
    def dynamic_stiffness(self, frequency: Annotated[si.Hertz, si.Above(0.0)]) -> complex:
        """k − m ω² + iωc in Pa/m, ω = 2π frequency."""
        omega = 2 * np.pi * frequency
        return complex(
            self.stiffness_per_area - self.mass_per_area * omega**2,
            self.damping_per_area * omega,
        )
