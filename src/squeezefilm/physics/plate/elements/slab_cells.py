"""The cells that a row of slices is cut into: stretches that repeat are eliminated once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.physics.plate.elements.block_ldl import PartialLDL
from squeezefilm.physics.plate.elements.mirrored_element import MirroredElement
from squeezefilm.physics.plate.elements.slabs import Slabs

Matrix = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Cell:
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

    @property
    def negative(self) -> int:
        """The number of negative pivots, if counted."""
        inside = sum(bubble.negative for bubble in self.bubbles)
        return inside + sum(joint.negative for joint in self.joints)


@dataclass(frozen=True, eq=False)
class Place:
    """Place of a cell: its slices in the order of the cell, mirrored or not."""

    cell: Cell
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


@dataclass(frozen=True, eq=False)
class Group:
    """The places of one cell: where their unknowns stand, in the order of the cell (unknowns,
    places), their signs there, and where in that order each slice begins and ends."""

    cell: Cell
    at: Matrix
    signs: Matrix
    stops: list[int]

    @property
    def count(self) -> int:
        """Number of places."""
        return int(self.at.shape[1])

    @property
    def ends(self) -> tuple[slice, slice]:
        """The first and the last slice."""
        return self.node(0), self.node(len(self.stops) - 2)

    def node(self, number: int) -> slice:
        """The unknowns of one slice."""
        return slice(self.stops[number], self.stops[number + 1])

    def inside(self, start: int, stop: int) -> slice:
        """The unknowns of the slices between two."""
        return slice(self.stops[start + 1], self.stops[stop])


def cut(slabs: Slabs) -> list[list[int]]:
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


def mirrors(slabs: Slabs, elements: Sequence[int]) -> bool:
    """True where a stretch may reuse its mirror image: not where two ceramics touch along x, for
    there the order of their potentials would change."""
    x = slabs.model.x
    for e in elements[1:]:
        node = x.first_node[e]
        both = np.intersect1d(slabs.sections[e - 1].codes, slabs.sections[e].codes)
        sections = slabs.sections[e - 1].codes.size, slabs.sections[e].codes.size
        if slabs.sizes[node] > max(sections) and both.size < min(sections):
            return False
    return True
