"""The second of two meshes, and a third where needed: modes refined, extrapolated, with errors."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.plate.elements.krylov import modes_near, prolonged
from squeezefilm.plate.elements.slab_factor import SlabFactor
from squeezefilm.plate.elements.slabs import Slabs
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.solid.coarse_modes import CoarseModes
from squeezefilm.plate.solid.electrode_circuits import inverse_with_open
from squeezefilm.plate.solid.mesh import plate_model
from squeezefilm.plate.solid.modes import Label, SolvedModel, label_of, surface_shapes
from squeezefilm.plate.solid.resolution import FINE, NORMAL

LEVELS = (NORMAL, FINE)
# Share of the difference between two meshes that is still missing on the finer one, and the
# uncertainty of that share, for the first and the second refinement. Of the first difference 1 % to
# 40 % was missing on the plates it was calibrated on (the smooth part of the error falls by ten and
# more, the singular one by three), of the second up to 15 %. Checked on plates drawn afterwards in
# tests/verification/test_plate_error.py. The floor is what a difference near zero may hide.
EXTRAPOLATION = (0.22, 0.1)
UNCERTAINTY = (0.22, 0.1)
_FLOOR = 1e-4


@dataclass(frozen=True, eq=False)
class RefinedModes:
    """The refined modes of one class."""

    found: CoarseModes
    index: si.IntArray
    solved: SolvedModel
    coarse_values: si.FloatArray
    values: si.FloatArray
    vectors: si.FloatArray
    level: int
    factor: SlabFactor


def refined_modes(
    plate: RectangularPlate,
    one: CoarseModes,
    index: si.IntArray,
    highest: float,
    tolerance: float,
) -> RefinedModes:
    """The modes `index` of a class on finer meshes, until the estimated error is below `tolerance`
    (relative) or the finest one is reached."""
    solved, values, vectors = one.solved, one.values[index], one.vectors[:, index]
    for level, resolution in enumerate(LEVELS):
        built = plate_model(plate, highest, resolution, one.parity)
        slabs = Slabs(built.model)
        finer = SolvedModel(plate, built, slabs)
        start = prolonged(solved.slabs, slabs, vectors)
        # Just below the coarse values, where the finer ones are expected.
        shift = float(np.mean(values)) * (1 - 2e-3)
        factor = SlabFactor(slabs, shift)
        solve = inverse_with_open(slabs, finer, factor)

        # By shape, not by value or order: a coarse value may be nearer to another mode, and
        # neighbours may change places between two meshes.
        pairs = modes_near(slabs, solve, shift, None, start, tolerance=min(1e-6, 1e-3 * tolerance))
        piece = RefinedModes(one, index, finer, values, pairs.values, pairs.vectors, level, factor)
        _, error = extrapolated(piece.coarse_values, piece.values, piece.level)
        worst = np.max(error / (np.sqrt(piece.values) / (2 * np.pi)))
        if worst <= tolerance or level == len(LEVELS) - 1:
            return piece
        solved, values, vectors = finer, pairs.values, pairs.vectors
    raise AssertionError("no level was solved")


def with_label(piece: RefinedModes, label: Label) -> RefinedModes:
    """Of refined modes those that have these nodal lines."""
    x, y, surface = surface_shapes(piece.solved, piece.vectors)
    keep = np.array([label_of(one, x, y) == label for one in surface])
    return dataclasses.replace(
        piece,
        index=piece.index[keep],
        coarse_values=piece.coarse_values[keep],
        values=piece.values[keep],
        vectors=piece.vectors[:, keep],
    )


def extrapolated(
    coarse: si.FloatArray, fine: si.FloatArray, level: int
) -> tuple[si.FloatArray, si.FloatArray]:
    """Frequencies extrapolated from two meshes, and their estimated errors (Hz)."""
    a, b = np.sqrt(coarse) / (2 * np.pi), np.sqrt(fine) / (2 * np.pi)
    share, doubt = EXTRAPOLATION[level], UNCERTAINTY[level]
    return b - share * (a - b), doubt * np.abs(a - b) + _FLOOR * b
