"""The film thickness of the paper, corrected and as printed, and its dimensionless numbers.

The paper is Biet, Giraud, Lemaire-Semail, "The implementation of tactile feedback using squeeze
film effect devices". Its letters: h_r roughness, h_vib vibration amplitude (zero-to-peak), h_e
amplitude of the fingerprint ridges (half their height), L ridge period, λ wavelength, l0 contact
length, H0 = h_r + h_vib + h_e, ε = h_vib/H0, δ = h_e/H0, k1 = 2π l0/λ, k2 = 2π l0/L, X = x/l0.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import Gas


@si.closed_form(
    positive="frequency ridge_period wavelength",
    nonnegative="roughness vibration_amplitude ridge_amplitude",
)
def film_thickness(
    x: si.MetreLike,
    time: si.SecondLike,
    frequency: si.HertzLike,
    roughness: si.Metre,
    vibration_amplitude: si.MetreLike,
    ridge_amplitude: si.Metre,
    ridge_period: si.Metre,
    wavelength: si.Metre,
) -> si.MetreLike:
    """The film thickness h(x, t) in m, paper eq 1 corrected: the roughness does not oscillate.

    h = h_r + h_vib [1 + cos ωt cos(2πx/λ)] + h_e [1 + cos(2πx/L)]; x = 0 is an antinode of the
    vibration and a groove of the fingerprint. Broadcasts. Never thinner than h_r.
    """
    wave = np.cos(2 * np.pi * frequency * time) * np.cos(2 * np.pi * x / wavelength)
    ridges = np.cos(2 * np.pi * x / ridge_period)
    return roughness + vibration_amplitude * (1 + wave) + ridge_amplitude * (1 + ridges)


@si.closed_form(positive="frequency length film_thickness viscosity ambient_pressure")
def squeeze_number(
    frequency: si.HertzLike,
    length: si.MetreLike,
    film_thickness: si.MetreLike,
    viscosity: si.PascalSecond,
    ambient_pressure: si.Pascal,
) -> si.DimensionlessLike:
    """The squeeze number σ = 12 η ω ℓ² / (p0 h²) (dimensionless) with ω = 2π frequency; broadcasts.

    `length` is the strip's width, the disc's radius or the rectangle's shorter side; the paper
    takes l0 and h = H0. Paper eq 4 with l0², which it prints as l0. Source: Langlois 1962.
    """
    omega = 2 * np.pi * frequency
    return 12 * viscosity * omega * length**2 / (ambient_pressure * film_thickness**2)


@si.closed_form(positive="frequency length film_thickness viscosity ambient_pressure")
def squeeze_number_printed(
    frequency: si.HertzLike,
    length: si.MetreLike,
    film_thickness: si.MetreLike,
    viscosity: si.PascalSecond,
    ambient_pressure: si.Pascal,
) -> si.DimensionlessLike:
    """Paper eq 4 as printed, 12 η ω l0 / (p0 H0²): not dimensionless (it is in 1/m).

    Kept to show the misprint: `tests/dimensions` asserts that it fails. Use `squeeze_number`.
    """
    omega = 2 * np.pi * frequency
    return 12 * viscosity * omega * length / (ambient_pressure * film_thickness**2)


@si.closed_form(positive="squeeze_number length film_thickness viscosity ambient_pressure")
def frequency_for_squeeze_number(
    squeeze_number: si.DimensionlessLike,
    length: si.MetreLike,
    film_thickness: si.MetreLike,
    viscosity: si.PascalSecond,
    ambient_pressure: si.Pascal,
) -> si.HertzLike:
    """The frequency (Hz) at which a film has a wanted squeeze number: the paper's criterion σ ≥ 10.

    f = σ p0 h² / (24π η ℓ²), the inverse of `squeeze_number`; broadcasts. That σ = 10 makes the
    asymptote hold is the paper's claim and is not so, see `physics.film.validity`.
    """
    pressure = squeeze_number * ambient_pressure * film_thickness**2
    return pressure / (24 * np.pi * viscosity * length**2)


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class PaperGap:
    """The gap of the paper's model; lengths in m, the vibration amplitude a scalar or 1-D array.

    `ridge_amplitude` is half the ridges' height (0 for a smooth finger). As in the paper an
    antinode and a groove lie at the centre of the contact.

    Raises `InputError` for lengths that are not finite or not positive, and for an array of
    amplitudes of more than one dimension. The roughness must be positive: without it the
    corrected gap closes at an antinode over a ridge, and the paper's pressure is infinite there.
    """

    roughness: Annotated[si.Metre, si.Above(0)]
    vibration_amplitude: Annotated[si.MetreLike, si.AtLeast(0)]
    ridge_amplitude: Annotated[si.Metre, si.AtLeast(0)]
    ridge_period: Annotated[si.Metre, si.Above(0)]
    wavelength: Annotated[si.Metre, si.Above(0)]
    contact_length: Annotated[si.Metre, si.Above(0)]

    def __post_init__(self) -> None:
        if np.ndim(self.vibration_amplitude) > 1:
            raise InputError(
                f"vibration_amplitude has {np.ndim(self.vibration_amplitude)} dimensions; "
                "give a number or a one-dimensional array"
            )

    @si.checked_numbers
    def with_amplitude(self, vibration_amplitude: si.MetreLike) -> PaperGap:
        """The same gap at another vibration amplitude (m, scalar or 1-D array)."""
        return dataclasses.replace(self, vibration_amplitude=vibration_amplitude)

    @property
    def reference_thickness(self) -> si.MetreLike:
        """H0 = h_r + h_vib + h_e in m."""
        return self.roughness + self.vibration_amplitude + self.ridge_amplitude

    @property
    def crest_thickness(self) -> si.MetreLike:
        """The mean thickness over a ridge crest, h_r + h_vib, in m."""
        return self.roughness + self.vibration_amplitude

    @property
    def amplitude_ratio(self) -> si.DimensionlessLike:
        """ε = h_vib/H0 (dimensionless)."""
        return self.vibration_amplitude / self.reference_thickness

    @property
    def amplitude_ratio_printed(self) -> si.DimensionlessLike:
        """ε = (h_vib + h_r)/H0 as the paper prints it below eq 2 (dimensionless)."""
        return self.crest_thickness / self.reference_thickness

    @property
    def ridge_ratio(self) -> si.DimensionlessLike:
        """δ = h_e/H0 (dimensionless)."""
        return self.ridge_amplitude / self.reference_thickness

    @property
    def wave_number(self) -> si.Dimensionless:
        """k1 = 2π l0/λ (dimensionless)."""
        return 2 * np.pi * self.contact_length / self.wavelength

    @property
    def ridge_number(self) -> si.Dimensionless:
        """k2 = 2π l0/L (dimensionless)."""
        return 2 * np.pi * self.contact_length / self.ridge_period

    @si.checked_numbers
    def squeeze_number(self, frequency: si.Hertz, gas: Gas) -> si.DimensionlessLike:
        """The paper's σ in a gas at a frequency (Hz): on l0 and H0 (dimensionless)."""
        thickness, length = self.reference_thickness, self.contact_length
        return squeeze_number(frequency, length, thickness, gas.viscosity, gas.ambient_pressure)
