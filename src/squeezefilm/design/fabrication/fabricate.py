"""`fabricate`: what it takes to build a display and to see on a bench that it is the one meant."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import Result, stamp, to_json, values_of
from squeezefilm.design.fabrication.test_plan import BenchFacts, TestStep, test_plan
from squeezefilm.design.fabrication.wiring import (
    BillRow,
    Electrode,
    bill_of,
    electrodes_of,
    nodal_lines_of,
)
from squeezefilm.measure.calibration.blind import (
    BlindPrediction,
    load_prediction,
    predicted,
)
from squeezefilm.measure.calibration.priors import calibration_parameters
from squeezefilm.measure.calibration.solved_answers import FRICTION
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import Display, NamedDisplay
from squeezefilm.physics.plate.electronics import load_of_mode
from squeezefilm.physics.plate.layout import AnnularStator, RectangularPlate
from squeezefilm.physics.plate.parts import parts_of
from squeezefilm.physics.uncertainty.parameters import Parameter
from squeezefilm.physics.uncertainty.uncertainty import (
    SAMPLES,
    UncertainFriction,
    interval_or_reason,
)

ASKED = (
    "mass",
    "resonance_frequency",
    "parallel_resonance_frequency",
    "coupling_coefficient",
    "static_capacitance",
    "quality_factor",
    "amplitude_per_volt",
    "half_wavelength",
)
"""Quantities predicted of every plate and disc, by the name for a calibration."""
SHARES = (0.5, 1.0)
"""The amplitudes, over that of the display under its finger, at which µ′/µ is predicted."""


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Fabrication(BenchFacts, Result):
    """Everything that a workshop and a bench are told of a display.

    `parts` are its solid bodies, `bill` what is bought or cut, `blind` what is expected of the
    built display with intervals, to be scored by `squeezefilm measure score` (None where nothing
    can be drawn: `no_intervals` says why), `drawn` which values these intervals are of.
    """

    display: Display
    electrodes: tuple[Electrode, ...]
    bill: tuple[BillRow, ...]
    drawn: tuple[Parameter, ...]
    no_intervals: str = ""
    _shown: ClassVar[str] = (
        "display.name mass prediction.frequency prediction.vibration_amplitude "
        "prediction.relative_friction"
    )

    @functools.cached_property
    def steps(self) -> tuple[TestStep, ...]:
        """Plan of the bench."""
        return test_plan(self)

    def summary(self) -> dict[str, Any]:
        """The numbers as plain JSON values, units in the keys."""
        return {
            "display": self.display.name,
            **values_of(
                self,
                "prediction.mode.resonance_frequency prediction.vibration_amplitude "
                "prediction.relative_friction prediction.warnings bill electrodes expected "
                "no_intervals",
            ),
            "mass_kg": self.mass,
            "nodal_lines": to_json(self.nodal),
            "drive_electronics": to_json(self.load),
            "test_plan": to_json(self.steps),
            "provenance": stamp(self.display),
        }


@reads_text
def fabricate(
    display: NamedDisplay,
    *,
    prediction: Prediction | None = None,
    uncertainty: UncertainFriction | None = None,
    samples: int = SAMPLES,
    intervals: bool = True,
    blind: BlindPrediction | None = None,
    seed: int = 1,
    progress: SayProgress | None = None,
) -> Fabrication:
    """Prepare to build a display and to measure it, with what is expected.

    A `prediction` and an `uncertainty` of this display that are there already (those of an
    `Analysis`) are not computed again; without them it is predicted at its own voltage. Of
    `intervals` those of frequency, amplitude and the rest take 32 solved plates drawn from its
    spreads: a minute or so, and nothing once they are kept on disk. `samples` are those of the
    amplitude's under the finger, 0 for none. A `blind` prediction that was sealed before (see
    `sealed_already`) stays what is expected.

    Raises `InputError` as `predict`, and `UnreachableError` for a stator that nothing fits.
    """
    tell = progress or (lambda _: None)
    tell("bodies and electrodes")
    parts = parts_of(display.actuator)
    electrodes = electrodes_of(display.actuator, parts)
    if prediction is None:
        tell("resonance, amplitude and friction")
        prediction = predict(display)
    if uncertainty is None and samples and intervals:
        tell("how sure amplitude and friction are")
        uncertainty, _ = interval_or_reason(display, prediction, samples=samples, seed=seed)
    why_not = "none were asked for" if not intervals else _why_not_drawn(display, prediction)
    if intervals and blind is None:
        blind, why_not = _expected(display, prediction, why_not, seed, tell)
    drawn = () if why_not else calibration_parameters(display)
    p = prediction
    return Fabrication(
        display=display,
        prediction=prediction,
        uncertainty=uncertainty,
        parts=parts,
        electrodes=electrodes,
        bill=bill_of(display.actuator, parts, electrodes),
        nodal=nodal_lines_of(display.actuator, p.mode),
        load=load_of_mode(display.actuator, p.mode, p.voltage, p.frequency),
        blind=blind,
        drawn=drawn,
        no_intervals=why_not,
    )


def sealed_already(file: Path, display: Display) -> BlindPrediction | None:
    """The prediction of this very display in a file, None where there is no file.

    Raises `InputError` for a file that is none, or one of another description or version: what was
    predicted is never overwritten.
    """
    if not file.exists():
        return None
    sealed, own = load_prediction(file), stamp(display)
    for key, what in (
        ("config_sha256", "another description"),
        ("squeezefilm_version", "another version of squeezefilm"),
    ):
        if sealed.stamp.get(key) != own[key]:
            raise InputError(
                f"{file} is a prediction of {what}, and is never overwritten; name another folder"
            )
    return sealed


def _why_not_drawn(display: Display, prediction: Prediction) -> str:
    """Reason why no bodies of this kind can be drawn and solved; "" where they can."""
    if isinstance(display.actuator, AnnularStator):
        return (
            "frequency and amplitude of a stator are measured values of its description; what a "
            "second one would have is not known"
        )
    if isinstance(display.actuator, RectangularPlate) and prediction.mode.solid is None:
        return "the plate was not solved in three dimensions; the warnings say why"
    return ""


def _expected(
    display: Display, prediction: Prediction, why_not: str, seed: int, tell: SayProgress
) -> tuple[BlindPrediction | None, str]:
    """Prediction of what a bench will see, and the reason where there is none."""
    asked = [] if why_not else [Observation(name, 0.0, 0.0) for name in ASKED]
    amplitude = prediction.vibration_amplitude
    if amplitude > 0 and prediction.touch.law is not None:
        under = {"normal_force": prediction.normal_force, "finger_speed": prediction.speed}
        asked += [
            Observation(FRICTION, 0.0, 0.0, {"vibration_amplitude": share * amplitude, **under})
            for share in SHARES
        ]
    if not asked:
        return None, why_not
    try:
        return predicted(display, asked, seed=seed, progress=tell), why_not
    except SqueezefilmError as error:
        # A drawn plate that has no such mode, or a finger that is pressed through: the rest stands.
        return None, str(error)
