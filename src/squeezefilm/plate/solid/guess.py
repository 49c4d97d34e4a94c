"""Where to look for a mode of a plate.

A uniform beam takes ceramic to be everywhere. Where a plate carries it on a part of its face only,
the shear plate is the guide: it sees the strips where they are, and costs a second.
"""

from __future__ import annotations

import math

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import ConvergenceError, InputError, SqueezefilmError
from squeezefilm.plate.beam.modes import free_beam_mode, timoshenko_frequency
from squeezefilm.plate.elements.nodal_lines import zero_crossings
from squeezefilm.plate.laminate import plate_laminate
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.shear.modes import ShearMode, shear_modes
from squeezefilm.plate.shear.section import shear_layout
from squeezefilm.plate.solid.modes import Label, profiles

# So many modes of one class of symmetry around the bare plate's frequency are looked at: strips on
# a part of the face move a mode by some ten percent.
_NEAREST = 16
_COVERED = 0.8


def estimated_frequency(plate: RectangularPlate, label: Label) -> float:
    """A first guess of a mode's frequency: a Timoshenko beam with the mode's wave number, or the
    shear plate where ceramics cover little of it."""
    section = plate_laminate(plate, "plane_strain")
    lines = [(n, span) for n, span in zip(label, (plate.length, plate.width), strict=True)]
    k2 = sum(((n - 0.5) * np.pi / span) ** 2 for n, span in lines if n >= 2)
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
    spans = (plate.length, plate.width)
    k2 = sum(
        ((n - 0.5) * math.pi / span) ** 2 for n, span in zip(label, spans, strict=True) if n > 1
    )
    substrate, h = plate.substrate, plate.thickness
    stiffness = substrate.plane_strain_modulus * h**3 / 12
    return k2 / (2 * math.pi) * math.sqrt(stiffness / (substrate.density * h))


def screened_frequency(plate: RectangularPlate, label: Label) -> si.Hertz | None:
    """The frequency of a mode by the shear plate (Hz), searched around the bare plate's.

    Of several with these nodal lines the one whose shape is most nearly that of straight lines:
    strips mix neighbours, and a mixture may count the same lines. None where the shear plate knows
    no such mode: then the caller's own guess must do.
    """
    bare = bare_frequency(plate, label)
    if bare == 0:
        return None
    layout = shear_layout(plate)
    try:
        modes = shear_modes(layout, bare, _NEAREST, parities=(layout.parity_of(label),))
    except (InputError, ConvergenceError):
        return None
    found = [mode for mode in modes if not mode.is_rigid and _lines(mode) == label]
    best = max(found, key=lambda mode: straightness(mode.deflection), default=None)
    return None if best is None else best.frequency


def _lines(mode: ShearMode) -> Label:
    """Nodal lines counted as the solved plate counts them: on the shape's dominant product."""
    along, across, _ = profiles(mode.deflection)
    return zero_crossings(mode.x, along).size, zero_crossings(mode.y, across).size


def straightness(deflection: si.FloatArray) -> si.Dimensionless:
    """The share of a shape's square that is one profile along x times one along y: 1 for straight
    nodal lines. `deflection` on a grid, shape (x, y)."""
    size = np.linalg.svd(deflection, compute_uv=False)
    return float(size[0] ** 2 / np.sum(size**2))
