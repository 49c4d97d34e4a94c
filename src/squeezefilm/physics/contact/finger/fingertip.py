"""The fingertip as the film and the contact see it, and the dynamics of its pad.

The skin at ultrasonic frequency: nearly inertial, moved a little by the film's pressure.

A patch of skin over a ridge is a mass per area m on a stiffness k and a damping c per area. The
alternating pressure of film and asperities moves it by y = p/D, D = k − m ω² + iωc, so that the gap
swings by b = a − y instead of a; in the mean the skin is soft and only carries the load.

With a stiffness Z of film and asperities |b/a| = |D/(D + Z)|. Without damping the gap swings less
than the plate, and damping makes it swing more, where k − m ω² > −|Z|²/(2 Re Z): on an elastic
skin, which rides along with the plate, or one that is light against the interface. On a heavier
skin without stiffness the gap swings more than the plate, and damping takes from that.

How fingers differ from person to person, as far as friction on vibrating glass was published.

Seventy free strokes of 14 people, each fitted by its authors with a Gaussian of the amplitude:
Monnoyer, Diaz, Bourdin and Wiertlewski, IEEE Trans. Haptics 11 (2018) 579. Decay lengths ℓ of the
levitation model that fall to half at the same amplitude, and frictions at rest µ0, are log-normal
as far as these strokes can tell, and correlated. Who made which stroke was not published, so that a
stroke counts as a person. `tools/levitation_fit.py` prints the numbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal, cast

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import (
    CONTACT_LENGTH,
    FINGER_SPEED,
    FORCE,
    PAD_DAMPING,
    PAD_MASS,
    PAD_STIFFNESS,
    PRESSURE,
    RIDGE_AMPLITUDE,
    RIDGE_PERIOD,
    RIDGES,
    ROUGHNESS,
    SKIN_DAMPING,
    SKIN_MASS,
    SKIN_ROUGHNESS,
    SKIN_STIFFNESS,
    require_within,
)
from squeezefilm.physics.contact.rough_contact import ContactLaw, RoughContact

# The skin under the contact (mass m) hangs on the bone by a spring k and a damper c. While it
# slides it obeys m ẍ + c (ẋ − v_bone) + k (x − x_bone) = −F with F the friction force. Its answer
# to a friction that is modulated is here in closed form.
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
    def pressed(cls, normal_force: si.Newton) -> FingerpadDynamics:
        """The published pad at a normal force (N): above 0, at most 2, or an `InputError`."""
        si.require("normal_force", normal_force, si.Unit("N"), above=0.0, at_most=2.0)
        rise = normal_force**0.35
        return cls(1480.0 * rise, 1.78 * rise, 0.20e-3 * normal_force**0.26)


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


Moisture = Literal["dry", "normal", "moist"]

STIFFNESS_OF_MOISTURE: dict[Moisture, float] = {"dry": 2.0, "normal": 1.0, "moist": 0.4}
"""Stiffness of the outermost skin over that of a normal one: the factor of its modulus, and of what
separate asperities carry at a gap. Assumed: water softens the stratum corneum; the factors are
illustrative, not measured."""

FRICTION_OF_MOISTURE: dict[Moisture, float] = {"dry": 0.6, "normal": 1.0, "moist": 1.8}
"""Friction without vibration over normal. Assumed, illustrative."""

EXPLORING_SPEED: si.MetrePerSecond = 0.08
"""Speed between 77 and 86 mm/s: Smith, Gosselin and Houde 2002, 10.1007/s00221-002-1240-4."""

CONTACT_DECAY_LENGTH: si.Metre = 9.6e-6
"""Geometric mean of what friction at 10 mm/s (7.4 µm, three people) and in free strokes (12.5 µm,
seventy strokes of 14 people, 0.5 N assumed) says: `tools/levitation_fit.py`."""

DECAY_SPEED_EXPONENT: si.Dimensionless = 0.23
"""Takes the one into the other where free strokes slide at 100 mm/s, assumed. Speed was never
varied alone, so that this may be the difference of two laboratories."""

RIDGE_LENGTH: si.Metre = 2.54e-6
"""ℓ over solved films of single ridges, at 32 mm/s, of a person whose `contact_decay_length` is the
mean of people. The same curves and strokes say that people differ in it by the power 0.53 of what
they differ by in that one, and that it grows with 1.79 times the exponent of the speed:
`tools/levitation_fit.py`."""
RIDGE_POWER_OF_PEOPLE: si.Dimensionless = 0.53
RIDGE_POWER_OF_SPEED: si.Dimensionless = 1.79

SLOWEST, FASTEST = 0.01, 0.2
"""The speeds (m/s) between which friction on vibrating glass was published."""

# Frozen, so that every finger may share them.
_ASPERITIES, _SKIN, _FINGERPAD = RoughContact(), Skin(), FingerpadDynamics()


@si.checked_numbers
@dataclass(frozen=True)
class Finger:
    """A fingertip resting on the surface.

    `contact_length` l0 along the wave (the contact is a square of that side, as in the paper's
    eq 13); ridges of `ridge_amplitude` h_e (half their height) and `ridge_period` L;
    `normal_force` F. Pressed on a surface the ridges flatten: `plateau_width` is that of the flat
    part of each (illustrative; 150 to 350 µm are reported).

    The area grows with the load like F^`contact_area_exponent` (the 1/3 assumed lies within the 0.2
    to 0.5 of soft pads; 0: fixed) and is contact_length² at `contact_area_force` (None: at
    `normal_force`). `ridge_angle` is between the ridges' normal and the wave: 0 where ridges run
    along the nodal lines. `speed` is that of sliding.

    `asperities` is the law of the contact with a surface as rough as `asperity_roughness`; on
    another surface its heights scale with √(skin_roughness² + roughness²). With a
    `shear_strength` τ and a `RoughContact` the friction without vibration is τ times the real
    contact area; without it (None) the friction coefficient of the surface stands, at every load.

    Over `contact_decay_length` ℓ the pressure of the contact falls by e as a film lifts it off, at
    `decay_speed`; it grows with `decay_speed_exponent` of the speed. Both are fitted to published
    friction of people (`physics.contact.sharing.levitation`).

    `skin` is the tissue at ultrasonic frequency, `fingerpad` the pad as a hand moves it. All of
    these defaults are assumed and illustrative: they control the friction predicted, so give your
    own where you can.
    """

    contact_length: Annotated[si.Metre, CONTACT_LENGTH]
    ridge_amplitude: Annotated[si.Metre, RIDGE_AMPLITUDE]
    ridge_period: Annotated[si.Metre, RIDGE_PERIOD]
    normal_force: Annotated[si.Newton, FORCE]
    plateau_width: Annotated[si.Metre, RIDGE_PERIOD, si.AtMost("ridge_period")] = 250e-6
    contact_area_exponent: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(1)] = 1 / 3
    contact_area_force: Annotated[si.Newton, FORCE] | None = None
    ridge_angle: Annotated[si.Radian, si.AtLeast(-math.pi), si.AtMost(math.pi)] = 0.0
    asperities: ContactLaw = _ASPERITIES
    asperity_roughness: Annotated[si.Metre, ROUGHNESS] = 0.6e-6
    skin_roughness: Annotated[si.Metre, SKIN_ROUGHNESS] = 0.6e-6
    skin: Skin = _SKIN
    fingerpad: FingerpadDynamics = _FINGERPAD
    moisture: Moisture = "normal"
    speed: Annotated[si.MetrePerSecond, FINGER_SPEED] = EXPLORING_SPEED
    shear_strength: Annotated[si.Pascal, PRESSURE] | None = None
    contact_decay_length: Annotated[si.Metre, si.Above(0), si.AtMost(1e-3)] = CONTACT_DECAY_LENGTH
    decay_speed_exponent: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(2)] = (
        DECAY_SPEED_EXPONENT
    )
    decay_speed: Annotated[si.MetrePerSecond, si.AtLeast(SLOWEST), si.AtMost(FASTEST)] = 0.032

    def __post_init__(self) -> None:
        if self.shear_strength is not None and not isinstance(self.asperities, RoughContact):
            raise InputError(
                "shear_strength acts on the real contact area, which separate asperities do not "
                'know; give asperities of type "rough_contact", or leave shear_strength out',
                quantity="shear_strength",
            )
        _require_ridges(self.contact_length, self.ridge_period)

    @property
    def mean_pressure(self) -> si.Pascal:
        """P_f = F / l0² (paper eq 13)."""
        return self.normal_force / self.contact_length**2

    @si.checked_numbers
    def contact_area(self, normal_force: si.Newton | None = None) -> si.SquareMetre:
        """A = l0² (F/F_ref)^exponent under a force (N; None: the finger's own)."""
        force = self.normal_force if normal_force is None else normal_force
        require_within(FORCE, force, "normal_force")
        reference = self.contact_area_force or self.normal_force
        area = self.contact_length**2 * float((force / reference) ** self.contact_area_exponent)
        _require_ridges(math.sqrt(area), self.ridge_period)
        return area

    @si.checked_numbers
    def decay_length_at(self, speed: si.MetrePerSecondLike) -> si.MetreLike:
        """ℓ (m) at speeds of sliding (m/s): `contact_decay_length` at `decay_speed`, held beyond
        the 10 to 200 mm/s at which friction was measured."""
        paces = np.clip(np.abs(speed), SLOWEST, FASTEST)
        return self.contact_decay_length * (paces / self.decay_speed) ** self.decay_speed_exponent

    @si.checked_numbers
    def ridge_length_at(self, speed: si.MetrePerSecond) -> si.Metre:
        """ℓ (m) at a speed (m/s) where films are solved over single ridges: see `RIDGE_LENGTH`."""
        pace = min(max(abs(speed), SLOWEST), FASTEST) / self.decay_speed
        person = self.contact_decay_length / CONTACT_DECAY_LENGTH
        exponent = RIDGE_POWER_OF_SPEED * self.decay_speed_exponent
        return float(RIDGE_LENGTH * person**RIDGE_POWER_OF_PEOPLE * pace**exponent)

    @si.checked_numbers
    def plateau_pressure(self, normal_force: si.Newton | None = None) -> si.Pascal:
        """p_plateau = F L/(A w): what a flattened ridge carries in the mean."""
        force = self.normal_force if normal_force is None else normal_force
        return force / self.contact_area(force) * self.ridge_period / self.plateau_width

    @si.checked_numbers
    def largest_force(self, surface_roughness: si.Metre) -> si.Newton:
        """The force (N) up to which the contact's law holds at rest on a surface of a roughness
        (m); where the area grows as fast as the force, all the 10 kN that one may have, or none."""
        most = self.asperity_law(surface_roughness).largest_pressure
        force = self.contact_area_force or self.normal_force
        # p ∝ F^(1 − exponent), in logarithms: the power may be any.
        room = math.log(most / self.plateau_pressure(force))
        left = 1 - self.contact_area_exponent
        reach = math.log(FORCE.most / force)
        if room < left * reach:
            return force * math.exp(room / left) if left > 0 else 0.0
        return FORCE.most

    @si.checked_numbers
    def asperity_law(self, surface_roughness: Annotated[si.Metre, si.AtLeast(0.0)]) -> ContactLaw:
        """Contact law of the asperities of this skin on a surface of a roughness (m).

        Heights add as independent ones do; the moisture scales the modulus.
        """
        here: si.FloatLike = np.hypot(self.skin_roughness, surface_roughness)
        there = float(np.hypot(self.skin_roughness, self.asperity_roughness))
        if not here > 0:
            raise InputError("a perfectly smooth skin on a perfectly smooth surface has no law")
        law = self.asperities.scaled(float(here) / there)
        return law.stiffened(STIFFNESS_OF_MOISTURE[self.moisture])

    @si.checked_numbers
    def friction_coefficient(
        self,
        of_surface: Annotated[si.Dimensionless, si.Above(0.0)],
        surface_roughness: Annotated[si.Metre, si.AtLeast(0.0)],
        normal_force: si.Newton | None = None,
    ) -> si.Dimensionless:
        """µ without vibration on a surface, under a force (N; None: the finger's own).

        The surface's coefficient times the factor assumed for the moisture; with a
        `shear_strength` τ instead τ A_r/F, from the real contact area of `asperity_law` on the
        plateaus, where it falls with the load as the contact fills.
        """
        law = self.asperity_law(surface_roughness)
        if self.shear_strength is None or not isinstance(law, RoughContact):
            return of_surface * FRICTION_OF_MOISTURE[self.moisture]
        pressure = self.plateau_pressure(normal_force)
        return self.shear_strength * float(law.contact_ratio(pressure)) / pressure


def _require_ridges(side: si.Metre, period: si.Metre) -> None:
    """Refuse a contact with more ridges than can be worked on."""
    if side // period <= RIDGES.most:
        return  # as nearly always, without the words below
    shown, finest = (si.format_quantity(size, si.Unit("m")) for size in (side, side / RIDGES.most))
    enough = f"a contact of {shown} may have a ridge_period of {finest} or more"
    require_within(RIDGES, side // period, enough=enough)


PEOPLE = 14
"""Number of people who made the strokes."""
DECAY_LENGTH_SPREAD: si.Dimensionless = 0.345
"""Standard deviation of ln ℓ over the strokes."""
REST_FRICTION_SPREAD: si.Dimensionless = 0.491
"""Standard deviation of ln µ0 over the strokes."""
CORRELATION: si.Dimensionless = 0.34
"""Correlation of ln ℓ with ln µ0 over the strokes."""
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
