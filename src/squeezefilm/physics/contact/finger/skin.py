"""The skin at ultrasonic frequency: nearly inertial, moved a little by the film's pressure.

A patch of skin over a ridge is a mass per area m on a stiffness k and a damping c per area. The
alternating pressure of film and asperities moves it by y = p/D, D = k − m ω² + iωc, so that the gap
swings by b = a − y instead of a; in the mean the skin is soft and only carries the load.

With a stiffness Z of film and asperities |b/a| = |D/(D + Z)|. Without damping the gap swings less
than the plate, and damping makes it swing more, where k − m ω² > −|Z|²/(2 Re Z): on an elastic
skin, which rides along with the plate, or one that is light against the interface. On a heavier
skin without stiffness the gap swings more than the plate, and damping takes from that.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import SKIN_DAMPING, SKIN_MASS, SKIN_STIFFNESS


@si.checked_numbers
@dataclass(frozen=True)
class Skin:
    """Mass, stiffness and damping of the skin per area of plateau, at ultrasonic frequency.

    The defaults are derived from 43 fingertips pressed on glass with 0.5 N at 34.59 kHz (Monnoyer,
    Diaz, Bourdin and Wiertlewski, IEEE Transactions on Haptics 11 (2018) 579, read off a figure):
    medians of 18.9 N·s/m and 0.112 g, a magnitude of 33 N·s/m on average. What film and asperities
    of the default finger leave of these medians to the skin at a vanishing amplitude is 1.2 kg/m²
    and no damping: the film alone loses as much. Area and interface are assumed, and the amplitude
    of the measurement was not read (see `load`). No stiffness is known: a skin on which its
    stiffness weighs more than its inertia would raise the resonance, which none of the 43 did.
    """

    mass_per_area: Annotated[si.KilogramPerSquareMetre, SKIN_MASS] = 1.2
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
