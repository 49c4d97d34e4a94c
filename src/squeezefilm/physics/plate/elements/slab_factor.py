"""K − σM of a row of slices, factorised by dense blocks.

The inner slices of each element are eliminated onto its two end slices; elements that are alike
share what comes of that, and are solved side by side. The chain of end slices that remains is
eliminated from left to right.
"""

from __future__ import annotations

import collections
import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.elements.cross_section import code_parts
from squeezefilm.physics.plate.elements.elimination import (
    MirroredElement,
    PartialLDL,
    SliceMatrices,
    mirrored_element,
    partial_ldl,
)
from squeezefilm.physics.plate.elements.lobatto import line_matrices
from squeezefilm.physics.plate.elements.slabs import Slabs

Matrix = NDArray[Any]


@dataclass(frozen=True, eq=False)
class _Alike:
    """Elements that are alike: what eliminates their inner slices, and where the unknowns of these
    and of the two end slices stand, both of shape (unknowns, elements)."""

    element: MirroredElement
    inner: si.IntArray
    ends: si.IntArray


class SlabFactor:
    """(K − σM)⁻¹ of a discretised model, real for a real shift.

    `count` also counts the modes below the shift, in `modes_below`.
    """

    def __init__(self, slabs: Slabs, shift: float, *, count: bool = False) -> None:
        self._slabs, self.shift, self._count = slabs, shift, count
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
        inner: int = sum(some.element.negative * some.inner.shape[1] for some in self._alike)
        self._negative = inner + sum(link.negative for link in (*self._links, self._final))

    @property
    def modes_below(self) -> int:
        """Count the modes that lie below the shift (Sylvester's law of inertia)."""
        potentials = int(np.sum((self._slabs.components == 3) & ~self._slabs.held))
        return self._negative - potentials

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
        return mirrored_element(matrices, count=self._count)

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
            link, carried = partial_ldl(S, n, count=self._count)
            self._links.append(link)
        last = np.flatnonzero(slabs.held[self._joints[-1]])
        carried[last, last] = 1
        self._final, _ = partial_ldl(carried, carried.shape[0], count=self._count)

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
