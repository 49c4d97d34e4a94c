"""Before a plate is solved: where to look for a mode, how large its meshes are, how long they take.

Sizes are counted on the meshes that would be made, before anything is assembled. For a frequency, a
uniform beam takes ceramic to be everywhere; where a plate carries it on a part of its face only,
the beam of pieces is the guide: it has the strips where they are.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfTimeError, SqueezefilmError
from squeezefilm.core.progress import Deadline
from squeezefilm.physics.plate.beam_modes import free_beam_mode, timoshenko_frequency
from squeezefilm.physics.plate.beam_pieces import beam_pieces, pieced_beam_mode
from squeezefilm.physics.plate.laminate import plate_laminate, section_with
from squeezefilm.physics.plate.layout import RectangularPlate, turned
from squeezefilm.physics.plate.solid.coarse_modes import class_fits
from squeezefilm.physics.plate.solid.layers import COARSE, NORMAL, Resolution
from squeezefilm.physics.plate.solid.mesh import plate_model, require_thin
from squeezefilm.physics.plate.solid.modes import Label
from squeezefilm.physics.plate.solid.reduced import resolved_frequency
from squeezefilm.physics.plate.solid.symmetry import PlateModel, all_classes, drive_classes

# Processor time of one thread of the machine that this was written on, fitted to 14 plates of metal
# and glass (see `benchmarks/size.py`): cubes of elements' slices that are worked off in a second to
# factorise and search a mesh, and squares to go on to the response.
_RATE, _RESPONSE_RATE = 2.0e9, 6.5e6
# Around what a mesh takes besides (s).
_BESIDES = 0.15
# From this share of the plate on, ceramics stiffen it as if they were everywhere.
_COVERED = 0.8


class SolveSize(NamedTuple):
    """Size of the solve of a plate's working mode: unknowns of its largest mesh, and seconds of the
    coarse meshes, of the finer ones, and of the response on either."""

    unknowns: int
    coarse: si.Second
    refined: si.Second
    coarse_response: si.Second
    response: si.Second

    @property
    def seconds(self) -> si.Second:
        """Time of all that a working mode takes (s): within a factor of 2 of the processor time on
        14 plates, and by how fast the machine is and what else it does."""
        return self.coarse + self.refined + self.response

    def require_within(self, deadline: Deadline, budget: si.Second) -> None:
        """Raise `OutOfTimeError` where a deadline, that of a budget (s), does not allow the coarse
        meshes."""
        least = self.coarse + self.coarse_response
        if not deadline.allows(least):
            raise OutOfTimeError(
                f"the coarsest three-dimensional mesh takes about {least:.2g} s, more than the "
                f"budget of {budget:.3g} s; allow more",
                quantity="budget",
            )


def expected_seconds(solved: PlateModel) -> si.Second:
    """Time that a mesh takes to be factorised and searched (s): elements times the cube of their
    slices' unknowns, as `SolveSize.seconds` is right."""
    return _BESIDES + solved.slabs.products / _RATE


@si.checked_numbers
def solve_size(plate: RectangularPlate, label: Label, frequency: si.Hertz) -> SolveSize:
    """The size of a solve for the mode with the nodal lines of `label`, expected near a frequency
    (Hz).

    Raises what `plate_model` raises: `OutOfRangeError` for a plate too thin for solid elements,
    `InputError` for one too large.
    """
    fitting = [one for one in all_classes(plate) if class_fits(one, label)]
    driven = drive_classes(plate)
    highest, band = 1.15 * frequency, resolved_frequency((frequency, frequency))

    def searched(resolution: Resolution) -> si.Second:
        return sum(
            expected_seconds(plate_model(plate, highest, resolution, one)) for one in fitting
        )

    def answered(resolution: Resolution) -> tuple[si.Second, int]:
        """The response's seconds and largest mesh: a mode's own mesh and factors serve again."""
        seconds, most = 0.0, 0
        for parity in driven:
            mesh = plate_model(plate, band, resolution, parity)
            seconds += _BESIDES + mesh.slabs.squares / _RESPONSE_RATE
            seconds += 0.0 if parity in fitting else expected_seconds(mesh)
            most = max(most, mesh.slabs.unknowns)
        return seconds, most

    response, unknowns = answered(NORMAL)
    return SolveSize(unknowns, searched(COARSE), searched(NORMAL), answered(COARSE)[0], response)


@si.checked_numbers
def band_seconds(plate: RectangularPlate, highest: si.Hertz) -> si.Second:
    """Time that the coarse meshes of all classes of symmetry take up to a frequency (Hz), each
    counted twice more to know how many modes there are (s).

    Raises what `solve_size` raises.
    """
    meshes = [plate_model(plate, highest, COARSE, parity) for parity in all_classes(plate)]
    return 3 * sum(expected_seconds(mesh) for mesh in meshes)


def estimated_frequency(plate: RectangularPlate, label: Label) -> float:
    """A first guess of a mode's frequency (Hz): a Timoshenko beam with the mode's wave number, or
    `pieced_frequency` where ceramics cover little of it. Raises `InputError` for a mode that does
    not bend the plate, `OutOfRangeError` for one of waves across the thickness."""
    frequency = _guess(plate, label)
    require_thin(plate, frequency, f"mode ({label[0]},{label[1]}) near")
    return frequency


def _guess(plate: RectangularPlate, label: Label) -> float:
    section = plate_laminate(plate, "plane_strain")
    k2 = _wave_number(plate, label) ** 2
    k2 += 2 * (np.pi / plate.length) * (np.pi / plate.width) if label == (1, 1) else 0.0
    if k2 == 0:
        raise InputError(
            f"a mode with nodal lines {label} is no elastic mode that can be guessed; solve near a "
            "frequency or in a band",
            quantity="mode",
        )
    if plate.coverage < _COVERED and _wave_number(plate, label):
        return pieced_frequency(plate, label)
    if label[1] == 0:
        try:
            return free_beam_mode(section, plate.length, label[0]).frequency
        except SqueezefilmError:
            pass
    return float(timoshenko_frequency(float(np.pi / np.sqrt(k2)), section))


def bare_frequency(plate: RectangularPlate, label: Label) -> si.Hertz:
    """The frequency of the substrate alone (Hz), with free edges: k of a free-free beam along each
    side, Kirchhoff's plate. Good to 10 % for plates thin against the half wavelength.

    0 for labels that are no bending (fewer than two lines across a side do not bend it).
    """
    substrate, h = plate.substrate, plate.thickness
    stiffness = substrate.plane_strain_modulus * h**3 / 12
    k2 = _wave_number(plate, label) ** 2
    return k2 / (2 * math.pi) * math.sqrt(stiffness / (substrate.density * h))


def _wave_number(plate: RectangularPlate, label: Label) -> float:
    """Wave number of a free plate's bending with these nodal lines (1/m): 0 for fewer than two."""
    spans = (plate.length, plate.width)
    return math.hypot(
        *((n - 0.5) * math.pi / span for n, span in zip(label, spans, strict=True) if n > 1)
    )


def pieced_frequency(plate: RectangularPlate, label: Label) -> si.Hertz:
    """The frequency of a bending mode of a plate that is covered in part (Hz).

    By the beam of pieces where all lines run one way, within 13 % of solved plates as
    `beam_response` is. With lines both ways that of a wave between the bare plate and the covered
    one, by how much is covered.
    """
    if min(label) == 0:
        pieces = beam_pieces(plate if label[0] else turned(plate), "plane_strain")
        try:
            return pieced_beam_mode(pieces, max(label)).frequency
        except SqueezefilmError:
            pass
    half = math.pi / _wave_number(plate, label)
    bare, covered = (
        float(timoshenko_frequency(half, section))
        for section in (
            section_with(plate, "plane_strain", 0.0, 0.0),
            plate_laminate(plate, "plane_strain"),
        )
    )
    return bare + plate.coverage * (covered - bare)
