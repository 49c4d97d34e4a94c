"""Modes of a row of slices near a shift σ, by block Krylov iteration with K − σM factorised.

The inner slices of each element are eliminated onto its two end slices; elements that are alike
share what comes of that, and are solved side by side. The chain of end slices that remains is
eliminated from left to right.
"""

from __future__ import annotations

import collections
import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.plate.elements.cross_section import code_parts
from squeezefilm.physics.plate.elements.elimination import (
    MirroredElement,
    PartialLDL,
    SliceMatrices,
    mirrored_element,
    partial_ldl,
)
from squeezefilm.physics.plate.elements.lobatto import LineMesh, line_matrices
from squeezefilm.physics.plate.elements.slabs import Slabs

Matrix = NDArray[Any]
Solve = Callable[[si.FloatArray], si.FloatArray]
_MOST_STEPS = 40
# Of a block's square: what two projections leave of what the basis holds.
_ROUNDING = 1e-26


@dataclass(frozen=True, eq=False)
class _Alike:
    """Elements that are alike: what eliminates their inner slices, and where the unknowns of these
    and of the two end slices stand, both of shape (unknowns, elements)."""

    element: MirroredElement
    inner: si.IntArray
    ends: si.IntArray


class SlabFactor:
    """(K − σM)⁻¹ of a discretised model, real for a real shift."""

    def __init__(self, slabs: Slabs, shift: float) -> None:
        self._slabs, self.shift = slabs, shift
        x = slabs.model.x
        made: dict[tuple[int, int, int], tuple[MirroredElement, Matrix]] = {}
        alike: dict[tuple[int, int, int], list[int]] = collections.defaultdict(list)
        left: list[Matrix] = []
        for e in range(x.elements):
            length = round((x.edges[e + 1] - x.edges[e]) * 1e12)
            # Sections that differ in the numbers of their ceramics only share their matrices.
            key = id(slabs.sections[e].P2), length, x.orders[e]
            if key not in made:
                made[key] = self._eliminated(e)
            alike[key].append(e)
            left.append(made[key][1])
        self._alike = [self._places(made[key][0], elements) for key, elements in alike.items()]
        self._chain(left)

    @property
    def modes_below(self) -> int:
        """Count the modes that lie below the shift, electrodes shorted (Sylvester's law of
        inertia)."""
        potentials = int(np.sum((self._slabs.components == 3) & ~self._slabs.held))
        inner: int = sum(some.element.negative * some.inner.shape[1] for some in self._alike)
        return inner + sum(link.negative for link in (*self._links, self._final)) - potentials

    def _eliminated(self, e: int) -> tuple[MirroredElement, Matrix]:
        """The inner slices of an element eliminated, and what is left over its end slices."""
        slabs, x = self._slabs, self._slabs.model.x
        section, length = slabs.sections[e], x.edges[e + 1] - x.edges[e]
        component, iy, _ = code_parts(slabs.model, section.codes)
        matrices = SliceMatrices(
            section.P2,
            section.P1,
            section.P0 - self.shift * section.R,
            *line_matrices(length, x.orders[e]),
            np.where(component == 0, -1.0, 1.0),
            tuple(
                (np.flatnonzero((iy > a) & (iy < b)), np.flatnonzero((iy == a) | (iy == b)))
                for a, b in itertools.pairwise(slabs.model.y.first_node)
                if slabs.model.y.elements > 1
            ),
        )
        return mirrored_element(matrices)

    def _places(self, element: MirroredElement, elements: list[int]) -> _Alike:
        first, offsets = self._slabs.model.x.first_node, self._slabs.offsets
        inner = [np.arange(offsets[first[e] + 1], offsets[first[e + 1]]) for e in elements]
        return _Alike(
            element, np.stack(inner, axis=1), np.stack([self._ends(e) for e in elements], axis=1)
        )

    def _ends(self, e: int) -> si.IntArray:
        """Where the unknowns of an element stand in its two end slices."""
        x, offsets = self._slabs.model.x, self._slabs.offsets
        first, last = x.first_node[e], x.first_node[e + 1]
        return np.concatenate(
            [
                offsets[first] + self._slabs.places(e, 0),
                offsets[last] + self._slabs.places(e, x.orders[e]),
            ]
        )

    def _chain(self, left: list[Matrix]) -> None:
        """Eliminate the end slices of all elements, with these matrices over them, from left to
        right."""
        slabs = self._slabs
        self._joints = [slice(*slabs.offsets[n : n + 2]) for n in slabs.model.x.first_node]
        self._links: list[PartialLDL] = []
        carried = np.zeros((0, 0))
        for e, (here, after) in enumerate(itertools.pairwise(self._joints)):
            n = here.stop - here.start
            # An end slice may have more unknowns than the element has in it.
            places = self._ends(e)
            places = np.where(places < here.stop, places - here.start, places - after.start + n)
            size = n + after.stop - after.start
            S = np.zeros((size, size), dtype=left[e].dtype)
            S[np.ix_(places, places)] = left[e]
            held = np.flatnonzero(np.concatenate([slabs.held[here], slabs.held[after]]))
            S[held, :] = S[:, held] = 0
            if e:
                S[:n, :n] += carried
            # A held unknown keeps its place in the slice: its row is that of the identity.
            own = held[held < n]
            S[own, own] = 1
            link, carried = partial_ldl(S, n)
            self._links.append(link)
        last = np.flatnonzero(slabs.held[self._joints[-1]])
        carried[last, last] = 1
        self._final, _ = partial_ldl(carried, carried.shape[0])

    def solve(self, right: Matrix) -> Matrix:
        """The solution for each column of `right`, shape (unknowns, vectors)."""
        x = np.array(right, dtype=np.result_type(right.dtype, self._final.W.dtype))
        held, vectors = self._slabs.held, x.shape[1]
        x[held] = 0
        kept = [self._forward(some, x) for some in self._alike]
        x[held] = 0
        pairs = list(itertools.pairwise(self._joints))
        for link, (here, after) in zip(self._links, pairs, strict=True):
            x[here], update = link.forward(x[here])
            x[after] -= update
        last = self._joints[-1]
        reduced, _ = self._final.forward(x[last])
        x[last] = self._final.backward(reduced, np.empty((0, vectors)))
        for link, (here, after) in zip(self._links[::-1], pairs[::-1], strict=True):
            x[here] = link.backward(x[here], x[after])
        for some, parts in zip(self._alike, kept, strict=True):
            if some.inner.size:
                outside = x[some.ends].reshape(len(some.ends), -1)
                inside = some.element.backward(parts, outside)
                x[some.inner] = inside.reshape(*some.inner.shape, vectors)
        return x

    @staticmethod
    def _forward(some: _Alike, x: Matrix) -> Any:
        """Carry right sides (in place) from inside elements to their ends; the reduced sides."""
        if not some.inner.size:
            return None
        reduced, update = some.element.forward(x[some.inner].reshape(len(some.inner), -1))
        update = update.reshape(*some.ends.shape, x.shape[1])
        for number, places in enumerate(some.ends.T):
            x[places] -= update[:, number]
        return reduced


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
