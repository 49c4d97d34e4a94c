"""All driven modes of a plate in a band within a second or two: to choose a mode by.

The three-dimensional plate on a light mesh, reduced from its drive: glue, both faces, supports,
clamped edges and open electrodes are in it as they are in the full solution. Against that,
frequencies come out up to a few percent high; `tests/verification/test_screening.py` says how far.
"""

from __future__ import annotations

import math

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import BAND_MODES, require_within
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.layers import SCREENING
from squeezefilm.physics.plate.solid.mesh import require_thin, wave_number
from squeezefilm.physics.plate.solid.modes import Label, check_band
from squeezefilm.physics.plate.solid.reduced import reduced_class
from squeezefilm.physics.plate.solid.resonances import DrivenMode, driven_modes
from squeezefilm.physics.plate.solid.symmetry import (
    Symmetry,
    drive_classes,
    drive_signs,
    only_stretches,
    symmetric_axes,
)

SCREENING_ERROR: si.Dimensionless = 0.05
"""Bound on the share by which a screened frequency lies off the solved one, as tested."""

# Krylov steps beside two for each mode expected in the band of one class.
_STEPS = 40
# One force goes along with the drive for each so many vectors of the space; not more than this.
_LONG, _MOST_BESIDE = 40, 15
_POINTS = (41, 31)
Load = tuple[si.FloatArray, si.FloatArray, si.FloatArray]
"""A surface force: x, y, and w on their grid (see `PlateModel.force`)."""


@si.checked_numbers
def screened_modes(
    plate: RectangularPlate, band: tuple[si.Hertz, si.Hertz]
) -> tuple[DrivenMode, ...]:
    """The driven modes of a plate in a band (Hz), ascending, by a light three-dimensional mesh.

    The mesh is stiffer than the plate: the band is looked through to `SCREENING_ERROR` above its
    upper end, so that no mode of the band is missed; some that are returned may lie just above it.
    Range and losses as `solve_modes`. Raises `InputError` for a band that is none, a plate on
    which no electrode is driven, or a band with more modes than the hard limit.
    """
    check_band(band)
    if not np.any(drive_signs(plate)):
        raise InputError(
            "no electrode is driven; give at least one patch electrode = 'driven'",
            quantity="patches",
        )
    wide = band[0], band[1] * (1 + SCREENING_ERROR)
    require_thin(plate, wide[1])
    steps, loads = _space(plate, wide)
    modes: list[DrivenMode] = []
    with one_blas_thread():
        for parity in drive_classes(plate):
            part = reduced_class(plate, parity, wide, steps, loads, SCREENING)
            if part.basis.shape[1]:
                modes += driven_modes(part, wide)
    return tuple(sorted(modes, key=lambda mode: mode.frequency))


def _space(plate: RectangularPlate, band: tuple[si.Hertz, si.Hertz]) -> tuple[int, list[Load]]:
    """Steps of the reduction for a band, by how many modes of bending one class has there, and
    surface forces that go along with the drive where they are many.

    To solve for several right sides takes little longer than for one: a long space is grown from
    the drive and, beside it, forces without any order. What the drive cannot move has no amplitude
    then, but is found.
    """
    low, high = (wave_number(plate, max(f, 1.0)) for f in band)
    rim, copies = plate.length + plate.width, 1 << sum(symmetric_axes(plate))
    # Weyl's count of a free plate: k² area/4π, and what its rim adds.
    modes = (high**2 - low**2) * plate.area / (4 * math.pi) + (high - low) * rim / (2 * math.pi)
    require_within(BAND_MODES, math.ceil(modes), "band", enough="ask for a narrower band")
    vectors = _STEPS + math.ceil(2 * modes / copies)
    beside = min(vectors // _LONG, _MOST_BESIDE)
    x, y = np.linspace(0, plate.length, _POINTS[0]), np.linspace(0, plate.width, _POINTS[1])
    forces = np.random.default_rng(1).standard_normal((beside, *_POINTS))
    return math.ceil(vectors / (1 + beside)) + min(beside, 6), [(x, y, force) for force in forces]


_SIDES, _ENDS = ("length", "width"), ("left and right", "front and back")


def forbidden_by(plate: RectangularPlate, label: Label) -> str | None:
    """Reason why symmetry keeps the drive from a mode with these nodal lines, in a sentence; None
    where it does not.

    A mode with an odd number of lines across a side is turned over by the mirror in the middle of
    that side, one with an even number is its own image. Where the plate is symmetric, a drive that
    is its own image moves the second kind only, one that is turned over the first.
    """
    if only_stretches(plate):
        return (
            f"symmetry forbids ({label[0]},{label[1]}): every ceramic has its mirror image on the "
            "other face, with the same sign, so that both stretch the plate alike and bend it "
            "against each other. No mode of bending is driven; turn the polarity of the ceramics "
            "on one face"
        )
    classes = drive_classes(plate)
    for axis, lines in enumerate(label):
        driven = {parity[axis] for parity in classes}
        odd = lines % 2 == 1
        if len(driven) > 1 or None in driven or ("A" in driven) == odd:
            continue
        kind, side = "odd" if odd else "even", _SIDES[axis]
        pattern = (
            f"the ceramics' signs are the same on both halves of the {side}"
            if odd
            else f"the ceramics' signs are opposite on the two halves of the {side}"
        )
        return (
            f"symmetry forbids ({label[0]},{label[1]}): {pattern} ({_ENDS[axis]}), and in a mode "
            f"with an {kind} number of nodal lines across the {side} "
            + ("the two halves move against each other" if odd else "both halves move alike")
            + f", so that what one half drives the other cancels. Modes with an "
            f"{'even' if odd else 'odd'} number of lines across the {side} are driven; for this "
            f"one turn the polarity of the ceramics on one half, or choose another nodal_lines"
        )
    return None


def symmetry_in_words(parity: Symmetry) -> str:
    """A class of symmetry as people say it."""
    words = {"S": "even", "A": "odd", None: "no mirror"}
    return f"{words[parity[0]]} along length, {words[parity[1]]} along width"
