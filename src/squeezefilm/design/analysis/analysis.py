"""Analysis of one display at one working point, ready to be shown or saved."""

from __future__ import annotations

import contextlib
import functools
import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, get_type_hints

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import Result, stamp, to_json
from squeezefilm.design.analysis.area_odds import JudgedArea
from squeezefilm.design.analysis.curves import (
    FrequencyResponse,
    FrictionCurve,
    frequency_response,
    friction_curve,
)
from squeezefilm.design.analysis.ears import EarExposure, ear_exposure
from squeezefilm.design.analysis.felt import DRAWS as FELT_DRAWS
from squeezefilm.design.analysis.felt import (
    EXPLORING_SPEEDS,
    FeltGratings,
    GratingsLeft,
    felt_gratings,
)
from squeezefilm.design.analysis.sensitivities import (
    DisplaySensitivities,
    Effort,
    display_sensitivities,
)
from squeezefilm.design.analysis.verdict import (
    Finding,
    as_json,
    ears_finding,
    held_back,
    model_form,
    rival_frictions,
    why_not_good,
)
from squeezefilm.design.analysis.wanted import Wanted
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.beam_modes import BeamTheory
from squeezefilm.physics.plate.beam_response import beam_response
from squeezefilm.physics.plate.electronics import ElectricalLoad, load_of_mode
from squeezefilm.physics.plate.laminate import CrossSection
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.working import solid_mode
from squeezefilm.physics.uncertainty.intervals import description_of
from squeezefilm.physics.uncertainty.uncertainty import (
    FrictionBand,
    UncertainFriction,
    friction_bands,
)


@dataclass(frozen=True)
class OtherModel:
    """The same plate by another theory, to show how far they differ."""

    model: str
    resonance_frequency: si.Hertz
    half_wavelength: si.Metre
    vibration_amplitude: si.Metre


def other_models(display: Display, prediction: Prediction) -> Iterator[OtherModel]:
    """A rectangular plate's mode by each other theory that has it, driven at its own resonance;
    none for other actuators or an amplitude that was given."""
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


@dataclass(frozen=True)
class MeasuredBeside:
    """A number that was measured of the real display beside the computed one, without a finger:
    `quantity` in words, both in `unit`, at what voltage (V) where it depends on it, and the source
    of the measured one ("" where none is stated)."""

    quantity: str
    measured: float
    computed: float
    unit: str
    voltage: si.Volt | None
    source: str

    @property
    def difference(self) -> si.Dimensionless:
        """The computed number less the measured one, as a share of the measured one."""
        return self.computed / self.measured - 1


def measured_beside(display: Display, prediction: Prediction) -> tuple[MeasuredBeside, ...]:
    """Measurements in a display's `[measured]` beside the solved mode of a prediction, in the order
    frequency, amplitude, quality factor; empty without one. The amplitude is the free antinode's at
    resonance, linear in the voltage."""
    known, mode = display.measured, prediction.mode
    if known is None:
        return ()
    volts = known.voltage
    amplitude = math.nan if volts is None else volts * mode.amplitude_per_volt
    pairs: tuple[tuple[str, str, str, float, si.Volt | None], ...] = (
        ("resonance_frequency", "Resonance frequency", "Hz", mode.resonance_frequency, None),
        ("vibration_amplitude", "Amplitude, free", "m", amplitude, volts),
        ("quality_factor", "Quality factor", "1", mode.quality_factor, None),
    )
    return tuple(
        MeasuredBeside(quantity, measured, computed, unit, at, source.source)
        for name, quantity, unit, computed, at in pairs
        if (measured := getattr(known, name)) is not None
        for source in (display.provenance.get(f"measured.{name}", Provenance("")),)
    )


BAND_POINTS, BAND_SAMPLES = 9, 64
"""Amplitudes at which the band of the friction is computed, and draws at each."""

BAND_REACH = 1.5
"""Reach of the band in vibration amplitudes: beyond, draws are pressed through."""

_OF_THE_DRIVE = ("vibration_amplitude_interval_m", "power_W", "power_interval_W")
"""What an interval's summary says of the drive."""

KEPT = ("sensitivities", "ears", "friction_curves", "other_models")
"""Properties that take tenths of a second to seconds, kept on disk (`Analysis.compute`)."""


@dataclass(frozen=True, eq=False, repr=False)
class Analysis(Result):
    """Everything `squeezefilm analyze` knows of a display at one working point.

    Its fields are what one decides from. What stands beside it for comparison (other models, curves
    of the paper) is a property, computed when it is first asked for.
    Summary and report hold what each value does where an `effort` was asked for, and that and other
    theories of the plate where it is `whole`. A notebook shows what `notebook` makes of it.
    """

    display: Display
    prediction: Prediction
    active_area: JudgedArea | None
    envelope_time_constant: si.Second
    envelope_bandwidth: si.Hertz
    own_curve: FrictionCurve
    uncertainty: UncertainFriction | None
    fidelity: GratingsLeft | None
    verdict: tuple[Finding, ...]
    wanted: Wanted | None = None
    effort: Effort | None = None
    whole: bool = False
    notebook: Callable[[Analysis], str] | None = None
    _shown: ClassVar[str] = (
        "display.name prediction.model prediction.voltage prediction.frequency "
        "prediction.vibration_amplitude prediction.relative_friction uncertainty.interval "
        "envelope_time_constant"
    )

    def _repr_html_(self) -> str:
        return super()._repr_html_() if self.notebook is None else self.notebook(self)

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
            friction_curve(self.prediction, surface, "paper2008")
            for surface in self.display.surfaces
        )
        return (*papers, *self.own_curves)

    @functools.cached_property
    def band(self) -> FrictionBand | None:
        """Band of µ′/µ over the amplitude with all else uncertain; None where no interval is."""
        if self.uncertainty is None:
            return None
        reach = BAND_REACH * self.prediction.vibration_amplitude
        at = reach * np.linspace(0.0, 1.0, BAND_POINTS) ** 1.5
        return friction_bands(self.display, self.prediction, at, samples=BAND_SAMPLES)[0]

    @functools.cached_property
    def rivals(self) -> dict[str, float]:
        """µ′/µ as described by the compared models that the interval does not draw."""
        return rival_frictions(self.prediction)

    @functools.cached_property
    def model_form(self) -> Finding | None:
        """Sentence on what the interval varied and what not; None where there is no interval."""
        if self.uncertainty is None:
            return None
        return model_form(self.uncertainty, self.rivals, self.prediction.mode.resonance_frequency)

    @functools.cached_property
    def ears(self) -> EarExposure | None:
        """Sound at an ear, beside the guidance; about a second, when it is first asked for."""
        return ear_exposure(self.display, self.prediction, self.uncertainty)

    @functools.cached_property
    def findings(self) -> tuple[Finding, ...]:
        """The verdict, with what reaches an ear."""
        why = None if why_not_good(self.display, self.prediction) is None else ""
        return (*self.verdict, held_back(ears_finding(self.ears), why))

    @functools.cached_property
    def felt(self) -> FeltGratings | None:
        """The finest grating that is felt at the prediction's finger speed, at others too where the
        analysis is `whole`. Without an interval of the friction this has none either."""
        draws = 0 if self.uncertainty is None else FELT_DRAWS
        speeds = EXPLORING_SPEEDS if self.whole else ()
        return felt_gratings(self.display, self.prediction, draws=draws, speeds=speeds)

    @functools.cached_property
    def sensitivities(self) -> DisplaySensitivities | None:
        """Effect of each uncertain or toleranced value, with the `effort` asked for: about a
        second, or twice a solve for each value; None where nothing vibrates."""
        if self.prediction.touch.law is None:
            return None
        return display_sensitivities(self.display, self.prediction, self.effort or "quick")

    @property
    def has_sensitivities(self) -> bool:
        """True where summary and report hold what each value does."""
        return self.whole or self.effort is not None

    @functools.cached_property
    def drive_electronics(self) -> ElectricalLoad | None:
        """Load that the plate is for its amplifier; None where no admittance was solved."""
        p = self.prediction
        return load_of_mode(self.display.actuator, p.mode, p.voltage, p.frequency)

    @functools.cached_property
    def other_models(self) -> tuple[OtherModel, ...]:
        """The same plate by other theories."""
        return tuple(other_models(self.display, self.prediction))

    @property
    def measured(self) -> tuple[MeasuredBeside, ...]:
        """Measurements of the real display beside what is computed; empty for nothing."""
        return measured_beside(self.display, self.prediction)

    def compute(self, names: Sequence[str], tell: SayProgress) -> None:
        """Compute the properties of some names; those that take long are kept on disk. `tell` is
        told each."""
        dear = [name for name in names if name in KEPT]
        types = tuple(get_type_hints(getattr(Analysis, name).func)["return"] for name in dear)
        kept: Kept[tuple[Any, ...]] = Kept("beside", tuple[types], large=True)  # type: ignore[valid-type]
        unsure = None if self.uncertainty is None else self.uncertainty.summary()
        more = (dear, self.effort, unsure)
        asked = description_of(self.display, self.prediction, more)
        known = kept.get(asked)
        vars(self).update(zip(dear, known or (), strict=False))
        for name in names:
            if name not in vars(self):
                tell(name.replace("_", " "))
                getattr(self, name)
        if known is None:
            kept.put(asked, tuple(vars(self)[name] for name in dear))

    def finest_period(self) -> dict[str, float]:
        """The finest square grating (m) that keeps 90 % of its amplitude swing, by finger speed."""
        if self.fidelity is None:
            return {}
        return {
            f"{1e3 * speed:g} mm/s": float(period)
            for speed, period in zip(self.fidelity.speeds, self.fidelity.finest_period, strict=True)
        }

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values, with units in the keys."""
        known = {} if self.uncertainty is None else self.uncertainty.summary()
        shifts = self.sensitivities if self.has_sensitivities else None
        return {
            **self.prediction.summary(),
            "active_area": None if self.active_area is None else self.active_area.summary(),
            "relative_friction_interval": known.get("relative_friction_interval"),
            "relative_friction_of_rival_models": self.rivals,
            "model_form": None if self.model_form is None else as_json([self.model_form])[0],
            "relative_friction_median": known.get("relative_friction_median"),
            **{name: known[name] for name in _OF_THE_DRIVE if name in known},
            "wanted": None if self.wanted is None else self.wanted.summary(),
            "felt": None if self.felt is None else self.felt.summary(),
            "sound_at_ear": to_json(self.ears),
            "sensitivities": None if shifts is None else shifts.summary(),
            "envelope_bandwidth_Hz": self.envelope_bandwidth,
            "finest_period_m": self.finest_period(),
            "finest_period_keeps": None
            if self.fidelity is None
            else {
                "swing": self.fidelity.kept,
                "fundamental": self.fidelity.fundamental,
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
            "other_models": to_json(self.other_models) if self.whole else None,
            "measured": [
                to_json(beside) | {"difference": beside.difference} for beside in self.measured
            ],
            "drive_electronics": to_json(self.drive_electronics),
            "verdict": as_json(self.findings),
            "provenance": stamp(self.display),
        }
