"""Modes near a shift, by block Krylov iteration with the factorised inverse."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.plate.elements.lobatto import LineMesh
from squeezefilm.physics.plate.elements.slab_factor import SlabFactor
from squeezefilm.physics.plate.elements.slabs import Slabs

_MOST_STEPS = 40
# Of a block's square: what two projections leave of what the basis holds.
_ROUNDING = 1e-26
Solve = Callable[[si.FloatArray], si.FloatArray]


class Pairs(NamedTuple):
    """Eigenvalues ω² (ascending) and vectors with unit modal mass of the model."""

    values: si.FloatArray
    vectors: si.FloatArray


def with_open_electrodes(slabs: Slabs, solve: Solve, columns: si.FloatArray) -> Solve:
    """The inverse where combinations of electrodes carry no charge instead of no voltage.

    `columns` (electrodes × combinations) says which electrodes are tied with which sign. Bordered
    by a few rows, so the factorisation with all electrodes shorted serves.
    """
    G, C = slabs.electrode_columns
    G, C = G @ columns, columns.T @ C @ columns
    AG = solve(G)
    S = G.T @ AG - C

    def bordered(right: si.FloatArray) -> si.FloatArray:
        x = solve(right)
        return x - AG @ np.linalg.solve(S, G.T @ x)

    return bordered


def modes_near(
    slabs: Slabs,
    solve: Solve,
    shift: float,
    wanted: Callable[[si.FloatArray], si.IntArray] | None,
    start: si.FloatArray,
    *,
    tolerance: float,
) -> Pairs:
    """The modes that `wanted` picks, from the eigenvalues found so far to their indices; without it
    those that move most like the columns of `start`, one for each and in their order.

    Converged when their values change by less than `tolerance` (relative) in a step; the error
    left is of the order of that change times the ratio of convergence. Raises `ConvergenceError`
    where that does not happen.
    """
    Q: si.FloatArray = np.zeros((slabs.unknowns, 0))
    MQ = Q
    H = np.zeros((0, 0))
    X = solve(slabs.mass_times(start))
    before: si.FloatArray | None = None
    chosen = H
    for _ in range(_MOST_STEPS):
        X, MX = orthonormal(slabs, X, Q, MQ)
        if not X.shape[1]:
            # The space holds all that the start leads to: what was found in it is exact.
            if before is not None and before.size:
                return Pairs(before, Q @ chosen)
            break
        Q, MQ = np.concatenate([Q, X], axis=1), np.concatenate([MQ, MX], axis=1)
        X = solve(MX)
        H = _grown(H, MQ.T @ X)
        inverse, turn = eigh(H)
        keep = np.abs(inverse) > 1e-30
        values = shift + 1 / inverse[keep]
        order = np.argsort(values)
        values, coefficients = values[order], turn[:, keep][:, order]
        if wanted is not None:
            index = wanted(values)
        elif values.size < start.shape[1]:
            continue
        else:
            index = _most_alike(start.T @ MQ @ coefficients)
        now, chosen = values[index], coefficients[:, index]
        if (
            before is not None
            and before.size == now.size
            and np.all(np.abs(now - before) <= tolerance * np.maximum(np.abs(now), abs(shift)))
            and now.size
        ):
            return Pairs(now, Q @ chosen)
        before = now
    if before is not None and before.size == 0:
        return Pairs(before, np.zeros((slabs.unknowns, 0)))
    raise ConvergenceError(
        f"the modes did not converge in {_MOST_STEPS} steps; ask for a narrower band or fewer "
        "modes",
        iterations=_MOST_STEPS,
    )


def _most_alike(products: si.FloatArray) -> si.IntArray:
    """The column for each row, each another one, by the squares of their products."""
    # A tenth of a second of imports that few solves need.
    from scipy.optimize import linear_sum_assignment

    chosen: si.IntArray = linear_sum_assignment(-(products**2))[1]
    return chosen


def orthonormal(
    slabs: Slabs, X: si.FloatArray, Q: si.FloatArray, MQ: si.FloatArray
) -> tuple[si.FloatArray, si.FloatArray]:
    """A block orthonormal in mass to itself and to the basis Q, and M times it; directions that
    the basis has are left out."""
    held = MQ.T @ X
    X = X - Q @ held
    X = X - Q @ (MQ.T @ X)
    MX = slabs.mass_times(X)
    gram = X.T @ MX
    size, turn = np.linalg.eigh((gram + gram.T) / 2)
    # Of a block that lies in the basis rounding is left, whose directions are none.
    least = _ROUNDING * np.max(np.sum(held**2, axis=0), initial=0.0)
    good = size > max(1e-13 * size[-1], least, 1e-300)
    if not good.any():
        return X[:, good], MX[:, good]
    scale = turn[:, good] / np.sqrt(size[good])
    X, MX = X @ scale, MX @ scale
    # A second pass: the first divides by small numbers where the block is near a mode.
    again = MX.T @ X
    lower = np.linalg.inv(np.linalg.cholesky((again + again.T) / 2)).T
    return X @ lower, MX @ lower


def _grown(H: si.FloatArray, new: si.FloatArray) -> si.FloatArray:
    """The symmetric projection with the columns of a new block, and the rows that mirror them."""
    old = H.shape[0]
    grown = np.empty((new.shape[0], new.shape[0]))
    grown[:old, :old] = H
    grown[:, old:] = new
    grown[old:, :] = new.T
    return np.asarray((grown + grown.T) / 2)


def prolonged(source: Slabs, target: Slabs, vectors: si.FloatArray) -> si.FloatArray:
    """Displacements of a solution as vectors of another discretisation of the same solid, finer or
    coarser, by interpolation; potentials are left at zero."""
    out = np.zeros((target.unknowns, vectors.shape[1]))
    x = source.model.x.interpolation(target.model.x.nodes)
    y = _transfer(source.model.y, target.model.y)
    z = _transfer(source.model.z, target.model.z)
    for column in range(vectors.shape[1]):
        grid = np.tensordot(x, source.grid(vectors[:, column]), 1)
        grid = np.einsum("abcd,eb,fc->aefd", grid, y, z, optimize=True)
        for n, (component, iy, iz) in enumerate(target.parts):
            moving = np.flatnonzero(component < 3)
            at = target.offsets[n] + moving
            out[at, column] = grid[n, iy[moving], iz[moving], component[moving]]
    out[target.held] = 0
    return out


def _transfer(source: LineMesh, target: LineMesh) -> si.FloatArray:
    """Hierarchic coefficients on one line mesh from those on another."""
    values = source.interpolation(target.nodes, hierarchic=True)
    return np.asarray(np.linalg.solve(target.interpolation(target.nodes, hierarchic=True), values))


def modes_below(slabs: Slabs, shift: float) -> int:
    """Count the modes that lie below a shift, electrodes shorted (Sylvester's law of inertia)."""
    return SlabFactor(slabs, shift, count=True).modes_below
