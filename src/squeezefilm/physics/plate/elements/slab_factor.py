"""K − σM of a row of slices, factorised by dense blocks; equal stretches of the plate only once.

The row is cut at the middle of every ceramic and of every gap into cells. The unknowns inside a
cell are eliminated onto its two end slices; a cell that repeats another, or its mirror image, is
the same dense matrix up to signs. The displays of this field repeat one ceramic many times, so
most of the work is done once. The remaining chain of end slices is eliminated from left to right.
"""

from __future__ import annotations

import collections
import functools
import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.physics.plate.elements.block_ldl import PartialLDL, partial_ldl
from squeezefilm.physics.plate.elements.cross_section import code_parts
from squeezefilm.physics.plate.elements.lobatto import line_matrices
from squeezefilm.physics.plate.elements.slab_cells import (
    Cell,
    Group,
    MirroredElement,
    Place,
    SliceMatrices,
    cut,
    mirrored_element,
    mirrors,
)
from squeezefilm.physics.plate.elements.slabs import Slabs, relabelled

Matrix = NDArray[Any]
_REPEATED = 3


class SlabFactor:
    """(K − σM)⁻¹ of a discretised model, real for a real shift.

    `count` also counts the modes below the shift, in `modes_below`.
    """

    def __init__(self, slabs: Slabs, shift: float, *, count: bool = False) -> None:
        self._slabs, self.shift, self._count = slabs, shift, count
        # Matrices that are needed on the way only: they would be half of all memory.
        self._dynamic: dict[int, Matrix] = {}
        self._bubbles: dict[Any, tuple[MirroredElement, Matrix]] = {}
        # Reflection along x turns u and nothing else.
        self._mirror_signs = np.where(slabs.components == 0, -1.0, 1.0)
        cells: dict[Any, tuple[Cell, Matrix]] = {}
        self._places: list[Place] = []
        ends: list[Matrix] = []
        for elements, repeated in self._stretches():
            forward, backward = self._key(elements), self._key(elements[::-1])
            mirrored = forward not in cells and backward in cells and mirrors(slabs, elements)
            key = backward if mirrored else forward
            if not repeated:
                # Its end slices may have more unknowns than its own: it is like no other.
                mirrored, key = False, tuple(elements)
            if key not in cells:
                cells[key] = self._cell(elements)
            first = slabs.model.x.first_node
            nodes = range(first[elements[0]], first[elements[-1] + 1] + 1)
            cell, left = cells[key]
            self._places.append(Place(cell, nodes[::-1] if mirrored else nodes, mirrored))
            ends.append(left)
        self._chain(ends)
        del self._dynamic, self._bubbles

    @property
    def modes_below(self) -> int:
        """Count the modes that lie below the shift (Sylvester's law of inertia)."""
        potentials = int(np.sum((self._slabs.components == 3) & ~self._slabs.held))
        return self._negative - potentials

    # -- factorisation ----------------------------------------------------------------------

    def _stretches(self) -> list[tuple[list[int], bool]]:
        """Cells that occur three times or more, and by themselves the elements of all others (and
        whether it is one of the former): to eliminate a stretch onto its two ends costs nearly
        three times what it costs to go through it from the left."""
        cells = cut(self._slabs)
        keys = [frozenset((self._key(cell), self._key(cell[::-1]))) for cell in cells]
        counts = collections.Counter(keys)
        out: list[tuple[list[int], bool]] = []
        for cell, key in zip(cells, keys, strict=True):
            repeated = counts[key] >= _REPEATED
            out.extend([(cell, True)] if repeated else [([e], False) for e in cell])
        return out

    def _key(self, elements: Sequence[int]) -> tuple[Any, ...]:
        model = self._slabs.model
        x = model.x
        ceramic = relabelled(model.ceramic[list(elements)]).tobytes()
        lengths = tuple(round((x.edges[e + 1] - x.edges[e]) * 1e12) for e in elements)
        return (
            tuple(self._slabs.patterns[e] for e in elements),
            ceramic,
            lengths,
            tuple(x.orders[e] for e in elements),
        )

    def _bubble(self, e: int) -> tuple[MirroredElement, Matrix]:
        slabs, x = self._slabs, self._slabs.model.x
        length, order = x.edges[e + 1] - x.edges[e], x.orders[e]
        section = slabs.sections[e]
        key = (slabs.patterns[e], id(section.P2), round(length * 1e12), order)
        if key in self._bubbles:
            return self._bubbles[key]
        if id(section) not in self._dynamic:
            self._dynamic[id(section)] = section.P0 - self.shift * section.R
        component, iy, _ = code_parts(slabs.model, section.codes)
        made = SliceMatrices(
            section.P2,
            section.P1,
            self._dynamic[id(section)],
            *line_matrices(length, order),
            np.where(component == 0, -1.0, 1.0),
            tuple(
                (np.flatnonzero((iy > a) & (iy < b)), np.flatnonzero((iy == a) | (iy == b)))
                for a, b in itertools.pairwise(slabs.model.y.first_node)
                if slabs.model.y.elements > 1
            ),
        )
        self._bubbles[key] = mirrored_element(made, count=self._count)
        return self._bubbles[key]

    def _ends(self, e: int, schur: Matrix) -> tuple[Matrix, int, tuple[Matrix, Matrix]]:
        """The end matrix of an element over all unknowns of its two end slices, how many of them
        the first has, and where those of the element stand in each; `schur` is over the latter."""
        slabs, x = self._slabs, self._slabs.model.x
        at = slabs.places(e, 0), slabs.places(e, x.orders[e])
        sizes = slabs.sizes[x.first_node[e]], slabs.sizes[x.first_node[e + 1]]
        out = schur
        if (at[0].size, at[1].size) != sizes:
            out = np.zeros((sum(sizes), sum(sizes)), dtype=schur.dtype)
            where = np.concatenate([at[0], sizes[0] + at[1]])
            out[np.ix_(where, where)] = schur
        return out, sizes[0], at

    def _cell(self, elements: Sequence[int]) -> tuple[Cell, Matrix]:
        """A stretch of elements, and the matrix that is left over its two end slices."""
        # Cells are always made in ascending order of x; mirrored ones reuse them.
        bubbles = [self._bubble(e) for e in elements]
        front, n0, first = self._ends(elements[0], bubbles[0][1])
        joints, places = [], [first]
        for e, (_, schur) in zip(elements[1:], bubbles[1:], strict=True):
            element, m0, at = self._ends(e, schur)
            places.append(at)
            m1 = element.shape[0] - m0
            A = np.zeros((m0 + n0 + m1, m0 + n0 + m1), dtype=front.dtype)
            order = np.concatenate([np.arange(m0, m0 + n0), np.arange(m0)])
            A[np.ix_(order, order)] = front
            ends = np.concatenate([np.arange(m0), np.arange(m0 + n0, A.shape[0])])
            A[np.ix_(ends, ends)] += element
            joint, front = partial_ldl(A, m0, count=self._count)
            joints.append(joint)
        stops = np.cumsum([0, *(self._slabs.model.x.orders[e] for e in elements)]).tolist()
        spans = tuple(itertools.pairwise(stops))
        inner = tuple(bubble for bubble, _ in bubbles)
        return Cell(inner, tuple(joints), spans, tuple(places)), front

    def _signs(self, node: int) -> Matrix:
        offsets = self._slabs.offsets
        return self._mirror_signs[offsets[node] : offsets[node + 1]]

    def _chain(self, ends: list[Matrix]) -> None:
        """Eliminate the end slices of all cells, with these matrices, from left to right."""
        self._negative = sum(place.cell.negative for place in self._places)
        self._links: list[PartialLDL] = []
        carried: Matrix | None = None
        for place, S in zip(self._places, ends, strict=True):
            left, right = place.left, place.right
            n = self._slabs.sizes[left]
            if place.mirrored:
                signs = np.concatenate([self._signs(right), self._signs(left)])
                swap = np.concatenate(
                    [np.arange(S.shape[0] - n, S.shape[0]), np.arange(S.shape[0] - n)]
                )
                S = (S * signs[:, None] * signs[None, :])[np.ix_(swap, swap)]
            else:
                S = S.copy()
            held = np.flatnonzero(self._held(left, right))
            S[held, :] = S[:, held] = 0
            if carried is not None:
                S[:n, :n] += carried
            # A held unknown keeps its place in the slice: its row is that of the identity.
            inside = held[held < n]
            S[inside, inside] = 1
            link, carried = partial_ldl(S, n, count=self._count)
            self._links.append(link)
        assert carried is not None
        last = np.flatnonzero(self._held(self._places[-1].right))
        carried[last, last] = 1
        self._final, _ = partial_ldl(carried, carried.shape[0], count=self._count)
        self._negative += sum(link.negative for link in (*self._links, self._final))

    def _held(self, *nodes: int) -> Matrix:
        offsets = self._slabs.offsets
        return np.concatenate([self._slabs.held[offsets[n] : offsets[n + 1]] for n in nodes])

    # -- solution ---------------------------------------------------------------------------

    @functools.cached_property
    def _groups(self) -> list[Group]:
        """Places that share a cell: they are solved as one block of right sides."""
        found: dict[int, list[Place]] = {}
        for place in self._places:
            found.setdefault(id(place.cell), []).append(place)
        return [self._group(places) for places in found.values()]

    def _group(self, places: list[Place]) -> Group:
        offsets, sizes = self._slabs.offsets, self._slabs.sizes
        at = np.stack(
            [
                np.concatenate([np.arange(offsets[n], offsets[n + 1]) for n in place.nodes])
                for place in places
            ],
            axis=1,
        )
        signs = np.stack(
            [
                self._mirror_signs[at[:, k]] if place.mirrored else np.ones(at.shape[0])
                for k, place in enumerate(places)
            ],
            axis=1,
        )
        stops = np.cumsum([0, *(sizes[n] for n in places[0].nodes)]).tolist()
        return Group(places[0].cell, at, signs[:, :, None], stops)

    def solve(self, right: Matrix) -> Matrix:
        """The solution for each column of `right`, shape (unknowns, vectors)."""
        offsets = self._slabs.offsets
        x = np.array(right, dtype=np.result_type(right.dtype, self._final.W.dtype))
        x[self._slabs.held] = 0
        vectors = right.shape[1]
        blocks = [self._gathered(group, x) for group in self._groups]
        kept = [
            self._forward(group, block) for group, block in zip(self._groups, blocks, strict=True)
        ]
        for group, block in zip(self._groups, blocks, strict=True):
            for ends in group.ends:
                carried = block[ends].reshape(-1, group.count, vectors) * group.signs[ends]
                for number in range(group.count):
                    x[group.at[ends, number]] += carried[:, number]
        for node in (0, len(offsets) - 2):
            x[offsets[node] : offsets[node + 1]][self._held(node)] = 0
        for place, link in zip(self._places, self._links, strict=True):
            left, after = self._slice(place.left), self._slice(place.right)
            x[left], update = link.forward(x[left])
            x[after] -= update
        last = self._slice(self._places[-1].right)
        reduced, _ = self._final.forward(x[last])
        x[last] = self._final.backward(reduced, np.empty((0, vectors)))
        for place, link in zip(self._places[::-1], self._links[::-1], strict=True):
            left, after = self._slice(place.left), self._slice(place.right)
            x[left] = link.backward(x[left], x[after])
        for group, block, parts in zip(self._groups, blocks, kept, strict=True):
            self._finish(group, x, block, parts)
        return x

    def _slice(self, node: int) -> slice:
        return slice(self._slabs.offsets[node], self._slabs.offsets[node + 1])

    def _gathered(self, group: Group, x: Matrix) -> Matrix:
        """The right sides of all places of one cell, side by side with the signs of the cell (u
        changes its sign in a mirrored one); none at the end slices."""
        block = np.asarray((x[group.at] * group.signs).reshape(group.at.shape[0], -1))
        for ends in group.ends:
            block[ends] = 0
        return block

    def _forward(self, group: Group, block: Matrix) -> list[Any]:
        """Carry right sides inside a cell to its ends (in place); returns the reduced sides."""
        cell, node = group.cell, group.node
        kept: list[Any] = []
        for k, (bubble, (start, stop)) in enumerate(zip(cell.bubbles, cell.spans, strict=True)):
            if stop - start == 1:
                kept.append(None)
                continue
            reduced, update = bubble.forward(block[group.inside(start, stop)])
            kept.append(reduced)
            at0, at1 = cell.at[k]
            block[node(start)][at0] -= update[: at0.size]
            block[node(stop)][at1] -= update[at0.size :]
        first = node(0)
        for k, joint in enumerate(cell.joints):
            middle, after = node(cell.spans[k][1]), node(cell.spans[k + 1][1])
            block[middle], update = joint.forward(block[middle])
            block[first] -= update[: first.stop]
            block[after] -= update[first.stop :]
        return kept

    def _finish(self, group: Group, x: Matrix, block: Matrix, kept: list[Any]) -> None:
        """Solve inside the cells, their end slices being known."""
        cell, node = group.cell, group.node
        for ends in group.ends:
            block[ends] = (x[group.at[ends]] * group.signs[ends]).reshape(-1, block.shape[1])
        for k in range(len(cell.joints) - 1, -1, -1):
            middle, after = node(cell.spans[k][1]), node(cell.spans[k + 1][1])
            outside = np.concatenate([block[node(0)], block[after]])
            block[middle] = cell.joints[k].backward(block[middle], outside)
        for k, (start, stop) in enumerate(cell.spans):
            if stop - start == 1:
                continue
            at0, at1 = cell.at[k]
            outside = np.concatenate([block[node(start)][at0], block[node(stop)][at1]])
            block[group.inside(start, stop)] = cell.bubbles[k].backward(kept[k], outside)
        inner = slice(group.ends[0].stop, group.ends[1].start)
        vectors = x.shape[1]
        x[group.at[inner]] = block[inner].reshape(-1, group.count, vectors) * group.signs[inner]
