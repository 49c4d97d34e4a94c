"""Compiled residual and Jacobian of the film in the plane at its collocation times.

The unknown m = P^{1/n} H has shape (nodes, times). The time derivative is spectral and couples
all times of a node; the flow couples neighbours at the same time. Between two rows the Jacobian
is therefore diagonal, which is what makes the elimination row by row cheap.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.film.gas import Gas
from squeezefilm.physics.film.mobility import mobility


class Faces(NamedTuple):
    """Nodes in a row; the faces between rows, within a row and on the edge, with the nodes they
    join and their conductances, as `PlanarGrid` has them."""

    columns: int
    row_conductance: si.Array
    column_from: si.Array
    column_to: si.Array
    column_conductance: si.Array
    edge_node: si.Array
    edge_conductance: si.Array


class Storage(NamedTuple):
    """σ · area of the nodes, and the derivative in time (times, times)."""

    weight: si.Array
    derivative: si.Array


class Balances(NamedTuple):
    """Residual (inflow − weight · dm/dT) and the flow's part of its Jacobian.

    `diagonal` (nodes, times) is ∂residual/∂m of the node itself without the derivative in time;
    `*_up` (faces, times) is ∂(from)/∂m(to), `*_down` ∂(to)/∂m(from).
    """

    residual: si.Array
    diagonal: si.Array
    row_up: si.Array
    row_down: si.Array
    column_up: si.Array
    column_down: si.Array


@compiled()
def assemble(
    m: si.Array, gaps: si.Array, faces: Faces, storage: Storage, gas: Gas, balance: Balances
) -> None:
    """Fill `balance` at the gas m, shape (nodes, times).

    `gaps` (…, times) is that at the nodes, at the faces between rows, at those within a row and at
    those on the edge, one after the other.
    """
    columns, row_G, column_from, column_to, column_G, edge_node, edge_G = faces
    weight, D = storage
    n, knudsen, model = gas
    residual, diagonal, row_up, row_down, column_up, column_down = balance
    N, M = m.shape
    row_end = N + row_G.size
    H, H_row = gaps[:N], gaps[N:row_end]
    H_column = gaps[row_end : row_end + column_G.size]
    H_edge = gaps[row_end + column_G.size :]
    P = np.empty((N, M))
    dP = np.empty((N, M))
    for i in range(N):
        for k in range(M):
            ratio = m[i, k] / H[i, k]
            P[i, k] = ratio if n == 1.0 else ratio**n
            dP[i, k] = n * P[i, k] / m[i, k]
            s = 0.0
            for q in range(M):
                s += D[k, q] * m[i, q]
            residual[i, k] = -weight[i] * s
            diagonal[i, k] = 0.0
    for f in range(row_G.size + column_from.size):
        in_row = f >= row_G.size
        g = f - row_G.size if in_row else f
        a = column_from[g] if in_row else g
        b = column_to[g] if in_row else g + columns
        G = column_G[g] if in_row else row_G[g]
        for k in range(M):
            h = H_column[g, k] if in_row else H_row[g, k]
            value, slope = mobility(h, 0.5 * (P[a, k] + P[b, k]), n, knudsen, model)
            drop = P[b, k] - P[a, k]
            flow = G * value * drop
            by_a = G * (0.5 * slope * drop - value) * dP[a, k]
            by_b = G * (0.5 * slope * drop + value) * dP[b, k]
            residual[a, k] += flow
            residual[b, k] -= flow
            diagonal[a, k] += by_a
            diagonal[b, k] -= by_b
            if in_row:
                column_up[g, k] = by_b
                column_down[g, k] = -by_a
            else:
                row_up[g, k] = by_b
                row_down[g, k] = -by_a
    for g in range(edge_node.size):
        a = edge_node[g]
        for k in range(M):
            value, slope = mobility(H_edge[g, k], 0.5 * (P[a, k] + 1.0), n, knudsen, model)
            drop = 1.0 - P[a, k]
            residual[a, k] += edge_G[g] * value * drop
            diagonal[a, k] += edge_G[g] * (0.5 * slope * drop - value) * dP[a, k]


@compiled()
def row_block(
    weight: si.Array,
    D: si.Array,
    diagonal: si.Array,
    within: si.Array,
    up: si.Array,
    down: si.Array,
    block: si.Array,
) -> None:
    """The dense Jacobian block of one row: its nodes, all their times.

    `weight` (columns,) and `diagonal` (columns, times) are those of its nodes. `within` (…, 3) are
    the faces within it, each with the nodes that it joins, counted in the row; `up` and `down`
    (faces, times) those of the faces of all rows.
    `block` (columns·times)² is overwritten. Arrays and no records: it is called for every row, and
    a record of arrays takes longer to hand over than a small block to fill.
    """
    M = D.shape[0]
    block[:, :] = 0.0
    for i in range(weight.size):
        for k in range(M):
            for q in range(M):
                block[i * M + k, i * M + q] = -weight[i] * D[k, q]
            block[i * M + k, i * M + k] += diagonal[i, k]
    for f in range(within.shape[0]):
        g, a, b = within[f]
        for k in range(M):
            # += because on a full ring of two columns both faces join the same nodes.
            block[a * M + k, b * M + k] += up[g, k]
            block[b * M + k, a * M + k] += down[g, k]


@compiled()
def take_off(block: si.Array, down: si.Array, inverse: si.Array, up: si.Array) -> None:
    """block −= diag(down) · inverse · diag(up)."""
    n = block.shape[0]
    for i in range(n):
        for j in range(n):
            block[i, j] -= down[i] * inverse[i, j] * up[j]
