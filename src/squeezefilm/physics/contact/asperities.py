"""Pressure of the roughness of skin and surface at a gap: laws of asperities.

A law gives the pressure p_a (Pa) of the asperities on a plateau as a function of the gap h between
the mean planes, and of nothing else: it does not know the load, nor the frequency. Two laws:

- exponential: p_a = p_ref exp(−(h − h_ref)/λ_r), asperity heights distributed exponentially;
- Greenwood–Williamson 1966 (10.1098/rspa.1966.0242) with Gaussian heights of deviation λ_r:
  p_a = p_ref F(h/λ_r)/F(h_ref/λ_r), F(t) = ∫_t^∞ (z − t)^{3/2} φ(z) dz, elastic Hertzian tips.

With exponential heights the same integral is Γ(5/2) exp(−t): the first law.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from functools import lru_cache
from statistics import NormalDist
from typing import Annotated, Literal, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import DECAY_LENGTH, PRESSURE

AsperityHeights = Literal["exponential", "gaussian"]

# ln F is tabulated between these, in units of the height deviation: below, the asperities are
# crushed flat, above they carry e^-200 of anything.
_LOWEST, _HIGHEST, _STEP = -8.0, 20.0, 0.025
# Decay lengths over which an exponential is tabulated.
_FAINTEST = 780.0


class CompiledAsperities(NamedTuple):
    """A law of asperities for compiled code: its constants, and the cubics of ln p (p in Pa)
    between gaps at equal steps, the first of them straight at nearer gaps too. For the constants
    see `asperity_kernel`."""

    constants: si.FloatArray
    table: si.FloatArray


def cubics(values: si.FloatArray, slopes: si.FloatArray, step: float) -> si.FloatArray:
    """The cubics in x from 0 to 1 between points `step` apart, by their values and slopes."""
    rise, start, end = np.diff(values), slopes[:-1] * step, slopes[1:] * step
    return np.stack(
        [values[:-1], start, 3 * rise - 2 * start - end, start + end - 2 * rise], axis=1
    )


@si.closed_form(positive="reference_pressure decay_length")
def exponential_pressure(
    gap: si.MetreLike,
    reference_pressure: si.Pascal,
    reference_gap: si.Metre,
    decay_length: si.Metre,
) -> si.PascalLike:
    """p_a = p_ref exp(−(h − h_ref)/λ_r), in Pa, at a gap h (m); broadcasts.

    Greenwood–Williamson with exponentially distributed heights. Holds for gaps of some λ_r, where
    the asperities touch one by one.
    """
    return reference_pressure * np.exp(-(gap - reference_gap) / decay_length)


@si.checked_numbers
def gaussian_overlap(separation: si.DimensionlessLike) -> si.DimensionlessLike:
    """F(t) = ∫_t^∞ (z − t)^{3/2} exp(−z²/2)/√(2π) dz (dimensionless) for t from −8 to 20.

    The parabolic cylinder function: F = Γ(5/2)/√(2π) exp(−t²/4) D_{−5/2}(t). Broadcasts.
    """
    from scipy.special import pbdv

    t = np.asarray(separation, dtype=float)
    si.require("separation", t, at_least=_LOWEST, at_most=_HIGHEST)
    return np.asarray(
        math.gamma(2.5) / math.sqrt(2 * math.pi) * np.exp(-(t**2) / 4) * pbdv(-2.5, t)[0]
    )[()]


@lru_cache(maxsize=1)
def _gaussian_cubics() -> si.FloatArray:
    """ln F over the tabulated range, for the compiled code; within 1e-9."""
    from scipy.special import pbdv

    t = np.linspace(_LOWEST, _HIGHEST, round((_HIGHEST - _LOWEST) / _STEP) + 1)
    cylinder, slope = pbdv(-2.5, t)
    return cubics(np.log(np.asarray(gaussian_overlap(t))), slope / cylinder - t / 2, _STEP)


@si.checked_numbers
@dataclass(frozen=True)
class AsperityLaw:
    """The pressure that asperities carry at a gap, independent of load and frequency.

    `reference_pressure` p_ref is carried at `reference_gap` h_ref; `decay_length` λ_r is the
    length over which it falls by e ("exponential" heights), or the standard deviation of the
    heights ("gaussian").
    """

    reference_pressure: Annotated[si.Pascal, PRESSURE] = 5e3
    reference_gap: Annotated[si.Metre, DECAY_LENGTH] = 2e-6
    decay_length: Annotated[si.Metre, DECAY_LENGTH] = 0.6e-6
    heights: AsperityHeights = "exponential"
    type: Literal["separate_asperities"] = "separate_asperities"

    @si.checked_numbers
    def pressure(self, gap: si.MetreLike) -> si.PascalLike:
        """p_a (Pa) at a gap (m); broadcasts."""
        if self.heights == "exponential":
            return exponential_pressure(
                gap, self.reference_pressure, self.reference_gap, self.decay_length
            )
        reference = float(gaussian_overlap(self.reference_gap / self.decay_length))
        separation = np.asarray(gap, dtype=float) / self.decay_length
        overlap = np.asarray(gaussian_overlap(np.minimum(separation, _HIGHEST)))
        # Beyond 20 deviations no asperity reaches.
        overlap = np.where(separation <= _HIGHEST, overlap, 0.0)
        return np.asarray(self.reference_pressure * overlap / reference)[()]

    @si.checked_numbers
    def scaled(self, factor: Annotated[si.Dimensionless, si.Above(0.0)]) -> AsperityLaw:
        """The law of a geometrically similar interface, all heights times `factor` (> 0)."""
        return AsperityLaw(
            self.reference_pressure,
            self.reference_gap * factor,
            self.decay_length * factor,
            self.heights,
        )

    @si.checked_numbers
    def stiffened(self, factor: Annotated[si.Dimensionless, si.Above(0.0)]) -> AsperityLaw:
        """The law of a skin whose modulus is `factor` (> 0) times as large."""
        return dataclasses.replace(self, reference_pressure=self.reference_pressure * factor)

    @property
    def largest_pressure(self) -> si.Pascal:
        """The largest pressure (Pa) for which the law holds: 1/e of the asperities touch under it.

        The theory takes asperities that touch apart from one another, the real contact area a
        small part of the whole (Greenwood & Williamson 1966, 10.1098/rspa.1966.0242), and so ends
        where most of them touch. That it ends at 1/e is our convention (assumed): exponential
        heights are then pressed to a gap of one decay length, Gaussian ones to 0.34 deviations.
        """
        if self.heights == "exponential":
            # A law that falls off in an instant holds to any pressure that a float has.
            depth = min(self.reference_gap / self.decay_length - 1, 600.0)
            return self.reference_pressure * math.exp(depth)
        return float(self.pressure(NormalDist().inv_cdf(1 - 1 / math.e) * self.decay_length))

    @property
    def words(self) -> str:
        """Words for the law in the name of a model."""
        return f"asperities of {self.heights} heights"

    def compiled(self) -> CompiledAsperities:
        """The law as the compiled code takes it."""
        scale, first, step = self.decay_length, _LOWEST * self.decay_length, _STEP
        if self.heights == "exponential":
            # One straight line, to where a float holds nothing.
            first, step, slope = self.reference_gap, _FAINTEST, -_FAINTEST
            table = np.array([[math.log(self.reference_pressure), slope, 0.0, 0.0]])
        else:
            table = _gaussian_cubics().copy()
            overlap = float(gaussian_overlap(self.reference_gap / scale))
            table[:, 0] += math.log(self.reference_pressure / overlap)
        steps = [first, step * scale, -step * scale / table[-1, 1]]
        constants = [self.reference_pressure, self.reference_gap, scale, *steps]
        return CompiledAsperities(np.array(constants), table)
