"""Nodal elements in one direction on the nodes of `lobatto`: Lagrange values, graded edges.

The plate and ring solvers are tensor products of these.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Sequence

import numpy as np
from numpy.polynomial import legendre

from squeezefilm import quantities as si
from squeezefilm.plate.elements.lobatto import lagrange_basis, lobatto_nodes

CORNER_GRADING = 0.15
"""The ratio in which elements shrink towards a singular corner; near the optimum of hp methods
(Babuška and Guo 1986: (√2 − 1)²)."""


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


def node_coordinates(edges: si.FloatArray, degree: int) -> si.FloatArray:
    """The nodes of a row of elements, shape ((len(edges) − 1) × degree + 1,), shared at edges."""
    reference = (lobatto_nodes(degree) + 1) / 2
    inner = edges[:-1, None] + np.diff(edges)[:, None] * reference[None, :-1]
    return np.append(inner.ravel(), edges[-1])


def graded_edges(
    breaks: Sequence[float],
    longest: float,
    singular: Sequence[float] = (),
    *,
    levels: int = 1,
    shortest: float = 0.0,
) -> si.FloatArray:
    """Element edges that contain all `breaks`, no element longer than `longest`.

    Next to each value in `singular` the elements shrink `levels` times by `CORNER_GRADING`, as
    long as they stay above `shortest`.
    """
    edges = [breaks[0]]
    for left, right in itertools.pairwise(breaks):
        span = right - left
        cuts = np.linspace(0.0, span, max(1, int(np.ceil(span / longest - 1e-9))) + 1)
        first = last = cuts[1]
        left_fans = [first * CORNER_GRADING**k for k in range(1, levels + 1)]
        right_fans = [span - last * CORNER_GRADING**k for k in range(1, levels + 1)]
        extra = [c for c in left_fans if c > shortest] if _in(left, singular) else []
        extra += [c for c in right_fans if span - c > shortest] if _in(right, singular) else []
        edges += [left + cut for cut in sorted({*cuts[1:-1], *extra})]
        edges.append(right)
    return np.array(edges)


def _in(value: float, values: Sequence[float]) -> bool:
    return any(abs(value - other) <= 1e-9 for other in values)
