"""Stiffness, mass and drive of a first-order shear plate in one symmetry class."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.elements.lobatto import gauss_points, lagrange, lobatto_nodes
from squeezefilm.physics.plate.elements.sparse_modes import Entries, entries, gathered
from squeezefilm.physics.plate.shear.section import ShearLayout, ShearSection

# Unknowns at a node: mid-plane u, v, deflection w, and the rotations a, b: u_x = u + z a, …
_U, _V, _W, _A, _B = range(5)
# Held on the mirror line x = middle: for w even in x, and for w odd; then the same for y.
_HELD = {(0, 1): (_U, _A), (0, -1): (_V, _W, _B), (1, 1): (_V, _B), (1, -1): (_U, _W, _A)}


@dataclass(frozen=True, eq=False)
class Axis:
    """A row of elements of individual degrees: edges and nodes, and the layout's cell of each."""

    edges: si.FloatArray
    degrees: tuple[int, ...]
    nodes: si.FloatArray
    first: tuple[int, ...]
    cell: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class ShearSystem:
    """K q = ω² M q + f V of one symmetry class (parity +1, −1, or 0 for the whole plate).

    `unknown` (nodes x, nodes y, 5) is the row of each field at each node, −1 where it is held.
    """

    parity: tuple[int, int]
    stiffness: sparse.csc_matrix
    mass: sparse.csc_matrix
    force: si.FloatArray
    x: Axis
    y: Axis
    unknown: np.ndarray

    def deflection(self, vector: si.FloatArray) -> si.FloatArray:
        """w at the nodes, (nodes x, nodes y)."""
        rows = self.unknown[:, :, _W]
        result: si.FloatArray = np.append(vector, 0.0)[rows]
        return result


def make_axis(edges: si.FloatArray, degree: int, longest: si.Metre, halved: bool) -> Axis:
    """Cut the cells so that none is longer than `longest`; short ones get a lower degree."""
    end = (edges[0] + edges[-1]) / 2 if halved else edges[-1]
    cuts, cells = [edges[0]], []
    for k, (left, right) in enumerate(itertools.pairwise(edges)):
        right = min(right, end)
        if right - left <= 1e-9:
            break
        parts = max(1, int(np.ceil((right - left) / longest - 1e-9)))
        cuts += [left + (right - left) * (n + 1) / parts for n in range(parts)]
        cells += [k] * parts
    sizes = np.diff(cuts)
    degrees = tuple(max(2, int(np.ceil(degree * min(1.0, 2 * s / longest)))) for s in sizes)
    nodes, first = [cuts[0]], []
    for left, size, p in zip(cuts[:-1], sizes, degrees, strict=True):
        first.append(len(nodes) - 1)
        nodes += [left + size * (t + 1) / 2 for t in lobatto_nodes(p)[1:]]
    return Axis(np.array(cuts), degrees, np.array(nodes), tuple(first), tuple(cells))


def shear_system(
    layout: ShearLayout, degree: int, longest: si.Metre, parity: tuple[int, int]
) -> ShearSystem:
    """Assemble one symmetry class; full Gauss quadrature (high degrees do not lock)."""
    x = make_axis(layout.x_edges, degree, longest, parity[0] != 0)
    y = make_axis(layout.y_edges, degree, longest, parity[1] != 0)
    unknown, count = _unknowns(x, y, parity)
    drive = _projected(layout.polarity, parity)
    images = (2 if parity[0] else 1) * (2 if parity[1] else 1)
    made: dict[tuple[object, ...], tuple[si.FloatArray, si.FloatArray, si.FloatArray]] = {}
    force = np.zeros(count + 1)
    stiffness: list[Entries] = []
    inertia: list[Entries] = []
    for i, (ci, px) in enumerate(zip(x.cell, x.degrees, strict=True)):
        for j, (cj, py) in enumerate(zip(y.cell, y.degrees, strict=True)):
            section = layout.sections[layout.section[ci, cj]]
            size = (x.edges[i + 1] - x.edges[i], y.edges[j + 1] - y.edges[j])
            key = (layout.section[ci, cj], px, py, round(size[0], 12), round(size[1], 12))
            if key not in made:
                made[key] = _element(section, size, (px, py))
            stiff, mass, pull = made[key]
            block = unknown[x.first[i] : x.first[i] + px + 1, y.first[j] : y.first[j] + py + 1]
            rows = np.moveaxis(block, -1, 0).ravel()
            np.add.at(force, np.where(rows < 0, count, rows), drive[ci, cj] * pull)
            stiffness.append(entries(rows, images * stiff))
            inertia.append(entries(rows, images * mass))
    K, M = gathered(stiffness, count), gathered(inertia, count)
    return ShearSystem(parity, K, M, force[:count], x, y, unknown)


def _element(
    section: ShearSection, size: tuple[float, float], degrees: tuple[int, int]
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    along, weights = [], []
    for h, p in zip(size, degrees, strict=True):
        points, w = gauss_points(p + 1)
        value, slope = lagrange(p, tuple(points))
        along.append((value, slope * 2 / h))
        weights.append(w * h / 2)
    (nx, dx), (ny, dy) = along
    n = nx.shape[1] * ny.shape[1]
    N = np.einsum("ga,hb->ghab", nx, ny).reshape(-1, n)
    X = np.einsum("ga,hb->ghab", dx, ny).reshape(-1, n)
    Y = np.einsum("ga,hb->ghab", nx, dy).reshape(-1, n)
    area = np.outer(*weights).ravel()
    B = np.zeros((area.size, 8, 5, n))
    for first, one, two in ((0, _U, _V), (3, _A, _B)):
        B[:, first, one] = X
        B[:, first + 1, two] = Y
        B[:, first + 2, one] = Y
        B[:, first + 2, two] = X
    B[:, 6, _W], B[:, 6, _A] = X, N
    B[:, 7, _W], B[:, 7, _B] = Y, N
    B = B.reshape(area.size, 8, 5 * n)
    weighted = np.matmul(section.stiffness * area[:, None, None], B)
    stiff = np.tensordot(B, weighted, axes=([0, 1], [0, 1]))
    i0, i1, i2 = section.inertia
    couple = np.diag([i0, i0, i0, i2, i2])
    couple[_U, _A] = couple[_A, _U] = couple[_V, _B] = couple[_B, _V] = i1
    mass = np.kron(couple, (N.T * area) @ N)
    pull = section.stress_coefficient * (
        area @ (B[:, 0] + B[:, 1] + section.piezo_arm * (B[:, 3] + B[:, 4]))
    )
    return stiff, mass, pull


def _unknowns(x: Axis, y: Axis, parity: tuple[int, int]) -> tuple[np.ndarray, int]:
    free = np.ones((x.nodes.size, y.nodes.size, 5), dtype=bool)
    for k in _HELD.get((0, parity[0]), ()):
        free[-1, :, k] = False
    for k in _HELD.get((1, parity[1]), ()):
        free[:, -1, k] = False
    unknown = np.full(free.shape, -1)
    count = int(free.sum())
    unknown[free] = np.arange(count)
    return unknown, count


def _projected(polarity: si.FloatArray, parity: tuple[int, int]) -> si.FloatArray:
    """The drive summed over a cell's mirror images, each with the sign of the class."""
    for axis in (0, 1):
        if parity[axis]:
            polarity = polarity + parity[axis] * np.flip(polarity, axis)
    # A cell cut by a mirror line is its own image: each half counts once.
    return polarity
