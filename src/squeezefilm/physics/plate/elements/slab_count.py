"""Size of a box model, counted before any matrix of it is made: unknowns and memory."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import SOLID_MEMORY, require_within
from squeezefilm.physics.plate.elements.box_model import BoxModel, kept_products
from squeezefilm.physics.plate.elements.cross_section import slice_codes
from squeezefilm.physics.plate.elements.lobatto import LineMesh

_FLOAT = 8.0
# Matrices of a slice's size that an element of its own kind takes (a number, and one for each
# order), and vectors over all unknowns that the modes' search keeps. Fitted to peaks of resident
# memory on four plates of metal and glass, 0.07 to 1.7 GB: within 10 % of all.
_OF_A_KIND, _OF_AN_ORDER, _VECTORS = 3.0, 2.0, 120.0
# A slice has this share at least of the squares of a full box's: the rest is air beside ceramics.
# Meshes of gigahertz are refused by it; to count their unknowns would take hours.
_FEWEST = 0.05


class SlabCount(NamedTuple):
    """The size of a box model: the unknowns of each slice (x node), and those of the slices that
    each x element is made of, with its order; `kinds` are the elements unlike all before them."""

    slices: si.IntArray
    elements: si.IntArray
    orders: si.IntArray
    kinds: si.IntArray

    @property
    def unknowns(self) -> int:
        """Number of unknowns of the whole model, with those held at its ends along x."""
        return int(np.sum(self.slices))

    @property
    def products(self) -> float:
        """The cubes of the elements' slices, to which the time of a factorisation goes."""
        return float(np.sum(self.elements.astype(float) ** 3))

    @property
    def squares(self) -> float:
        """The squares of the elements' slices: entries of the factors."""
        return float(np.sum(self.elements.astype(float) ** 2))

    @property
    def memory(self) -> float:
        """The bytes that the factors, what is made on the way to them and the modes take: within a
        tenth of the resident memory measured on four plates."""
        squares = self.elements[self.kinds].astype(float) ** 2
        alone = float(np.sum((_OF_A_KIND + _OF_AN_ORDER * self.orders[self.kinds]) * squares))
        return _FLOAT * (2 * self.squares + alone + _VECTORS * self.unknowns)


def slab_count(model: BoxModel) -> SlabCount:
    """Count a model's unknowns slice by slice, in milliseconds."""
    x = model.x
    known: dict[bytes, si.IntArray] = {}
    kinds: dict[tuple[object, ...], int] = {}
    parts: list[list[si.IntArray]] = [[] for _ in range(x.nodes.size)]
    for e in range(x.elements):
        pattern = model.medium[e].tobytes() + model.ceramic[e].tobytes()
        if pattern not in known:
            known[pattern] = slice_codes(model, e)
        length = round((x.edges[e + 1] - x.edges[e]) * 1e12)
        kinds.setdefault((model.medium[e].tobytes(), length, x.orders[e]), e)
        for node in range(x.first_node[e], x.first_node[e + 1] + 1):
            parts[node].append(known[pattern])
    slices = [functools.reduce(np.union1d, some).size for some in parts]
    elements = [parts[x.first_node[e] + 1][0].size for e in range(x.elements)]
    alone = np.array(sorted(kinds.values()))
    return SlabCount(np.array(slices), np.array(elements), np.array(x.orders), alone)


def require_countable(x: LineMesh, y: LineMesh, z: LineMesh, trunk: float) -> None:
    """Refuse meshes that are far too fine for memory, before a model is made of them.

    Raises `InputError`.
    """
    full = int(np.count_nonzero(kept_products(y, z, trunk)))
    _require_memory(x.nodes.size, full, _FEWEST * _FLOAT * x.elements * full**2)


def require_memory(model: BoxModel) -> None:
    """Refuse a model whose factors would not fit into memory, before anything is made of it.

    Raises `InputError`.
    """
    count = slab_count(model)
    _require_memory(count.slices.size, int(np.max(count.slices)), count.memory)


def _require_memory(slices: int, most: int, memory: float) -> None:
    enough = (
        f"{slices} slices of up to {most} unknowns are too many; "
        "ask for fewer nodal lines or a lower frequency, or take a beam (theory timoshenko)"
    )
    require_within(SOLID_MEMORY, memory, enough=enough)
