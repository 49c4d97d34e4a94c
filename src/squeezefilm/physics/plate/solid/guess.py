"""Where to look for a mode of a plate.

A uniform beam takes ceramic to be everywhere. Where a plate carries it on a part of its face only,
the shear plate is the guide: it sees the strips where they are, and costs a second.
"""

from __future__ import annotations

import math

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError, SqueezefilmError
from squeezefilm.physics.plate.beam.modes import free_beam_mode, timoshenko_frequency
from squeezefilm.physics.plate.laminate import plate_laminate, section_with
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.shear.modes import shear_mode
from squeezefilm.physics.plate.solid.mesh import require_thin
from squeezefilm.physics.plate.solid.modes import Label

_COVERED = 0.8


def estimated_frequency(plate: RectangularPlate, label: Label) -> float:
    """A first guess of a mode's frequency (Hz): a Timoshenko beam with the mode's wave number, or
    the shear plate where ceramics cover little of it. Raises `InputError` for a mode that does not
    bend the plate, `OutOfRangeError` for one of waves across the thickness."""
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
    if plate.coverage < _COVERED and (guess := screened_frequency(plate, label)) is not None:
        return guess
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
    """That of a free plate's bending with these nodal lines (1/m): 0 for fewer than two."""
    spans = (plate.length, plate.width)
    return math.hypot(
        *((n - 0.5) * math.pi / span for n, span in zip(label, spans, strict=True) if n > 1)
    )


def screened_frequency(plate: RectangularPlate, label: Label) -> si.Hertz | None:
    """The frequency of a mode by the shear plate (Hz), searched around that of a wave in the bare
    plate: see `shear_mode`. None where the shear plate knows no such mode: then the caller's own
    guess must do.
    """
    wave = _wave_number(plate, label)
    if wave == 0:
        return None
    bare = timoshenko_frequency(math.pi / wave, section_with(plate, "plane_strain", 0.0, 0.0))
    try:
        return shear_mode(plate, label, float(bare), with_error=False).frequency
    except (InputError, ConvergenceError):
        return None
