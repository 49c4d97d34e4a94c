"""The second of two meshes, and a third where needed: modes refined, extrapolated, with errors."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.progress import Deadline
from squeezefilm.physics.plate.elements.slab_modes import (
    SlabFactor,
    modes_near,
    orthonormal,
    prolonged,
)
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.coarse_modes import (
    CoarseModes,
    inverse_with_open,
    open_values,
    shunted_frequencies,
)
from squeezefilm.physics.plate.solid.forecast import expected_seconds
from squeezefilm.physics.plate.solid.layers import COARSE, FINE, NORMAL, Resolution
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.modes import (
    COARSE_ERROR,
    Label,
    label_of,
    surface_shapes,
)
from squeezefilm.physics.plate.solid.reduced import ReducedClass, resolved_frequency
from squeezefilm.physics.plate.solid.symmetry import PlateModel

LEVELS = (NORMAL, FINE)
UNREFINED = -1
"""The level of what a deadline left on the coarse mesh."""
# Share of the difference between two meshes that is still missing on the finer one, and the
# uncertainty of that share, for the first and the second refinement. Of the first difference 1 % to
# 84 % was missing on the 118 modes it was calibrated on, of half of them 10 % to 37 % (a third is
# what the singular lines at strip edges leave; all meshes resolve the smooth part), of the second
# up to 69 %. Checked on plates drawn afterwards in tests/verification/test_plate_error.py. The
# floor is what a difference near zero may hide and what thin plates lose in rounding (see mesh.py).
EXTRAPOLATION = (0.42, 0.3)
UNCERTAINTY = (0.46, 0.35)
_FLOOR = 4e-5
# Of the plates in test_plate_error.py the worst needs 0.037 of it.
_OF_FREQUENCY = 0.05
# Two solutions on one mesh are of one mode if their ω² agree to this.
_SAME = 1e-5


@dataclass(frozen=True, eq=False)
class RefinedModes:
    """The refined modes of one class: ω² on the finer mesh and on the one before it, with the
    drive's terminals short (`values`) and open (`open_values`); `shunted` is the complex ω with
    resistors at work. The `factor` of the mesh is kept for those who go on with it only."""

    found: CoarseModes
    index: si.IntArray
    solved: PlateModel
    coarse_values: si.FloatArray
    values: si.FloatArray
    coarse_open_values: si.FloatArray
    open_values: si.FloatArray
    vectors: si.FloatArray
    level: int
    factor: SlabFactor | None
    shunted: si.ComplexArray


def refined_modes(
    plate: RectangularPlate,
    coarse: CoarseModes,
    index: si.IntArray,
    highest: float,
    tolerance: float,
    deadline: Deadline | None = None,
    *,
    keep_factor: bool = False,
) -> RefinedModes:
    """The modes `index` of a class on finer meshes, until the estimated error is below `tolerance`
    (relative), the finest that memory holds is reached or the next would end after the deadline:
    without time for any, the coarse mesh's own (level `UNREFINED`).

    Raises `InputError` where memory does not hold the first of the finer meshes.
    """
    solved, values, vectors = coarse.solved, coarse.values[index], coarse.vectors[:, index]
    assert coarse.factor is not None
    opened = open_values(solved, coarse.factor, values, vectors)
    piece = RefinedModes(
        found=dataclasses.replace(coarse, factor=None),
        index=index,
        solved=solved,
        coarse_values=values,
        values=values,
        coarse_open_values=opened,
        open_values=opened,
        vectors=vectors,
        level=UNREFINED,
        factor=coarse.factor,
        shunted=np.sqrt(values).astype(complex),
    )
    for level, resolution in enumerate(LEVELS):
        try:
            finer = plate_model(plate, highest, resolution, solved.parity)
        except InputError:
            if level == 0:
                raise
            break  # The finest mesh that memory holds is the one before.
        if deadline is not None and not deadline.allows(expected_seconds(finer)):
            break
        # Let go of one mesh's factors before the next one's are made.
        piece = dataclasses.replace(piece, factor=None)
        piece = _finer(piece, finer, level, tolerance)
        _, error = extrapolated(piece.coarse_values, piece.values, piece.level)
        worst = np.max(error / (np.sqrt(piece.values) / (2 * np.pi)))
        if worst <= tolerance:
            break
    assert piece.factor is not None
    shunted = shunted_frequencies(piece.solved, piece.factor, piece.values, piece.vectors)
    return dataclasses.replace(piece, factor=piece.factor if keep_factor else None, shunted=shunted)


def _finer(piece: RefinedModes, finer: PlateModel, level: int, tolerance: float) -> RefinedModes:
    """The same modes on a finer mesh."""
    slabs, values = finer.slabs, piece.values
    start = prolonged(piece.solved.slabs, slabs, piece.vectors)
    # Just below the coarse values, where the finer ones are expected.
    shift = float(np.mean(values)) * (1 - 2e-3)
    factor = SlabFactor(slabs, shift)
    # By shape, not by value or order: a coarse value may be nearer to another mode, and neighbours
    # may change places between two meshes.
    pairs = modes_near(
        slabs,
        inverse_with_open(finer, factor),
        shift,
        None,
        start,
        tolerance=min(1e-6, 1e-3 * tolerance),
    )
    return dataclasses.replace(
        piece,
        solved=finer,
        coarse_values=values,
        values=pairs.values,
        coarse_open_values=piece.open_values,
        open_values=open_values(finer, factor, pairs.values, pairs.vectors),
        vectors=pairs.vectors,
        level=level,
        factor=factor,
    )


def with_label(piece: RefinedModes, label: Label) -> RefinedModes:
    """The refined modes that have these nodal lines."""
    x, y, surface = surface_shapes(piece.solved, piece.vectors)
    keep = np.array([label_of(top, x, y) == label for top in surface])
    return dataclasses.replace(
        piece,
        index=piece.index[keep],
        coarse_values=piece.coarse_values[keep],
        values=piece.values[keep],
        coarse_open_values=piece.coarse_open_values[keep],
        open_values=piece.open_values[keep],
        vectors=piece.vectors[:, keep],
        shunted=piece.shunted[keep],
    )


def with_coarse_modes(piece: RefinedModes) -> si.FloatArray:
    """The refined modes of a class, and beside them the others that the coarse mesh has, brought
    onto the finer one by a step of inverse iteration; of unit mass, orthogonal to each other, shape
    (unknowns, modes). The piece must have its factor."""
    assert piece.factor is not None
    slabs, found = piece.solved.slabs, piece.found
    others = np.delete(found.vectors, piece.index, axis=1)
    start = slabs.mass_times(prolonged(found.solved.slabs, slabs, others))
    MV = slabs.mass_times(piece.vectors)
    beside, _ = orthonormal(slabs, piece.factor.solve(start), piece.vectors, MV)
    return np.concatenate([piece.vectors, beside], axis=1)


def extrapolated(
    coarse: si.FloatArray, fine: si.FloatArray, level: int
) -> tuple[si.FloatArray, si.FloatArray]:
    """Frequencies extrapolated from two meshes, and their estimated errors (Hz)."""
    a, b = np.sqrt(coarse) / (2 * np.pi), np.sqrt(fine) / (2 * np.pi)
    if level == UNREFINED:
        return b, COARSE_ERROR * b
    share, doubt = EXTRAPOLATION[level], UNCERTAINTY[level]
    return b - share * (a - b), doubt * np.abs(a - b) + _FLOOR * b


def effective_coupling(
    piece: RefinedModes,
) -> tuple[si.DimensionlessArray, si.DimensionlessArray]:
    """Each mode's effective coupling √(1 − f_short²/f_open²), and its estimated error.

    Of two meshes the couplings differ less than the frequencies, of which they are a difference,
    and may agree by accident: a twentieth of what the frequency's own error would do counts too.
    """
    short, error = extrapolated(piece.coarse_values, piece.values, piece.level)
    opened, _ = extrapolated(piece.coarse_open_values, piece.open_values, piece.level)
    k, before, now = (
        np.sqrt(np.maximum(0.0, 1 - ratio))
        for ratio in (
            (short / opened) ** 2,
            piece.coarse_values / piece.coarse_open_values,
            piece.values / piece.open_values,
        )
    )
    own = _OF_FREQUENCY * (error / short) * (1 - k**2) / np.maximum(k, 1e-12)
    apart = 0.0 if piece.level == UNREFINED else UNCERTAINTY[piece.level]
    return k, apart * np.abs(before - now) + np.where(k > 0, own, 0.0)


def extrapolated_class(
    reduced: ReducedClass, band: tuple[si.Hertz, si.Hertz], known: RefinedModes | None = None
) -> ReducedClass:
    """The same class with its stiffness and loss scaled so that the most strongly driven mode near
    the band stands at its frequency extrapolated from two meshes.

    Other modes move by the same ratio, nearer to theirs than the mesh alone. Unchanged where no
    driven mode is near, and on meshes that have no coarser one to compare with. `known` are refined
    modes of the same mesh: one that is among them need not be solved on the coarser mesh again.
    """
    level = next((k for k, res in enumerate(LEVELS) if res == reduced.resolution), None)
    coarser = (COARSE, *LEVELS)[level] if level is not None else None
    values, shapes = eigh(reduced.stiffness, reduced.mass)
    f = np.sqrt(np.maximum(values, 0.0)) / (2 * np.pi)
    force = np.abs(shapes.T @ (reduced.coupling @ reduced.drive))
    # Far above the band the space holds no modes but what they add, with any force.
    driven = force > 1e-3 * np.max(force, initial=0.0, where=f < 4 * band[1])
    near = np.flatnonzero((f > 0.9 * band[0]) & (f < 1.1 * band[1]) & driven)
    if coarser is None or level is None or near.size == 0:
        return reduced
    # Response at the band's nearest frequency: force squared over the distance of the squares.
    distance = np.maximum(0.0, np.maximum(band[0] - f[near], f[near] - band[1])) / f[near]
    mode = int(near[np.argmax(force[near] ** 2 / (distance + 0.01))])
    same: list[int] = []
    if known is not None:
        same = np.flatnonzero(np.abs(known.values / values[mode] - 1) < _SAME)[:1].tolist()
    if known is not None and same:
        wanted, _ = extrapolated(known.coarse_values[same], known.values[same], level)
    else:
        wanted = _compared(reduced, coarser, level, band, (values[mode], shapes[:, mode]))
    ratio = float(wanted[0] / f[mode]) ** 2
    return dataclasses.replace(
        reduced, stiffness=ratio * reduced.stiffness, loss=ratio * reduced.loss
    )


def _compared(
    reduced: ReducedClass,
    coarser: Resolution,
    level: int,
    band: tuple[si.Hertz, si.Hertz],
    mode: tuple[float, si.FloatArray],
) -> si.FloatArray:
    """The extrapolated frequency (Hz) of a mode (value, coordinates) of a reduced class, compared
    with the mode of its shape on a coarser mesh."""
    value, coordinates = mode
    solved, vector = reduced.solved, (reduced.basis @ coordinates)[:, None]
    rough = plate_model(solved.plate, resolved_frequency(band), coarser, solved.parity).slabs
    shift = value * (1 + 2e-3)
    start = prolonged(solved.slabs, rough, vector)
    pairs = modes_near(
        rough,
        SlabFactor(rough, shift).solve,
        shift,
        lambda v: np.array([np.argmin(np.abs(v - shift))]),
        start,
        tolerance=1e-6,
    )
    return extrapolated(pairs.values, np.array([value]), level)[0]
