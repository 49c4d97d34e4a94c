"""Forecast of a display by closed forms, before anything is solved.

A plate is a Timoshenko beam that carries ceramic in places, a disc a thin free plate. A few
milliseconds.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Annotated

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.plate.beam.response import BeamResponse, beam_response
from squeezefilm.physics.plate.laminate import plate_laminate
from squeezefilm.physics.plate.layout import Actuator, AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.solid.guess import bare_frequency

# How far estimates may be off, as a factor. All of 95 random plates lay within 1.13 of the solved
# frequency (tests/verification/test_beam_beside_solid.py); the disc as `_of_disc` says.
_PLATE_OFF, _DISC_OFF = 1.15, 2.0
# What strips along edges drive is not told: they drive modes along the other side as well.
_COVERED = 0.8
_USUAL_BAND: tuple[si.Hertz, si.Hertz] = (20e3, 200e3)


@dataclass(frozen=True)
class Expectation:
    """An estimate of a working mode: `frequency` (Hz) is right within the factor `off`.

    `amplitude_per_volt` (m/V) is at the largest interior lobe and `power_per_mass` (W/kg) that of
    one volt, both None where the estimate does not know them; `model` names what made it.
    """

    frequency: si.Hertz
    off: si.Dimensionless
    model: str
    amplitude_per_volt: si.MetrePerVolt | None = None
    power_per_mass: Annotated[float, si.Unit("W/kg/V2")] | None = None
    half_wavelength_over_thickness: si.Dimensionless | None = None

    @property
    def nearest_frequency(self) -> si.Hertz:
        """The frequency within the estimate's doubt that is nearest to what displays work at."""
        low, high = _USUAL_BAND
        wanted = min(max(self.frequency, low), high)
        return min(max(wanted, self.frequency / self.off), self.frequency * self.off)

    @property
    def sentence(self) -> str:
        """Sentence on what is expected, for people who wait: ``"about 33.4 kHz (mostly right to 15
        %), 110 nm/V (to a factor of two), by a beam"``."""
        known = self.off == 1
        said = f"about {si.format_quantity(self.frequency, si.Unit('Hz'), 3)}"
        said += "" if known else f" (mostly right to {100 * (self.off - 1):.0f} %)"
        if self.amplitude_per_volt is not None:
            said += f", {si.format_quantity(self.amplitude_per_volt, si.Unit('m/V'), 2)}"
            said += "" if known else " (to a factor of two)"
        return f"{said}, by {self.model}"


@functools.lru_cache(maxsize=64)
def expectation(actuator: Actuator) -> Expectation | None:
    """Expected working mode of an actuator; None where no closed form says it."""
    try:
        if isinstance(actuator, AnnularStator):
            return _of_stator(actuator)
        if isinstance(actuator, DiscPlate):
            return _of_disc(actuator)
        return _of_plate(actuator)
    except (InputError, OverflowError, ZeroDivisionError):
        return None


def _of_stator(ring: AnnularStator) -> Expectation:
    per_volt = ring.reference_amplitude / ring.reference_voltage
    return Expectation(ring.resonance_frequency, 1.0, "its measurement", per_volt)


def _of_plate(plate: RectangularPlate) -> Expectation:
    span = plate.length if plate.lines_across == "length" else plate.width
    flexural = span / (plate.nodal_lines - 0.5) / plate.thickness
    try:
        beam = beam_response(plate)
    except OutOfRangeError:
        bare = bare_frequency(plate, plate.working_label)
        return Expectation(bare, _DISC_OFF, "a thin plate", None, None, flexural)
    covered = plate.coverage >= _COVERED
    per_volt, power = (beam.amplitude_per_volt, _beam_power(beam)) if covered else (None, None)
    return Expectation(beam.mode.frequency, _PLATE_OFF, "a beam", per_volt, power, flexural)


def _beam_power(beam: BeamResponse) -> float:
    """The power (W) that one volt loses at resonance over the plate's mass: the mode's kinetic
    energy, ½ m (ωA)²/2 of a shape whose mean square is half that of its lobe, times ω/Q."""
    omega = 2 * math.pi * beam.mode.frequency
    speed = omega * beam.amplitude_per_volt
    return 0.25 * speed**2 * omega / beam.plate.quality_factor


def _of_disc(disc: DiscPlate) -> Expectation:
    """A thin free disc: λ² = (π/2 (n + 2s))² of n nodal diameters and s circles, for large ones;
    within a factor of two for the lowest (Leissa 1969, NASA SP-160, has 5.25 for n = 2, s = 0 and
    9.08 for n = 0, s = 1 where this gives 9.87)."""
    section = plate_laminate(disc)
    order = disc.nodal_diameters + 2 * disc.nodal_circles
    number = math.pi / 2 * order / (disc.diameter / 2)
    frequency = (
        number**2 * math.sqrt(section.bending_stiffness / section.mass_per_area) / (2 * math.pi)
    )
    # The ceramic may be smaller than the disc; then the bare disc is nearer.
    half = disc.diameter / order / disc.thickness
    return Expectation(frequency, _DISC_OFF, "a thin disc", None, None, half)
