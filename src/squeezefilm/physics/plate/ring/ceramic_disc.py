"""A bare ceramic disc, free, poled through its thickness, with electrodes all over both faces.

Three-dimensional piezoelectricity of the axisymmetric motion that is even about the middle plane
(radial modes and their overtones), by the Rayleigh-Ritz method with polynomials in r² and z². The
weak form is linear in the material's ten constants, and these may be complex: losses of every kind
are exact, and the derivative of the admittance with every constant costs one product. Weak form
after Allik and Hughes 1970, 10.1002/nme.1620020202. `physics.plate.ring.modes` solves the same body
by elements and is its check.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.polynomial import legendre

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.core.hard_limits import DENSITY, LAYER, SIDE
from squeezefilm.core.materials import VACUUM_PERMITTIVITY

CONSTANTS = ("c11", "c12", "c13", "c33", "c44", "e31", "e33", "e15", "eps11", "eps33")
"""The ten constants of the weak form: stiffness at constant field (Pa), stress coefficients
(C/m²), permittivity at constant strain (F/m)."""

_ALONG_RADIUS, _ALONG_THICKNESS = 7, 3
_AT_ONCE = 64  # matrices of frequencies that are held in memory together


@si.checked_numbers
@dataclass(frozen=True)
class CeramicDisc:
    """The disc's `diameter` and `thickness` (m) and its `density` (kg/m³)."""

    diameter: Annotated[si.Metre, SIDE]
    thickness: Annotated[si.Metre, LAYER]
    density: Annotated[si.KilogramPerCubicMetre, DENSITY]


@dataclass(frozen=True, eq=False)
class DiscSystem:
    """The matrices of a disc: `parts` (10, n + 1, n + 1), one for every constant of `CONSTANTS`,
    and `mass` (n + 1, n + 1). The last unknown is the voltage between the faces."""

    parts: si.FloatArray
    mass: si.FloatArray


@functools.lru_cache(maxsize=8)
def disc_system(
    disc: CeramicDisc,
    along_radius: int = _ALONG_RADIUS,
    along_thickness: int = _ALONG_THICKNESS,
) -> DiscSystem:
    """Assemble with that many polynomials along radius and thickness.

    Seven and three leave the lowest two radial modes of a disc that is ten or more times as wide as
    thick within 1e-6 of their limit (`tests/verification/test_ceramic_disc.py`).
    """
    rows, radial, axial, scale = _fields(disc, along_radius, along_thickness)
    weight = radial[:, None] * axial[None, :] * scale

    def gram(a: si.FloatArray, b: si.FloatArray) -> si.FloatArray:
        weighted = (a * weight).reshape(a.shape[0], -1)
        product = weighted @ b.reshape(b.shape[0], -1).T
        return np.asarray((product + product.T) / 2)

    s1, s2, s3, s5, e1, e3 = (rows[name] for name in ("s1", "s2", "s3", "s5", "e1", "e3"))
    flat = s1 + s2
    parts = np.array(
        [
            gram(s1, s1) + gram(s2, s2),
            2 * gram(s1, s2),
            2 * gram(flat, s3),
            gram(s3, s3),
            gram(s5, s5),
            -2 * gram(e3, flat),
            -2 * gram(e3, s3),
            -2 * gram(e1, s5),
            -gram(e1, e1),
            -gram(e3, e3),
        ]
    )
    mass = gram(rows["ur"], rows["ur"]) + gram(rows["uz"], rows["uz"])
    return DiscSystem(parts, disc.density * mass)


def _fields(
    disc: CeramicDisc, along_radius: int, along_thickness: int
) -> tuple[dict[str, si.FloatArray], si.FloatArray, si.FloatArray, float]:
    """Displacements, strains and fields of every unknown at the Gauss points of the upper half,
    each (unknowns, radii, heights), with the weights along r and z and their common factor.

    Legendre polynomials of 2ρ² − 1 are orthogonal on a disc; u_r is odd in r and even in z, u_z
    and the potential are even in r and odd in z, and the potential's share beside the applied one
    vanishes on the electrodes.
    """
    radius, half = disc.diameter / 2, disc.thickness / 2
    rho, rho_weight = _gauss(along_radius + 4)
    zeta, zeta_weight = _gauss(along_thickness + 4)
    p, dp = _even(along_radius, rho)
    q, dq = _even(along_thickness, zeta)
    bubble = 1 - zeta**2
    u = {"r": (rho * p, p + rho * dp), "z": (q, dq)}
    w = {"r": (p, dp), "z": (zeta * q, q + zeta * dq)}
    f = {
        "r": (p, dp),
        "z": (zeta * bubble * q, (1 - 3 * zeta**2) * q + zeta * bubble * dq),
    }
    n = along_radius * along_thickness
    count = 3 * n + 1

    def outer(a: si.FloatArray, b: si.FloatArray, block: int) -> si.FloatArray:
        field = np.zeros((count, rho.size, zeta.size))
        product = a[:, None, :, None] * b[None, :, None, :]
        field[block * n : (block + 1) * n] = product.reshape(n, rho.size, zeta.size)
        return field

    rows = {
        "ur": radius * outer(u["r"][0], u["z"][0], 0),
        "uz": radius * outer(w["r"][0], w["z"][0], 1),
        "s1": outer(u["r"][1], u["z"][0], 0),
        "s2": outer(u["r"][0] / rho, u["z"][0], 0),
        "s3": radius / half * outer(w["r"][0], w["z"][1], 1),
        "s5": radius / half * outer(u["r"][0], u["z"][1], 0) + outer(w["r"][1], w["z"][0], 1),
        "e1": -half / radius * outer(f["r"][1], f["z"][0], 2) / half,
        "e3": -outer(f["r"][0], f["z"][1], 2) / half,
    }
    # One volt between the faces: φ = z / thickness.
    rows["e3"][-1] = -1 / disc.thickness
    # Twice for both halves.
    return rows, rho_weight * rho, zeta_weight, 2 * 2 * math.pi * radius**2 * half


def _gauss(count: int) -> tuple[si.FloatArray, si.FloatArray]:
    points, weights = legendre.leggauss(count)
    return (points + 1) / 2, weights / 2


def _even(count: int, x: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
    """Legendre polynomials of 2x² − 1 and their derivatives with x, both (count, points)."""
    every = np.eye(count)
    y = 2 * x**2 - 1
    value = legendre.legval(y, every)
    slope = legendre.legval(y, legendre.legder(every)) if count > 1 else np.zeros_like(value)
    return np.asarray(value), np.asarray(slope * 4 * x)


@si.checked_numbers
def disc_admittance(
    disc: CeramicDisc,
    constants: si.ComplexArray,
    frequency: Annotated[si.HertzArray, si.Above(0.0)],
    system: DiscSystem | None = None,
) -> tuple[si.ComplexArray, si.ComplexArray]:
    """The admittance (S), time factor e^{iωt}, shape (frequencies,), and its derivative with each
    of the ten `constants` (order of `CONSTANTS`, complex), shape (10, frequencies).

    With the potential prescribed, the charge is −x·A·x of the solution x of A x = 0, and stationary
    in x: its derivative with a constant needs no further solve. Linear; thickness-shear, edge and
    thickness modes are as exact as the polynomials allow (see `disc_system`). `constants` may be
    (10,) or, where they change with frequency, (10, frequencies). Raises `InputError` for other
    shapes, `ConvergenceError` for constants that no solid has.
    """
    si.require("frequency", frequency, si.Unit("Hz"), above=0, axes=1)
    shapes = ((len(CONSTANTS),), (len(CONSTANTS), frequency.size))
    if np.shape(constants) not in shapes:
        raise InputError(
            f"constants has the shape {np.shape(constants)}; allowed are {shapes[0]} and, for "
            f"{frequency.size} frequencies, {shapes[1]}: {', '.join(CONSTANTS)}",
            quantity="constants",
        )
    system = system or disc_system(disc)
    constants = np.asarray(constants, dtype=complex).reshape(len(CONSTANTS), -1)
    scale = _scales(system, constants[:, 0])
    parts = system.parts * np.outer(scale, scale)
    mass = system.mass * np.outer(scale, scale)
    omega = 2 * np.pi * frequency
    admittance = np.empty(frequency.size, dtype=complex)
    slopes = np.empty((10, frequency.size), dtype=complex)
    for first in range(0, frequency.size, _AT_ONCE):
        few = slice(first, first + _AT_ONCE)
        own = constants if constants.shape[1] == 1 else constants[:, few]
        dynamic = np.einsum("pf,pij->fij", own, parts, optimize=True)
        dynamic = dynamic - omega[few, None, None] ** 2 * mass
        x = np.ones(dynamic.shape[:2], dtype=complex)
        try:
            x[:, :-1] = -np.linalg.solve(dynamic[:, :-1, :-1], dynamic[:, :-1, -1:])[..., 0]
        except np.linalg.LinAlgError as error:
            raise ConvergenceError(
                f"the disc could not be solved ({error}); give the constants of a ceramic, see "
                f"{weak_constants.__name__}"
            ) from error
        share = np.einsum("pij,fi,fj->pf", parts, x, x, optimize=True)
        slopes[:, few] = -1j * omega[few] * share
        admittance[few] = -1j * omega[few] * np.einsum("fij,fi,fj->f", dynamic, x, x, optimize=True)
    return admittance, slopes


def _scales(system: DiscSystem, constants: si.ComplexArray) -> si.FloatArray:
    """Factors that bring displacements and potentials to one size; 1 for the voltage."""
    diagonal = np.abs(np.einsum("p,pii->i", constants.real, system.parts))
    if not np.all(np.isfinite(diagonal) & (diagonal > 1e-200)):
        raise ConvergenceError(
            "the disc could not be solved: a stiffness or a permittivity is as good as none; give "
            f"the constants of a ceramic, see {weak_constants.__name__}"
        )
    scale = 1 / np.sqrt(diagonal)
    scale[-1] = 1.0
    return np.asarray(scale)


def weak_constants(
    compliance: si.ComplexArray, charge: si.ComplexArray, free_permittivity: si.ComplexArray
) -> si.ComplexArray:
    """The ten constants of the weak form from compliances s11, s12, s13, s33, s44 (m²/N), charge
    coefficients d31, d33, d15 (m/V) and relative permittivities at constant stress ε11, ε33: all
    complex, imaginary parts negative where they are losses.

    e = d c and εS = εT − e dᵀ (IEEE standard on piezoelectricity 176-1987, table 8).
    """
    s11, s12, s13, s33, s44 = compliance
    d31, d33, d15 = charge
    stiffness = np.linalg.inv(np.array([[s11, s12, s13], [s12, s11, s13], [s13, s13, s33]]))
    row = np.array([d31, d31, d33])
    e31, _, e33 = row @ stiffness
    e15 = d15 / s44
    return np.array(
        [
            stiffness[0, 0],
            stiffness[0, 1],
            stiffness[0, 2],
            stiffness[2, 2],
            1 / s44,
            e31,
            e33,
            e15,
            free_permittivity[0] * VACUUM_PERMITTIVITY - e15 * d15,
            free_permittivity[1] * VACUUM_PERMITTIVITY - np.array([e31, e31, e33]) @ row,
        ]
    )
