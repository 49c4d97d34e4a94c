"""The levitation model of 2016 in closed form: a film lifts off a contact that reaches high.

Wiertlewski, Fenton Friesen and Colgate, PNAS 113 (2016) 9210, supporting information: the squeezed
film lifts a skin whose contact pressure falls off with the gap u as exp(−u/ℓ),

    p_s (1 − exp(−(u − u0)/ℓ)) = (5/4) p0 a²/u²,    µ′/µ = exp(−(u − u0)/ℓ),

with the finger's pressure p_s, ambient p0, and the gap u0 at rest. With z = (u − u0)/ℓ and the
scale g = ℓ √(p_s/(1.25 p0)) it is (1 − exp(−z)) (z + u0/ℓ)² = (a/g)². The film's asymptote is that
of a large squeeze number and a small excursion; the excursion is always small, since a/u stays
below √(p_s/(1.25 p0)), 0.15 for 2.8 kPa in air.

The published gap at rest is u0 = ℓ ln(p_c/p_s), p_c = 0.375 q0 u_rms E/(1 − ν²), with skin of
u_rms = 5 µm, q0 = 1e4 1/m, E = 20 MPa, ν = 0.5. As printed ℓ = u_rms, which makes u0 26 µm where
the text says 2 u_rms; with Persson's ℓ = 0.4 u_rms, taken here, it is 10.4 µm.
"""

from __future__ import annotations

import functools
import math
from typing import Annotated

import numpy as np

from squeezefilm import quantities as si

# Of z: from where µ′/µ is 1 to rounding to where it has left the range of a float.
_LIFT = np.geomspace(1e-18, 745.0, 12000)


PUBLISHED_DECAY_LENGTH: si.Metre = 0.4 * 5e-6
_PUBLISHED_PRESSURE: si.Pascal = 0.375 * 1e4 * 5e-6 * 20e6 / (1 - 0.5**2)


@si.checked_numbers
def published_rest_gap(contact_pressure: Annotated[si.Pascal, si.Above(0.0)]) -> si.Dimensionless:
    """The gap at rest u0/ℓ with the constants of 2016, under a pressure of the finger (Pa); 0 from
    500 kPa on."""
    return max(0.0, math.log(_PUBLISHED_PRESSURE / contact_pressure))


@si.checked_numbers
def levitation_scale(
    decay_length: Annotated[si.Metre, si.Above(0.0)],
    contact_pressure: Annotated[si.Pascal, si.Above(0.0)],
    ambient_pressure: Annotated[si.Pascal, si.Above(0.0)],
) -> si.Metre:
    """The amplitude g (m) in which the model counts, of a decay length ℓ (m), the pressure of the
    finger on the surface and the ambient one (Pa): g = ℓ √(p_s/(1.25 p0))."""
    return decay_length * float(np.sqrt(contact_pressure / (1.25 * ambient_pressure)))


@si.checked_numbers
def levitation_friction(
    relative_amplitude: Annotated[si.DimensionlessArray, si.AtLeast(0.0), si.AtMost(1e6)],
    rest_gap: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1e6)] = 0.0,
) -> si.DimensionlessArray:
    """µ′/µ within 1e-5 over the amplitude in scales g, any shape; `rest_gap` is u0/ℓ.

    Without a gap at rest friction falls at once, with one it falls as a Gaussian at first. Range:
    amplitudes small against the gap, a contact of many wavelengths of the squeezed film (a squeeze
    number of hundreds). Raises `InputError` for what is out of range.
    """
    log_amplitude, log_lift = _table(rest_gap)
    # At rest the logarithm is -inf, which the table's first lift answers.
    with np.errstate(divide="ignore"):
        lift = np.interp(np.log(relative_amplitude), log_amplitude, log_lift)
    return np.exp(-np.exp(lift))


@functools.lru_cache(maxsize=8)
def _table(rest_gap: float) -> tuple[si.FloatArray, si.FloatArray]:
    """Logarithms of the amplitude that makes a lift z, and of z."""
    amplitude = np.sqrt(-np.expm1(-_LIFT)) * (_LIFT + rest_gap)
    return np.log(amplitude), np.log(_LIFT)
