"""Load of a finger on the vibration: the dynamic stiffness that the film passes on to the plate.

Plate and skin face each other across gas and asperities. Per area of plateau the interface has a
complex stiffness K_i (film and asperities side by side), the skin D = k − mω² + iωc behind it, so
that the plate feels K = K_i D/(K_i + D): its real part detunes the mode, its imaginary part damps
it.

What can be felt at an amplitude a is bounded, whatever the skin: asperities that only push swing by
at most twice the load F they carry, and a film whose pressure swings by p̂ carries 5 p̂²/(4 p0) in
the mean (Salbu, to the second order). So |Z| ≤ (√(4 F p0 A/5) + 2 F)/(ωa): 14 N·s/m for 0.5 N on
1 cm² at 1 µm and 34.59 kHz, where 33 were measured (see `Skin`); its amplitude was below 0.43 µm.
"""

from __future__ import annotations

import cmath
import math
from typing import Annotated, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.materials import Gas
from squeezefilm.physics.contact.asperities import CompiledAsperities
from squeezefilm.physics.contact.asperity_kernel import asperity_mean
from squeezefilm.physics.contact.finger.fingertip import Skin
from squeezefilm.physics.film.gap import squeeze_number

NewtonSecondPerMetreComplex = Annotated[complex, si.Unit("N*s/m")]


@si.checked_numbers
def compiled_finger(
    plateau_width: si.Metre,
    frequency: Annotated[si.Hertz, si.Above(0.0)],
    gas: Gas,
    skin: Skin,
    plateau_share: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)],
) -> CompiledFinger:
    """A finger at a frequency (Hz) as the compiled code takes it: plateaus of a width (m), which
    are a share (0 to 1) of the contact, on a skin. Raises `InputError` for what cannot be used."""

    unit = squeeze_number(frequency, plateau_width, 1.0, gas.viscosity, gas.ambient_pressure)
    return CompiledFinger(
        math.sqrt(float(unit)),
        float(gas.mean_free_path),
        float(gas.ambient_pressure),
        plateau_share,
        skin.dynamic_stiffness(frequency),
    )


@si.checked_numbers
def finger_impedance(
    stiffness_per_area: complex,
    area: Annotated[si.SquareMetre, si.Above(0.0)],
    frequency: Annotated[si.Hertz, si.Above(0.0)],
    mean_square: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1e4)] = 1.0,
) -> NewtonSecondPerMetreComplex:
    """The mechanical impedance of a whole finger, Z = K A ⟨cos²⟩/(iω) (N·s/m, complex).

    K is `felt` (Pa/m), A the area of contact, `mean_square` the mean of the square of
    the vibration's shape over it: Z is referred to the velocity v at an antinode, and the finger
    takes the power ½ Re Z |v|². A positive imaginary part is a mass, a negative one a spring. Both
    depend on the amplitude through the film and the asperities in K. Raises `InputError` unless
    area and frequency are above 0 and the mean square within 0 and 1.
    """
    return stiffness_per_area * area * mean_square / (2j * np.pi * frequency)


# As `physics.film.closed` has it, whose formula for arrays takes a tenth of a millisecond
# for one.
_SWITCH = 900.0

# The limit of the asperities' difference quotient, without 0/0 (m).
_LEAST_SWING = 1e-11


class CompiledFinger(NamedTuple):
    """A finger for compiled code: the length ℓ (m) with which a plateau's squeeze number is (ℓ/u)²
    at a gap u, the gas's mean free path (m) and pressure (Pa), the plateaus' share of the contact,
    and the skin's dynamic stiffness (Pa/m)."""

    length: float
    free_path: float
    ambient_pressure: float
    plateau_share: float
    skin: complex


@compiled(error_model="numpy")
def strip_force(sigma: float) -> complex:
    """fk + i fd of a strip at a squeeze number: see `physics.film.closed`."""
    if sigma > _SWITCH:
        z = cmath.sqrt(1j * sigma) / 2.0
        decay = cmath.exp(-2.0 * z)
        return 1.0 - (1.0 - decay) / ((1.0 + decay) * z)
    u = 0.25j * sigma
    tail = 243.0 + 0.0j
    for k in range(119, 0, -1):
        tail = 3.0 + 2.0 * k + u / tail
    return u / (u + 3.0 + u / tail)


@compiled(error_model="numpy")
def between(u: float, swing: float, finger: CompiledFinger, law: CompiledAsperities) -> complex:
    """Film and asperities between plate and plateau at a mean gap and swing (m): complex stiffness
    per area (Pa/m).

    The film is the linear one of a strip at the mean gap, with first-order slip: within some tens
    of percent up to a swing of half the gap, too soft beyond. The asperities' is the first harmonic
    of their law over the swing, −2⟨p_a cos T⟩/a, exact at any swing.
    """
    sigma = (finger.length / u) ** 2 / (1.0 + 6.0 * finger.free_path / u)
    film = finger.ambient_pressure / u * strip_force(sigma)
    a = max(swing, _LEAST_SWING)
    return film + asperity_mean(law, u, a)[1] / a


@compiled(error_model="numpy")
def felt(u: float, swing: float, finger: CompiledFinger, law: CompiledAsperities) -> complex:
    """Stiffness of a finger that the plate feels per area of contact (Pa/m, complex): K_i D/(K_i +
    D) on the plateaus' share of it, K_i from `between`, D of the skin; grooves are left out."""
    interface = between(u, swing, finger, law)
    return finger.plateau_share * interface * finger.skin / (interface + finger.skin)
