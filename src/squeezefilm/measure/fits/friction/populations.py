"""Numbers of many people as they were published beside those of every model: decay amplitudes of
friction, and what fingertips add to a vibration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import to_json
from squeezefilm.measure.fits.friction.friction_curve import relative_friction
from squeezefilm.measure.fits.friction.friction_scores import fitted_shape
from squeezefilm.measure.recordings.kinds import FingertipImpedances, FrictionDecays, Told
from squeezefilm.physics.chain.friction_models import MODEL_KINDS
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display

_POINTS, _MOST_DECAY = 9, 10.0
# A publication of fingertip impedances does not tell it; what was measured is impossible at 1 µm
# (see `physics.contact.finger.load`).
_PRESSED_AMPLITUDE: si.Metre = 1e-7


@dataclass(frozen=True, eq=False)
class PopulationComparison:
    """One quantity of many people: `measured` (people or touches,), in `unit`, and what each model
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
        """What ``--json`` prints, in SI units."""
        low, median, high = np.quantile(self.measured, [0.05, 0.5, 0.95])
        return {
            "recording": to_json(self.told),
            "display": self.display,
            "conditions": self.conditions,
            "quantity": self.quantity,
            "unit": self.unit,
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
        curve = relative_friction(prediction.law.by(model), amplitude)
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
        decays.told, display.name, conditions, "decay amplitude τ", "m",
        decays.decay_amplitude, tuple(models),
    )  # fmt: skip


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
