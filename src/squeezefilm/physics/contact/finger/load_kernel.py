"""The compiled stiffness of what lies between plate and skin, and what the plate feels of it."""

from __future__ import annotations

import cmath
from typing import NamedTuple

from squeezefilm.core.compiled import compiled
from squeezefilm.physics.contact.asperities import CompiledAsperities
from squeezefilm.physics.contact.asperity_kernel import asperity_mean

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
