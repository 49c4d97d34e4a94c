"""`analyze`: everything about one display at one working point, ready to be shown or saved."""

from __future__ import annotations

import contextlib
import functools
import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.curves import (
    FrequencyResponse,
    FrictionCurve,
    ModelCurve,
    PressureProfile,
    WavelengthCurve,
    frequency_response,
    friction_curve,
    model_curves,
    pressure_profiles,
    wavelength_curves,
)
from squeezefilm.analysis.film.models import FilmComparison, compare_film_models
from squeezefilm.analysis.sound import plate_sound
from squeezefilm.analysis.textures import (
    CompensatedGrating,
    TextureSurvival,
    compensated_grating,
    driven_envelope,
    texture_survival,
)
from squeezefilm.analysis.uncertainty import (
    SAMPLES,
    FrictionBand,
    UncertainFriction,
    friction_band,
    interval_or_reason,
)
from squeezefilm.analysis.verdict import Finding, film_findings, verdict
from squeezefilm.chain.friction_models import FrictionModel
from squeezefilm.chain.prediction import Prediction, predict
from squeezefilm.display import Display, NamedDisplay
from squeezefilm.errors import InputError, OutOfRangeError
from squeezefilm.from_text import reads_text
from squeezefilm.plate.beam.modes import BeamTheory
from squeezefilm.plate.beam.response import beam_response
from squeezefilm.plate.laminate import CrossSection
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.shear.modes import shear_mode
from squeezefilm.plate.solid.working import solid_mode
from squeezefilm.plate.sound import SoundField
from squeezefilm.plate.working_mode import PlateTheory
from squeezefilm.progress import SayProgress
from squeezefilm.render.fidelity.survival import FidelityTable, fidelity_table
from squeezefilm.render.fidelity.trace import FrictionTrace, friction_trace
from squeezefilm.render.motion.stroke import Stroke
from squeezefilm.render.resonator.envelope import envelope_bandwidth
from squeezefilm.render.texture.levels import Amplitude
from squeezefilm.render.texture.shapes import SquareWave
from squeezefilm.results import Result, stamp, to_json

BAND_POINTS, BAND_SAMPLES = 9, 64
"""Amplitudes at which the band of the friction is computed, and draws at each."""

BAND_REACH = 1.5
"""How far the band goes, in vibration amplitudes: beyond, draws are pressed through."""

SEATED: tuple[si.Metre, ...] = (0.5,)
"""Where the sound is asked for: at the head of a seated user. `squeezefilm plate` has more."""


@dataclass(frozen=True)
class OtherModel:
    """The same plate by another theory, to show how far they differ; no amplitude where the theory
    is used for the frequency only."""

    model: str
    resonance_frequency: si.Hertz
    half_wavelength: si.Metre | None
    vibration_amplitude: si.Metre | None


@dataclass(frozen=True, eq=False, repr=False)
class Analysis(Result):
    """Everything `squeezefilm analyze` knows of a display at one working point.

    Its fields are what one decides from. What stands beside it for comparison (other models, curves
    of the paper, textures along a stroke) is a property, computed when it is first asked for.
    """

    display: Display
    prediction: Prediction
    envelope_time_constant: si.Second
    envelope_bandwidth: si.Hertz
    own_curve: FrictionCurve
    uncertainty: UncertainFriction | None
    fidelity: FidelityTable | None
    verdict: tuple[Finding, ...]
    _shown: ClassVar[str] = (
        "display.name prediction.model prediction.voltage prediction.frequency "
        "prediction.vibration_amplitude prediction.relative_friction uncertainty.interval "
        "envelope_time_constant"
    )

    @functools.cached_property
    def response(self) -> FrequencyResponse:
        """The amplitude per volt around the working resonance, without a finger."""
        return frequency_response(self.prediction)

    @functools.cached_property
    def own_curves(self) -> tuple[FrictionCurve, ...]:
        """Friction against amplitude on each surface, by the model of the prediction."""
        return tuple(
            self.own_curve
            if surface == self.prediction.surface
            else friction_curve(self.prediction, surface, self.prediction.model)
            for surface in self.display.surfaces
        )

    @functools.cached_property
    def friction_curves(self) -> tuple[FrictionCurve, ...]:
        """Friction against amplitude on each surface: by the paper's model (its Fig 5), then by
        the prediction's own where that is another."""
        if self.prediction.model == "paper2008":
            return self.own_curves
        papers = (
            friction_curve(self.prediction, one, "paper2008") for one in self.display.surfaces
        )
        return (*papers, *self.own_curves)

    @functools.cached_property
    def band(self) -> FrictionBand | None:
        """Where µ′/µ lies over the amplitude with all else uncertain; None where no interval is."""
        if self.uncertainty is None:
            return None
        reach = BAND_REACH * self.prediction.vibration_amplitude
        at = reach * np.linspace(0.0, 1.0, BAND_POINTS) ** 1.5
        return friction_band(self.display, self.prediction, at, samples=BAND_SAMPLES)

    @functools.cached_property
    def sound(self) -> SoundField | None:
        """The airborne sound of the solved face as it is driven; None where no face was solved or
        nothing drives it."""
        p = self.prediction
        if p.mode.solid is None or not p.voltage:
            return None
        response = p.mode.solid.response
        nearest = int(np.argmin(np.abs(response.frequencies - p.frequency)))
        return plate_sound(response, nearest, p.frequency, p.voltage, SEATED)

    @functools.cached_property
    def pressure(self) -> tuple[PressureProfile, ...]:
        """The mean pressure along the contact, by the paper's asymptote and solved."""
        return pressure_profiles(self.prediction)

    @functools.cached_property
    def model_curves(self) -> tuple[ModelCurve, ...]:
        """Friction against amplitude by every model."""
        return model_curves(self.prediction)

    @functools.cached_property
    def wavelength_curves(self) -> tuple[WavelengthCurve, ...]:
        """Friction against amplitude at the paper's half wavelengths (its Fig 11)."""
        return wavelength_curves(self.prediction)

    @functools.cached_property
    def film_models(self) -> FilmComparison | None:
        """The film under the finger as each model reads it; None where nothing vibrates."""
        return compare_film_models(self.display, self.prediction)

    @functools.cached_property
    def film_findings(self) -> tuple[Finding, ...]:
        """What the readings of the film amount to, in sentences."""
        films = self.film_models
        return () if films is None else tuple(film_findings(self.prediction, films))

    @functools.cached_property
    def other_models(self) -> tuple[OtherModel, ...]:
        """The same plate by other theories."""
        return tuple(_other_models(self.display, self.prediction))

    @functools.cached_property
    def texture(self) -> FrictionTrace | None:
        """A stroke over a square grating; None where the amplitude changes no friction."""
        return _texture(self.prediction, self.envelope_time_constant)

    @functools.cached_property
    def _compensation(self) -> tuple[CompensatedGrating | None, TextureSurvival | None]:
        return _compensation(self.display, self.prediction)

    @property
    def compensated(self) -> CompensatedGrating | None:
        """A fine grating through the resonator; None where no voltage makes an amplitude."""
        return self._compensation[0]

    @property
    def survival(self) -> TextureSurvival | None:
        """Which grating survives at which speed; None where no voltage makes an amplitude."""
        return self._compensation[1]

    def finest_period(self) -> dict[str, float]:
        """The finest square grating (m) that keeps 90 % of its amplitude swing, by finger speed."""
        if self.fidelity is None:
            return {}
        return {
            f"{1e3 * speed:g} mm/s": float(period)
            for speed, period in zip(self.fidelity.speeds, self.fidelity.finest_period, strict=True)
        }

    def summary(self) -> dict[str, Any]:
        """The numbers, with units in the keys: what ``--json`` prints."""
        p = self.prediction
        return {
            **p.summary(),
            "relative_friction_interval": None
            if self.uncertainty is None
            else list(self.uncertainty.interval),
            "relative_friction_median": None
            if self.uncertainty is None
            else self.uncertainty.median,
            "envelope_bandwidth_Hz": self.envelope_bandwidth,
            "finest_period_m": self.finest_period(),
            "finest_period_keeps": None
            if self.fidelity is None
            else {
                "swing": self.fidelity.kept,
                "fundamental": self.fidelity.fundamental_at_limit,
            },
            "compensation_speed_gain": None
            if self.survival is None
            else {
                law.name: gain
                for law, gain in zip(self.survival.laws, self.survival.gain.tolist(), strict=True)
            },
            "friction_criterion": [
                {
                    "surface": curve.surface,
                    "model": curve.model,
                    "amplitude_for_0.7_m": curve.amplitude_for_criterion,
                    "zero_friction_amplitude_m": curve.zero_friction_amplitude,
                }
                for curve in self.friction_curves
            ],
            "film_models": None
            if self.film_models is None
            else {
                "results": to_json(self.film_models.results),
                "teeth": to_json(self.film_models.teeth),
                "plateau_balance": to_json(self.film_models.balance),
            },
            "other_models": to_json(self.other_models),
            "verdict": to_json((*self.verdict, *self.film_findings)),
            "provenance": stamp(self.display),
        }


@reads_text
def analyze(
    display: NamedDisplay,
    *,
    voltage: si.Volt | None = None,
    frequency: si.Hertz | None = None,
    vibration_amplitude: si.Metre | None = None,
    normal_force: si.Newton | None = None,
    surface: str | None = None,
    theory: PlateTheory | None = None,
    model: FrictionModel | None = None,
    speed: si.MetrePerSecond | None = None,
    strict: bool = False,
    samples: int = SAMPLES,
    progress: SayProgress | None = None,
) -> Analysis:
    """The whole analysis of a display at one working point.

    Arguments and errors are those of `prediction.predict`; `samples` (0: none) is the base of the
    uncertainty's design, see `uncertain_friction`; `progress` is told each step.
    """
    tell = progress or (lambda _: None)
    tell("resonance, amplitude and friction")
    prediction = predict(
        display,
        voltage=voltage,
        frequency=frequency,
        normal_force=normal_force,
        surface=surface,
        vibration_amplitude=vibration_amplitude,
        theory=theory,
        model=model,
        speed=speed,
        strict=strict,
    )
    return _what_follows(display, prediction, samples, tell)


def _what_follows(
    display: Display, prediction: Prediction, samples: int, tell: SayProgress
) -> Analysis:
    """What one decides from, of a prediction."""
    mode = prediction.mode
    tau = prediction.envelope_time_constant
    tell("friction against amplitude")
    own = friction_curve(prediction, prediction.surface, prediction.model)
    tell("how sure the friction is")
    unsure, why_not = interval_or_reason(display, prediction, samples=samples)
    tell("verdict")
    table = _fidelity(prediction, tau)
    return Analysis(
        display=display,
        prediction=prediction,
        envelope_time_constant=tau,
        envelope_bandwidth=float(envelope_bandwidth(mode.quality_factor, mode.resonance_frequency)),
        own_curve=own,
        uncertainty=unsure,
        fidelity=table,
        verdict=tuple(verdict(display, prediction, own, table, unsure, why_not)),
    )


def _compensation(
    display: Display, prediction: Prediction
) -> tuple[CompensatedGrating | None, TextureSurvival | None]:
    if not prediction.voltage or prediction.vibration_amplitude == 0:
        return None, None
    envelope = driven_envelope(prediction)
    return compensated_grating(envelope), texture_survival(display.name, envelope)


def _other_models(display: Display, prediction: Prediction) -> Iterator[OtherModel]:
    if not isinstance(display.actuator, RectangularPlate) or prediction.voltage is None:
        return
    plate, volts = display.actuator, prediction.voltage
    mode = prediction.mode
    if mode.solid is None:
        with contextlib.suppress(InputError):
            solid = solid_mode(plate)
            amplitude = volts * solid.amplitude_per_volt
            yield OtherModel(solid.model, solid.frequency, solid.half_wavelength, amplitude)
    # A theory that has no such mode near has nothing to set beside.
    with contextlib.suppress(InputError):
        shear = shear_mode(plate, plate.working_label, mode.resonance_frequency)
        yield OtherModel("shear_plate", shear.frequency, None, None)
    theories: tuple[BeamTheory, ...] = ("timoshenko", "euler_bernoulli")
    sections: tuple[CrossSection, ...] = ("plane_strain", "plane_stress", "paper")
    for theory, section in itertools.product(theories, sections):
        try:
            beam = beam_response(plate, theory, section)
        except OutOfRangeError:
            continue
        if beam.model != mode.model:
            amplitude = volts * beam.amplitude_per_volt
            yield OtherModel(beam.model, beam.mode.frequency, beam.mode.half_wavelength, amplitude)


def _texture(prediction: Prediction, tau: si.Second) -> FrictionTrace | None:
    high = prediction.vibration_amplitude
    if not _changes_friction(prediction):
        return None
    grating = Amplitude(SquareWave(2e-3), low=0.0, high=high)
    return friction_trace(grating, Stroke(speed=0.1), tau, prediction.friction)


def _fidelity(prediction: Prediction, tau: si.Second) -> FidelityTable | None:
    if not _changes_friction(prediction):
        return None
    return fidelity_table(tau, prediction.friction, low=0.0, high=prediction.vibration_amplitude)


def _changes_friction(prediction: Prediction) -> bool:
    return prediction.relative_friction != 1 and prediction.vibration_amplitude != 0
