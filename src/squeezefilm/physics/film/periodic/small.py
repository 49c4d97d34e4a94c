"""Films that move so little that a solve would drown in rounding: closed forms, and what is linear.

Under a uniform gap closed forms hold. Under a profile there is none; but the film
of a motion s times as large is s² times the over-pressure and s times the pressure that swings, and
that motion can be solved.

The over-pressure of a uniform film goes with ε². Where that is small against what double precision
leaves of the solver's sums, which grow with σ, the closed forms of the linear film are the better
answer: exact but for the next order in ε, which is stated.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.film.closed import relative_damping, relative_stiffness
from squeezefilm.physics.film.periodic.profile import GapProfile, Harmonics
from squeezefilm.physics.film.periodic.resolution import STRIP, Films
from squeezefilm.physics.film.periodic.solution import HARMONICS, Field, Found

NEXT_IN_LOAD, NEXT_IN_FORCE, NEXT_HARMONIC = 8.0, 3.0, 2.0
"""Bounds of the next order in parts of ε²: of the over-pressure and of the first harmonic; and in
parts of ε, what a harmonic is of the one before. Measured over σ, n and Kn."""
_ROUNDING = 1e-12


@dataclass(frozen=True)
class SmallVibration:
    """A film or many: over-pressure W − 1, and stiffness and damping over p0 A ε as fk + i fd; the
    errors are absolute."""

    over_pressure: si.FloatArray
    over_pressure_error: si.FloatArray
    force: si.ComplexArray
    force_error: si.FloatArray


def small_vibration(films: Films) -> SmallVibration:
    """The films of strips or discs to second order in ε, for any law of slip.

    With φ the flow factor at Kn and ψ = Kn dφ/dKn: F = n f(σ/(nφ)), W − 1 = ε² F [5/4 −
    (ψ/φ)(1/2 − n/4)]; without slip (5/4) ε² n fk(σ/n). Derivation, here
    for first-order slip, g = 1 + 6 Kn: average the Reynolds equation over a period to O(ε²). With
    p1 and H1 the first-order pressure and gap, g⟨p2⟩ = −(3 + 12 Kn)⟨H1 p1⟩ − ½ (1/n + 6 Kn (1/n −
    1))⟨p1²⟩; the linear equation gives the area means ⟨H1 p1⟩ = −F/2 and ⟨p1²⟩ = n F/2.
    """
    n, shape = films.polytropic_exponent, films.planform
    phi, psi = flow_factor(films.knudsen_number, films.law)
    local = films.squeeze_number / (n * phi)
    force = np.asarray(n * (relative_stiffness(local, shape) + 1j * relative_damping(local, shape)))
    square = films.excursion_ratio**2
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
    from squeezefilm.physics.film.mobility import slip_factor

    pairs = np.array([slip_factor(law, float(k)) for k in kn.ravel()]).reshape(*kn.shape, 2)
    return pairs[..., 0], kn * pairs[..., 1]


def small_pressure(x: si.FloatArray, film: Films) -> tuple[si.ComplexArray, si.FloatArray]:
    """The complex amplitude of P − 1 ∝ e^{iT} of one film, and its mean over a period to second
    order.

    `x` from −1/2 to 1/2 for a strip, r/R for a disc. Linear: p = −n ε (1 − cosh qx/cosh(q/2)) with
    q² = iσ/(nφ), Bessel's I0 in place of cosh for a disc. No gas flows in the mean, so that
    φ⟨p2⟩ = −(3φ − ψ)⟨h p⟩ − ½ (φ/n − ψ)⟨p²⟩ at every place.
    """
    sigma, eps, n, kn = (float(column[0]) for column in film[:4])
    phi, psi = (float(value) for value in flow_factor(np.array(kn), film.law))
    q = np.sqrt(1j * sigma / (n * phi))
    ratio: Any
    if film.shape == STRIP:
        far = np.abs(x)
        ratio = (np.exp(q * (far - 0.5)) + np.exp(-q * (far + 0.5))) / (1.0 + np.exp(-q))
    else:
        from scipy.special import ive

        ratio = ive(0, q * x) / ive(0, q) * np.exp(q.real * (np.abs(x) - 1.0))
    p = -n * eps * (1.0 - ratio)
    moved, squared = 0.5 * eps * p.real, 0.5 * np.abs(p) ** 2
    mean = -((3.0 * phi - psi) * moved + 0.5 * (phi / n - psi) * squared) / phi
    return np.asarray(p), np.asarray(mean)


LARGEST = 0.02
"""Largest excursion of a film that a closed form is asked of."""
LEAST_DEPTH = 1e-4
"""The relative excursion of a profile below which a larger motion is solved in its place."""
_NEXT_OF_PROFILE = 100.0  # ε² of the over-pressure that the next order is: its crests are closer
_POINTS = 65
_ORDERS = np.arange(HARMONICS + 1)


def small_film(film: Films, tolerance: float) -> tuple[Found, Field]:
    """One film under a uniform gap in closed form, and its field; `met` says whether that meets the
    tolerance. Its second and higher harmonics are left out, and are their errors."""

    eps, is_strip = float(film.excursion_ratio[0]), film.shape == STRIP
    known = small_vibration(film)
    force, force_error = complex(known.force[0]), float(known.force_error[0])
    over, error = float(known.over_pressure[0]), float(known.over_pressure_error[0])
    harmonics = np.zeros(HARMONICS + 1, dtype=complex)
    harmonics[:2] = over, -force * eps
    errors = abs(harmonics[1]) * (NEXT_HARMONIC * abs(eps)) ** np.maximum(_ORDERS - 1, 0)
    errors[:2] = error, force_error * abs(eps)
    norm = tolerance * abs(harmonics[1])
    met = bool(error <= tolerance * over and errors[1:].max() <= norm)
    xi = np.sin(np.linspace(-0.5 if is_strip else 0.0, 0.5, _POINTS) * np.pi)
    x = 0.5 * xi if is_strip else xi
    T = 2.0 * np.pi * np.arange(64) / 64
    swing, mean = small_pressure(x, film)
    gap = np.broadcast_to(1.0 + eps * np.cos(T), (len(x), len(T))).copy()
    pressure = (swing[:, None] * np.exp(1j * T)).real + mean[:, None]
    force_over = Found(over, error, met, 0, 0.0, 0, 0, harmonics, errors, (force, force_error))
    return force_over, Field(x, T, gap, pressure)


def fill_small(
    films: Films, tolerance: float, rows: si.FloatArray, which: si.IntArray, *, better: bool
) -> si.IntArray:
    """Fill result rows in closed form; the indices, of `which`, where that meets the tolerance and,
    with `better`, is nearer than rounding lets a solve come."""
    from squeezefilm.physics.film.periodic import uniform as u

    which = which[films.excursion_ratio[which] < LARGEST]
    if len(which) == 0:
        return which
    sigma, n = films.squeeze_number[which], films.polytropic_exponent[which]
    known = small_vibration(films.at(which))
    over, error = known.over_pressure, known.over_pressure_error
    allowed = tolerance * over
    if better:
        floor = np.array([u.rounding(*one) for one in zip(sigma, n, over, strict=True)])
        allowed = np.minimum(allowed, floor)
    good = error <= allowed
    at = which[good]
    rows[at] = 0.0
    rows[at, u.OVER], rows[at, u.ERROR] = over[good], error[good]
    rows[at, u.STIFFNESS], rows[at, u.DAMPING] = known.force.real[good], known.force.imag[good]
    rows[at, u.FORCE_ERROR] = known.force_error[good]
    return at


@dataclass(frozen=True, slots=True)
class _Larger:
    """A gap's harmonics with its motion made larger."""

    harmonics: Harmonics
    factor: float

    def __call__(self, x: si.FloatArray) -> si.ComplexArray:
        h = np.array(self.harmonics(x), dtype=complex)
        h[1:] *= self.factor
        return h


def enlarged(profile: GapProfile) -> tuple[GapProfile, float]:
    """The profile with a motion that can be solved, and by how much that is larger."""
    if not 0.0 < profile.depth < LEAST_DEPTH:
        return profile, 1.0
    factor = LEAST_DEPTH / profile.depth
    return GapProfile(_Larger(profile.harmonics, factor), profile.description), factor


def reduced(found: Found, field: Field, factor: float, tolerance: float) -> tuple[Found, Field]:
    """The film of a motion smaller by `factor`, linearised, its errors with the next order."""

    if factor == 1.0:
        return found, field
    harmonics, errors = found.harmonics / factor, found.harmonics_error / factor
    over = found.over / factor**2
    error = found.error / factor**2 + _NEXT_OF_PROFILE * LEAST_DEPTH**2 * abs(over)
    harmonics[0], errors[0] = over, error
    largest = np.abs(harmonics[1:]).max()
    errors[1:] += NEXT_HARMONIC * LEAST_DEPTH * largest
    met = error <= tolerance * abs(over) and not errors[1:].max() > tolerance * largest
    found = replace(
        found,
        over=over,
        error=error,
        met=bool(found.met and met),
        harmonics=harmonics,
        harmonics_error=errors,
    )
    if len(field.time):
        mean_gap, mean = (part.mean(axis=1, keepdims=True) for part in (field.gap, field.over))
        gap = mean_gap + (field.gap - mean_gap) / factor
        field = Field(
            field.position, field.time, gap, (field.over - mean) / factor + mean / factor**2
        )
    return found, field
