"""A plate reduced to a few dozen coordinates that answer a drive over a band.

The coordinates of a class of symmetry are a Krylov space of (K − σM)⁻¹ started from the forces at
work: the modes near the band, and what the modes left out add quasi-statically, in one. Losses and
circuits are projected on it.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.elements.slab_modes import SlabFactor, orthonormal
from squeezefilm.physics.plate.elements.slabs import Slabs
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.layers import NORMAL, Resolution
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.symmetry import PlateModel, Symmetry, drive_signs


@dataclass(frozen=True, eq=False)
class ReducedClass:
    """A class of symmetry, reduced: `basis` (unknowns × coordinates), mass, stiffness, loss
    (mechanical and of supports) and electrode matrices, of the whole plate.

    `drive` is the potential of each model electrode per volt of the drive; `circuit` lists the
    electrodes (number, Ω, share) that are open (infinite) or shunted.
    """

    solved: PlateModel
    resolution: Resolution
    basis: si.FloatArray
    mass: si.FloatArray
    stiffness: si.FloatArray
    loss: si.FloatArray
    coupling: si.FloatArray
    capacitance: si.FloatArray
    drive: si.FloatArray
    circuit: tuple[tuple[int, float, float], ...]


def class_drive(solved: PlateModel) -> si.FloatArray:
    """The part of the drive in a class: potential of each model electrode per volt."""
    signs = drive_signs(solved.plate)
    out = np.zeros(len(solved.model.electrodes))
    members = np.zeros(out.size)
    for i, electrode in enumerate(solved.electrode_of):
        out[electrode] += solved.sign_of[i] * signs[i] * (solved.share_of[i] != 0)
        members[electrode] += 1
    return out / np.maximum(members, 1)


def resolved_frequency(band: tuple[si.Hertz, si.Hertz]) -> si.Hertz:
    """The frequency that meshes for a band are made for: as `solve_modes` makes its own."""
    return max(band[1], 1.15 * sum(band) / 2)


def plate_circuit(solved: PlateModel) -> tuple[tuple[int, float, float], ...]:
    """Open and shunted electrodes of a class: model electrode, resistance (Ω, infinite if open) and
    how many times the model's part of the ceramic makes a whole one."""
    out: dict[int, tuple[int, float, float]] = {}
    for i, patch in enumerate(solved.plate.patches):
        share = solved.share_of[i]
        if patch.electrode not in ("open", "shunted") or share == 0:
            continue
        resistance = np.inf if patch.shunt_resistance is None else patch.shunt_resistance
        out[solved.electrode_of[i]] = (solved.electrode_of[i], resistance, share)
    return tuple(out.values())


def open_electrodes(solved: PlateModel) -> si.FloatArray:
    """Columns (electrodes, open ones) with a 1 for each electrode that the plate leaves open."""
    opened = [number for number, resistance, _ in plate_circuit(solved) if np.isinf(resistance)]
    return np.eye(len(solved.model.electrodes))[:, opened]


def reduced_class(
    plate: RectangularPlate,
    parity: Symmetry,
    band: tuple[si.Hertz, si.Hertz],
    steps: int,
    loads: list[tuple[si.FloatArray, si.FloatArray, si.FloatArray]],
    resolution: Resolution = NORMAL,
) -> ReducedClass:
    """Reduce one class over a band with `steps` block Krylov steps.

    `loads` are surface forces (x, y, w as in `PlateModel.force`) whose responses the space must
    hold too.
    """
    solved = plate_model(plate, resolved_frequency(band), resolution, parity)
    shift = (2 * np.pi) ** 2 * 0.5 * (band[0] ** 2 + band[1] ** 2) * 1.0007**2
    return reduced_model(solved, SlabFactor(solved.slabs, shift), resolution, steps, loads)


def reduced_model(
    solved: PlateModel,
    factor: SlabFactor,
    resolution: Resolution,
    steps: int,
    loads: list[tuple[si.FloatArray, si.FloatArray, si.FloatArray]],
    modes: si.FloatArray | None = None,
) -> ReducedClass:
    """Reduce a class that is discretised, at `resolution`, and factorised at a shift within the
    band; `steps` and `loads` as in `reduced_class`. `modes` (unknowns × modes) that are known are
    put into the space first: the steps are then left to the others."""
    slabs, plate = solved.slabs, solved.plate
    G, C = slabs.electrode_columns
    drive, circuit = class_drive(solved), plate_circuit(solved)
    columns = [G @ drive] if np.any(drive) else []
    columns += [G[:, number] for number, _, _ in circuit]
    columns += [solved.force(x, y, plate.thickness, w) for x, y, w in loads]
    basis = _krylov_space(slabs, factor, np.stack(columns, axis=1), steps, modes)
    sections = slabs.weighted_sections(lambda m: (m.loss or 0.0, 0.0), slabs.model.spring_losses)
    KW, LW = slabs.stiffness_times(basis), slabs.stiffness_times(basis, sections)
    n = float(solved.copies)
    return ReducedClass(
        solved,
        resolution,
        basis,
        n * _symmetric(basis.T @ slabs.mass_times(basis)),
        n * _symmetric(basis.T @ KW),
        n * _symmetric(basis.T @ LW),
        n * basis.T @ G,
        n * C,
        drive,
        circuit,
    )


def charge_free_stiffness(part: ReducedClass) -> si.FloatArray:
    """The stiffness with the voltages of open electrodes, which keep no charge."""
    opened = open_electrodes(part.solved)
    pull = part.coupling @ opened
    return part.stiffness - pull @ np.linalg.solve(opened.T @ part.capacitance @ opened, pull.T)


def _symmetric(matrix: si.FloatArray) -> si.FloatArray:
    return (matrix + matrix.T) / 2


def _krylov_space(
    slabs: Slabs,
    factor: SlabFactor,
    columns: si.FloatArray,
    steps: int,
    modes: si.FloatArray | None = None,
) -> si.FloatArray:
    """The modes, (K − σM)⁻¹ applied to the columns, and `steps` times (K − σM)⁻¹M to that, of unit
    mass."""
    X = factor.solve(columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300))
    known = np.zeros((slabs.unknowns, 0)) if modes is None else modes
    held = known.shape[1]
    # As long as it may become, vectors side by side: each step takes products with all of it.
    Q = np.empty((slabs.unknowns, held + steps * X.shape[1]), order="F")
    MQ = np.empty_like(Q)
    Q[:, :held], MQ[:, :held] = known, slabs.mass_times(known)
    for step in range(steps):
        X, MX = orthonormal(slabs, X, Q[:, :held], MQ[:, :held])
        if not X.shape[1]:
            break
        new = slice(held, held + X.shape[1])
        Q[:, new], MQ[:, new] = X, MX
        held = new.stop
        if step < steps - 1:
            X = factor.solve(MX)
    return Q[:, :held]


def class_slices(parts: list[ReducedClass]) -> list[slice]:
    """Slices of the coordinates of each class among those of all."""
    ends = np.cumsum([0, *(part.basis.shape[1] for part in parts)]).tolist()
    return [slice(*pair) for pair in itertools.pairwise(ends)]


def surface_values(
    parts: list[ReducedClass], x: si.FloatArray, y: si.FloatArray, z: float
) -> si.FloatArray:
    """w of every coordinate of all classes on a grid, shape (coordinates, x, y)."""
    return np.concatenate([part.solved.field(part.basis, x, y, z)[..., 2] for part in parts])


def harmonic_solution(
    parts: list[ReducedClass], omega: si.FloatArray
) -> tuple[si.ComplexArray, list[si.ComplexArray], si.ComplexArray]:
    """Coordinates (frequencies × coordinates), electrode potentials of each class (frequencies ×
    electrodes) and the charge at the drive's terminals, per volt at angular frequencies `omega`."""
    coordinates, potentials, charge = [], [], np.zeros(omega.size, dtype=complex)
    for part in parts:
        numbers = [number for number, _, _ in part.circuit]
        resistance = np.array([resistor for _, resistor, _ in part.circuit])
        is_open, held = np.isinf(resistance), part.capacitance @ part.drive
        # Charge = −(Gᵀx + C V); a shunt draws V = −iωR · charge, an open electrode none. Matrices
        # are of the whole plate; one patch carries a part of them.
        shares = np.array([share for _, _, share in part.circuit]) / part.solved.copies
        per_charge = 1j * np.outer(omega, np.where(is_open, 0.0, resistance) * shares)
        per_charge[:, is_open] = 1.0
        n = part.mass.shape[0]
        A = np.zeros((omega.size, n + len(numbers), n + len(numbers)), dtype=complex)
        A[:, :n, :n] = part.stiffness + 1j * part.loss - omega[:, None, None] ** 2 * part.mass
        A[:, :n, n:] = part.coupling[:, numbers]
        A[:, n:, :n] = per_charge[:, :, None] * part.coupling[:, numbers].T
        A[:, n:, n:] = per_charge[:, :, None] * part.capacitance[np.ix_(numbers, numbers)]
        A[:, n:, n:] -= np.diag(np.where(is_open, 0.0, 1.0))
        b = np.empty((omega.size, n + len(numbers)), dtype=complex)
        b[:, :n], b[:, n:] = -(part.coupling @ part.drive), -per_charge * held[numbers]
        # Circuit rows are in farads, the others in newtons: bring them to one size.
        scale = np.max(np.abs(A), axis=2)
        solution = np.linalg.solve(A / scale[:, :, None], (b / scale)[:, :, None])[:, :, 0]
        V = np.tile(part.drive.astype(complex), (omega.size, 1))
        V[:, numbers] = solution[:, n:]
        charge -= (solution[:, :n] @ part.coupling + V @ part.capacitance) @ part.drive
        coordinates.append(solution[:, :n])
        potentials.append(V)
    return np.concatenate(coordinates, axis=1), potentials, charge
