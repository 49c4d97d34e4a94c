"""Contact of an elastic skin with a rough surface, from roughness and modulus: Persson's theory.

The interface has one self-affine roughness: heights of standard deviation h_rms, whose spectrum

    C(q) ∝ q^(−2(1 + H)),   q0 = 2π/longest_wavelength ≤ q ≤ q1 = 2π/shortest_wavelength,

and an effective modulus E* = E/(1 − ν²). With w(q) = (π ∫_{q0}^q q'³ C dq')^{−1/2}, the part of
the surface in contact on the scale q is P = erf(w p/E*), the real contact area that on the
shortest scale, and the mean gap ū under a pressure p (Yang & Persson 2008,
10.1088/0953-8984/20/21/215214; Almqvist et al. 2011, 10.1016/j.jmps.2011.08.004)

    ū(p) = √π ∫ dq q² C w ∫_p^∞ dp'/p' [γ + 3(1 − γ) P²] exp(−(w p'/E*)²),    γ = 0.45.

At small pressure p = β E* exp(−ū/u0) (Persson 2007, 10.1103/PhysRevLett.99.125502): exponential,
with u0 ≈ 0.44 h_rms and β fixed by the spectrum, so that no pressure at a gap is left to choose.
Pressed harder the contact stiffens beyond that law: the gap closes only as p → ∞, where the law of
exponential asperities has a finite strength.

What the theory leaves out: layers of the skin of different modulus, viscoelasticity, plastic
flattening, and adhesion in the normal load.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Literal, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.hard_limits import HEIGHTS, MODULUS
from squeezefilm.physics.contact.asperities import (
    AsperityLaw,
    CompiledAsperities,
    cubics,
)

LEAST_GAP: si.Dimensionless = 0.05
"""The least gap, in h_rms, of the tabulated law: there nearly everything is in contact."""

_LARGEST_GAP, _STEP = 12.0, 0.025
_GAMMA = 0.45
# Of w p: below, the real contact area is nothing; above, it is all.
_LOG_S = -60.0, math.log(7.0)


class Spectrum(NamedTuple):
    """Shape of a spectrum as the law needs it, in units of h_rms, q0 and E*.

    `slope` is h′_rms/(q0 h_rms), `energy` the elastic energy of full contact over E* q0 h_rms²;
    `decay` u0/h_rms and `strength` β/(q0 h_rms) are those of the exponential limit at small
    pressure. `logarithm` and `steepness` are ln(p/(E* q0 h_rms)) and its derivative at the gaps
    LEAST_GAP, LEAST_GAP + 0.025, … in h_rms, and `curve` is the one that runs through them.
    """

    slope: si.Dimensionless
    energy: si.Dimensionless
    decay: si.Dimensionless
    strength: si.Dimensionless
    logarithm: si.FloatArray
    steepness: si.FloatArray
    curve: Callable[[si.FloatArray], si.FloatArray]


@lru_cache(maxsize=1)
def _close_to_full() -> np.polynomial.Chebyshev:
    """∫_0^s erf²(t) exp(−t²)/t dt for s from 0 to 7."""
    from scipy.special import erf

    def part(t: si.FloatArray) -> si.FloatArray:
        return np.asarray(erf(t) ** 2 * np.exp(-(t**2)) / t)

    return np.polynomial.Chebyshev.interpolate(part, 100, domain=[0.0, 7.0]).integ(lbnd=0.0)


@lru_cache(maxsize=1)
def _fallen() -> Callable[[si.FloatArray], si.FloatArray]:
    """γ E₁(s²)/2 + 3 (1 − γ) ∫_s^7 erf²(t) exp(−t²)/t dt of ln s, from −60 to ln 7: through values
    and slopes at steps of 0.01, which holds it within 1e-10 and takes a fifth of the time."""
    from scipy.interpolate import CubicHermiteSpline
    from scipy.special import exp1

    log_s = np.linspace(*_LOG_S, 6200)
    s, partial = np.exp(log_s), _close_to_full()
    value = _GAMMA * exp1(s**2) / 2 + 3 * (1 - _GAMMA) * (partial(7.0) - partial(s))
    return CubicHermiteSpline(log_s, value, -_falls(s))


def _falls(s: si.FloatArray) -> si.FloatArray:
    """Fall of `_fallen` for each e in s."""
    from scipy.special import erf

    return np.asarray((_GAMMA + 3 * (1 - _GAMMA) * erf(s) ** 2) * np.exp(-(s**2)))


def _separation(
    pressure: si.FloatArray, weight: si.FloatArray, width: si.FloatArray
) -> tuple[si.FloatArray, si.FloatArray]:
    """ū and −dū/d ln p at pressures over E* q0 h_rms, from weights √π q² C w dq and w."""
    log_s = np.clip(np.log(pressure)[:, None] + np.log(width), *_LOG_S)
    return _fallen()(log_s) @ weight, _falls(np.exp(log_s)) @ weight


@lru_cache(maxsize=32)
def _spectrum(hurst_exponent: float, magnification: float) -> Spectrum:
    """The law of a self-affine spectrum of one Hurst exponent and one q1/q0 (both 1).

    Solved on 96 Gauss points over the wave numbers and tabulated in steps of 0.025 h_rms; the
    table holds ln p within 1e-5.
    """
    from scipy.interpolate import CubicHermiteSpline

    points, weights = np.polynomial.legendre.leggauss(96)
    # ln(q/q0) = z⁴: at q0, where w is infinite, the integrand is then smooth.
    last = math.log(magnification)
    z, dz = (points + 1) / 2 * last**0.25, weights * last**0.25 / 2
    q, dq = np.exp(z**4), np.exp(z**4) * 4 * z**3 * dz
    # C(q) = level q^(−2(1 + H)), so that h_rms² = 2π ∫ q C dq = 1.
    level = hurst_exponent / (-np.pi * math.expm1(-2 * hurst_exponent * last))
    density = level * q ** (-2 * (1 + hurst_exponent))
    rise = 2 - 2 * hurst_exponent
    # π ∫ q³ C dq up to q, half of the mean square slope there; the last is that of the whole.
    steep = np.append(z**4, last)
    steep = np.pi * level * (steep if rise == 0 else np.expm1(rise * steep) / rise)
    width = 1 / np.sqrt(steep[:-1])
    weight = np.sqrt(np.pi) * q**2 * density * width * dq

    # ū falls by the decay length for each e in p; the two ends reach past the table.
    logarithm = np.linspace(-36.0, math.log(4 * math.sqrt(steep[-1])), 600)
    gap, falls = _separation(np.exp(logarithm), weight, width)
    decay = _GAMMA * float(np.sum(weight))
    order = np.argsort(gap)
    inverse = CubicHermiteSpline(gap[order], logarithm[order], -1 / falls[order])
    at = LEAST_GAP + _STEP * np.arange(round((_LARGEST_GAP - LEAST_GAP) / _STEP) + 1)
    tabulated, steepness = inverse(at), inverse(at, 1)
    return Spectrum(
        slope=math.sqrt(2 * steep[-1]),
        energy=float(np.pi / 2 * np.sum(q**2 * density * dq)),
        decay=decay,
        strength=math.exp(logarithm[0] + gap[0] / decay),
        logarithm=tabulated,
        steepness=steepness,
        curve=CubicHermiteSpline(at, tabulated, steepness),
    )


@si.checked_numbers
@dataclass(frozen=True)
class RoughContact:
    """The pressure that a rough elastic interface carries at a gap, by Persson's theory.

    `roughness` h_rms is that of both faces together and `modulus` E* the effective one of the
    skin. The spectrum reaches from `longest_wavelength`, at most the width of a plateau, to
    `shortest_wavelength`. Independent of load and frequency. The values are assumed: with them
    the law at small pressure is, within a tenth, that of `AsperityLaw`'s defaults.

    Raises `InputError` for values out of bounds or wavelengths the wrong way round.
    """

    roughness: Annotated[si.Metre, HEIGHTS] = 1.25e-6
    modulus: Annotated[si.Pascal, MODULUS] = 3.2e6
    hurst_exponent: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)] = 0.8
    longest_wavelength: Annotated[si.Metre, HEIGHTS] = 250e-6
    shortest_wavelength: Annotated[si.Metre, HEIGHTS] = 2.5e-6
    type: Literal["rough_contact"] = "rough_contact"

    def __post_init__(self) -> None:
        if not 1.5 <= self.longest_wavelength / self.shortest_wavelength <= 1e5:
            longest, shortest = (
                si.format_quantity(length, si.Unit("m"))
                for length in (self.longest_wavelength, self.shortest_wavelength)
            )
            raise InputError(
                f"shortest_wavelength = {shortest} beside a longest_wavelength of {longest} cannot "
                "be used: the longest must be 1.5 to 100 000 times the shortest",
                quantity="shortest_wavelength",
            )

    @property
    def spectrum(self) -> Spectrum:
        """The law of the spectrum's shape, in units of roughness, q0 and modulus."""
        return _spectrum(self.hurst_exponent, self.longest_wavelength / self.shortest_wavelength)

    @property
    def pressure_scale(self) -> si.Pascal:
        """E* q0 h_rms, the unit of pressure of `spectrum`."""
        return self.modulus * 2 * math.pi / self.longest_wavelength * self.roughness

    @property
    def decay_length(self) -> si.Metre:
        """u0, over which the pressure falls by e at small pressure."""
        return self.spectrum.decay * self.roughness

    @property
    def rms_slope(self) -> si.Dimensionless:
        """h′_rms, the standard deviation of the slope of the interface."""
        return self.spectrum.slope * 2 * math.pi / self.longest_wavelength * self.roughness

    @si.checked_numbers
    def scaled(self, factor: Annotated[si.Dimensionless, si.Above(0.0)]) -> RoughContact:
        """The law of an interface with heights `factor` (> 0) times as large, wavelengths kept."""
        return dataclasses.replace(self, roughness=self.roughness * factor)

    @si.checked_numbers
    def stiffened(self, factor: Annotated[si.Dimensionless, si.Above(0.0)]) -> RoughContact:
        """The law of a skin whose modulus is `factor` (> 0) times as large."""
        return dataclasses.replace(self, modulus=self.modulus * factor)

    @si.checked_numbers
    def contact_ratio(
        self, pressure: Annotated[si.PascalLike, si.AtLeast(0.0)]
    ) -> si.DimensionlessLike:
        """Real over apparent contact area, erf(√2 p/(E* h′_rms)) (Persson 2001, 10.1063/1.1388626).

        In proportion to a small pressure (Pa), 1 at full contact; broadcasts.
        """
        from scipy.special import erf

        full = self.modulus * self.rms_slope
        return np.asarray(erf(math.sqrt(2) * np.asarray(pressure) / full))[()]

    @si.checked_numbers
    def pressure(self, gap: si.MetreLike) -> si.PascalLike:
        """p_a (Pa) at a mean gap (m); broadcasts.

        Zero beyond 12 h_rms, where less than 1e-11 of the pressure scale is left. Raises
        `OutOfRangeError` below 0.05 h_rms, where nearly everything is in contact.
        """
        t = np.asarray(gap, dtype=float) / self.roughness
        if np.any(t < LEAST_GAP * (1 - 1e-9)):
            least, rough = (
                si.format_quantity(length, si.Unit("m"))
                for length in (float(np.min(gap)), self.roughness)
            )
            raise OutOfRangeError(
                f"a gap of {least} is less than {LEAST_GAP} of the roughness of {rough}: the faces "
                "are nearly in full contact there; press less or take a rougher skin"
            )
        carried = self.pressure_scale * np.exp(self.spectrum.curve(np.minimum(t, _LARGEST_GAP)))
        return np.asarray(np.where(t <= _LARGEST_GAP, carried, 0.0))[()]

    @property
    def largest_pressure(self) -> si.Pascal:
        """The largest pressure (Pa) for which the law holds: it presses the gap at rest to
        `LEAST_GAP` of the roughness, where nearly everything touches and the table ends."""
        return self.pressure_scale * math.exp(self.spectrum.logarithm[0])

    @property
    def least_gap(self) -> si.Metre:
        """The gap (m) at which the law ends: nearly everything is in contact there."""
        return LEAST_GAP * self.roughness

    @property
    def words(self) -> str:
        """Words for the law in the name of a model."""
        return "a rough elastic interface by Persson's theory"

    def compiled(self) -> CompiledAsperities:
        """The law as the compiled code takes it."""
        return _compiled(self)


@lru_cache(maxsize=32)
def _compiled(law: RoughContact) -> CompiledAsperities:
    known, step = law.spectrum, _STEP * law.roughness
    constants = [
        law.pressure_scale * known.strength,
        0.0,
        law.decay_length,
        law.least_gap,
        step,
        -law.roughness / known.steepness[-1],
    ]
    table = cubics(known.logarithm + math.log(law.pressure_scale), known.steepness, _STEP)
    return CompiledAsperities(np.array(constants), table)


ContactLaw = AsperityLaw | RoughContact
"""Law of skin and surface at a gap, by asperities of assumed strength or from roughness."""
