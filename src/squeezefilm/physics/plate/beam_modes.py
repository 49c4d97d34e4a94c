"""Uniform free–free beams: Euler–Bernoulli and Timoshenko, exact solutions.

A beam of bending stiffness G, mass per area M, shear stiffness S and rotary inertia J (all per
unit width) obeys  S(w″ − ψ′) + Mω²w = 0,  Gψ″ + S(w′ − ψ) + Jω²ψ = 0,  with ψ′ = 0 and w′ = ψ
at free ends. Euler–Bernoulli is its limit S → ∞, J → 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.hard_limits import NODAL_LINES, require_within
from squeezefilm.physics.plate.elements.nodal_lines import largest_lobe, zero_crossings
from squeezefilm.physics.plate.laminate import Laminate

BeamTheory = Literal["euler_bernoulli", "timoshenko"]


@si.closed_form(positive="half_wavelength bending_stiffness mass_per_area")
def euler_bernoulli_frequency(
    half_wavelength: si.MetreLike,
    bending_stiffness: si.NewtonMetre,
    mass_per_area: si.KilogramPerSquareMetre,
) -> si.HertzLike:
    """The frequency (Hz) of a flexural wave of given half wavelength; broadcasts.

    f = (1/2π) (π/(λ/2))² √(G/M): paper eq 15 corrected (it prints ω as f_n). Overestimates from
    λ/2 of some ten thicknesses downwards, where shear and rotation count.
    """
    frequency: si.HertzLike = (np.pi / half_wavelength) ** 2 * np.sqrt(
        bending_stiffness / mass_per_area
    )
    return frequency / (2 * np.pi)


@si.closed_form(positive="frequency bending_stiffness mass_per_area")
def euler_bernoulli_half_wavelength(
    frequency: si.HertzLike,
    bending_stiffness: si.NewtonMetre,
    mass_per_area: si.KilogramPerSquareMetre,
) -> si.MetreLike:
    """The half wavelength (m) of a flexural wave of given frequency; the inverse of
    `euler_bernoulli_frequency`, with its range."""
    half_wavelength: si.MetreLike = np.sqrt(
        np.pi / (2 * frequency) * np.sqrt(bending_stiffness / mass_per_area)
    )
    return half_wavelength


@si.checked_numbers
def timoshenko_frequency(
    half_wavelength: Annotated[si.MetreLike, si.Above(0.0)], section: Laminate
) -> si.HertzLike:
    """The frequency (Hz) of a flexural wave of given half wavelength in a Timoshenko beam.

    The lower branch of  MJ ω⁴ − ω²[M S + k²(M G + S J)] + S G k⁴ = 0  with k = π/(λ/2). Broadcasts.
    Valid for λ/2 above about two thicknesses. Source: Timoshenko 1921.
    """
    G, M = section.bending_stiffness, section.mass_per_area
    S, J = section.shear_stiffness, section.rotary_inertia
    k2 = (np.pi / np.asarray(half_wavelength, dtype=float)) ** 2
    b = M * S + k2 * (M * G + S * J)
    c = M * J * S * G * k2**2
    # The lower root written so that it does not cancel for long waves.
    omega2 = 2 * S * G * k2**2 / (b + np.sqrt(b**2 - 4 * c))
    frequency = np.sqrt(omega2) / (2 * np.pi)
    return frequency if frequency.ndim else float(frequency)


@dataclass(frozen=True, eq=False)
class BeamMode:
    """A bending mode of a free–free beam, w(x) scaled to 1 at its largest lobe inside the ends.

    `deflection`, `rotation` (1/m per metre of w) and `position` are arrays over the length;
    `nodal_positions` where w = 0; `half_wavelength` is π/β of the oscillating part, with β its mean
    along the beam;
    `modal_mass_per_width` is ∫ M w² + J ψ² dx in kg/m for the scaled w.
    """

    theory: BeamTheory
    nodal_lines: int
    frequency: si.Hertz
    half_wavelength: si.Metre
    length: si.Metre
    position: si.MetreArray
    deflection: si.FloatArray
    rotation: si.FloatArray
    nodal_positions: si.MetreArray
    modal_mass_per_width: si.KilogramPerMetre

    @si.checked_numbers
    def deflection_at(self, x: si.FloatArray | float) -> si.FloatArray:
        """The scaled deflection at positions x (m)."""
        return np.asarray(np.interp(x, self.position, self.deflection))

    @si.checked_numbers
    def rotation_at(self, x: si.FloatArray | float) -> si.FloatArray:
        """The section's rotation (rad per metre of scaled deflection) at positions x (m)."""
        return np.asarray(np.interp(x, self.position, self.rotation))


def wave_numbers(omega: Any, G: float, M: float, S: float, J: float) -> tuple[Any, Any, Any]:
    """α (decaying part), β (oscillating part) and m = Mω²/S at frequencies below the cut-off;
    broadcasts. Raises `OutOfRangeError` above it."""
    m = M * omega**2 / S if math.isfinite(S) else 0.0 * omega
    p = G * m + J * omega**2
    q = M * omega**2 * (1 - (J * omega**2 / S if math.isfinite(S) else 0.0))
    if np.any(q <= 0):
        raise OutOfRangeError(
            f"{np.max(omega) / 2 / math.pi:.4g} Hz lies above the beam's cut-off frequency, where "
            "the decaying wave oscillates too; beam theory does not hold there, use fewer nodal "
            "lines"
        )
    beta2 = (p + np.sqrt(p * p + 4 * G * q)) / (2 * G)
    return np.sqrt(q / (G * beta2)), np.sqrt(beta2), m


def _determinant(
    omega: Any, symmetric: bool, length: float, constants: tuple[float, float, float, float]
) -> Any:
    alpha, beta, m = wave_numbers(omega, *constants)
    half = beta * length / 2
    th, s, c = np.tanh(alpha * length / 2), np.sin(half), np.cos(half)
    if symmetric:
        return (alpha**2 + m) * s * alpha - (m - beta**2) * c * th * beta
    return (alpha**2 + m) * alpha * c * th + (m - beta**2) * s * beta


@si.checked_numbers
def require_nodal_lines(nodal_lines: int) -> None:
    """Raises `InputError` for a number of nodal lines that no bending mode of a free beam has, or
    that is too large to be meant."""
    if nodal_lines < 2:
        raise InputError(
            f"nodal_lines = {nodal_lines}: a free beam bends with at least 2; fewer is rigid motion"
        )
    require_within(NODAL_LINES, nodal_lines, "nodal_lines")


@si.checked_numbers
def free_beam_mode(
    section: Laminate,
    length: Annotated[si.Metre, si.Above(0.0)],
    nodal_lines: int,
    theory: BeamTheory = "timoshenko",
    points: int = 2001,
) -> BeamMode:
    """The bending mode of a free–free beam with a given number of nodal lines (≥ 2).

    The exact solution of the frequency equation, frequency to 1e-12 relative. Raises `InputError`
    for fewer than two nodal lines, `OutOfRangeError` above the Timoshenko cut-off, where beam
    theory ends. Euler–Bernoulli's βL are 4.730041, 7.853205, 10.995608, …
    """
    from scipy.optimize import brentq

    require_nodal_lines(nodal_lines)
    G, M = section.bending_stiffness, section.mass_per_area
    euler = theory == "euler_bernoulli"
    S = math.inf if euler else section.shear_stiffness
    J = 0.0 if euler else section.rotary_inertia
    constants = (G, M, S, J)
    symmetric = nodal_lines % 2 == 0
    # Shear and rotation only lower the frequency: Euler–Bernoulli's (just above its estimate
    # β L = (n + 1/2)π) bounds the scan from above.
    upper = ((nodal_lines - 0.4) * math.pi / length) ** 2 * math.sqrt(G / M)
    if not euler:
        upper = min(upper, 0.999999 * math.sqrt(S / J))
    wanted = nodal_lines // 2
    # Modes are even in the root of the frequency: however many there are, the first one, at three
    # half waves, is not passed over.
    grid = upper * np.linspace(0.5 / nodal_lines, 1, 160 * nodal_lines) ** 2
    signs = np.signbit(_determinant(grid, symmetric, length, constants))
    brackets = np.flatnonzero(signs[:-1] != signs[1:])
    if brackets.size < wanted:
        raise OutOfRangeError(
            f"a mode with {nodal_lines} nodal lines on {si.format_quantity(length, si.Unit('m'))} "
            "lies above the cut-off frequency of the Timoshenko beam; ask for fewer nodal lines"
        )
    at = brackets[wanted - 1]
    omega = float(
        brentq(
            _determinant,
            grid[at],
            grid[at + 1],
            args=(symmetric, length, constants),
            xtol=1e-9 * grid[at],
            rtol=1e-14,
        )
    )
    # A lobe of many is still drawn with some forty points.
    points = max(points, 40 * nodal_lines + 1)
    return _mode(omega, symmetric, length, constants, theory, points)


def _mode(
    omega: float,
    symmetric: bool,
    length: float,
    constants: tuple[float, float, float, float],
    theory: BeamTheory,
    points: int,
) -> BeamMode:
    _, M, _, J = constants
    alpha, beta, m = wave_numbers(omega, *constants)
    x = np.linspace(0, length, points)
    xi = x - length / 2
    end = np.exp(-alpha * length)
    # cosh and sinh divided by cosh(αL/2), from decaying exponentials only.
    right, left = np.exp(alpha * (xi - length / 2)), np.exp(-alpha * (xi + length / 2))
    ch, sh = (right + left) / (1 + end), (right - left) / (1 + end)
    half = beta * length / 2
    if symmetric:
        A = -(m - beta**2) * math.cos(half) / (alpha**2 + m)
        w = A * ch + np.cos(beta * xi)
        psi = A * (alpha**2 + m) / alpha * sh + (m - beta**2) / beta * np.sin(beta * xi)
    else:
        A = alpha * math.cos(half) / beta
        w = A * sh + np.sin(beta * xi)
        psi = A * (alpha**2 + m) / alpha * ch - (m - beta**2) / beta * np.cos(beta * xi)
    energy = float(np.trapezoid(M * w**2 + J * psi**2, x))
    return scaled_mode(theory, omega / (2 * math.pi), math.pi / beta, x, w, psi, energy)


def scaled_mode(
    theory: BeamTheory,
    frequency: si.Hertz,
    half_wavelength: si.Metre,
    x: si.MetreArray,
    w: si.FloatArray,
    psi: si.FloatArray,
    mass: si.KilogramPerMetre,
) -> BeamMode:
    """A mode of any scale, on rising places from 0 to the beam's length, as it is told: scaled to 1
    at its largest lobe inside the ends. `mass` is its modal mass as it comes."""
    nodes = zero_crossings(x, w)
    scale = float(w[largest_lobe(x, w)])
    return BeamMode(
        theory=theory,
        nodal_lines=nodes.size,
        frequency=frequency,
        half_wavelength=half_wavelength,
        length=float(x[-1]),
        position=x,
        deflection=w / scale,
        rotation=psi / scale,
        nodal_positions=nodes,
        modal_mass_per_width=mass / scale**2,
    )
