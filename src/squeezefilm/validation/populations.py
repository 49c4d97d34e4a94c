"""Published measurements of people beside what is computed: decay amplitudes of friction and what
fingertips add to a vibration, beside every model; thresholds of its modulation beside rival senses.

At one speed a spatial period and a frequency are the same variable: senses that go by frequency
("temporal"), by period ("spatial") or half by either ("mixed": by the root of their product) have
the same thresholds there, and part at any other speed. The skin goes by the frequency with all of
them. What the stretch of sliding skin masks was fitted to the medians (`tools/threshold_fit.py`).
The mean friction is not published: assumed. Nothing is known of how people differ.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import to_json, values_of
from squeezefilm.measure.fits.friction.friction_scores import fitted_shape
from squeezefilm.measure.recordings.kinds import (
    DetectionThresholds,
    FingertipImpedances,
    FrictionDecays,
    Told,
)
from squeezefilm.physics.chain.friction import where_known
from squeezefilm.physics.chain.pad_law import MODEL_KINDS
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.display import Display
from squeezefilm.physics.perception.observer import Observer, load_observer
from squeezefilm.physics.perception.senses import MEAN_FRICTION, Rubbed, detected_share

_POINTS, _MOST_DECAY = 9, 10.0
# A publication of fingertip impedances does not tell it; what was measured is impossible at 1 µm
# (see `physics.contact.finger.load`).
_PRESSED_AMPLITUDE: si.Metre = 1e-7


@dataclass(frozen=True, eq=False)
class PopulationComparison:
    """A quantity of many people: `measured` (people or touches,), in `unit`, and what each model
    gives, None where it gives nothing; nothing is fitted."""

    told: Told
    display: str
    conditions: str
    quantity: str
    unit: str
    measured: si.FloatArray
    models: tuple[tuple[str, float | None], ...]

    def share_below(self, value: float) -> si.Dimensionless:
        """The share of the measured numbers below a value."""
        return float(np.mean(self.measured < value))

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values, in SI units."""
        low, median, high = np.quantile(self.measured, [0.05, 0.5, 0.95])
        return {
            "recording": to_json(self.told),
            **values_of(self, "display conditions quantity unit"),
            "count": int(self.measured.size),
            "median": float(median),
            "5_to_95_percent": [float(low), float(high)],
            "models": dict(self.models),
        }


def compare_decays(
    decays: FrictionDecays, display: Display, progress: SayProgress | None = None
) -> PopulationComparison:
    """The decay amplitude τ of published fits (m) beside that of each model on a display, fitted to
    the model's own curve in the same way. Raises what `predict` raises."""
    tell = progress or (lambda _: None)
    largest = 2.0 * float(np.quantile(decays.decay_amplitude, 0.95))
    amplitude = np.linspace(0.0, largest, _POINTS)
    prediction = predict(
        display,
        vibration_amplitude=largest,
        frequency=decays.frequency,
        normal_force=decays.normal_force,
        speed=decays.speed,
    )
    models: list[tuple[str, float | None]] = []
    for model in MODEL_KINDS:
        tell(f"{decays.told.name}: {model}")
        curve = where_known(prediction.law.by(model).curve, amplitude)
        known = np.isfinite(curve)
        tau = None
        if known.sum() > 2:
            tau = fitted_shape("gaussian", amplitude[known], curve[known])[0]
            # A curve that hardly falls says nothing of its decay.
            tau = tau if tau < _MOST_DECAY * largest else None
        models.append((model, tau))
    assumed = "" if decays.speed is not None and decays.normal_force is not None else ", assumed"
    conditions = (
        f"{decays.frequency:.5g} Hz, {prediction.normal_force:.2g} N, "
        f"{1e3 * prediction.speed:.3g} mm/s{assumed}"
    )
    return PopulationComparison(
        decays.told,
        display.name,
        conditions,
        "decay amplitude τ",
        "m",
        decays.decay_amplitude,
        tuple(models),
    )


def compare_impedances(
    touches: FingertipImpedances, display: Display
) -> tuple[PopulationComparison, PopulationComparison]:
    """Damping (N s/m) and moving mass (kg) of fingertips beside those of the default model on a
    display, at an assumed amplitude of 0.1 µm; a mass below zero is a stiffness. Raises what
    `predict` raises."""
    prediction = predict(
        display,
        vibration_amplitude=_PRESSED_AMPLITUDE,
        frequency=touches.frequency,
        normal_force=touches.normal_force,
    )
    impedance = prediction.touch.impedance
    damping = mass = None
    if impedance is not None:
        damping, mass = impedance.real, impedance.imag / (2 * np.pi * touches.frequency)
    conditions = (
        f"{touches.frequency:.5g} Hz, {touches.normal_force:.2g} N, 0.1 µm assumed; the mass of "
        "the default skin is derived from the fingertips on glass of 2018"
    )
    model = prediction.law.model
    told = (touches.told, display.name, conditions)
    return (
        PopulationComparison(
            *told, "damping of a fingertip", "N*s/m", touches.damping, ((model, damping),)
        ),
        PopulationComparison(
            *told, "moving mass of a fingertip", "kg", touches.mass, ((model, mass),)
        ),
    )


Rival = Literal["temporal", "mixed", "spatial"]
RIVALS: Mapping[Rival, si.Dimensionless] = {"temporal": 1.0, "mixed": 0.5, "spatial": 0.0}
"""Rival senses by the speed's exponent in their channels; at `TUNED_AT` all are alike."""
METHOD_RATIO: si.Dimensionless = 1.45
"""Ratio of what two intervals, three down and one up, the mean of the last six trials and the
larger of two directions give, over the amplitude with d′ = 1: simulated by
`tools/threshold_fit.py`, 1.4 to 1.6 by what of the method is not published."""
_SAMPLES = 256


@dataclass(frozen=True, eq=False)
class DetectionComparison:
    """Measured medians beside what each rival gives by the published method: `rivals` has their
    names and amplitudes of the friction coefficient (1), of the shape of the measured ones."""

    measured: DetectionThresholds
    rivals: tuple[tuple[Rival, si.DimensionlessArray], ...]

    @property
    def told(self) -> Told:
        """Source: who measured, when and how."""
        return self.measured.told

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values; keys carry units."""
        return {
            "recording": to_json(self.told),
            "people": self.measured.people,
            "finger_speed_m_per_s": self.measured.speed,
            "mean_friction_assumed": MEAN_FRICTION,
            "spatial_period_m": self.measured.period.tolist(),
            "measured_friction_coefficient": self.measured.amplitude.tolist(),
            "rivals_friction_coefficient": {name: x.tolist() for name, x in self.rivals},
        }


def rival_observer(observer: Observer, rival: Rival) -> Observer:
    """The observer whose channels go by what a rival says. Raises `InputError` for another."""
    si.require_one_of("rival", rival, tuple(RIVALS))
    channels = tuple(
        dataclasses.replace(channel, speed_exponent=RIVALS[rival]) for channel in observer.channels
    )
    return dataclasses.replace(observer, name=f"{observer.name}, {rival}", channels=channels)


@si.checked_numbers
def detection_threshold(
    observer: Observer,
    period: Annotated[si.MetreArray, si.Above(0.0)],
    speed: Annotated[si.MetrePerSecond, si.Above(0.0)],
    normal_force: Annotated[si.Newton, si.Above(0.0), si.AtMost(2.0)],
    friction_coefficient: Annotated[si.Dimensionless, si.Above(0.0)] = MEAN_FRICTION,
) -> si.DimensionlessArray:
    """The amplitude (zero-to-peak) of the friction coefficient (1) about its mean that has d′ = 1,
    of sines of periods (m), shape (n,), under the published pad that slides at a speed (m/s) and a
    force (N). Raises `InputError` for a value out of range. Source: `physics.perception.senses`."""
    pad = FingerpadDynamics.pressed(normal_force)
    rubbed = Rubbed(friction_coefficient * normal_force, pad, speed)
    wave = np.sin(2 * math.pi * np.arange(_SAMPLES) / _SAMPLES) * np.ones((period.size, 1))
    return np.asarray(friction_coefficient * detected_share(observer, period, wave, rubbed))


def detection_medians(
    observer: Observer,
    measured: DetectionThresholds,
    *,
    speed: si.MetrePerSecond | None = None,
    period: si.MetreArray | None = None,
) -> si.DimensionlessArray:
    """Medians that the published method would give of this observer (1), shape (periods,): where
    thresholds were measured, or at another speed (m/s) and other periods (m)."""
    return METHOD_RATIO * detection_threshold(
        observer,
        measured.period if period is None else period,
        measured.speed if speed is None else speed,
        measured.normal_force,
    )


def compare_detection(measured: DetectionThresholds) -> DetectionComparison:
    """Measured medians beside the rivals of the preset observer."""
    observer = load_observer()
    made = [detection_medians(rival_observer(observer, rival), measured) for rival in RIVALS]
    return DetectionComparison(measured, tuple(zip(RIVALS, made, strict=True)))
