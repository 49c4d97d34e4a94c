"""Dense symmetric matrices eliminated by blocks: a part onto the rest, and the inner slices of an
element onto its ends.

LAPACK's triangular solves run at a third of the speed of matrix products on current cores; here
only diagonal blocks are inverted, and everything else is a product of tall matrices. Where parts
of the rows do not meet each other, each is eliminated with those it meets only (`LDLSteps`).

An element is its own mirror image along x: reflection turns u and takes node a to node p − a. The
sums and the differences of what mirrored nodes have (with that sign) do not meet in the stiffness
of a uniform element, so it falls into two matrices of half the size: a quarter of the work of
eliminating it in one. In each, what is inside one element along y meets nothing of another: those
are eliminated one by one, and what they share after them.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any, NamedTuple

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

    `W` (rows × pivots, unit block diagonal left out), `inverse` the inverted diagonal blocks.
    """

    pivots: int
    W: Matrix
    inverse: tuple[Matrix, ...]

    @property
    def negative(self) -> int:
        """The number of negative pivots: with what is left, A has as many negative eigenvalues
        (Sylvester's law of inertia)."""
        return sum(int(np.count_nonzero(np.linalg.eigvalsh(inv) < 0)) for inv in self.inverse)

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
        """The number of negative pivots."""
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


def partial_ldl(A: Matrix, pivots: int) -> tuple[PartialLDL, Matrix]:
    """Eliminate the first `pivots` rows and columns of a symmetric matrix (real or complex); the
    second result is the matrix that is left of the others, their Schur complement.

    Not pivoted between blocks: right for matrices whose leading blocks are regular, as those of
    stiffness with a shift and of potentials (quasi-definite) are but for accidents. Raises
    `ConvergenceError` for a singular block.
    """
    n = A.shape[0]
    raw = np.empty((n, pivots), dtype=A.dtype)
    W = np.empty((n, pivots), dtype=A.dtype)
    inverse = []
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
    return PartialLDL(pivots, W, tuple(inverse)), schur


class SliceMatrices(NamedTuple):
    """Matrices of an element of order p and any length: its slice's matrices (`P0` with the shift
    in it, as `cross_section` names them) and the integrals along x as `line_matrices` gives them;
    `signs` is −1 for the slice's u and 1 for all else. `groups` has for each of several elements
    along y the unknowns inside it, and those on its two sides."""

    P2: Matrix
    P1: Matrix
    P0: Matrix
    mass: Matrix
    slope: Matrix
    stiffness: Matrix
    signs: Matrix
    groups: tuple[tuple[si.IntArray, si.IntArray], ...]


@dataclass(frozen=True, eq=False)
class MirroredElement:
    """The inner slices of an element eliminated onto its two end slices.

    `halves` are the sums and the differences of mirrored slices, each with those of the ends last;
    `kept` says which unknowns of a middle slice (of an even order) belong to each.
    """

    order: int
    signs: Matrix
    halves: tuple[LDLSteps, LDLSteps]
    kept: tuple[Matrix, Matrix]

    @property
    def negative(self) -> int:
        """The number of negative pivots."""
        return sum(half.negative for half in self.halves)

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
        solutions = [
            half.backward(y, (first + sign * image) * np.sqrt(0.5))
            for sign, half, y in zip((1, -1), self.halves, reduced, strict=True)
        ]
        out = np.empty((order - 1, n, first.shape[1]), dtype=solutions[0].dtype)
        size = (pairs, n, first.shape[1])
        even, odd = (part[: pairs * n].reshape(size) * np.sqrt(0.5) for part in solutions)
        out[:pairs] = even + odd
        out[order - 1 - pairs :] = ((even - odd) * self.signs[:, None])[::-1]
        if order % 2 == 0:
            for part, kept in zip(solutions, self.kept, strict=True):
                out[pairs][kept] = part[pairs * n :]
        return out.reshape((order - 1) * n, first.shape[1])


def mirrored_element(made: SliceMatrices) -> tuple[MirroredElement, Matrix]:
    """Eliminate the inner slices of an element of uniform cross-section; the second result is the
    matrix that is left over the first and the last slice.

    Right for media that are their own mirror image along x: then P1 couples u with what is not u,
    and the other slice matrices u with u.
    """
    n, order = made.signs.size, made.mass.shape[0] - 1
    kept = np.flatnonzero(made.signs > 0), np.flatnonzero(made.signs < 0)
    plus, even = _half(made, 1, kept[0])
    minus, odd = _half(made, -1, kept[1])
    signs = made.signs
    schur = np.empty((2 * n, 2 * n), dtype=even.dtype)
    schur[:n, :n] = (even + odd) / 2
    schur[:n, n:] = (even - odd) / 2 * signs
    schur[n:, :n] = schur[:n, n:].T
    schur[n:, n:] = schur[:n, :n] * signs * signs[:, None]
    return MirroredElement(order, signs, (plus, minus), kept), schur


_Place = tuple[int, si.IntArray, si.IntArray]
"""A slice, some of its unknowns, and their rows in the matrix of a half."""


def _half(made: SliceMatrices, sign: int, own: si.IntArray) -> tuple[LDLSteps, Matrix]:
    """The inner slices' sums (`sign` 1) or differences (−1) eliminated: pairs, then the unknowns
    `own` of a middle slice. With the matrix that is left of the ends."""
    n, order = made.signs.size, made.mass.shape[0] - 1
    pairs, everything = (order - 1) // 2, np.arange(n)
    inner: list[_Place] = [(a, everything, everything + (a - 1) * n) for a in range(1, pairs + 1)]
    pivots = pairs * n
    if order % 2 == 0:
        inner.append((order // 2, own, pivots + np.arange(own.size)))
        pivots += own.size
    ends: _Place = (0, everything, pivots + everything)
    inside = np.zeros(n, dtype=bool)
    for group, _ in made.groups:
        inside[group] = True
    shared = [_part(place, ~inside) for place in inner]
    steps: list[tuple[Rows, Rows, PartialLDL]] = []
    # What the elements along y share, and the ends: eliminated last, and what is left.
    rows = np.concatenate([place[2] for place in (*shared, ends)])
    position = np.full(pivots + n, -1)
    position[rows] = np.arange(rows.size)
    rest = _matrix(made, sign, [*shared, ends], len(shared) + 1)
    for group, sides in made.groups if inner else ():
        chosen, beside = np.zeros((2, n), dtype=bool)
        chosen[group], beside[sides] = True, True
        first = [_part(place, chosen) for place in inner]
        later = [*(_part(place, beside) for place in inner), _part(ends, chosen | beside)]
        eliminated, met = (np.concatenate([p[2] for p in part]) for part in (first, later))
        if not eliminated.size:
            continue
        A = _matrix(made, sign, [*first, *later], len(first))
        ldl, left = partial_ldl(A, eliminated.size)
        rest[np.ix_(position[met], position[met])] += left
        steps.append((_rows(eliminated), _rows(met), ldl))
    if rows.size > n:
        ldl, rest = partial_ldl(rest, rows.size - n)
        steps.append((_rows(rows[:-n]), _rows(rows[-n:]), ldl))
    return LDLSteps(pivots, pivots + n, tuple(steps)), rest


def _rows(numbers: si.IntArray) -> Rows:
    """Rows that follow each other as a slice: taken without copying."""
    first, last = int(numbers[0]), int(numbers[-1])
    return slice(first, last + 1) if last - first == numbers.size - 1 else numbers


def _part(place: _Place, wanted: Matrix) -> _Place:
    """Place with those unknowns of it that are wanted (a truth value for each of the slice)."""
    a, unknowns, rows = place
    return a, unknowns[wanted[unknowns]], rows[wanted[unknowns]]


def _matrix(made: SliceMatrices, sign: int, places: list[_Place], filled: int) -> Matrix:
    """The half's matrix over the unknowns of places, one after the other: what the first `filled`
    of them have of all; what the others have of each other is left at 0."""
    stops = np.cumsum([0, *(place[1].size for place in places)])
    spans = [slice(a, b) for a, b in itertools.pairwise(stops.tolist())]
    order = made.mass.shape[0] - 1
    A = np.zeros((int(stops[-1]), int(stops[-1])), dtype=made.P0.dtype)
    for i, (a, some, _) in enumerate(places[:filled]):
        for k in range(i, len(places)):
            b, others, _ = places[k]
            block = _block(made, (a, some), (b, others), sign)
            # A middle slice is its own image: it stands once, not half and half.
            block *= np.sqrt(0.5) ** ((2 * a == order) + (2 * b == order))
            A[spans[i], spans[k]] = block
            if i != k:
                A[spans[k], spans[i]] = block.T
    return A


def _block(
    made: SliceMatrices, own: tuple[int, si.IntArray], other: tuple[int, si.IntArray], sign: int
) -> Matrix:
    """Block of unknowns of a slice with others of slice b and of b's image, with u turned in it."""
    (a, some), (b, others) = own, other
    image = made.mass.shape[0] - 1 - b
    turned = sign * made.signs[others]

    def factor(line: Matrix, i: int, j: int, k: int, m: int) -> Matrix:
        return np.asarray(line[i, j] + turned * line[k, m])

    def cut(matrix: Matrix) -> Matrix:
        every = some.size == others.size == made.signs.size
        return matrix if every else matrix[np.ix_(some, others)]

    out = cut(made.P0) * factor(made.mass, a, b, a, image)
    out += cut(made.P2) * factor(made.stiffness, a, b, a, image)
    out += cut(made.P1) * factor(made.slope, a, b, a, image)
    out += cut(made.P1.T) * factor(made.slope, b, a, image, a)
    return out
