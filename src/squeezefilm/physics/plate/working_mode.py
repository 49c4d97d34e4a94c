"""The one mode a display works in, whatever the actuator: frequency, wavelength, Q, µm per volt.

This is the seam between the vibrating body and everything above it. A solved plate
or a beam makes it for a plate, measured values make it for a stator.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.progress import NO_HURRY, Pace
from squeezefilm.physics.plate.beam_response import BeamResponse, beam_response
from squeezefilm.physics.plate.elements.nodal_lines import largest_lobe, zero_crossings
from squeezefilm.physics.plate.layout import Actuator, AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.ring.body import (
    RingBody,
    half_wavelength_of,
    ring_body,
    surface_profile,
)
from squeezefilm.physics.plate.ring.modes import AnnularMode
from squeezefilm.physics.plate.solid.resonances import Neighbour, label_name
from squeezefilm.physics.plate.solid.working import SolidMode, solid_mode


@si.closed_form(positive="frequency resonance_frequency quality_factor")
def resonance_factor(
    frequency: si.HertzLike, resonance_frequency: si.Hertz, quality_factor: si.Dimensionless
) -> si.DimensionlessLike:
    """The amplitude off resonance relative to the one at resonance, of one mode; broadcasts.

    1 / √(Q²(1 − (f/f0)²)² + 1) for structural damping 1/Q. Valid near the mode, where the others
    add little.
    """
    ratio = (frequency / resonance_frequency) ** 2
    factor: si.DimensionlessLike = 1 / np.sqrt(quality_factor**2 * (1 - ratio) ** 2 + 1)
    return factor


PlateTheory = Literal["solid", "timoshenko", "euler_bernoulli"]
PLATE_THEORIES: tuple[PlateTheory, ...] = get_args(PlateTheory)


MEASURED = "measured_stator"
"""The model of a stator's mode, which is as it was measured."""

CROWDED: si.Dimensionless = 0.2
"""A mode is crowded if a neighbour adds at least this share of its amplitude at its resonance,
and hidden if it adds as much as the mode has."""


@dataclass(frozen=True, eq=False)
class ModeLine:
    """The mode along the line across its nodal lines: 1 at the largest interior lobe."""

    position: si.MetreArray
    deflection: si.FloatArray

    @property
    def nodal_positions(self) -> si.MetreArray:
        """Places where the deflection is zero (m), by straight lines between points."""
        return zero_crossings(self.position, self.deflection)


@dataclass(frozen=True, eq=False)
class WorkingMode:
    """The mode a display works in; amplitudes are zero-to-peak at the largest interior lobe.

    `model` names what made the numbers, `frequency_error` is the solver's estimate where one
    solved it; `modal_mass` is the mass that has the mode's kinetic energy if it moves as the lobe
    does, where it is known. `lobe` is where that is (x, y): from a plate's corner, from a disc's
    middle, along a stator's track. `disc` is a disc's mode; `beam` is the plate as a beam: what
    made the numbers, or stands beside them.
    """

    label: str
    resonance_frequency: si.Hertz
    half_wavelength: si.Metre
    quality_factor: si.Dimensionless
    amplitude_per_volt: si.MetrePerVolt
    model: str
    lobe: tuple[si.Metre, si.Metre]
    frequency_error: si.Hertz | None = None
    modal_mass: si.Kilogram | None = None
    line: ModeLine | None = None
    solid: SolidMode | None = None
    beam: BeamResponse | None = None
    disc: AnnularMode | None = None

    @property
    def has_shape(self) -> bool:
        """True where the shape over the face is solved or, of a stator, measured: not of a beam."""
        return self.solid is not None or self.disc is not None or self.model == MEASURED

    @property
    def neighbour(self) -> Neighbour | None:
        """The driven mode that adds most at this one's resonance, where the plate was solved."""
        return None if self.solid is None else self.solid.neighbour

    @property
    def company(self) -> str | None:
        """Sentence on a neighbour that takes part in this mode; None where none does."""
        beside = self.neighbour
        if beside is None or beside.share < CROWDED:
            return None
        adds = f"adds {100 * beside.share:.0f} % of what this mode moves at its resonance"
        kind = "hidden" if beside.share >= 1 else "crowded"
        return (
            f"{self.label} is {kind}: the mode {beside.name} at "
            f"{si.format_quantity(beside.frequency, si.Unit('Hz'))} lies {beside.distance:.2g} "
            f"half-bandwidths away and {adds}. Where two modes cross they share the motion, so "
            "that the amplitude has a dip there; small changes of the plate move it, and nodal "
            "lines and amplitude then differ from what is computed"
        )

    @si.checked_numbers
    def amplitude_per_volt_at(self, frequency: si.HertzLike) -> si.MetrePerVoltLike:
        """Zero-to-peak amplitude per volt (m/V) at a frequency near resonance.

        Of this mode alone, with structural damping; see `response` for what its neighbours add.
        """
        return self.amplitude_per_volt * resonance_factor(
            frequency, self.resonance_frequency, self.quality_factor
        )

    @si.checked_numbers
    def response(self, frequency: si.HertzArray) -> si.MetrePerVoltArray:
        """Zero-to-peak amplitude per volt (m/V) at frequencies (Hz), with the neighbouring modes
        where the model has them."""
        wanted = np.asarray(frequency, dtype=float)
        if self.solid is not None:
            return self.solid.amplitude_per_volt_at(wanted)
        if self.beam is not None:
            return self.beam.amplitude_at(wanted, _beam_lobe(self.beam))
        return np.asarray(self.amplitude_per_volt_at(wanted))


def working_mode(
    actuator: Actuator,
    theory: PlateTheory = "solid",
    *,
    pace: Pace = NO_HURRY,
) -> WorkingMode:
    """The working mode of an actuator.

    A plate is solved in three dimensions (see `solid_mode`), or taken as a beam (see
    `beam_response` for its range and error); a disc is solved by Fourier harmonics; a stator is
    taken as measured, linear in the voltage. `pace` says how long a solid may take. Raises
    `InputError` for another theory or a disc's mode that crosses no two nodal lines, and what the
    solvers raise. The last few are kept, so that what is kept of a mode, its shape under a finger,
    is found again.
    """
    si.require_one_of("theory", theory, PLATE_THEORIES)
    return _working_mode(actuator, theory, pace)


@functools.lru_cache(maxsize=4)
def _working_mode(actuator: Actuator, theory: PlateTheory, pace: Pace) -> WorkingMode:
    if isinstance(actuator, AnnularStator):
        return WorkingMode(
            label=f"B(0,{round(actuator.wavelengths_around)})",
            resonance_frequency=actuator.resonance_frequency,
            half_wavelength=actuator.wavelength / 2,
            quality_factor=actuator.quality_factor,
            amplitude_per_volt=actuator.reference_amplitude / actuator.reference_voltage,
            model=MEASURED,
            lobe=(0.0, actuator.radial_width / 2),
        )
    if isinstance(actuator, DiscPlate):
        body = ring_body(actuator)
        return _solved_ring(body, body.mode())
    if theory == "solid":
        return solid_working_mode(actuator, solid_mode(actuator, pace=pace))
    beam = beam_response(actuator, theory)
    shape, middle = beam.mode, beam.plate.width / 2
    lobe = _beam_lobe(beam), middle
    return WorkingMode(
        label=label_name(actuator.working_label),
        resonance_frequency=shape.frequency,
        half_wavelength=shape.half_wavelength,
        quality_factor=actuator.quality_factor,
        amplitude_per_volt=beam.amplitude_per_volt,
        model=beam.model,
        lobe=lobe if actuator.lines_across == "length" else lobe[::-1],
        modal_mass=shape.modal_mass_per_width * beam.plate.width,
        line=ModeLine(shape.position, shape.deflection),
        beam=beam,
    )


@si.checked_numbers
def solid_working_mode(
    plate: RectangularPlate, solid: SolidMode, label: tuple[int, int] | None = None
) -> WorkingMode:
    """A solved mode of a plate as the mode that a display works in; without a label of nodal lines
    it is the one that the plate asks for."""
    return WorkingMode(
        label=label_name(label or plate.working_label),
        resonance_frequency=solid.frequency,
        half_wavelength=solid.half_wavelength,
        quality_factor=solid.quality_factor,
        amplitude_per_volt=solid.amplitude_per_volt,
        model=solid.model,
        lobe=solid.lobe,
        frequency_error=solid.frequency_error,
        modal_mass=solid.modal_mass,
        line=ModeLine(solid.position, solid.deflection),
        solid=solid,
        beam=_beam_beside(plate),
    )


def ring_working_mode(
    actuator: AnnularStator | DiscPlate, body: RingBody, mode: AnnularMode
) -> WorkingMode:
    """A solved mode of a disc or stator as the mode that a display works in: a stator's own is as
    it was measured. Raises `InputError` for one that crosses no two nodal lines."""
    if isinstance(actuator, AnnularStator) and mode.harmonic == body.label[1]:
        return working_mode(actuator)
    return _solved_ring(body, mode)


def _solved_ring(body: RingBody, mode: AnnularMode) -> WorkingMode:
    half, _ = half_wavelength_of(mode)
    if half is None:
        raise InputError(
            f"{mode.label} has no two nodal lines, so no half wavelength; choose a mode with a "
            "nodal circle or nodal diameters",
            quantity="nodal_circles",
        )
    return WorkingMode(
        label=mode.label,
        resonance_frequency=mode.frequency,
        half_wavelength=half,
        quality_factor=mode.quality_factor,
        amplitude_per_volt=mode.amplitude_per_volt(body.drive),
        model=mode.model,
        lobe=(float(mode.surface_radius[np.argmax(np.abs(mode.surface_shape))]), 0.0),
        frequency_error=mode.frequency_error,
        modal_mass=mode.modal_mass,
        line=_diameter(mode),
        disc=mode,
    )


def _diameter(mode: AnnularMode) -> ModeLine:
    """The mode along a diameter, 1 at the surface's highest antinode."""
    radius = np.linspace(mode.surface_radius[0], mode.surface_radius[-1], 401)
    shape = surface_profile(mode, radius)
    # u_z = W(r) cos mθ: on the other side of the middle the sign of cos mπ.
    other = shape if mode.harmonic % 2 == 0 else -shape
    whole = radius[0] == 0
    position = np.concatenate([-radius[::-1], radius[1:] if whole else radius])
    deflection = np.concatenate([other[::-1], shape[1:] if whole else shape])
    return ModeLine(position, deflection)


def _beam_lobe(beam: BeamResponse) -> si.Metre:
    """Place of the largest lobe between the outermost nodal lines, where the shape is 1."""
    position = beam.mode.position
    return float(position[largest_lobe(position, beam.mode.deflection)])


def _beam_beside(plate: RectangularPlate) -> BeamResponse | None:
    """The plate as a beam, for comparison; None where the beam has no such mode."""
    try:
        return beam_response(plate)
    except OutOfRangeError:
        return None
