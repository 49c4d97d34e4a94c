"""K − σM of a row of slices, factorised by dense blocks; equal stretches of the plate only once.

The row is cut at the middle of every ceramic and of every gap into cells. The unknowns inside a
cell are eliminated onto its two end slices; a cell that repeats another, or its mirror image, is
the same dense matrix up to signs. The displays of this field repeat one ceramic many times, so
most of the work is done once. The remaining chain of end slices is eliminated from left to right.
"""

from __future__ import annotations

import collections
import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.plate.elements.block_ldl import PartialLDL, partial_ldl
from squeezefilm.plate.elements.cross_section import code_parts
from squeezefilm.plate.elements.lobatto import line_matrices
from squeezefilm.plate.elements.mirrored_element import (
    MirroredElement,
    SliceMatrices,
    mirrored_element,
)
from squeezefilm.plate.elements.slabs import Slabs, relabelled

Matrix = NDArray[Any]
_REPEATED = 3


@dataclass(frozen=True, eq=False)
class _Cell:
    """A stretch of elements eliminated onto its end slices.

    `bubbles[k]` eliminates the inner slices of its k-th element onto its two end slices;
    `joints[k]` the slice between elements k and k + 1 onto the first slice and slice k + 2.
    `spans[k]` are the first and the last slice of an element, counted within the cell, `at[k]`
    where its unknowns stand in these two.
    """

    bubbles: tuple[MirroredElement, ...]
    joints: tuple[PartialLDL, ...]
    spans: tuple[tuple[int, int], ...]
    at: tuple[tuple[Matrix, Matrix], ...]
    ends: Matrix
    negative: int


@dataclass(frozen=True, eq=False)
class _Place:
    """Where a cell stands: its slices in the order of the cell, mirrored or not."""

    cell: _Cell
    nodes: range
    mirrored: bool

    @property
    def left(self) -> int:
        """The first of its slices along x."""
        return min(self.nodes)

    @property
    def right(self) -> int:
        """The last of its slices along x."""
        return max(self.nodes)


class SlabFactor:
    """(K − σM)⁻¹ of a discretised model, real for a real shift.

    `count` also counts the modes below the shift, in `modes_below`.
    """

    def __init__(self, slabs: Slabs, shift: float, *, count: bool = False) -> None:
        self._slabs, self.shift, self._count = slabs, shift, count
        self._dynamic: dict[int, Matrix] = {}
        self._bubbles: dict[Any, MirroredElement] = {}
        # Reflection along x turns u and nothing else.
        self._mirror_signs = np.where(slabs.components == 0, -1.0, 1.0)
        cells: dict[Any, _Cell] = {}
        self._places: list[_Place] = []
        for elements, repeated in self._stretches():
            forward, backward = self._key(elements), self._key(elements[::-1])
            mirrored = forward not in cells and backward in cells and _mirrors(slabs, elements)
            key = backward if mirrored else forward
            if not repeated:
                # Its end slices may have more unknowns than its own: it is like no other.
                mirrored, key = False, tuple(elements)
            if key not in cells:
                cells[key] = self._cell(elements)
            first = slabs.model.x.first_node
            nodes = range(first[elements[0]], first[elements[-1] + 1] + 1)
            self._places.append(_Place(cells[key], nodes[::-1] if mirrored else nodes, mirrored))
        self._chain()

    @property
    def modes_below(self) -> int:
        """How many modes lie below the shift (Sylvester's law of inertia)."""
        potentials = int(np.sum((self._slabs.components == 3) & ~self._slabs.held))
        return self._negative - potentials

    # -- factorisation ----------------------------------------------------------------------

    def _stretches(self) -> list[tuple[list[int], bool]]:
        """Cells that occur three times or more, and by themselves the elements of all others (and
        whether it is one of the former): to eliminate a stretch onto its two ends costs nearly
        three times what it costs to go through it from the left."""
        cells = _cut(self._slabs)
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

    def _bubble(self, e: int) -> MirroredElement:
        slabs, x = self._slabs, self._slabs.model.x
        length, order = x.edges[e + 1] - x.edges[e], x.orders[e]
        section = slabs.sections[e]
        key = (slabs.patterns[e], id(section.P2), round(length * 1e12), order)
        if key in self._bubbles:
            return self._bubbles[key]
        if id(section) not in self._dynamic:
            self._dynamic[id(section)] = section.P0 - self.shift * section.R
        made = SliceMatrices(
            section.P2,
            section.P1,
            self._dynamic[id(section)],
            *line_matrices(length, order),
            np.where(code_parts(slabs.model, section.codes)[0] == 0, -1.0, 1.0),
        )
        self._bubbles[key] = mirrored_element(made, count=self._count)
        return self._bubbles[key]

    def _ends(self, e: int, bubble: MirroredElement) -> tuple[Matrix, int, tuple[Matrix, Matrix]]:
        """The end matrix of an element over all unknowns of its two end slices, how many of them
        the first has, and where those of the element stand in each."""
        slabs, x = self._slabs, self._slabs.model.x
        at = slabs.places(e, 0), slabs.places(e, x.orders[e])
        sizes = slabs.sizes[x.first_node[e]], slabs.sizes[x.first_node[e + 1]]
        out = bubble.schur
        if (at[0].size, at[1].size) != sizes:
            out = np.zeros((sum(sizes), sum(sizes)), dtype=bubble.schur.dtype)
            where = np.concatenate([at[0], sizes[0] + at[1]])
            out[np.ix_(where, where)] = bubble.schur
        return out, sizes[0], at

    def _cell(self, elements: Sequence[int]) -> _Cell:
        # Cells are always made in ascending order of x; mirrored ones reuse them.
        bubbles = tuple(self._bubble(e) for e in elements)
        front, n0, first = self._ends(elements[0], bubbles[0])
        joints, places = [], [first]
        for e, bubble in zip(elements[1:], bubbles[1:], strict=True):
            element, m0, at = self._ends(e, bubble)
            places.append(at)
            m1 = element.shape[0] - m0
            A = np.zeros((m0 + n0 + m1, m0 + n0 + m1), dtype=front.dtype)
            order = np.concatenate([np.arange(m0, m0 + n0), np.arange(m0)])
            A[np.ix_(order, order)] = front
            ends = np.concatenate([np.arange(m0), np.arange(m0 + n0, A.shape[0])])
            A[np.ix_(ends, ends)] += element
            joint = partial_ldl(A, m0, count=self._count)
            joints.append(joint)
            front = joint.schur
        negative = sum(one.negative for one in bubbles) + sum(one.negative for one in joints)
        stops = np.cumsum([0, *(self._slabs.model.x.orders[e] for e in elements)]).tolist()
        spans = tuple(itertools.pairwise(stops))
        return _Cell(bubbles, tuple(joints), spans, tuple(places), front, negative)

    def _signs(self, node: int) -> Matrix:
        offsets = self._slabs.offsets
        return self._mirror_signs[offsets[node] : offsets[node + 1]]

    def _chain(self) -> None:
        """Eliminate the end slices of all cells from left to right."""
        self._negative = sum(place.cell.negative for place in self._places)
        self._links: list[PartialLDL] = []
        carried: Matrix | None = None
        for place in self._places:
            S = place.cell.ends
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
            link = partial_ldl(S, n, count=self._count)
            self._links.append(link)
            carried = link.schur
        assert carried is not None
        last = np.flatnonzero(self._held(self._places[-1].right))
        carried[last, last] = 1
        self._final = partial_ldl(carried, carried.shape[0], count=self._count)
        self._negative += sum(link.negative for link in (*self._links, self._final))

    def _held(self, *nodes: int) -> Matrix:
        offsets = self._slabs.offsets
        return np.concatenate([self._slabs.held[offsets[n] : offsets[n + 1]] for n in nodes])

    # -- solution ---------------------------------------------------------------------------

    def solve(self, right: Matrix) -> Matrix:
        """The solution for each column of `right`, shape (unknowns, vectors)."""
        offsets = self._slabs.offsets
        right = np.where(self._slabs.held[:, None], 0, right)
        slices = [
            np.array(right[a:b], dtype=self._dtype(right)) for a, b in itertools.pairwise(offsets)
        ]
        vectors = right.shape[1]
        groups: dict[int, list[_Place]] = {}
        for place in self._places:
            groups.setdefault(id(place.cell), []).append(place)
        # Places that share a cell are solved as one block of right sides.
        blocks = [self._gathered(group, slices) for group in groups.values()]
        kept = [
            self._forward(group[0].cell, block)
            for group, block in zip(groups.values(), blocks, strict=True)
        ]
        for group, block in zip(groups.values(), blocks, strict=True):
            for number, place in enumerate(group):
                columns = slice(number * vectors, (number + 1) * vectors)
                for at in (0, -1):
                    node = place.nodes[at]
                    slices[node] += self._signed(place, node, block[at][:, columns])
        for node in (0, len(slices) - 1):
            slices[node][self._held(node)] = 0
        for place, link in zip(self._places, self._links, strict=True):
            slices[place.left], update = link.forward(slices[place.left])
            slices[place.right] -= update
        last = self._places[-1].right
        reduced, _ = self._final.forward(slices[last])
        slices[last] = self._final.backward(reduced, np.empty((0, vectors)))
        for place, link in zip(self._places[::-1], self._links[::-1], strict=True):
            slices[place.left] = link.backward(slices[place.left], slices[place.right])
        for group, block, parts in zip(groups.values(), blocks, kept, strict=True):
            self._finish(group, slices, block, parts)
        return np.concatenate(slices)

    def _dtype(self, right: Matrix) -> Any:
        return np.result_type(right.dtype, self._final.W.dtype)

    def _signed(self, place: _Place, node: int, values: Matrix) -> Matrix:
        """To or from the signs of a mirrored cell (u changes its sign)."""
        return values * self._signs(node)[:, None] if place.mirrored else values

    def _side_by_side(self, group: list[_Place], slices: list[Matrix], at: int) -> Matrix:
        """What all places of one cell have in its slice `at`, with the signs of the cell."""
        parts = [self._signed(one, one.nodes[at], slices[one.nodes[at]]) for one in group]
        return np.concatenate(parts, axis=1)

    def _gathered(self, group: list[_Place], slices: list[Matrix]) -> list[Matrix]:
        """The right sides of all places of one cell, side by side; none at the end slices."""
        block = [self._side_by_side(group, slices, k) for k in range(len(group[0].nodes))]
        block[0], block[-1] = np.zeros_like(block[0]), np.zeros_like(block[-1])
        return block

    def _forward(self, cell: _Cell, block: list[Matrix]) -> list[Any]:
        """Carry right sides inside a cell to its ends (in place); returns the reduced sides."""
        spans = cell.spans
        kept: list[Any] = []
        for k, (bubble, (start, stop)) in enumerate(zip(cell.bubbles, spans, strict=True)):
            if stop - start == 1:
                kept.append(None)
                continue
            reduced, update = bubble.forward(np.concatenate(block[start + 1 : stop]))
            kept.append(reduced)
            at0, at1 = cell.at[k]
            block[start][at0] -= update[: at0.size]
            block[stop][at1] -= update[at0.size :]
        n0 = block[0].shape[0]
        for k, joint in enumerate(cell.joints):
            middle, after = spans[k][1], spans[k + 1][1]
            block[middle], update = joint.forward(block[middle])
            block[0] -= update[:n0]
            block[after] -= update[n0:]
        return kept

    def _finish(
        self, group: list[_Place], slices: list[Matrix], block: list[Matrix], kept: list[Any]
    ) -> None:
        """Solve inside the cells, their end slices being known."""
        cell, spans = group[0].cell, group[0].cell.spans
        for at in (0, -1):
            block[at] = self._side_by_side(group, slices, at)
        for k in range(len(cell.joints) - 1, -1, -1):
            middle, after = spans[k][1], spans[k + 1][1]
            ends = np.concatenate([block[0], block[after]])
            block[middle] = cell.joints[k].backward(block[middle], ends)
        for k, (start, stop) in enumerate(spans):
            if stop - start == 1:
                continue
            at0, at1 = cell.at[k]
            ends = np.concatenate([block[start][at0], block[stop][at1]])
            inside = cell.bubbles[k].backward(kept[k], ends)
            block[start + 1 : stop] = np.split(inside, stop - start - 1)
        vectors = block[0].shape[1] // len(group)
        for number, place in enumerate(group):
            columns = slice(number * vectors, (number + 1) * vectors)
            for node, part in zip(place.nodes[1:-1], block[1:-1], strict=True):
                slices[node] = self._signed(place, node, part[:, columns])


def _cut(slabs: Slabs) -> list[list[int]]:
    """Elements grouped into cells: cut at the middle of each stretch of one pattern."""
    model = slabs.model
    elements = model.x.elements
    keys = [slabs.patterns[e] + model.ceramic[e].tobytes() for e in range(elements)]
    runs: list[list[int]] = []
    for e in range(elements):
        if runs and keys[e] == keys[runs[-1][-1]]:
            runs[-1].append(e)
        else:
            runs.append([e])
    cells: list[list[int]] = [[]]
    for number, run in enumerate(runs):
        # Half of a stretch goes to the cell before, half to the cell after; a stretch at an end
        # of the plate is cut too, if it has a middle.
        edges = [model.x.edges[e] for e in (*run, run[-1] + 1)]
        middle = (edges[0] + edges[-1]) / 2
        at = int(np.argmin(np.abs(np.array(edges) - middle)))
        cuttable = len(run) > 1 and abs(edges[at] - middle) < 1e-9
        symmetric_end = (number == 0 and model.ends[0] != "free") or (
            number == len(runs) - 1 and model.ends[1] != "free"
        )
        if not cuttable or symmetric_end:
            cells[-1].extend(run)
            continue
        cells[-1].extend(run[:at])
        cells.append(list(run[at:]))
    return [cell for cell in cells if cell]


def _mirrors(slabs: Slabs, elements: Sequence[int]) -> bool:
    """Whether a stretch may reuse its mirror image: not where two ceramics touch along x, for
    there the order of their potentials would change."""
    x = slabs.model.x
    for e in elements[1:]:
        node = x.first_node[e]
        both = np.intersect1d(slabs.sections[e - 1].codes, slabs.sections[e].codes)
        sections = slabs.sections[e - 1].codes.size, slabs.sections[e].codes.size
        if slabs.sizes[node] > max(sections) and both.size < min(sections):
            return False
    return True
