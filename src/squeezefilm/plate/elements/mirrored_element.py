"""An element's inner slices eliminated by halves: it is its own mirror image along x.

Reflection along x turns u and takes node a to node p − a. The sums and the differences of what
mirrored nodes have (with that sign) do not meet in the stiffness of a uniform element, so it falls
into two matrices of half the size: a quarter of the work of eliminating it in one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from squeezefilm.plate.elements.block_ldl import PartialLDL, partial_ldl

Matrix = NDArray[Any]


class SliceMatrices(NamedTuple):
    """What an element of order p and any length is made of: its slice's matrices (`P0` with the
    shift in it, as `cross_section` names them) and the integrals along x as `line_matrices` gives
    them; `signs` is −1 for the slice's u and 1 for all else."""

    P2: Matrix
    P1: Matrix
    P0: Matrix
    mass: Matrix
    slope: Matrix
    stiffness: Matrix
    signs: Matrix


@dataclass(frozen=True, eq=False)
class MirroredElement:
    """The inner slices of an element eliminated onto its two end slices.

    `halves` are the sums and the differences of mirrored slices, each with those of the ends last;
    `kept` says which unknowns of a middle slice (of an even order) belong to each. `schur` is the
    remaining matrix over the first and the last slice, `negative` the number of negative pivots if
    counted.
    """

    order: int
    signs: Matrix
    halves: tuple[PartialLDL, PartialLDL]
    kept: tuple[Matrix, Matrix]
    schur: Matrix
    negative: int

    def forward(self, inside: Matrix) -> tuple[tuple[Matrix, Matrix], Matrix]:
        """The reduced right sides of both halves, and what to subtract from that of the ends."""
        n, order = self.signs.size, self.order
        slices = inside.reshape(order - 1, n, inside.shape[1])
        # The mirror image of an inner slice, with u turned.
        image = slices[::-1] * self.signs[:, None]
        pairs, reduced, updates = (order - 1) // 2, [], []
        size = (pairs * n, inside.shape[1])
        for sign, half, kept in zip((1, -1), self.halves, self.kept, strict=True):
            part = (slices[:pairs] + sign * image[:pairs]).reshape(size) * np.sqrt(0.5)
            if order % 2 == 0:
                part = np.concatenate([part, slices[pairs][kept]])
            y, update = half.forward(part)
            reduced.append(y)
            updates.append(update * np.sqrt(0.5))
        both, differ = updates[0] + updates[1], updates[0] - updates[1]
        return (reduced[0], reduced[1]), np.concatenate([both, self.signs[:, None] * differ])

    def backward(self, reduced: tuple[Matrix, Matrix], outside: Matrix) -> Matrix:
        """The solution in the inner slices, given `forward`'s reduced sides and the solution at the
        first and the last slice."""
        n, order = self.signs.size, self.order
        first, image = outside[:n], self.signs[:, None] * outside[n:]
        pairs = (order - 1) // 2
        found = [
            half.backward(y, (first + sign * image) * np.sqrt(0.5))
            for sign, half, y in zip((1, -1), self.halves, reduced, strict=True)
        ]
        out = np.empty((order - 1, n, first.shape[1]), dtype=found[0].dtype)
        size = (pairs, n, first.shape[1])
        even, odd = (part[: pairs * n].reshape(size) * np.sqrt(0.5) for part in found)
        out[:pairs] = even + odd
        out[order - 1 - pairs :] = ((even - odd) * self.signs[:, None])[::-1]
        if order % 2 == 0:
            for part, kept in zip(found, self.kept, strict=True):
                out[pairs][kept] = part[pairs * n :]
        return out.reshape((order - 1) * n, first.shape[1])


def mirrored_element(made: SliceMatrices, *, count: bool = False) -> MirroredElement:
    """Eliminate the inner slices of an element of uniform cross-section.

    Right for media that are their own mirror image along x: then P1 couples u with what is not u,
    and the other slice matrices u with u. `count` counts negative pivots.
    """
    n, order = made.signs.size, made.mass.shape[0] - 1
    kept = np.flatnonzero(made.signs > 0), np.flatnonzero(made.signs < 0)
    halves = []
    for sign, own in zip((1, -1), kept, strict=True):
        A = _half(made, sign, own)
        halves.append(partial_ldl(A, A.shape[0] - n, count=count))
    even, odd = (half.schur for half in halves)
    signs = made.signs
    schur = np.empty((2 * n, 2 * n), dtype=even.dtype)
    schur[:n, :n] = (even + odd) / 2
    schur[:n, n:] = (even - odd) / 2 * signs
    schur[n:, :n] = schur[:n, n:].T
    schur[n:, n:] = schur[:n, :n] * signs * signs[:, None]
    negative = sum(half.negative for half in halves)
    return MirroredElement(order, signs, (halves[0], halves[1]), kept, schur, negative)


def _half(made: SliceMatrices, sign: int, own: Matrix) -> Matrix:
    """The element's matrix over the sums (`sign` 1) or differences (−1) of mirrored slices: inner
    pairs, then the unknowns `own` of the middle slice, then the ends."""
    n, order = made.signs.size, made.mass.shape[0] - 1
    pairs = (order - 1) // 2
    middle = order // 2 if order % 2 == 0 else None
    places = [(a, slice((a - 1) * n, a * n)) for a in range(1, pairs + 1)]
    start = pairs * n
    if middle is not None:
        places.append((middle, slice(start, start + own.size)))
        start += own.size
    places.append((0, slice(start, start + n)))
    A = np.empty((start + n, start + n), dtype=made.P0.dtype)
    for i, (a, rows) in enumerate(places):
        for b, columns in places[i:]:
            block = _block(made, a, b, sign)
            # A middle slice is its own image: it stands once, not half and half.
            if b == middle:
                block = block[:, own] * np.sqrt(0.5)
            if a == middle:
                block = block[own] * np.sqrt(0.5)
            A[rows, columns] = block
            if a != b:
                A[columns, rows] = block.T
    return A


def _block(made: SliceMatrices, a: int, b: int, sign: int) -> Matrix:
    """What slice a has of slice b and of b's image, with u turned in it."""
    image = made.mass.shape[0] - 1 - b
    turned = sign * made.signs

    def factor(line: Matrix, i: int, j: int, k: int, m: int) -> Matrix:
        return np.asarray(line[i, j] + turned * line[k, m])

    out = made.P0 * factor(made.mass, a, b, a, image)
    out += made.P2 * factor(made.stiffness, a, b, a, image)
    out += made.P1 * factor(made.slope, a, b, a, image)
    out += made.P1.T * factor(made.slope, b, a, image, a)
    return out
