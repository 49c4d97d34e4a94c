"""Part of a dense symmetric matrix eliminated onto the rest, by blocks and mostly in `gemm`.

LAPACK's triangular solves run at a third of the speed of matrix products on current cores; here
only diagonal blocks are inverted, and everything else is a product of tall matrices. Where parts
of the rows do not meet each other, each is eliminated with those it meets only (`LDLSteps`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError

Matrix = NDArray[Any]
# Measured on slices of 100 to 400 unknowns.
_BLOCK = 64
_SCHUR_BLOCK = 128


@dataclass(frozen=True, eq=False)
class PartialLDL:
    """A = W D Wᵀ for the first `pivots` rows of a symmetric matrix.

    `W` (rows × pivots, unit block diagonal left out), `inverse` the inverted diagonal blocks,
    `negative` the number of negative pivots if counted.
    """

    pivots: int
    W: Matrix
    inverse: tuple[Matrix, ...]
    negative: int

    def forward(self, inside: Matrix) -> tuple[Matrix, Matrix]:
        """The reduced right side of the pivots, and what to subtract from that of the rest."""
        m, W = self.pivots, self.W
        y = np.array(inside)
        for k in range(_BLOCK, m, _BLOCK):
            y[k : k + _BLOCK] -= W[k : min(k + _BLOCK, m), :k] @ y[:k]
        return y, W[m:] @ y

    def backward(self, reduced: Matrix, outside: Matrix) -> Matrix:
        """The solution at the pivots, given `forward`'s reduced side and the rest's solution."""
        m, W = self.pivots, self.W
        x = np.concatenate(
            [inv @ reduced[i * _BLOCK : (i + 1) * _BLOCK] for i, inv in enumerate(self.inverse)]
        )
        if outside.size:
            x -= W[m:].T @ outside
        for k in range((m - 1) // _BLOCK * _BLOCK, 0, -_BLOCK):
            x[:k] -= W[k : min(k + _BLOCK, m), :k].T @ x[k : k + _BLOCK]
        return x


Rows = si.IntArray | slice
"""Numbers of rows of a matrix."""


@dataclass(frozen=True, eq=False)
class LDLSteps:
    """The first `pivots` of `size` rows of a symmetric matrix, eliminated in steps.

    A step is which rows it eliminates, which later rows they meet, and how. `forward` and
    `backward` are those of `PartialLDL`.
    """

    pivots: int
    size: int
    steps: tuple[tuple[Rows, Rows, PartialLDL], ...]

    @property
    def negative(self) -> int:
        """The number of negative pivots, if counted."""
        return sum(ldl.negative for _, _, ldl in self.steps)

    def forward(self, inside: Matrix) -> tuple[Matrix, Matrix]:
        """The reduced right side of the pivots, and what to subtract from that of the rest."""
        full = np.zeros((self.size, inside.shape[1]), dtype=inside.dtype)
        full[: self.pivots] = inside
        for own, met, ldl in self.steps:
            reduced, update = ldl.forward(full[own])
            full = full.astype(reduced.dtype, copy=False)
            full[own] = reduced
            full[met] -= update
        return full[: self.pivots], -full[self.pivots :]

    def backward(self, reduced: Matrix, outside: Matrix) -> Matrix:
        """The solution at the pivots, given `forward`'s reduced side and the rest's solution."""
        full = np.concatenate([reduced, outside])
        for own, met, ldl in self.steps[::-1]:
            full[own] = ldl.backward(full[own], full[met])
        return full[: self.pivots]


def partial_ldl(A: Matrix, pivots: int, *, count: bool = False) -> tuple[PartialLDL, Matrix]:
    """Eliminate the first `pivots` rows and columns of a symmetric matrix (real or complex); the
    second result is the matrix that is left of the others, their Schur complement.

    Not pivoted between blocks: right for matrices whose leading blocks are regular, as those of
    stiffness with a shift and of potentials (quasi-definite) are but for accidents. Raises
    `ConvergenceError` for a singular block.
    """
    n = A.shape[0]
    raw = np.empty((n, pivots), dtype=A.dtype)
    W = np.empty((n, pivots), dtype=A.dtype)
    inverse, negative = [], 0
    for k in range(0, pivots, _BLOCK):
        e = min(k + _BLOCK, pivots)
        # Products go where they stay: fresh memory for each costs as much as the product.
        panel = raw[k:, k:e]
        if k:
            np.matmul(raw[k:, :k], W[k:e, :k].T, out=panel)
            np.subtract(A[k:, k:e], panel, out=panel)
        else:
            panel[...] = A[:, :e]
        block = (panel[: e - k] + panel[: e - k].T) / 2
        try:
            inverted = np.linalg.inv(block)
        except np.linalg.LinAlgError as error:
            raise ConvergenceError(
                "the shifted stiffness matrix is singular: the shift hits a mode exactly; ask for "
                "a frequency a little beside it"
            ) from error
        if count:
            # Sylvester's law of inertia: pivot blocks and what is left together have as many as A.
            negative += int(np.count_nonzero(np.linalg.eigvalsh(block) < 0))
        inverse.append(inverted)
        np.matmul(panel, inverted, out=W[k:, k:e])
    r = n - pivots
    schur = np.empty((r, r), dtype=A.dtype)
    left, right, rest = raw[pivots:], W[pivots:], A[pivots:, pivots:]
    for j in range(0, r, _SCHUR_BLOCK):
        e = min(j + _SCHUR_BLOCK, r)
        part = schur[j:, j:e]
        np.matmul(left[j:], right[j:e].T, out=part)
        np.subtract(rest[j:, j:e], part, out=part)
        schur[j:e, e:] = part[e - j :].T
    return PartialLDL(pivots, W, tuple(inverse), negative), schur
