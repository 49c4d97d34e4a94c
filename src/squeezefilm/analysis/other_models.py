"""The same plate by other theories, to set beside what the chain goes on with."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterator
from dataclasses import dataclass

from squeezefilm import quantities as si
from squeezefilm.chain.prediction import Prediction
from squeezefilm.display import Display
from squeezefilm.errors import InputError, OutOfRangeError
from squeezefilm.plate.beam.modes import BeamTheory
from squeezefilm.plate.beam.response import beam_response
from squeezefilm.plate.laminate import CrossSection
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.shear.modes import shear_mode
from squeezefilm.plate.solid.working import solid_mode


@dataclass(frozen=True)
class OtherModel:
    """The same plate by another theory, to show how far they differ; no amplitude where the theory
    is used for the frequency only."""

    model: str
    resonance_frequency: si.Hertz
    half_wavelength: si.Metre | None
    vibration_amplitude: si.Metre | None


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
