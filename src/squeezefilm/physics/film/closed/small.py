"""A uniform film under a vibration so small that closed forms hold better than any solve.

The over-pressure goes with ε². Where that is small against what double precision leaves of the
solver's sums, which grow with σ, the closed forms of the linear film are the better answer: exact
but for the next order in ε, which is stated.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.film.closed.linear import relative_damping, relative_stiffness
from squeezefilm.physics.film.mobility import slip_factor

NEXT_IN_LOAD, NEXT_IN_FORCE, NEXT_HARMONIC = 8.0, 3.0, 2.0
"""What the next order is at most, in parts of ε²: of the over-pressure and of the first harmonic;
and in parts of ε, what a harmonic is of the one before. Measured over σ, n and Kn."""
_ROUNDING = 1e-12


@dataclass(frozen=True)
class SmallVibration:
    """A film or many: over-pressure W − 1, and stiffness and damping over p0 A ε as fk + i fd; the
    errors are absolute."""

    over_pressure: si.FloatArray
    over_pressure_error: si.FloatArray
    force: si.ComplexArray
    force_error: si.FloatArray


def small_vibration(
    squeeze_number: si.FloatArray,
    excursion_ratio: si.FloatArray,
    shape: Literal["strip", "disc"],
    polytropic_exponent: si.FloatArray,
    knudsen_number: si.FloatArray,
    law: int,
) -> SmallVibration:
    """The film of a strip or disc to second order in ε, for any law of slip (its number).

    With φ the flow factor at Kn and ψ = Kn dφ/dKn: F = n f(σ/(nφ)), W − 1 = ε² F [5/4 −
    (ψ/φ)(1/2 − n/4)]; without slip (5/4) ε² n fk(σ/n). Derivation, here
    for first-order slip, g = 1 + 6 Kn: average the Reynolds equation over a period to O(ε²). With
    p1 and H1 the first-order pressure and gap, g⟨p2⟩ = −(3 + 12 Kn)⟨H1 p1⟩ − ½ (1/n + 6 Kn (1/n −
    1))⟨p1²⟩; the linear equation gives the area means ⟨H1 p1⟩ = −F/2 and ⟨p1²⟩ = n F/2.
    """
    n = polytropic_exponent
    phi, psi = flow_factor(knudsen_number, law)
    local = squeeze_number / (n * phi)
    force = np.asarray(n * (relative_stiffness(local, shape) + 1j * relative_damping(local, shape)))
    square = np.asarray(excursion_ratio, dtype=float) ** 2
    over = square * force.real * (1.25 - psi / phi * (0.5 - 0.25 * n))
    return SmallVibration(
        over,
        np.abs(over) * (NEXT_IN_LOAD * square + _ROUNDING),
        force,
        np.abs(force) * (NEXT_IN_FORCE * square + _ROUNDING),
    )


def flow_factor(knudsen_number: si.FloatArray, law: int) -> tuple[si.FloatArray, si.FloatArray]:
    """φ(Kn) of a law of slip by its number, and Kn dφ/dKn."""
    kn = np.asarray(knudsen_number, dtype=float)
    pairs = np.array([slip_factor(law, float(k)) for k in kn.ravel()]).reshape(*kn.shape, 2)
    return pairs[..., 0], kn * pairs[..., 1]


def small_pressure(
    x: si.FloatArray,
    squeeze_number: float,
    excursion_ratio: float,
    shape: Literal["strip", "disc"],
    polytropic_exponent: float,
    knudsen_number: float,
    law: int,
) -> tuple[si.ComplexArray, si.FloatArray]:
    """The complex amplitude of P − 1 ∝ e^{iT}, and its mean over a period to second order.

    `x` from −1/2 to 1/2 for a strip, r/R for a disc. Linear: p = −n ε (1 − cosh qx/cosh(q/2)) with
    q² = iσ/(nφ), Bessel's I0 in place of cosh for a disc. No gas flows in the mean, so that
    φ⟨p2⟩ = −(3φ − ψ)⟨h p⟩ − ½ (φ/n − ψ)⟨p²⟩ at every place.
    """
    n, eps = polytropic_exponent, excursion_ratio
    phi, psi = (float(value) for value in flow_factor(np.array(knudsen_number), law))
    q = np.sqrt(1j * squeeze_number / (n * phi))
    ratio: Any
    if shape == "strip":
        far = np.abs(x)
        ratio = (np.exp(q * (far - 0.5)) + np.exp(-q * (far + 0.5))) / (1.0 + np.exp(-q))
    else:
        from scipy.special import ive

        ratio = ive(0, q * x) / ive(0, q) * np.exp(q.real * (np.abs(x) - 1.0))
    p = -n * eps * (1.0 - ratio)
    moved, squared = 0.5 * eps * p.real, 0.5 * np.abs(p) ** 2
    mean = -((3.0 * phi - psi) * moved + 0.5 * (phi / n - psi) * squared) / phi
    return np.asarray(p), np.asarray(mean)
