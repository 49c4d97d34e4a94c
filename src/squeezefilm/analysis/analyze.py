"""`analyze`: everything about one display at one working point, ready to be shown or saved."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from squeezefilm import quantities as si
from squeezefilm.analysis.area_odds import JudgedArea, judged_area
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
from squeezefilm.analysis.ears import EarExposure, ear_exposure
from squeezefilm.analysis.felt import DRAWS as FELT_DRAWS
from squeezefilm.analysis.felt import FeltGratings, felt_gratings
from squeezefilm.analysis.film.models import FilmComparison, compare_film_models
from squeezefilm.analysis.friction.wanted import Wanted
from squeezefilm.analysis.friction.wanted import wanted_friction as friction_wanted
from squeezefilm.analysis.sensitivities import (
    DisplaySensitivities,
    Effort,
    display_sensitivities,
)
from squeezefilm.analysis.textures import (
    CompensatedGrating,
    TextureSurvival,
    compensated_grating,
    driven_envelope,
    texture_survival,
)
from squeezefilm.analysis.uncertainty import (
    SAMPLES,
    UncertainFriction,
    interval_or_reason,
)
from squeezefilm.analysis.verdict import Finding, ears_finding, unless_undriven, verdict
from squeezefilm.chain.active_area import active_area
from squeezefilm.chain.friction_models import FrictionModel
from squeezefilm.chain.pad_place import FacePlace
from squeezefilm.chain.prediction import Prediction, predict
from squeezefilm.display import Display, NamedDisplay
from squeezefilm.errors import InputError, OutOfRangeError
from squeezefilm.from_text import reads_text
from squeezefilm.plate.beam.modes import BeamTheory
from squeezefilm.plate.beam.response import beam_response
from squeezefilm.plate.electronics import ElectricalLoad, load_of_mode
from squeezefilm.plate.laminate import CrossSection
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.shear.modes import shear_mode
from squeezefilm.plate.solid.working import solid_mode
from squeezefilm.plate.working_mode import PlateTheory
from squeezefilm.progress import Deadline, Pace, SayProgress, said_with_time_left
from squeezefilm.render.fidelity.survival import FidelityTable, fidelity_table
from squeezefilm.render.fidelity.trace import FrictionTrace, friction_trace
from squeezefilm.render.motion.stroke import Stroke
from squeezefilm.render.resonator.envelope import envelope_bandwidth
from squeezefilm.render.texture.levels import Amplitude
from squeezefilm.render.texture.shapes import SquareWave
from squeezefilm.results import Result, stamp, to_json


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
    """Everything `squeezefilm analyze` knows of a display at one working point."""

    display: Display
    prediction: Prediction
    active_area: JudgedArea | None
    envelope_time_constant: si.Second
    envelope_bandwidth: si.Hertz
    other_models: tuple[OtherModel, ...]
    response: FrequencyResponse
    pressure: tuple[PressureProfile, ...]
    friction_curves: tuple[FrictionCurve, ...]
    model_curves: tuple[ModelCurve, ...]
    uncertainty: UncertainFriction | None
    wavelength_curves: tuple[WavelengthCurve, ...]
    film_models: FilmComparison | None
    texture: FrictionTrace | None
    fidelity: FidelityTable | None
    compensated: CompensatedGrating | None
    survival: TextureSurvival | None
    verdict: tuple[Finding, ...]
    wanted: Wanted | None = None
    effort: Effort = "quick"
    _shown: ClassVar[str] = (
        "display.name prediction.model prediction.voltage prediction.frequency "
        "prediction.vibration_amplitude prediction.relative_friction uncertainty.interval "
        "envelope_time_constant"
    )

    @functools.cached_property
    def ears(self) -> EarExposure | None:
        """What reaches an ear, beside the guidance; about a second, when it is first asked for."""
        return ear_exposure(self.display, self.prediction, self.uncertainty)

    @property
    def ears_finding(self) -> Finding:
        """What that amounts to; not good while an objection stands."""
        found = ears_finding(self.ears)
        return unless_undriven(found, "" if self.prediction.objections else None)

    @functools.cached_property
    def felt(self) -> FeltGratings | None:
        """The finest grating that is felt, by finger speed; about a second, when first asked for.
        Without an interval of the friction this has none either."""
        draws = 0 if self.uncertainty is None else FELT_DRAWS
        return felt_gratings(self.display, self.prediction, draws=draws)

    @functools.cached_property
    def sensitivities(self) -> DisplaySensitivities | None:
        """What each uncertain or toleranced value does, with the `effort` asked for: about a
        second, or twice a solve for each value; None where nothing vibrates."""
        if self.prediction.touch.sharing is None:
            return None
        return display_sensitivities(self.display, self.prediction, self.effort)

    @functools.cached_property
    def drive_electronics(self) -> ElectricalLoad | None:
        """What the plate asks of its amplifier; None where no admittance was solved."""
        p = self.prediction
        return load_of_mode(self.display.actuator, p.mode, p.voltage, p.frequency)

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
            "active_area": None if self.active_area is None else self.active_area.summary(),
            "relative_friction_interval": None
            if self.uncertainty is None
            else list(self.uncertainty.interval),
            "relative_friction_median": None
            if self.uncertainty is None
            else self.uncertainty.median,
            **_intervals(self.uncertainty),
            "wanted": None if self.wanted is None else self.wanted.summary(),
            "felt": None if self.felt is None else self.felt.summary(),
            "sound_at_ear": to_json(self.ears),
            "sensitivities": None if self.sensitivities is None else self.sensitivities.summary(),
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
            "drive_electronics": to_json(self.drive_electronics),
            "verdict": to_json((*self.verdict, self.ears_finding)),
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
    place: FacePlace | None = None,
    strict: bool = False,
    samples: int = SAMPLES,
    wanted_friction: si.Dimensionless | None = None,
    sensitivities: Effort = "quick",
    progress: SayProgress | None = None,
    budget: si.Second | None = None,
) -> Analysis:
    """The whole analysis of a display at one working point.

    Arguments and errors are those of `prediction.predict`; `samples` (0: none) is the base of the
    uncertainty's design, see `uncertain_friction`; `wanted_friction` asks for the voltage that
    reaches it, `sensitivities` how a plate with one thing different is computed, see
    `display_sensitivities`; `progress` is told each step. With a `budget` (s) half of it bounds the
    plate's solve, and the interval and the other films are left out where nothing is left for them:
    what is missing is said.
    """
    if budget is not None:
        si.require("budget", budget, si.Unit("s"), above=0)
    tell = progress or (lambda _: None)
    deadline = Pace(budget).deadline()
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
        place=place,
        strict=strict,
        pace=Pace(None if budget is None else budget / 2, said_with_time_left(tell)),
    )
    found = _what_follows(display, prediction, samples, tell, deadline)
    if wanted_friction is None:
        return dataclasses.replace(found, effort=sensitivities)
    tell("the voltage for the friction wanted")
    wanted = friction_wanted(
        display, prediction, wanted_friction, samples=samples, strict=False, progress=tell
    )
    return dataclasses.replace(found, wanted=wanted, effort=sensitivities)


def _intervals(unsure: UncertainFriction | None) -> dict[str, Any]:
    """Those of what the drive does, for ``--json``."""
    if unsure is None:
        return {}
    found = unsure.summary()
    names = ("vibration_amplitude_interval_m", "power_W", "power_interval_W")
    return {name: found[name] for name in names}


# What these steps take (s), measured on the presets; a budget without room for one leaves it out.
_INTERVAL, _FILMS = 6.0, 4.0


def _what_follows(
    display: Display,
    prediction: Prediction,
    samples: int,
    tell: SayProgress,
    deadline: Deadline | None,
) -> Analysis:
    """All that an analysis says, from a prediction; what a deadline leaves no room for is left
    out."""
    mode = prediction.mode
    tau = prediction.envelope_time_constant
    tell("friction over the active area")
    area = judged_area(display, prediction, active_area(display, prediction), samples=samples)
    tell("frequency response")
    response = frequency_response(prediction)
    tell("pressure under the finger")
    pressure = pressure_profiles(prediction)
    tell("friction against amplitude")
    models: tuple[FrictionModel, ...] = ("paper2008",)
    if prediction.model not in models:
        models = (*models, prediction.model)
    curves = tuple(
        friction_curve(prediction, surface, model)
        for model in models
        for surface in display.surfaces
    )
    tell("friction by every model, and how sure it is")
    by_model = model_curves(prediction)
    if deadline is None or deadline.allows(_INTERVAL):
        unsure, why_not = interval_or_reason(display, prediction, samples=samples)
    else:
        unsure, why_not = None, "the budget left no time for its interval"
    tell("wavelength against amplitude")
    wavelengths = wavelength_curves(prediction)
    tell("the paper's film and solved films")
    wide = deadline is None or deadline.allows(_FILMS)
    films = compare_film_models(display, prediction) if wide else None
    tell("textures")
    trace, table = _textures(prediction, tau)
    compensated, survival = _compensation(display, prediction)
    tell("verdict")
    return Analysis(
        display=display,
        prediction=prediction,
        active_area=area,
        envelope_time_constant=tau,
        envelope_bandwidth=float(envelope_bandwidth(mode.quality_factor, mode.resonance_frequency)),
        other_models=tuple(_other_models(display, prediction)),
        response=response,
        pressure=pressure,
        friction_curves=curves,
        model_curves=by_model,
        uncertainty=unsure,
        wavelength_curves=wavelengths,
        film_models=films,
        texture=trace,
        fidelity=table,
        compensated=compensated,
        survival=survival,
        verdict=tuple(verdict(display, prediction, area, curves, table, films, unsure, why_not)),
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
    # Where a budget left no time for the solid, it has none beside a beam either.
    if mode.solid is None and not prediction.objections:
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


def _textures(
    prediction: Prediction, tau: si.Second
) -> tuple[FrictionTrace | None, FidelityTable | None]:
    high = prediction.vibration_amplitude
    if prediction.relative_friction == 1 or high == 0:
        return None, None
    friction = prediction.friction
    trace = friction_trace(
        Amplitude(SquareWave(2e-3), low=0.0, high=high), Stroke(speed=0.1), tau, friction
    )
    return trace, fidelity_table(tau, friction, low=0.0, high=high)
