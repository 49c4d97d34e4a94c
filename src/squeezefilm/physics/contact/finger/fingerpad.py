"""The fingerpad as a mass between bone and surface: what its skin passes on of a changing friction.

The skin under the contact (mass m) hangs on the bone by a spring k and a damper c. While it slides
it obeys m ẍ + c (ẋ − v_bone) + k (x − x_bone) = −F with F the friction force. Its answer
to a friction that is modulated is here in closed form.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, cast

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import PAD_DAMPING, PAD_MASS, PAD_STIFFNESS

MetrePerNewtonComplexLike = Annotated[complex | si.ComplexArray, si.Unit("m/N")]

_SOURCE = (
    "published, of 7 people at 0.5 N: Wiertlewski and Hayward, Journal of Biomechanics 45 (2012) "
    "1869"
)
EVIDENCE = dict.fromkeys(("stiffness", "damping", "mass"), _SOURCE)
"""Sources of the defaults of `FingerpadDynamics`."""


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class FingerpadDynamics:
    """The lumped tangential dynamics of a fingerpad.

    One mass, linear: holds for stretches small against the contact (below 1 mm) and below the
    frequencies at which the contact deforms within itself. The whole contact sticks or slides at
    once; real ones slide from the edge inwards. The defaults are those published for a normal force
    of 0.5 N (see `EVIDENCE`): 1.48 N/mm and 1.78 N·s/m times F^0.35, 0.20 g times F^0.26, F in N.

    Args:
        stiffness: of the pad between bone and surface (N/m); above 0.
        damping: (N·s/m); at least 0.
        mass: of the skin that moves with the contact (kg); above 0.

    Raises:
        InputError: a value outside its range.
    """

    stiffness: Annotated[si.NewtonPerMetre, PAD_STIFFNESS] = 1160.0
    damping: Annotated[si.NewtonSecondPerMetre, PAD_DAMPING] = 1.40
    mass: Annotated[si.Kilogram, PAD_MASS] = 1.67e-4

    @classmethod
    def pressed(
        cls, normal_force: Annotated[si.Newton, si.Above(0.0), si.AtMost(2.0)]
    ) -> FingerpadDynamics:
        """The published pad at a normal force (N). Raises `InputError` for one out of range."""
        si.require("normal_force", normal_force, si.Unit("N"), above=0.0, at_most=2.0)
        rise = normal_force**0.35
        return cls(1480.0 * rise, 1.78 * rise, 0.20e-3 * normal_force**0.26)

    @property
    def resonance_frequency(self) -> si.Hertz:
        """Undamped resonance frequency of the sliding skin (Hz)."""
        return math.sqrt(self.stiffness / self.mass) / (2 * math.pi)


@si.closed_form(positive="stiffness mass", nonnegative="damping frequency")
def skin_displacement_per_friction(
    frequency: si.HertzLike,
    stiffness: si.NewtonPerMetreLike,
    damping: si.NewtonSecondPerMetreLike,
    mass: si.KilogramLike,
) -> MetrePerNewtonComplexLike:
    """Complex skin displacement per friction force modulated at a frequency (m/N), sliding.

    −1/(k − mω² + icω), ω = 2πf: more friction drags the skin back. Arguments (Hz, N/m, N·s/m, kg)
    broadcast. Holds while the skin never stops. Raises `InputError` for a stiffness or mass not
    above 0, or a negative damping or frequency.
    """
    omega = 2 * math.pi * frequency
    response: Any = -1 / (stiffness - mass * omega**2 + 1j * damping * omega)
    return cast(MetrePerNewtonComplexLike, response)
