"""Harmonic balance on one planar grid: Newton, eliminated row by row.

M = 2K + 1 collocation times carry K harmonics of m = P^{1/n} H, which is nearly constant in time
where the gas cannot follow, so that few are needed even at large excursion; the pressure is read
off on a finer set of times. Factors are kept while they still serve (chord steps).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from squeezefilm.core import quantities as si
from squeezefilm.physics.film.gas import Gas
from squeezefilm.physics.film.planar.gap import GapFunction, gap_values
from squeezefilm.physics.film.planar.grid import PlanarGrid
from squeezefilm.physics.film.planar.kernel import (
    Balances,
    Faces,
    Storage,
    assemble,
    row_block,
    take_off,
)

_OVERSAMPLE = 6


@dataclass(frozen=True)
class Film:
    """What is solved: gap, squeeze number, and the gas as compiled code knows it."""

    gap: GapFunction
    squeeze_number: float
    gas: Gas


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
    factorizations: int
    converged: bool

    @property
    def amplitudes(self) -> si.ComplexArray:
        """The over-pressure and the harmonics, (9,)."""
        return np.concatenate([[self.over_pressure], self.harmonics])


def times(count: int) -> si.FloatArray:
    """The collocation times of `count` points over a period."""
    return 2 * np.pi * np.arange(count) / count


def derivative(count: int) -> si.FloatArray:
    """The spectral derivative on an odd number of points over a period."""
    k = np.arange(count)
    d = k[:, None] - k[None, :]
    angle = np.pi * d / count
    sine = np.where(d == 0, 1.0, np.sin(angle))
    return np.where(d == 0, 0.0, 0.5 * (-1.0) ** d / sine)


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
        rows, columns = grid.rows, grid.columns
        self.inverse = np.empty((rows, columns * count, columns * count))
        row_of = grid.column_from // columns
        first = row_of * columns
        faces = np.arange(row_of.size)
        within = np.stack([faces, grid.column_from - first, grid.column_to - first], axis=1)
        self.within = [within[row_of == i] for i in range(rows)]

    def factor(self, storage: Storage, parts: Balances) -> None:
        rows, size = self.inverse.shape[:2]
        weight = storage.weight.reshape(rows, -1)
        diagonal = parts.diagonal.reshape(rows, weight.shape[1], -1)
        self.up = parts.row_up.reshape(rows - 1, size)
        self.down = parts.row_down.reshape(rows - 1, size)
        D, up, down = storage.derivative, parts.column_up, parts.column_down
        block = np.empty((size, size), order="F")
        for i in range(rows):
            row_block(weight[i], D, diagonal[i], self.within[i], up, down, block)
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
        X = np.concatenate([grid.X, grid.row_X, grid.column_X, grid.edge_X])
        Y = np.concatenate([grid.Y, grid.row_Y, grid.column_Y, grid.edge_Y])
        self.gaps = gap_values(film.gap, X, Y, T)
        self.storage = Storage(film.squeeze_number * grid.area, derivative(count))
        self.faces = Faces(
            grid.columns,
            grid.row_conductance,
            grid.column_from,
            grid.column_to,
            grid.column_conductance,
            grid.edge_node,
            grid.edge_conductance,
        )
        self._factors = _Factors(grid, count)
        self._fresh = False

    def _assemble(self, m: si.FloatArray) -> Balances:
        rows, columns = (
            (size, self.count)
            for size in (self.grid.row_conductance.size, self.grid.column_from.size)
        )
        shapes = (m.shape, m.shape, rows, rows, columns, columns)
        out = Balances(*(np.empty(shape) for shape in shapes))
        assemble(m, self.gaps, self.faces, self.storage, self.film.gas, out)
        return out

    def starts(self) -> list[si.FloatArray]:
        """Two guesses: gas at rest (P = 1), and gas that cannot follow at all (m constant)."""
        n, H = self.film.gas.polytropic_exponent, self.gaps[: self.grid.X.size]
        fine = gap_values(self.film.gap, self.grid.X, self.grid.Y, times(32))
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
        made = factored = 0
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
                factored += 1
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
            self._fresh = change < 0.1 and (factored > 0) and change < 0.3 * last
            last = change
        return self._report(m, change, made, factored, good)

    def _report(
        self, m: si.FloatArray, change: float, made: int, factored: int, good: bool
    ) -> Balance:
        grid, n = self.grid, self.film.gas.polytropic_exponent
        count = max(_OVERSAMPLE * self.count, 48)
        T = times(count)
        ratio = resampled(m, count) / gap_values(self.film.gap, grid.X, grid.Y, T)
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
            factorizations=factored,
            converged=good and bool(ratio.min() > 0.0),
        )
