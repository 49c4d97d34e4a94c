"""Results beside the plate that the chain goes on with: other theories, and measurements."""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.beam_modes import BeamTheory
from squeezefilm.physics.plate.beam_response import beam_response
from squeezefilm.physics.plate.laminate import CrossSection
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.working import solid_mode


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
