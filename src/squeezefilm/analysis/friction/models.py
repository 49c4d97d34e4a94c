"""The friction of one finger by every model, against the amplitude: how far models differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.chain.friction import MODEL_KINDS, FrictionModel, friction_law
from squeezefilm.chain.prediction import Prediction
from squeezefilm.display import Display
from squeezefilm.errors import SqueezefilmError

# The paper's model, the films of the paper's gap, and what shares the load; the cheap ones finely.
COMPARED: tuple[tuple[FrictionModel, int], ...] = (
    ("paper2008", 101),
    ("film-smooth", 25),
    ("film-sealed", 25),
    ("partial-levitation", 81),
    ("partial-levitation-one-gap", 41),
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


def model_curves(display: Display, prediction: Prediction) -> tuple[ModelCurve, ...]:
    """The curves of all compared models, at the frequency, force and surface of a prediction."""
    p = prediction
    top = max(4e-6, 1.25 * p.vibration_amplitude)
    found = []
    for model, points in COMPARED:
        law = friction_law(
            display,
            p.mode.half_wavelength,
            p.frequency,
            surface=p.surface,
            normal_force=p.normal_force,
            model=model,
            position=p.law.position if MODEL_KINDS[model].film == "shared" else 0.0,
        )
        # Denser at small amplitudes, where a smooth film lifts the finger off.
        amplitude = np.union1d(top * np.linspace(0, 1, points) ** 1.5, p.vibration_amplitude)
        friction = np.full(amplitude.size, np.nan)
        for at in range(amplitude.size):
            try:
                friction[at] = law.at(float(amplitude[at]))
            except SqueezefilmError:
                break
        found.append(ModelCurve(model, amplitude, friction))
    return tuple(found)
