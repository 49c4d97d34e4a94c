"""What a driven free–free beam does: modal force, amplitude per volt, frequency response."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError, OutOfRangeError
from squeezefilm.materials import VACUUM_PERMITTIVITY
from squeezefilm.plate.beam.modes import BeamMode, BeamTheory, free_beam_mode
from squeezefilm.plate.elements.again import SolvedAgain
from squeezefilm.plate.laminate import (
    CrossSection,
    Laminate,
    moment_per_volt,
    plate_laminate,
)
from squeezefilm.plate.layout import DiscPlate, RectangularPlate, turned


@si.closed_form(positive="modal_mass frequency quality_factor")
def resonant_amplitude_per_volt(
    modal_force: si.NewtonPerVolt,
    modal_mass: si.Kilogram,
    frequency: si.Hertz,
    quality_factor: si.Dimensionless,
) -> si.MetrePerVolt:
    """The amplitude per volt of a lightly damped mode at resonance: Q F / (ω² m), in m/V.

    Exact for structural (hysteretic) damping 1/Q of a single mode.
    """
    return quality_factor * modal_force / ((2 * np.pi * frequency) ** 2 * modal_mass)


@dataclass(frozen=True, eq=False)
class BeamResponse(SolvedAgain):
    """A plate driven as a beam: its working mode, and how strongly the ceramics drive it.

    `force_per_width` is the force of one volt on the working mode `mode` (N/V per m of width).
    `modes` are all that enter the superposition, found where they are asked for.
    """

    plate: RectangularPlate
    section: Laminate
    theory: BeamTheory
    cross_section: CrossSection
    mode: BeamMode
    force_per_width: float
    _again: Callable[[], BeamResponse] | None = field(repr=False, default=None)
    _bulk: ClassVar[tuple[str, ...]] = ("mode",)

    @property
    def model(self) -> str:
        """The model's name, for results and plots."""
        return f"{self.theory}_beam_{self.cross_section}"

    @property
    def amplitude_per_volt(self) -> si.MetrePerVolt:
        """Zero-to-peak amplitude at the largest interior lobe, per volt, at resonance (m/V)."""
        return abs(
            resonant_amplitude_per_volt(
                self.force_per_width,
                self.mode.modal_mass_per_width,
                self.mode.frequency,
                self.plate.quality_factor,
            )
        )

    @property
    def modes(self) -> tuple[BeamMode, ...]:
        """The bending modes up to twice the working mode's frequency, or up to the cut-off."""
        return _superposed(self.section, self.plate.length, self.mode)

    @si.checked_numbers
    def amplitude_at(self, frequency: si.HertzArray, position: si.Metre) -> si.MetrePerVoltArray:
        """|w| per volt (m/V) at one position over an array of frequencies, by superposition."""
        return np.abs(self.transfer(frequency, np.array([position]))[:, 0])

    @si.checked_numbers
    def transfer(self, frequency: si.HertzArray, position: si.MetreArray) -> si.ComplexArray:
        """Complex w per volt (m/V), shape (frequencies, positions), superposed over `modes`.

        Structural damping 1/Q for every mode; the truncation keeps the bending modes below twice
        the working mode's frequency (or the cut-off), so static parts off resonance are
        underestimated.
        """
        si.require("frequency", frequency, si.Unit("Hz"), at_least=0, axes=1)
        si.require("position", position, si.Unit("m"), axes=1)
        omega2 = (2 * np.pi * frequency[:, None]) ** 2
        total = np.zeros((frequency.size, np.size(position)), dtype=complex)
        modes = self.modes
        forces = _forces(self.plate, self.section, self.cross_section, modes)
        for mode, force in zip(modes, forces, strict=True):
            own = (2 * np.pi * mode.frequency) ** 2
            denominator = own * (1 + 1j / self.plate.quality_factor) - omega2
            total += force / mode.modal_mass_per_width / denominator * mode.deflection_at(position)
        return total


def beam_response(
    plate: RectangularPlate | DiscPlate,
    theory: BeamTheory = "timoshenko",
    cross_section: CrossSection = "plane_strain",
) -> BeamResponse:
    """The working mode of a plate seen as a uniform free–free beam, and its drive by the ceramics.

    Valid for plates wide against their thickness, covered by ceramics almost everywhere, in modes
    whose nodal lines run across the whole width. Against three-dimensional elasticity the
    Timoshenko frequency of the paper's plate is about 3 % high and Euler–Bernoulli's 12 % high;
    coupling to modes along the width is not seen. A plate whose nodal lines cross its width is
    turned first. Raises `OutOfRangeError` above the cut-off, `InputError` for a disc.
    """
    if isinstance(plate, DiscPlate):
        raise InputError(
            "a disc is no beam; squeezefilm plate solves it as a disc", quantity="type"
        )
    if plate.lines_across == "width":
        plate = turned(plate)
    return _driven(plate, theory, cross_section)


# Asked of one plate by the check of what is plausible, and again by the chain.
@functools.lru_cache(maxsize=8)
def _driven(
    plate: RectangularPlate, theory: BeamTheory, cross_section: CrossSection
) -> BeamResponse:
    section = plate_laminate(plate, cross_section)
    working = free_beam_mode(section, plate.length, plate.nodal_lines, theory)
    (force,) = _forces(plate, section, cross_section, (working,))
    return BeamResponse(
        plate,
        section,
        theory,
        cross_section,
        working,
        force,
        functools.partial(beam_response, plate, theory, cross_section),
    )


@functools.lru_cache(maxsize=8)
def _superposed(section: Laminate, length: si.Metre, working: BeamMode) -> tuple[BeamMode, ...]:
    modes: list[BeamMode] = []
    for lines in range(2, 2 * working.nodal_lines):
        try:
            mode = (
                working
                if lines == working.nodal_lines
                else free_beam_mode(section, length, lines, working.theory)
            )
        except OutOfRangeError:
            break
        if mode.frequency > 2 * working.frequency:
            break
        modes.append(mode)
    return tuple(modes)


def _forces(
    plate: RectangularPlate,
    section: Laminate,
    cross_section: CrossSection,
    modes: Iterable[BeamMode],
) -> Iterator[float]:
    """The force of one volt on each mode (N/V per m of width)."""
    moment = {
        face: moment_per_volt(plate, section, cross_section, face)
        for face in {patch.face for patch in plate.patches}
    }
    # Work of the piezo moment on the section's rotation at both ends of each ceramic; a ceramic
    # narrower than the plate drives in proportion to its width.
    pushed = np.array(
        [moment[one.face] * one.drive_sign * (one.width / plate.width) for one in plate.patches]
    )
    begin = np.array([one.x for one in plate.patches])
    end = begin + np.array([one.length for one in plate.patches])
    for mode in modes:
        yield float(pushed @ (mode.rotation_at(end) - mode.rotation_at(begin)))


LEAST_COVERAGE: si.Dimensionless = 0.8


def beam_doubt(plate: RectangularPlate) -> str | None:
    """Why the beam should not be believed for a plate, in a sentence; None where it may be.

    The section is taken to carry ceramic everywhere. With less than four fifths of it covered the
    stiffness and mass are wrong by more than the beam's own error.
    """
    if plate.coverage >= LEAST_COVERAGE:
        return None
    return (
        f"the beam takes the ceramics to cover the whole plate, and they cover "
        f"{si.percent(plate.coverage)} of it: its frequency and amplitude are rough here; "
        "squeezefilm plate solves the plate as it is"
    )


def patch_capacitance(plate: RectangularPlate) -> si.Farad:
    """The capacitance of all ceramics in parallel (F): ε A / h_p, fringes neglected."""
    permittivity = plate.ceramic.relative_permittivity * VACUUM_PERMITTIVITY
    return permittivity * sum(p.length * p.width / p.thickness for p in plate.patches)
