"""Open electrodes: the shift of a mode's frequency by open terminals, and floating electrodes. Both
by a few bordered solves with the factorisation that has them shorted."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.elements.krylov import modes_near, with_open_electrodes
from squeezefilm.physics.plate.elements.slab_factor import SlabFactor
from squeezefilm.physics.plate.solid.model import PlateModel
from squeezefilm.physics.plate.solid.symmetry import drive_signs

_HARDLY = 1e-9
_OPEN_TOLERANCE = 1e-6


def inverse_with_open(solved: PlateModel, factor: SlabFactor) -> Callable[..., si.FloatArray]:
    """The inverse with the plate's own open electrodes."""
    columns = _floating(solved)
    return (
        with_open_electrodes(solved.slabs, factor.solve, columns) if columns.size else factor.solve
    )


def _floating(solved: PlateModel) -> si.FloatArray:
    """The electrodes that the plate leaves open, each by itself."""
    patches = solved.plate.patches
    return tied_electrodes(
        solved, [[(i, 1.0)] for i, p in enumerate(patches) if p.electrode == "open"]
    )


def tied_electrodes(solved: PlateModel, groups: list[list[tuple[int, float]]]) -> si.FloatArray:
    """Model electrodes tied together, one column a group of (patch, sign); empty groups and
    repeated ones (mirror images) left out."""
    electrodes = len(solved.model.electrodes)
    columns: list[si.FloatArray] = []
    for group in groups:
        column = np.zeros(electrodes)
        for patch, sign in group:
            if solved.share_of[patch] == 0:
                continue
            column[solved.electrode_of[patch]] += sign * solved.sign_of[patch]
        column = np.sign(np.round(column, 9))
        if np.any(column) and not any(
            np.array_equal(np.abs(column), np.abs(other)) for other in columns
        ):
            columns.append(column)
    return np.stack(columns, axis=1) if columns else np.zeros((electrodes, 0))


def open_values(
    solved: PlateModel, factor: SlabFactor, values: si.FloatArray, vectors: si.FloatArray
) -> si.FloatArray:
    """ω² of the same modes with the drive's terminals open, to the accuracy of the mesh; `values`
    and `vectors` are those with the terminals short, `factor` that of a shift near them.

    Modes that the drive does not move keep their value. Raises `ConvergenceError` where a mode is
    not found again among those with open terminals.
    """
    slabs = solved.slabs
    signs = drive_signs(solved.plate)
    port = tied_electrodes(solved, [[(i, s) for i, s in enumerate(signs) if s]])
    out = values.copy()
    if values.size == 0 or not port.size:
        return out
    G, C = slabs.electrode_columns
    force, held = port.T @ G.T @ vectors, np.abs(np.diag(port.T @ C @ port))
    # The first order of the rise, F²/(C ω²): where it is rounding there is nothing to solve.
    moved = np.flatnonzero(np.sum(force**2 / held[:, None], axis=0) > _HARDLY * values)
    if not moved.size:
        return out
    columns = np.concatenate([port, _floating(solved)], axis=1)
    solve = with_open_electrodes(slabs, factor.solve, columns)
    pairs = modes_near(
        slabs, solve, factor.shift, None, vectors[:, moved], tolerance=_OPEN_TOLERANCE
    )
    out[moved] = np.maximum(pairs.values, values[moved])
    return out
