"""Shift of a mode's frequency by circuits at the electrodes: open terminals, floating electrodes,
resistive shunts. All by a few bordered solves with the factorisation that has them shorted."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import eig

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.plate.elements.krylov import modes_near, with_open_electrodes
from squeezefilm.physics.plate.elements.slab_factor import SlabFactor
from squeezefilm.physics.plate.solid.model import PlateModel
from squeezefilm.physics.plate.solid.reduced import plate_circuit
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


def shunted_frequencies(
    solved: PlateModel, factor: SlabFactor, values: si.FloatArray, vectors: si.FloatArray
) -> si.ComplexArray:
    """Complex ω (rad/s, time factor e^{iωt}) of modes with their electrodes' resistors at work.

    `values` and `vectors` (unit modal mass of the model) are those with shunts short. A resistor R
    at an electrode of charge q and capacitance C adds iωR/(1 + iωRC) times the square of the
    electrode's force to the stiffness: nothing for R → 0, that of an open electrode for R → ∞. The
    eigenproblem, nonlinear in ω, is solved by iteration on the space of these modes and of the
    static answers to the electrodes. Raises `ConvergenceError` where that does not settle.
    """
    omega = np.sqrt(values).astype(complex)
    circuit = [resistor for resistor in plate_circuit(solved) if np.isfinite(resistor[1])]
    if not circuit or values.size == 0:
        return omega
    slabs = solved.slabs
    number = [resistor[0] for resistor in circuit]
    weight = np.array([resistance * share for _, resistance, share in circuit])
    G, C = slabs.electrode_columns
    G, C = G[:, number], C[np.ix_(number, number)]
    opened = _floating(solved)
    solve = inverse_with_open(solved, factor)
    answer = solve(G / np.max(np.abs(G)))
    more = solve(slabs.mass_times(answer))
    X = np.concatenate([vectors, answer, more, solve(slabs.mass_times(more))], axis=1)
    X = X / np.sqrt(np.maximum(np.sum(X * slabs.mass_times(X), axis=0), 1e-300))
    M = X.T @ slabs.mass_times(X)
    size, turn = np.linalg.eigh((M + M.T) / 2)
    X = X @ (turn[:, size > 1e-10] / np.sqrt(size[size > 1e-10]))
    K = X.T @ slabs.stiffness_times(X)
    if opened.size:
        Go, Co = slabs.electrode_columns
        force = X.T @ (Go @ opened)
        K = K - force @ np.linalg.solve(opened.T @ Co @ opened, force.T)
    force, start = X.T @ G, X.T @ slabs.mass_times(vectors)
    for mode in range(values.size):
        shape = start[:, mode].astype(complex)
        for _ in range(60):
            scale = 1j * omega[mode] * weight
            stiffer = np.linalg.solve(
                np.eye(weight.size) - scale[:, None] * C, scale[:, None] * force.T
            )
            squares, shapes = eig(K + force @ stiffer)
            likeness = np.abs(shape.conj() @ shapes) / np.linalg.norm(shapes, axis=0)
            best = int(np.argmax(likeness))
            before, omega[mode] = omega[mode], np.sqrt(squares[best])
            shape = shapes[:, best]
            if abs(omega[mode] - before) <= 1e-10 * abs(before):
                break
        else:
            raise ConvergenceError(
                "the frequency of a mode with shunted electrodes did not settle; its mode passes "
                "into another one, ask with the electrodes open or shorted",
                iterations=60,
            )
    return omega
