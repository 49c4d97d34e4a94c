"""The worked case: the two numbers that the paper measured of its plate, and what they say.

The paper computed 35.6 kHz and 3.2 µm at 15 V, and its vibrometer showed 30.5 kHz and 1.15 µm.
Several single explanations are compared in `explanations` beside this; here all are free at once.
"""

from __future__ import annotations

import dataclasses

from squeezefilm.core.distributions import Distribution, Uniform
from squeezefilm.core.progress import SayProgress
from squeezefilm.design.plate.solved import with_glue
from squeezefilm.measure.calibration.calibrate import USUAL_EFFORT, Effort, calibrate
from squeezefilm.measure.calibration.calibration import Calibration
from squeezefilm.measure.calibration.priors import calibration_parameters
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.display import Display, load_display
from squeezefilm.validation.explanations import (
    DRIVE_VOLTAGE,
    MEASURED_AMPLITUDE,
    MEASURED_FREQUENCY,
    paper_plate,
)

# The paper states no errors: half of the last digit of the frequency, 5 % for a vibrometer.
_FREQUENCY_ERROR, _AMPLITUDE_SHARE = 50.0, 0.05
_GLUE = (30e-6, 2e9)
GLUE_PRIORS: dict[str, Distribution] = {
    "actuator.glue.thickness": Uniform(5e-6, 80e-6),
    "actuator.glue.young_modulus": Uniform(0.3e9, 5e9),
}
"""**Assumed**: the paper says nothing of its glue."""


def paper_observations() -> tuple[Observation, ...]:
    """What the paper measured (section 3.2.1): 30.5 kHz, and 1.15 µm at 15 V. Its errors are
    assumed: the last digit, and 5 %."""
    per_volt = MEASURED_AMPLITUDE / DRIVE_VOLTAGE
    return (
        Observation("resonance_frequency", MEASURED_FREQUENCY, _FREQUENCY_ERROR),
        Observation("amplitude_per_volt", per_volt, _AMPLITUDE_SHARE * per_volt),
    )


def glued_paper_display() -> Display:
    """The preset with a glue line under its ceramics, of assumed thickness and modulus."""
    return dataclasses.replace(
        load_display("biet2008-plate"), actuator=with_glue(paper_plate(), *_GLUE)
    )


def paper_calibration(
    *, seed: int = 1, effort: Effort = USUAL_EFFORT, progress: SayProgress | None = None
) -> Calibration:
    """The calibration of the paper's plate on its two measured numbers, its glue free. Three to
    five minutes; what was solved is kept."""
    display = glued_paper_display()
    paths: dict[str, Distribution | None] = {
        one.path: one.distribution for one in calibration_parameters(display)
    }
    return calibrate(
        display,
        paper_observations(),
        parameters=paths | GLUE_PRIORS,
        seed=seed,
        progress=progress,
        effort=effort,
    )
