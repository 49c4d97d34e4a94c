"""Distance of a film from assumptions: inertia, slip, trapped gas, small amplitude."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError, OutOfRangeWarning
from squeezefilm.core.materials import Gas
from squeezefilm.physics.film.closed import relative_stiffness
from squeezefilm.physics.film.gap import PaperGap

INERTIA_LIMIT: si.Dimensionless = 2.0
"""Reduced Reynolds number up to which inertia, about Re/10 of the viscous drag, is left out."""

SLIP_LIMIT: si.Dimensionless = 0.02
"""Knudsen number above which slip, which widens the flow by 6 Kn, counts (12 %)."""

ASYMPTOTE_SQUEEZE_NUMBER: si.Dimensionless = 200.0
"""Squeeze number from which a smooth strip has 90 % of its asymptotic over-pressure: 1 − √(2/σ)."""


@si.closed_form(positive="density frequency film_thickness viscosity")
def reduced_reynolds_number(
    density: si.KilogramPerCubicMetre,
    frequency: si.HertzLike,
    film_thickness: si.MetreLike,
    viscosity: si.PascalSecond,
) -> si.DimensionlessLike:
    """Inertia over viscous drag, Re = ρ ω h²/η (dimensionless), ω = 2π frequency; broadcasts.

    The Reynolds equation wants Re ≲ 2 (air at 40 kHz: h ≲ 10 µm); it is also, but for the Prandtl
    number 0.7, what decides whether the film is isothermal.
    """
    return density * (2 * np.pi * frequency) * film_thickness**2 / viscosity


@si.closed_form(positive="mean_free_path film_thickness")
def knudsen_number(
    mean_free_path: si.MetreLike, film_thickness: si.MetreLike
) -> si.DimensionlessLike:
    """Kn = mean free path / thickness (dimensionless), at ambient pressure; broadcasts.

    Slip widens the flow by 6 Kn: it counts above Kn ≈ 0.02 (air: below some 3 µm). First-order
    slip holds up to about 0.1.
    """
    return mean_free_path / film_thickness


@si.closed_form(
    positive="frequency ridge_amplitude ridge_period film_thickness viscosity ambient_pressure"
)
def crest_squeeze_number(
    frequency: si.HertzLike,
    ridge_amplitude: si.Metre,
    ridge_period: si.Metre,
    film_thickness: si.MetreLike,
    viscosity: si.PascalSecond,
    ambient_pressure: si.Pascal,
) -> si.DimensionlessLike:
    """The local squeeze number of the film over a sinusoidal ridge's crest (dimensionless).

    12 η ω ℓ²/(p0 h²) with ℓ² = 2 h R the square of the crest's half width at twice the gap h,
    R = L²/(4π² h_e) its radius; `film_thickness` is h, the mean gap over the crest. Broadcasts.
    The paper's ridges have 0.03 where its global σ is 20: a crest neither traps nor springs.
    """
    radius = ridge_period**2 / (4 * np.pi**2 * ridge_amplitude)
    omega = 2 * np.pi * frequency
    return 24 * viscosity * omega * radius / (ambient_pressure * film_thickness)


@si.checked_numbers
def asymptotic_fraction(squeeze_number: si.DimensionlessLike) -> si.DimensionlessLike:
    """The share of the over-pressure of σ → ∞ that a smooth strip has at σ (dimensionless).

    fk(σ), exact as ε → 0; finite amplitude raises it (at σ = 10 from 0.41 to 0.45 at ε = 0.5 and
    0.55 at ε = 0.9). Broadcasts. Raises `InputError` for a σ that is negative or not finite.
    """
    return relative_stiffness(squeeze_number)


@dataclass(frozen=True)
class ValidityCheck:
    """An assumption: its number, the range where it holds (None: no bound) and a sentence."""

    name: str
    value: si.Dimensionless
    low: si.Dimensionless | None
    high: si.Dimensionless | None
    sentence: str

    @property
    def holds(self) -> bool:
        """True where the value lies in the range."""
        above = self.low is None or self.value >= self.low
        return above and (self.high is None or self.value <= self.high)


@dataclass(frozen=True)
class FilmValidity:
    """Distance of a film from the assumptions of the asymptotic (σ → ∞) model.

    `checks` are named inertia, slip, asymptote and, where the finger has ridges, crest.
    `asymptotic_fraction` is the share of the asymptotic over-pressure that a smooth film of this
    squeeze number reaches.
    """

    squeeze_number: si.Dimensionless
    asymptotic_fraction: si.Dimensionless
    checks: tuple[ValidityCheck, ...]

    @property
    def failed(self) -> tuple[ValidityCheck, ...]:
        """The checks that do not hold."""
        return tuple(check for check in self.checks if not check.holds)


@si.checked_numbers
def film_validity(
    gap: PaperGap, frequency: si.Hertz, gas: Gas, *, strict: bool = False
) -> FilmValidity:
    """Distance of a film that vibrates at `frequency` (Hz) from where the σ → ∞ model holds.

    The gap needs a single vibration amplitude. Inertia and slip are judged where the film is
    thinnest (over a ridge crest, h_r + h_vib), the asymptote on the paper's σ (l0 and H0), the
    crest on its own length. Each check that fails warns `OutOfRangeWarning` with its sentence; with
    `strict`, raises `OutOfRangeError` with all of them. Raises `InputError` for an array of
    amplitudes or a frequency that is not positive.
    """
    if np.ndim(gap.vibration_amplitude) != 0:
        raise InputError("the validity of a film wants a single vibration amplitude, not an array")
    thickness = float(gap.crest_thickness)
    here = f"over a gap of {si.format_quantity(thickness, si.Unit('m'), 3)}"
    drive = si.format_quantity(frequency, si.Unit("Hz"), 3)
    sigma = float(gap.squeeze_number(frequency, gas))
    fraction = float(asymptotic_fraction(sigma))
    checks = [
        _inertia(
            float(reduced_reynolds_number(gas.density, frequency, thickness, gas.viscosity)),
            f"{here} at {drive}",
            thickness,
        ),
        _slip(float(knudsen_number(gas.mean_free_path, thickness)), here, gas.mean_free_path),
        _asymptote(sigma, fraction),
    ]
    if gap.ridge_amplitude > 0:
        crest = float(
            crest_squeeze_number(
                frequency,
                gap.ridge_amplitude,
                gap.ridge_period,
                thickness,
                gas.viscosity,
                gas.ambient_pressure,
            )
        )
        checks.append(_crest(crest, sigma))
    result = FilmValidity(sigma, fraction, tuple(checks))
    sentences = [check.sentence for check in result.failed]
    if strict and sentences:
        raise OutOfRangeError(
            " ".join(sentences) + " Pass strict=False to compute it all the same."
        )
    for sentence in sentences:
        warnings.warn(sentence, OutOfRangeWarning, stacklevel=2)
    return result


def _inertia(reynolds: float, where: str, thickness: float) -> ValidityCheck:
    thickest = si.format_quantity(thickness * math.sqrt(INERTIA_LIMIT / reynolds), si.Unit("m"), 3)
    verdict = (
        "the isothermal, viscous Reynolds equation holds"
        if reynolds <= INERTIA_LIMIT
        else "inertia and heat count, and the isothermal, viscous Reynolds equation fails"
    )
    sentence = (
        f"Reduced Reynolds number {reynolds:.3g} {where}: {verdict} (it holds up to {thickest})."
    )
    return ValidityCheck("inertia", reynolds, None, INERTIA_LIMIT, sentence)


def _slip(knudsen: float, where: str, mean_free_path: float) -> ValidityCheck:
    thinnest = si.format_quantity(mean_free_path / SLIP_LIMIT, si.Unit("m"), 3)
    verdict = (
        "slip can be left out"
        if knudsen <= SLIP_LIMIT
        else f"slip widens the flow by {si.percent(6 * knudsen)}, which the model leaves out"
    )
    sentence = f"Knudsen number {knudsen:.3g} {where}: {verdict} (it counts below {thinnest})."
    return ValidityCheck("slip", knudsen, None, SLIP_LIMIT, sentence)


def _asymptote(sigma: float, fraction: float) -> ValidityCheck:
    sentence = (
        f"Squeeze number {sigma:.4g}: a smooth film has {si.percent(fraction)} of the "
        f"over-pressure that σ → ∞ promises; 90 % takes σ ≥ {ASYMPTOTE_SQUEEZE_NUMBER:.0f}, and "
        "the paper's criterion σ ≥ 10 gives 41 %."
    )
    return ValidityCheck("asymptote", sigma, ASYMPTOTE_SQUEEZE_NUMBER, None, sentence)


def _crest(crest: float, sigma: float) -> ValidityCheck:
    verdict = (
        "the gas over a crest is trapped"
        if crest >= ASYMPTOTE_SQUEEZE_NUMBER
        else "the gas over a crest leaks into the grooves, and the pressure of σ → ∞ is far too "
        "high there"
    )
    sentence = (
        f"Squeeze number {crest:.2g} over a single ridge crest, where the pressure arises, against "
        f"{sigma:.3g} of the whole contact: {verdict}."
    )
    return ValidityCheck("crest", crest, ASYMPTOTE_SQUEEZE_NUMBER, None, sentence)
