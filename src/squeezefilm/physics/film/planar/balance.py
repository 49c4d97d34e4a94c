"""Harmonic balance on one planar grid: Newton, eliminated row by row.

M = 2K + 1 collocation times carry K harmonics of m = P^{1/n} H, which is nearly constant in time
where the gas cannot follow, so that few are needed even at large excursion; the pressure is read
off on a finer set of times. Factors are kept while they still serve (chord steps).

The compiled residual and Jacobian: the unknown m = P^{1/n} H has shape (nodes, times). The time
derivative is spectral and couples all times of a node; the flow couples neighbours at the same
time. Between two rows the Jacobian is therefore diagonal, which is what makes the elimination row
by row cheap.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg import lapack

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.film.gas import CompiledGas
from squeezefilm.physics.film.mobility import mobility
from squeezefilm.physics.film.periodic.resolution import derivative
from squeezefilm.physics.film.planar.grid import Faces, PlanarGap, PlanarGrid, gap_values


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
    m: si.Array, gaps: si.Array, faces: Faces, storage: Storage, gas: CompiledGas, balance: Balances
) -> None:
    """Fill `balance` at the gas m, shape (nodes, times).

    `gaps` (…, times) is that at the nodes, at the faces between rows, at those within a row and at
    those on the edge, one after the other.
    """
    columns, row_G, column_G, edge_node, edge_G = faces
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
    for f in range(row_G.size + column_G.size):
        in_row = f >= row_G.size
        g = f - row_G.size if in_row else f
        a = g + g // (columns - 1) if in_row else g
        b = a + 1 if in_row else a + columns
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
    up: si.Array,
    down: si.Array,
    block: si.Array,
) -> None:
    """The dense Jacobian block of one row: its nodes, all their times.

    `weight` (columns,) and `diagonal` (columns, times) are those of its nodes, `up` and `down`
    (columns − 1, times) those of the faces between them.
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
    for f in range(up.shape[0]):
        here, there = f * M, (f + 1) * M
        for k in range(M):
            block[here + k, there + k] += up[f, k]
            block[there + k, here + k] += down[f, k]


@compiled()
def take_off(block: si.Array, down: si.Array, inverse: si.Array, up: si.Array) -> None:
    """block −= diag(down) · inverse · diag(up)."""
    n = block.shape[0]
    for i in range(n):
        for j in range(n):
            block[i, j] -= down[i] * inverse[i, j] * up[j]


_OVERSAMPLE = 6


@dataclass(frozen=True)
class Film:
    """Film to be solved: gap, squeeze number, and the gas as compiled code knows it."""

    gap: PlanarGap
    squeeze_number: float
    gas: CompiledGas


@dataclass(frozen=True)
class Balance:
    """A periodic state on one grid: `gas` m (nodes, times), mean pressure per node, loads."""

    grid: PlanarGrid
    gas: si.FloatArray
    over_pressure: float
    mean_pressure: si.FloatArray
    harmonics: si.ComplexArray
    residual: float
    iterations: int
    converged: bool

    @property
    def amplitudes(self) -> si.ComplexArray:
        """The over-pressure and the harmonics, (9,)."""
        return np.concatenate([[self.over_pressure], self.harmonics])


def times(count: int) -> si.FloatArray:
    """The collocation times of `count` points over a period."""
    return 2 * np.pi * np.arange(count) / count


def resampled(values: si.FloatArray, count: int) -> si.FloatArray:
    """Values (…, odd times) as the same trigonometric polynomial on `count` times (or cut)."""
    have = values.shape[-1]
    if have == count:
        return values
    spectrum = np.fft.rfft(values, axis=-1)[..., : (min(have, count) + 1) // 2]
    return np.asarray(np.fft.irfft(spectrum, count, axis=-1) * (count / have))


class _Factors:
    """The Jacobian eliminated row by row; keeps the inverse of every pivot block."""

    def __init__(self, grid: PlanarGrid, count: int) -> None:
        size = grid.columns * count
        self.inverse = np.empty((grid.rows, size, size))

    def factor(self, storage: Storage, parts: Balances) -> None:
        rows, size = self.inverse.shape[:2]
        weight = storage.weight.reshape(rows, -1)
        diagonal = parts.diagonal.reshape(rows, weight.shape[1], -1)
        self.up = parts.row_up.reshape(rows - 1, size)
        self.down = parts.row_down.reshape(rows - 1, size)
        D, within = storage.derivative, (rows, weight.shape[1] - 1, diagonal.shape[2])
        up, down = parts.column_up.reshape(within), parts.column_down.reshape(within)
        block = np.empty((size, size), order="F")
        for i in range(rows):
            row_block(weight[i], D, diagonal[i], up[i], down[i], block)
            if i:
                take_off(block, self.down[i - 1], self.inverse[i - 1], self.up[i - 1])
            lu, pivots, bad = lapack.dgetrf(block, overwrite_a=1)
            if bad:
                raise np.linalg.LinAlgError("a pivot block is singular")
            inverse, _ = lapack.dgetri(lu, pivots, overwrite_lu=1)
            self.inverse[i] = inverse

    def solve(self, right: si.FloatArray) -> si.FloatArray:
        rows, size = self.inverse.shape[:2]
        y = right.reshape(rows, size).copy()
        for i in range(1, rows):
            y[i] -= self.down[i - 1] * (self.inverse[i - 1] @ y[i - 1])
        x = np.empty_like(y)
        x[-1] = self.inverse[-1] @ y[-1]
        for i in range(rows - 2, -1, -1):
            x[i] = self.inverse[i] @ (y[i] - self.up[i] * x[i + 1])
        return x.reshape(right.shape)


class Balancer:
    """The equations of one film on one grid at M times, and their solution."""

    def __init__(self, film: Film, grid: PlanarGrid, count: int) -> None:
        self.film, self.grid, self.count = film, grid, count
        T = times(count)
        self.gaps = gap_values(film.gap, np.concatenate([grid.X, grid.faces_X]), T)
        self.storage = Storage(film.squeeze_number * grid.area, derivative(count))
        self._factors = _Factors(grid, count)
        self._fresh = False

    def _assemble(self, m: si.FloatArray) -> Balances:
        faces = self.grid.faces
        rows, columns = (
            (size, self.count)
            for size in (faces.row_conductance.size, faces.column_conductance.size)
        )
        shapes = (m.shape, m.shape, rows, rows, columns, columns)
        out = Balances(*(np.empty(shape) for shape in shapes))
        assemble(m, self.gaps, faces, self.storage, self.film.gas, out)
        return out

    def starts(self) -> list[si.FloatArray]:
        """Two guesses: gas at rest (P = 1), and gas that cannot follow at all (m constant)."""
        n, H = self.film.gas.polytropic_exponent, self.gaps[: self.grid.X.size]
        fine = gap_values(self.film.gap, self.grid.X, times(32))
        still = (np.mean(fine**3, axis=1) / np.mean(fine ** (2 - n), axis=1)) ** (1 / (n + 1))
        return [H.copy(), np.ascontiguousarray(np.broadcast_to(still[:, None], H.shape))]

    def solve(self, start: si.FloatArray | None, tolerance: float, limit: int = 30) -> Balance:
        """Newton from `start` (or the better of `starts`) until a step changes no m by more than
        `tolerance` (relative). Not converged is reported, not raised."""
        if start is None:
            tries = [(float(np.abs(self._assemble(m).residual).max()), m) for m in self.starts()]
            m = min(tries, key=lambda pair: pair[0])[1]
        else:
            m = start.copy()
        self._fresh = False
        made = 0
        good = False
        change, last = np.inf, np.inf
        parts = self._assemble(m)
        while made < limit:
            made += 1
            if not self._fresh:
                try:
                    self._factors.factor(self.storage, parts)
                except np.linalg.LinAlgError:
                    break
            step = self._factors.solve(-parts.residual)
            relative = step / m
            change = float(np.abs(relative).max())
            if not np.isfinite(change):
                break
            m = m + step * min(1.0, 0.8 / max(0.8, float(-relative.min())))
            # Below 1e-10 a change that falls no more is rounding.
            if change <= tolerance or (change < 1e-10 and change > 0.5 * last):
                good = True
                break
            parts = self._assemble(m)
            # Kept factors converge by a constant factor a step; new ones are worth their price
            # only where that factor is poor or the iterate is still far off.
            self._fresh = change < 0.1 and change < 0.3 * last
            last = change
        return self._report(m, change, made, good)

    def _report(self, m: si.FloatArray, change: float, made: int, good: bool) -> Balance:
        grid, n = self.grid, self.film.gas.polytropic_exponent
        count = max(_OVERSAMPLE * self.count, 48)
        T = times(count)
        ratio = resampled(m, count) / gap_values(self.film.gap, grid.X, T)
        over = np.maximum(ratio, 1e-300) ** n - 1.0
        share = grid.area / grid.area.sum()
        load = share @ over
        spectrum = np.fft.rfft(load) * (2.0 / count)
        return Balance(
            grid=grid,
            gas=m,
            over_pressure=float(load.mean()),
            mean_pressure=1.0 + over.mean(axis=1),
            harmonics=np.asarray(spectrum[1:9]),
            residual=change,
            iterations=made,
            converged=good and bool(ratio.min() > 0.0),
        )
