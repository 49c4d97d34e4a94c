"""The first of two meshes: it finds the modes near a frequency or in a band and names them.

Open electrodes, open terminals and resistors at electrodes are a few bordered solves with the
factorisation that has them shorted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.core.hard_limits import BAND_MODES, require_within
from squeezefilm.physics.plate.elements.slab_modes import (
    SlabFactor,
    modes_near,
    with_open_electrodes,
)
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.layers import COARSE
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.modes import Label, label_of, surface_shapes
from squeezefilm.physics.plate.solid.reduced import (
    charge_free_stiffness,
    class_drive,
    open_electrodes,
    plate_circuit,
    reduced_model,
)
from squeezefilm.physics.plate.solid.symmetry import PlateModel, Symmetry

_HARDLY = 1e-9
_OPEN_TOLERANCE = 1e-6


def inverse_with_open(solved: PlateModel, factor: SlabFactor) -> Callable[..., si.FloatArray]:
    """The inverse with the plate's own open electrodes."""
    columns = open_electrodes(solved)
    return (
        with_open_electrodes(solved.slabs, factor.solve, columns) if columns.size else factor.solve
    )


def open_values(
    solved: PlateModel, factor: SlabFactor, values: si.FloatArray, vectors: si.FloatArray
) -> si.FloatArray:
    """ω² of the same modes with the drive's terminals open, to the accuracy of the mesh; `values`
    and `vectors` are those with the terminals short, `factor` that of a shift near them.

    Modes that the drive does not move keep their value. Raises `ConvergenceError` where a mode is
    not found again among those with open terminals.
    """
    slabs = solved.slabs
    port = class_drive(solved)[:, None]
    out = values.copy()
    if values.size == 0 or not np.any(port):
        return out
    G, C = slabs.electrode_columns
    force, held = port.T @ G.T @ vectors, np.abs(np.diag(port.T @ C @ port))
    # The first order of the rise, F²/(C ω²): where it is rounding there is nothing to solve.
    moved = np.flatnonzero(np.sum(force**2 / held[:, None], axis=0) > _HARDLY * values)
    if not moved.size:
        return out
    columns = np.concatenate([port, open_electrodes(solved)], axis=1)
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
    part = reduced_model(solved, factor, COARSE, 3, [], vectors)
    number = [resistor[0] for resistor in circuit]
    weight = np.array([resistance * share for _, resistance, share in circuit]) / solved.copies
    force, C = part.coupling[:, number], part.capacitance[np.ix_(number, number)]
    K = charge_free_stiffness(part)
    # The modes come first in the space.
    start = np.eye(len(K), values.size)
    for mode in range(values.size):
        shape = start[:, mode].astype(complex)
        for _ in range(60):
            scale = 1j * omega[mode] * weight
            stiffer = np.linalg.solve(
                np.eye(weight.size) - scale[:, None] * C, scale[:, None] * force.T
            )
            squares, shapes = eig(K + force @ stiffer, part.mass)
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


@dataclass(frozen=True, eq=False)
class CoarseModes:
    """Modes of one class on the coarse mesh, with what is taken from it; the `factor` is let go
    once they are refined."""

    solved: PlateModel
    values: si.FloatArray
    vectors: si.FloatArray
    labels: list[Label | None]
    factor: SlabFactor | None


def class_fits(parity: Symmetry, label: Label) -> bool:
    """True where a mode with these nodal lines can belong to a class of symmetry."""
    return all(
        p is None or p == ("S" if lines % 2 == 0 else "A")
        for p, lines in zip(parity, label, strict=True)
    )


def coarse_modes(
    plate: RectangularPlate,
    parity: Symmetry,
    centre: float,
    highest: float,
    band: tuple[float, float] | None,
    count: int,
) -> CoarseModes:
    """The modes of one class on the coarse mesh: the `count` nearest to `centre` (Hz), or all in a
    band, their number checked by Sylvester's law where no electrode is open."""
    solved = plate_model(plate, highest, COARSE, parity)
    slabs = solved.slabs
    shift = (2 * np.pi * centre * 1.0007) ** 2
    factor = SlabFactor(slabs, shift)
    expected: int | None = None
    if band is not None:
        # The coarse mesh is stiffer: look a little beyond the band, and choose later.
        low, high = 0.98 * band[0], 1.03 * band[1]
        limits = (2 * np.pi * low) ** 2, (2 * np.pi * high) ** 2
        opened = any(p.electrode == "open" for p in plate.patches)
        if not opened:
            below = [SlabFactor(slabs, limit).modes_below for limit in limits if limit > 0]
            expected = below[-1] - (below[0] if low > 0 else 0)
            require_within(BAND_MODES, expected, "band", enough="ask for a narrower band")

        def wanted(values: si.FloatArray) -> si.IntArray:
            inside = np.flatnonzero((values > limits[0]) & (values < limits[1]))
            # Not there yet: let the iteration go on by asking for what is not found.
            if expected is not None and inside.size < expected:
                return np.flatnonzero(values == np.inf)
            return inside

    else:

        def wanted(values: si.FloatArray) -> si.IntArray:
            positive = np.flatnonzero(values > (2 * np.pi * 1.0) ** 2)
            near = positive[np.argsort(np.abs(np.sqrt(values[positive]) - 2 * np.pi * centre))]
            return np.sort(near[:count])

    if expected == 0:
        values, vectors = np.zeros(0), np.zeros((slabs.unknowns, 0))
    else:
        start = np.random.default_rng(1).standard_normal((slabs.unknowns, 4))
        start[(slabs.components == 3) | slabs.held] = 0
        solve = inverse_with_open(solved, factor)
        pairs = modes_near(slabs, solve, shift, wanted, start, tolerance=1e-6)
        values, vectors = pairs.values, pairs.vectors
    x, y, surface = surface_shapes(solved, vectors)
    labels = [label_of(top, x, y) for top in surface]
    return CoarseModes(solved, values, vectors, labels, factor)


def chosen_modes(
    found: list[CoarseModes],
    near: float | None,
    band: tuple[float, float] | None,
    mode: Label | None,
    count: int,
) -> list[si.IntArray]:
    """The indices of the modes to refine, for each class."""
    if band is not None:
        return [np.arange(modes.values.size) for modes in found]
    away = [np.abs(np.sqrt(modes.values) / (2 * np.pi) - (near or 0.0)) for modes in found]
    if mode is not None:
        # Of several with these nodal lines those nearest to the guess: a finer mesh, which mixes
        # neighbours otherwise, shows which of them has the lines.
        hits = [
            [i for i in np.argsort(distance).tolist() if modes.labels[i] == mode][:3]
            for modes, distance in zip(found, away, strict=True)
        ]
        if not any(hits):
            seen = ", ".join(str(label) for modes in found for label in modes.labels if label)
            where = "" if near is None else f" near {near:.0f} Hz"
            raise InputError(
                f"no mode {mode} was found{where} (there are {seen or 'none with nodal lines'}); "
                "solve near another frequency",
                quantity="mode",
            )
        return [np.sort(np.array(numbers, dtype=np.int64)) for numbers in hits]
    chosen = np.zeros(sum(distance.size for distance in away), dtype=bool)
    chosen[np.argsort(np.concatenate(away), kind="stable")[:count]] = True
    ends = np.cumsum([distance.size for distance in away])[:-1]
    return [np.flatnonzero(part) for part in np.split(chosen, ends)]
