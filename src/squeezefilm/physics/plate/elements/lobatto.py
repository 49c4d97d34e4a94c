"""High-order line elements: Gauss–Lobatto–Legendre nodes, their matrices, and graded meshes.

A box meshed by a tensor product of these needs only one-dimensional integrals; every matrix of the
three-dimensional plate is a sum of Kronecker products of the three below.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

MAX_ORDER = 16


@functools.lru_cache(maxsize=64)
def lobatto_nodes(order: int) -> si.FloatArray:
    """The order + 1 Gauss–Lobatto–Legendre nodes on [−1, 1]: the ends and the roots of P′."""
    if not 1 <= order <= MAX_ORDER:
        raise InputError(f"order = {order}: elements of order 1 to {MAX_ORDER} are provided")
    roots = legendre.legroots(legendre.legder(np.eye(order + 1)[order])) if order > 1 else 0.0
    inside = np.sort(np.real(np.atleast_1d(roots)))[: order - 1]
    nodes: si.FloatArray = np.concatenate([[-1.0], inside, [1.0]])
    # Exact mirror symmetry lets mirrored cells of a plate share one factorisation.
    nodes = 0.5 * (nodes - nodes[::-1])
    nodes.setflags(write=False)
    return nodes


def lagrange_basis(
    nodes: si.FloatArray, points: si.FloatArray
) -> tuple[si.FloatArray, si.FloatArray]:
    """Values and derivatives of the Lagrange polynomials of `nodes` at `points`.

    Both have the shape (points, nodes).
    """
    count = nodes.size
    # Through Legendre polynomials: well conditioned up to MAX_ORDER.
    vandermonde = legendre.legvander(nodes, count - 1)
    coefficients = np.linalg.inv(vandermonde)
    values = legendre.legvander(points, count - 1) @ coefficients
    slopes = legendre.legval(points, legendre.legder(np.eye(count))).T
    return values, slopes @ coefficients


@functools.lru_cache(maxsize=64)
def lagrange(degree: int, at: tuple[float, ...]) -> tuple[si.FloatArray, si.FloatArray]:
    """Values and derivatives of the Lagrange polynomials on the Lobatto points at points `at`.

    Two arrays of shape (len(at), degree + 1); derivatives are with respect to −1…1.
    """
    return lagrange_basis(lobatto_nodes(degree), np.asarray(at))


@functools.lru_cache(maxsize=64)
def gauss_points(count: int) -> tuple[si.FloatArray, si.FloatArray]:
    """Gauss–Legendre points and weights on −1…1, exact to degree 2 count − 1."""
    points, weights = legendre.leggauss(count)
    return points, weights


@functools.lru_cache(maxsize=64)
def _reference_matrices(
    order: int, hierarchic: bool
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    nodes = lobatto_nodes(order)
    points, weights = legendre.leggauss(order + 1)
    values, slopes = lagrange_basis(nodes, points)
    mass = values.T @ (weights[:, None] * values)
    slope = slopes.T @ (weights[:, None] * values)
    stiffness = slopes.T @ (weights[:, None] * slopes)
    if hierarchic:
        E = hierarchic_values(order)
        mass, slope, stiffness = (_exact_zeros(E.T @ part @ E) for part in (mass, slope, stiffness))
    for array in (mass, slope, stiffness):
        array.setflags(write=False)
    return mass, slope, stiffness


def line_matrices(
    length: si.Metre, order: int, *, hierarchic: bool = False
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    """∫N Nᵀ, ∫N′ Nᵀ and ∫N′ N′ᵀ of one element, integrated exactly, in the nodal or the hierarchic
    basis; shape (order + 1)² each."""
    mass, slope, stiffness = _reference_matrices(order, hierarchic)
    return mass * (length / 2), slope, stiffness * (2 / length)


def _exact_zeros(matrix: si.FloatArray) -> si.FloatArray:
    """The same with what rounding leaves of integrals of orthogonal functions set to 0."""
    return np.where(np.abs(matrix) > 1e-14 * np.max(np.abs(matrix)), matrix, 0.0)


@functools.lru_cache(maxsize=64)
def hierarchic_values(order: int, points: tuple[float, ...] | None = None) -> si.FloatArray:
    """The hierarchic basis (two end functions, then integrated Legendre polynomials of order 2 to
    `order`, in the places of a Lagrange basis) at the Lobatto nodes or at given points of [−1, 1].

    Shape (points, order + 1): column 0 and `order` are the ends, column k the order k + 1.
    """
    x = lobatto_nodes(order) if points is None else np.array(points)
    out = np.empty((x.size, order + 1))
    out[:, 0], out[:, order] = (1 - x) / 2, (1 + x) / 2
    for k in range(2, order + 1):
        high = legendre.legval(x, np.eye(k + 1)[k])
        low = legendre.legval(x, np.eye(k + 1)[k - 2])
        out[:, k - 1] = (high - low) / np.sqrt(2 * (2 * k - 1))
    out.setflags(write=False)
    return out


def apart(places: Iterable[float], least: float) -> list[float]:
    """Places in rising order, of those that are as good as one (no more than `least` apart) the
    first."""
    kept: list[float] = []
    for place in sorted(places):
        if not kept or place - kept[-1] > least:
            kept.append(place)
    return kept


@dataclass(frozen=True, eq=False)
class LineMesh:
    """Elements on a line: `edges` (m, ascending) and the polynomial `orders` between them."""

    edges: tuple[float, ...]
    orders: tuple[int, ...]

    def __post_init__(self) -> None:
        if len(self.edges) != len(self.orders) + 1:
            raise InputError("a line mesh needs one edge more than it has elements")
        if any(b <= a for a, b in zip(self.edges, self.edges[1:], strict=False)):
            raise InputError("the edges of a line mesh must ascend")

    @property
    def elements(self) -> int:
        """Number of elements."""
        return len(self.orders)

    @functools.cached_property
    def first_node(self) -> tuple[int, ...]:
        """The index of each element's first node, and the last node's index at the end."""
        return tuple(int(k) for k in np.concatenate([[0], np.cumsum(self.orders)]))

    @functools.cached_property
    def nodes(self) -> si.FloatArray:
        """All nodes in ascending order (m)."""
        parts = [np.array([self.edges[0]])]
        for a, b, order in zip(self.edges[:-1], self.edges[1:], self.orders, strict=True):
            parts.append(a + (b - a) * (lobatto_nodes(order)[1:] + 1) / 2)
        return np.concatenate(parts)

    @functools.cached_property
    def function_orders(self) -> si.IntArray:
        """The polynomial order of each hierarchic function: 1 at element ends, 2 … inside."""
        out = np.ones(self.first_node[-1] + 1, dtype=np.int64)
        for k, order in enumerate(self.orders):
            out[self.first_node[k] + 1 : self.first_node[k + 1]] = np.arange(2, order + 1)
        return out

    def located(self, points: si.FloatArray) -> tuple[si.IntArray, si.FloatArray]:
        """Elements in which points lie (m; the nearest for those outside), and where in it, from −1
        to 1."""
        edges = np.array(self.edges)
        owner = np.clip(np.searchsorted(edges, points, side="right") - 1, 0, self.elements - 1)
        return owner, 2 * (points - edges[owner]) / (edges[owner + 1] - edges[owner]) - 1

    def interpolation(self, points: si.FloatArray, *, hierarchic: bool = False) -> si.FloatArray:
        """The matrix that takes nodal values, or hierarchic coefficients, to values at `points`;
        shape (points, nodes)."""
        points = np.atleast_1d(np.asarray(points, dtype=float))
        owner, local = self.located(points)
        out = np.zeros((points.size, self.nodes.size))
        orders, first = np.array(self.orders)[owner], np.array(self.first_node)[owner]
        # All elements of one order at once.
        for order in np.unique(orders).tolist():
            mine = np.flatnonzero(orders == order)
            if hierarchic:
                values = hierarchic_values(order, tuple(local[mine]))
            else:
                values, _ = lagrange_basis(lobatto_nodes(order), local[mine])
            out[mine[:, None], first[mine, None] + np.arange(order + 1)] = values
        return out
