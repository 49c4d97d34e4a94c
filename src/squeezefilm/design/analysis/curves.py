"""The curves of an analysis: response, pressure under the finger, friction by surface,
model and wavelength."""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import UnreachableError
from squeezefilm.core.materials import Gas
from squeezefilm.design.analysis.paper_procedure import PAPER_HALF_WAVELENGTHS, friction_criterion
from squeezefilm.measure.recordings import kinds as recordings
from squeezefilm.measure.recordings.read import check_folder
from squeezefilm.physics.chain.friction import FrictionLaw, where_known
from squeezefilm.physics.chain.pad_law import FrictionModel
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Surface, load_display
from squeezefilm.physics.film.closed import mean_pressure_profile
from squeezefilm.physics.film.gap import PaperGap
from squeezefilm.physics.plate.solid.working import response_frequencies

if TYPE_CHECKING:
    from squeezefilm.physics.film.periodic.solution import FilmSolution

PAPER_CRITERION: si.Dimensionless = 0.7
# Of the roughness: below it the over-pressure is at most 1e-8 of ambient, a millionth of a finger's
# pressure, and a solver would work on rounding.
_STILL: si.Dimensionless = 1e-4
_NEAR_FREQUENCY, _NEAR_FORCE = 1.5, 4.0
LIKE = (
    f"Dots: fingers measured on plates near in frequency (within a factor of {_NEAR_FREQUENCY:g}) "
    f"and force ({_NEAR_FORCE:g})."
)
"""Sentence on which measurements stand beside a display's friction."""


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Amplitude per volt against frequency, at the largest interior lobe of the working mode."""

    frequency: si.HertzArray
    amplitude_per_volt: si.MetrePerVoltArray
    model: str

    def __post_init__(self) -> None:
        si.require_alike(frequency=self.frequency, amplitude_per_volt=self.amplitude_per_volt)


@dataclass(frozen=True, eq=False)
class PressureProfile:
    """The film under the finger at rest over an antinode: the paper's Fig 4.

    `thickness` is the mean gap along the contact, `mean_pressure` the period mean over ambient.
    """

    position: si.MetreArray
    thickness: si.MetreArray
    mean_pressure: si.DimensionlessArray
    model: str


@dataclass(frozen=True, eq=False)
class FrictionCurve:
    """Relative friction against vibration amplitude on one surface: one curve of Fig 5.

    `amplitude_for_criterion` reaches µ′/µ = 0.7, `zero_friction_amplitude` zero; None where that is
    out of reach of any amplitude that `FrictionLaw.amplitude_for` looks at.
    """

    surface: str
    roughness: si.Metre
    amplitude: si.MetreArray
    relative_friction: si.DimensionlessArray
    amplitude_for_criterion: si.Metre | None
    zero_friction_amplitude: si.Metre | None
    model: str


@dataclass(frozen=True, eq=False)
class WavelengthCurve:
    """Relative friction against amplitude at one half wavelength: one curve of Fig 11."""

    half_wavelength: si.Metre
    amplitude: si.MetreArray
    relative_friction: si.DimensionlessArray
    amplitude_for_criterion: si.Metre
    model: str


def frequency_response(prediction: Prediction) -> FrequencyResponse:
    """The amplitude per volt around the working resonance, at the largest interior lobe."""
    mode = prediction.mode
    if mode.solid is not None:
        response = mode.solid.response
        line = response.amplitude_at(*mode.solid.lobe)
        return FrequencyResponse(response.frequencies, line, mode.model)
    frequency = response_frequencies(mode.resonance_frequency, mode.quality_factor, 601)
    return FrequencyResponse(frequency, mode.response(frequency), mode.model)


def pressure_profiles(prediction: Prediction) -> tuple[PressureProfile, ...]:
    """The mean pressure along the contact: the paper's asymptote, then the solved film."""
    law, p = prediction.law, prediction
    gap = law.gap(p.vibration_amplitude)
    X = np.linspace(-0.5, 0.5, 4001)
    ridges = gap.ridge_amplitude * np.cos(gap.ridge_number * X)
    thickness = np.asarray(gap.reference_thickness + ridges)
    position = X * gap.contact_length
    profiles = [PressureProfile(position, thickness, mean_pressure_profile(X, gap), "paper2008")]
    if p.vibration_amplitude > _STILL * gap.roughness:
        film = _solved_film(gap, p.squeeze_number, law.gas)
        solved = np.interp(X, film.position, film.mean_pressure)
        profiles.append(PressureProfile(position, thickness, solved, "solved film"))
    return tuple(profiles)


def _solved_film(gap: PaperGap, squeeze_number: si.Dimensionless, gas: Gas) -> FilmSolution:
    """The film along the contact: the paper's own equation at its squeeze number, grooves sealed at
    their ends; X = x/l0."""
    from squeezefilm.physics.film.periodic.film import solve_profile
    from squeezefilm.physics.film.periodic.profile import flexural_profile

    reference = float(gap.reference_thickness)
    profile = flexural_profile(
        float(gap.vibration_amplitude) / reference,
        wavenumber=gap.wave_number,
        ridge_depth=gap.ridge_amplitude / reference,
        ridge_wavenumber=gap.ridge_number,
    )
    slip = gas.mean_free_path / reference
    return solve_profile(squeeze_number, profile, knudsen_number=slip, tolerance=1e-3, field=True)


def friction_curve(prediction: Prediction, surface: Surface, model: FrictionModel) -> FrictionCurve:
    """Relative friction against amplitude on one surface by one model."""
    p = prediction
    law = dataclasses.replace(p.law.by(model), surface=surface)
    zero = _reached(law, 0.0)
    # Room for where the paper's finger floats; a solved one may never float.
    top = max(10e-6, 1.25 * p.vibration_amplitude, 1.1 * min(zero or 0.0, 15e-6))
    # Of a mode that is hardly driven the face moves many times as far elsewhere.
    top = min(top, law.largest_amplitude)
    amplitude = np.linspace(0.0, top, 201)
    if law.kind.shares_load:
        # Dear points lie denser at small amplitudes, where most of the friction goes.
        amplitude = top * np.linspace(0.0, 1.0, 51) ** 1.5
    return FrictionCurve(
        surface=surface.name,
        roughness=surface.roughness,
        amplitude=amplitude,
        relative_friction=law.curve(amplitude),
        amplitude_for_criterion=_reached(law, PAPER_CRITERION),
        zero_friction_amplitude=zero,
        model=model,
    )


def measured_on_like(prediction: Prediction) -> tuple[recordings.FrictionCurve, ...]:
    """Published curves of fingers on plates like that of a prediction, see `LIKE`; a force that
    was not told is that of the recording's display."""

    def is_like(curve: recordings.FrictionCurve, force: si.NewtonLike) -> bool:
        pairs = (
            (np.median(curve.frequency), prediction.frequency, _NEAR_FREQUENCY),
            (np.median(force), prediction.normal_force, _NEAR_FORCE),
        )
        return all(most >= value / own >= 1 / most for value, own, most in pairs)

    return tuple(curve for curve, force in _published() if is_like(curve, force))


@functools.cache
def _published() -> list[tuple[recordings.FrictionCurve, si.NewtonLike]]:
    """The friction curves that come with the package, with the forces of their fingers."""
    read = (check.recording for check in check_folder(presets.friction_folder()).checks)
    curves = [each for each in read if isinstance(each, recordings.FrictionCurve)]
    assumed = [load_display(curve.display).finger.normal_force for curve in curves]
    return [
        (curve, force if curve.normal_force is None else curve.normal_force)
        for curve, force in zip(curves, assumed, strict=True)
    ]


def _reached(law: FrictionLaw, relative_friction: si.Dimensionless) -> si.Metre | None:
    try:
        return law.amplitude_for(relative_friction)
    except UnreachableError:
        return None


def wavelength_curves(prediction: Prediction) -> tuple[WavelengthCurve, ...]:
    """Relative friction against amplitude at the paper's four half wavelengths, by its model."""
    p = prediction
    ambient = p.law.gas.ambient_pressure
    needed = friction_criterion(
        p.law.gap(0.0), PAPER_HALF_WAVELENGTHS, PAPER_CRITERION, p.law.normal_force, ambient
    )
    amplitude = np.linspace(0.0, 4e-6, 121)
    asymptote = p.law.by("paper2008")
    curves = []
    for half, at in zip(PAPER_HALF_WAVELENGTHS, needed, strict=True):
        law = dataclasses.replace(asymptote, half_wavelength=half)
        curves.append(
            WavelengthCurve(half, amplitude, law.curve(amplitude), float(at), "paper2008")
        )
    return tuple(curves)


# The cheap ones finely.
COMPARED: tuple[tuple[FrictionModel, int], ...] = (
    ("paper2008", 101),
    ("levitation-2016", 81),
    ("levitation-ridges", 41),
    ("levitation", 81),
    ("partial-levitation", 41),
)


@dataclass(frozen=True, eq=False)
class ModelCurve:
    """µ′/µ against vibration amplitude by one model; NaN beyond what it can do."""

    model: FrictionModel
    amplitude: si.MetreArray
    relative_friction: si.DimensionlessArray

    def at(self, amplitude: si.Metre) -> si.Dimensionless | None:
        """µ′/µ at an amplitude (m) by linear interpolation; None beyond the curve."""
        if not self.amplitude[0] <= amplitude <= self.amplitude[-1]:
            return None
        value = float(np.interp(amplitude, self.amplitude, self.relative_friction))
        return value if np.isfinite(value) else None


def model_curves(prediction: Prediction) -> tuple[ModelCurve, ...]:
    """The curves of all compared models, at the frequency, force and surface of a prediction."""
    p = prediction
    top = max(4e-6, 1.25 * p.vibration_amplitude)
    curves = []
    for model, points in COMPARED:
        law = p.law.by(model)
        # Denser at small amplitudes, where a smooth film lifts the finger off.
        amplitude = np.union1d(top * np.linspace(0, 1, points) ** 1.5, p.vibration_amplitude)
        curves.append(ModelCurve(model, amplitude, where_known(law.curve, amplitude)))
    return tuple(curves)
