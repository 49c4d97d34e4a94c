"""Films that move so little that a solve would drown in rounding: closed forms, and what is linear.

Under a uniform gap closed forms hold (`closed.small`). Under a profile there is none; but the film
of a motion s times as large is s² times the over-pressure and s times the pressure that swings, and
that motion can be solved.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.film.gas import Gas
from squeezefilm.physics.film.periodic.profile import GapProfile, Harmonics
from squeezefilm.physics.film.periodic.solution import HARMONICS, Asked, Field, Found

if TYPE_CHECKING:
    from squeezefilm.physics.film.periodic.uniform import Films

LARGEST = 0.02
"""No closed form is asked of a film of a larger excursion."""
LEAST_DEPTH = 1e-4
"""The relative excursion of a profile below which a larger motion is solved in its place."""
_NEXT_OF_PROFILE = 100.0  # ε² of the over-pressure that the next order is: its crests are closer
_POINTS = 65
_ORDERS = np.arange(HARMONICS + 1)


def small_film(asked: Asked, gas: Gas) -> tuple[Found, Field]:
    """A uniform gap's film in closed form, and its field; `met` says whether that meets the
    tolerance. Its second and higher harmonics are left out, and are their errors."""
    from squeezefilm.physics.film.closed.small import NEXT_HARMONIC, small_pressure, small_vibration

    eps = asked.excursion_ratio
    shape: Literal["strip", "disc"] = "strip" if asked.shape == "strip" else "disc"
    n, kn, law = gas
    sigma, excursion, ns, kns = (np.array([v]) for v in (asked.squeeze_number, eps, n, kn))
    known = small_vibration(sigma, excursion, shape, ns, kns, law)
    force, force_error = complex(known.force[0]), float(known.force_error[0])
    over, error = float(known.over_pressure[0]), float(known.over_pressure_error[0])
    harmonics = np.zeros(HARMONICS + 1, dtype=complex)
    harmonics[:2] = over, -force * eps
    errors = abs(harmonics[1]) * (NEXT_HARMONIC * abs(eps)) ** np.maximum(_ORDERS - 1, 0)
    errors[:2] = error, force_error * abs(eps)
    norm = asked.tolerance * abs(harmonics[1])
    met = bool(error <= asked.tolerance * over and errors[1:].max() <= norm)
    xi = np.sin(np.linspace(-0.5 if shape == "strip" else 0.0, 0.5, _POINTS) * np.pi)
    x = 0.5 * xi if shape == "strip" else xi
    T = 2.0 * np.pi * np.arange(64) / 64
    swing, mean = small_pressure(x, asked.squeeze_number, eps, shape, n, kn, law)
    gap = np.broadcast_to(1.0 + eps * np.cos(T), (len(x), len(T))).copy()
    pressure = (swing[:, None] * np.exp(1j * T)).real + mean[:, None]
    found = Found(over, error, met, 0, 0.0, 0, 0, harmonics, errors, (force, force_error))
    return found, Field(x, T, gap, pressure)


def fill_small(
    films: Films, tolerance: float, rows: si.FloatArray, which: si.IntArray, *, better: bool
) -> si.IntArray:
    """Fill result rows in closed form; the indices, of `which`, where that meets the tolerance and,
    with `better`, is nearer than rounding lets a solve come."""
    from squeezefilm.physics.film.closed.small import small_vibration
    from squeezefilm.physics.film.periodic import uniform as u

    which = which[films.excursion_ratio[which] < LARGEST]
    if len(which) == 0:
        return which
    sigma, eps, n, kn = (column[which] for column in films[:4])
    shape: Literal["strip", "disc"] = "strip" if films.shape == u.STRIP else "disc"
    known = small_vibration(sigma, eps, shape, n, kn, films.law)
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
    from squeezefilm.physics.film.closed.small import NEXT_HARMONIC

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
