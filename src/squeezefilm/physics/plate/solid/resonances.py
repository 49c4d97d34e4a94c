"""The driven modes that a reduced plate holds: frequency, shape, loss and amplitude per volt.

The space was grown from the drive, so that what the drive cannot move is not among them. On a light
mesh all of a band come within a second or two (`screened_modes`), to choose a mode by: glue, both
faces, supports, clamped edges and open electrodes are in it as they are in the full solution.
Against that, frequencies come out up to a few percent high; `tests/verification/test_screening.py`
says how far.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.linalg import eigh

from squeezefilm.core import quantities as si
from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import BAND_MODES, require_within
from squeezefilm.physics.plate.elements.nodal_lines import profiles
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.layers import SCREENING
from squeezefilm.physics.plate.solid.mesh import require_thin, wave_number
from squeezefilm.physics.plate.solid.modes import Label, check_band, label_of, surface_shapes
from squeezefilm.physics.plate.solid.reduced import (
    ReducedClass,
    charge_free_stiffness,
    reduced_class,
)
from squeezefilm.physics.plate.solid.symmetry import (
    Symmetry,
    drive_classes,
    drive_signs,
    symmetric_axes,
)


@dataclass(frozen=True, eq=False)
class DrivenMode:
    """A mode that the drive can move, by itself.

    `label` counts nodal lines across the length and across the width (None for motion in the
    plane) on the shape's dominant product, whose share of the shape's square is `straightness`.
    `parity` is the class of symmetry. Amplitudes are per volt on the drive at resonance, zero to
    peak, of this mode alone: `alone_per_volt` at its antinode (see `antinode`).
    `shape` is w on the upper face, (x, y) on the grid of `surface_shapes`, 1 at its largest.
    """

    frequency: si.Hertz
    quality_factor: si.Dimensionless
    label: Label | None
    straightness: si.Dimensionless
    parity: Symmetry
    alone_per_volt: si.MetrePerVolt
    shape: si.DimensionlessArray

    @property
    def name(self) -> str:
        """The label as people write it, "(8,0)"."""
        return label_name(self.label)

    @property
    def moving(self) -> Moving:
        """Motion at its antinode by which its neighbours are compared."""
        half = self.frequency / (2 * self.quality_factor)
        return Moving(self.name, self.frequency, half, self.alone_per_volt)


@si.checked_numbers
def label_name(label: Label | None) -> str:
    """Nodal lines across length and width as people write them, "(8,0)"."""
    return "in plane" if label is None else f"({label[0]},{label[1]})"


class Moving(NamedTuple):
    """A mode by its name, frequency (Hz), half-bandwidth f/2Q (Hz) and amplitude per volt (m/V)."""

    name: str
    frequency: si.Hertz
    half_bandwidth: si.Hertz
    amplitude_per_volt: si.MetrePerVolt


@dataclass(frozen=True)
class Neighbour:
    """The mode that adds most at another's resonance: its name and frequency, how far it lies from
    the other in its own half-bandwidths f/2Q, and how much it adds over the other's amplitude."""

    name: str
    frequency: si.Hertz
    distance: si.Dimensionless
    share: si.Dimensionless


def strongest_neighbour(own: Moving, others: Iterable[Moving]) -> Neighbour | None:
    """The mode that adds most at a mode's resonance; None where there is no other, or nothing of
    the mode itself to compare it with.

    A mode of amplitude A' and half-bandwidth b' adds A'/√(1 + n²) at a distance of n b'.
    """
    neighbour: Neighbour | None = None
    if own.amplitude_per_volt == 0:
        return None
    for other in others:
        distance = abs(other.frequency - own.frequency) / other.half_bandwidth
        share = other.amplitude_per_volt / (1 + distance**2) ** 0.5 / own.amplitude_per_volt
        if neighbour is None or share > neighbour.share:
            neighbour = Neighbour(other.name, other.frequency, distance, share)
    return neighbour


def driven_modes(part: ReducedClass, band: tuple[si.Hertz, si.Hertz]) -> list[DrivenMode]:
    """The modes of a reduced class in a band (Hz), ascending.

    Electrodes that are driven or shorted count as shorted, open ones as open, shunted ones as
    shorted. Amplitudes are Q F φ/ω² with Q from the materials' losses; valid where the reduced
    space has converged, which is about the band it was made for.
    """
    with one_blas_thread():
        squares, turn = eigh(charge_free_stiffness(part), part.mass)
        inside = (squares > (2 * np.pi * band[0]) ** 2) & (squares < (2 * np.pi * band[1]) ** 2)
        squares, turn = squares[inside], turn[:, inside]
        if not squares.size:
            return []
        forces = turn.T @ (part.coupling @ part.drive)
        losses = np.einsum("ij,ik,kj->j", turn, part.loss, turn) / squares
        x, y, surface = surface_shapes(part.solved, part.basis @ turn)
    modes = []
    for square, force, loss, top in zip(squares, forces, losses, surface, strict=True):
        w = top[:, :, 2]
        largest = float(np.max(np.abs(w)))
        per_volt = float(abs(force) / (max(loss, 1e-30) * square))
        label = label_of(top, x, y)
        modes.append(
            DrivenMode(
                frequency=float(np.sqrt(square) / (2 * np.pi)),
                quality_factor=float(1 / max(loss, 1e-30)),
                label=label,
                straightness=profiles(w)[2],
                parity=part.solved.parity,
                alone_per_volt=per_volt * antinode(w, label),
                shape=w / max(largest, 1e-300),
            )
        )
    return modes


def antinode(w: si.FloatArray, label: Label | None = None) -> float:
    """|w| at a mode's antinode, of w on an even grid (x, y) of the face.

    Of a mode with nodal lines across one side only: the largest lobe of the middle line that
    crosses them, between the outermost. Of any other: the highest point that is inside the face
    and not below its neighbours; the highest of all where there is no such point.
    """
    size = np.abs(w)
    if label is not None and min(label) == 0 and max(label) > 1:
        line = w.T if label[0] else w
        middle = (line[(len(line) - 1) // 2] + line[len(line) // 2]) / 2
        turns = np.flatnonzero(np.signbit(middle[1:]) != np.signbit(middle[:-1]))
        if turns.size > 1:
            return float(np.max(np.abs(middle[turns[0] + 1 : turns[-1] + 1])))
    if min(size.shape) < 3:
        return float(np.max(size))
    around = sliding_window_view(size, (3, 3)).max(axis=(2, 3))
    inner = size[1:-1, 1:-1]
    peaks = inner[inner == around]
    return float(np.max(peaks)) if np.any(peaks > 0) else float(np.max(size))


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
