"""Sparse matrices of rings, gathered from elements; modes nearest to a shift."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError

Entries = tuple[si.IntArray, si.IntArray, si.FloatArray]
"""Rows, columns and values of entries of a matrix."""


def entries(rows: si.IntArray, block: si.FloatArray) -> Entries:
    """An element's matrix as entries; unknowns numbered −1 are held and left out."""
    keep = rows >= 0
    rows, block = rows[keep], block[np.ix_(keep, keep)]
    return np.repeat(rows, rows.size), np.tile(rows, rows.size), block.ravel()


def gathered(parts: list[Entries], size: int) -> sparse.csc_matrix:
    """The sum of all elements' entries, shape (size, size)."""
    row, column, values = (np.concatenate([part[k] for part in parts]) for k in range(3))
    return sparse.coo_matrix((values, (row, column)), shape=(size, size)).tocsc()


def shifted_inverse(
    matrix: sparse.csc_matrix, mass: sparse.csc_matrix, shift: float
) -> LinearOperator:
    """(K − `shift` M)⁻¹; unknowns of the matrix beyond those of the mass are potentials, which
    have none and carry no load."""
    n, size = mass.shape[0], matrix.shape[0]
    inertia = mass.tocoo()
    padded_mass = sparse.coo_matrix((inertia.data, (inertia.row, inertia.col)), shape=(size, size))
    factors = splu(
        (matrix - shift * padded_mass).tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    padded = np.zeros(size)

    def solve(b: si.FloatArray) -> si.FloatArray:
        padded[:n] = np.ravel(b)
        answer: si.FloatArray = factors.solve(padded)[:n]
        return answer

    return LinearOperator((n, n), matvec=solve, dtype=float)


def nearest_modes(
    matrix: sparse.csc_matrix,
    mass: sparse.csc_matrix,
    shift: float,
    count: int,
    name: str,
) -> tuple[si.FloatArray, si.FloatArray]:
    """The `count` ω² nearest to a shift, rising, and their vectors of unit modal mass.

    Raises `ConvergenceError`, which calls the modes by `name`.
    """
    try:
        squares, vectors = eigsh(
            mass,  # not used: OPinv holds the potential too
            k=count,
            M=mass,
            sigma=shift,
            OPinv=shifted_inverse(matrix, mass, shift),
            v0=np.random.default_rng(1).standard_normal(mass.shape[0]),
            tol=1e-11,
        )
    except (RuntimeError, ValueError) as error:  # ARPACK's and SuperLU's
        raise ConvergenceError(
            f"{name} did not converge ({error}); ask for fewer modes or another degree"
        ) from error
    order = np.argsort(squares)
    return squares[order], vectors[:, order]
