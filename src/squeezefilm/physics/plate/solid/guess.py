"""Guess of where to look for a mode of a plate.

A uniform beam takes ceramic to be everywhere. Where a plate carries it on a part of its face only,
the beam of pieces is the guide: it has the strips where they are.
"""

from __future__ import annotations

import math

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.physics.plate.beam.modes import free_beam_mode, timoshenko_frequency
from squeezefilm.physics.plate.beam.pieces import beam_pieces, pieced_beam_mode
from squeezefilm.physics.plate.laminate import plate_laminate, section_with
from squeezefilm.physics.plate.layout import RectangularPlate, turned
from squeezefilm.physics.plate.solid.mesh import require_thin
from squeezefilm.physics.plate.solid.modes import Label

_COVERED = 0.8


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
