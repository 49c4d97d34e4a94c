"""The film in time, an oracle: it shares the slip law with the periodic solvers, and no solver.

The unknown is the gas held per area, m = P^{1/n} H, because its balance is what must close; the
pressure follows as P = (m/H)^n. Second order in time (BDF2) and space (finite volumes). The slowest
mode of a film of large squeeze number takes some σ/10 periods to settle, so the map of one period
onto the next is accelerated (Anderson mixing); its fixed point is the same.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.film.gas import ISOTHERMAL, CompiledGas, FilmGas
from squeezefilm.physics.film.mobility import mobility
from squeezefilm.physics.film.planar.grid import edge_graded, edge_layer, refined_line

Gap = Callable[[si.FloatArray, si.FloatArray], si.FloatArray]
"""H(X, T): takes arrays X (1, cells) and T (times, 1), returns what broadcasts with both."""
_MEMORY = 8
"""Periods the acceleration remembers."""


class Line(NamedTuple):
    """Volume of the cells (N,) and conductance of the faces (N+1,): 0 at a wall or a line of
    symmetry."""

    volume: si.Array
    conductance: si.Array


class Gaps(NamedTuple):
    """The gap in cells (N,) and at faces (N+1,), or with a row of them for every stage."""

    cell: si.Array
    face: si.Array


@compiled()
def step_by_newton(
    m: si.Array,
    held: si.Array,
    gap: Gaps,
    line: Line,
    step: float,
    gas: CompiledGas,
) -> float:
    """Solve volume (m − held) = step · (net inflow at m) for m, by Newton with one sweep a step.

    `m` (start and answer) and `held` have shape (N,). `step` is γΔT/σ. Returns the flow out through
    both ends, infinite where the step does not converge.
    """
    H, H_face = gap
    volume, conductance = line
    n, knudsen, model = gas
    N = m.size
    P = np.empty(N)
    slope_P = np.empty(N)
    lower = np.empty(N)
    diagonal = np.empty(N)
    upper = np.empty(N)
    rest = np.empty(N)
    change = np.inf
    last = np.inf
    for _ in range(40):
        for i in range(N):
            ratio = m[i] / H[i]
            P[i] = ratio if n == 1.0 else ratio**n
            slope_P[i] = n * P[i] / m[i]
            diagonal[i] = volume[i]
            rest[i] = volume[i] * (held[i] - m[i])
            lower[i] = 0.0
            upper[i] = 0.0
        for j in range(N + 1):
            if conductance[j] == 0.0:
                continue
            left = P[j - 1] if j > 0 else 1.0
            right = P[j] if j < N else 1.0
            value, slope = mobility(H_face[j], 0.5 * (left + right), n, knudsen, model)
            drop = right - left
            c = step * conductance[j]
            inflow = c * value * drop
            by_left = c * (0.5 * slope * drop - value)
            by_right = c * (0.5 * slope * drop + value)
            if j > 0:
                rest[j - 1] += inflow
                diagonal[j - 1] -= by_left * slope_P[j - 1]
                if j < N:
                    upper[j - 1] = -by_right * slope_P[j]
            if j < N:
                rest[j] -= inflow
                diagonal[j] += by_right * slope_P[j]
                if j > 0:
                    lower[j] = by_left * slope_P[j - 1]
        for i in range(1, N):
            w = lower[i] / diagonal[i - 1]
            diagonal[i] -= w * upper[i - 1]
            rest[i] -= w * rest[i - 1]
        rest[N - 1] /= diagonal[N - 1]
        for i in range(N - 2, -1, -1):
            rest[i] = (rest[i] - upper[i] * rest[i + 1]) / diagonal[i]
        change = 0.0
        scale = 1.0
        for i in range(N):
            relative = rest[i] / m[i]
            change = max(change, abs(relative))
            # Never take more than 0.8 of the gas out of a cell: m must stay positive.
            if relative * scale < -0.8:
                scale = -0.8 / relative
        for i in range(N):
            m[i] += scale * rest[i]
        if not np.isfinite(change + np.sum(rest)):  # `max` passes over what is no number
            return np.inf
        # Quadratic convergence: a change below sqrt(tolerance) leaves an error below tolerance,
        # but only rounding stops a change that no longer falls.
        if change <= 1e-13 or (change < 1e-10 and change >= 0.5 * last):
            break
        last = change
    if not change < 1e-6:
        return np.inf
    lost = 0.0
    for j, i in ((0, 0), (N, N - 1)):
        if conductance[j] != 0.0:
            P_i = m[i] / H[i] if n == 1.0 else (m[i] / H[i]) ** n
            value, _ = mobility(H_face[j], 0.5 * (P_i + 1.0), n, knudsen, model)
            lost += step * conductance[j] * value * (P_i - 1.0)
    return lost


@compiled()
def march(
    m: si.Array,
    before: si.Array,
    gaps: Gaps,
    line: Line,
    squeeze_number: float,
    gas: CompiledGas,
    pressure: si.Array,
) -> float:
    """March `m` in place over one period by BDF2, a step for each row of `gaps`.

    `before` (N,) is the gas one step before `m`. Fills `pressure` (steps, N); returns the gas lost
    through the ends, infinite where a step does not converge.
    """
    H, H_face = gaps
    n = gas.polytropic_exponent
    step = 2.0 / 3.0 * 2.0 * np.pi / H.shape[0] / squeeze_number
    lost = 0.0
    for k in range(H.shape[0]):
        held = (4.0 * m - before) / 3.0
        before[:] = m
        lost += 1.5 * step_by_newton(m, held, Gaps(H[k], H_face[k]), line, step, gas)
        if not lost < np.inf:
            break
        pressure[k] = (m / H[k]) ** n
    return lost


def line_grid(
    shape: str,
    cells: int,
    squeeze_number: float,
    mean_gap: Callable[[si.FloatArray], si.FloatArray],
) -> tuple[si.FloatArray, si.FloatArray, Line]:
    """Centres and faces of cells over the strip X ∈ [−½, ½] or the disc R ∈ [0, 1], graded to the
    edge layer, and to where `mean_gap` is small."""
    layer = edge_layer(squeeze_number if shape == "disc" else squeeze_number / 4)
    if shape == "disc":
        # Centres are the images of the half-points, so the grid stays smooth up to the edge.
        fine = edge_graded(2 * cells, layer)
        fine = refined_line(fine, mean_gap)
        face, centre = fine[::2], fine[1::2]
        weight, volume = face, np.diff(face**2) / 2
    else:
        fine = edge_graded(cells, layer) / 2
        fine = np.concatenate([-fine[:0:-1], fine])
        fine = refined_line(fine, mean_gap)
        face, centre = fine[::2], fine[1::2]
        weight, volume = np.ones_like(face), np.diff(face)
    distance = np.diff(np.concatenate([face[:1], centre, face[-1:]]))
    return centre, face, Line(volume, weight / distance)


def uniform_gap(excursion_ratio: float) -> Gap:
    """The gap H = 1 + ε cos T of two flat surfaces."""
    return lambda X, T: 1.0 + excursion_ratio * np.cos(T)


class _Mixer:
    """Anderson mixing of a map's iterates: from x and G(x), the next x to try."""

    def __init__(self) -> None:
        self._x: list[si.FloatArray] = []
        self._f: list[si.FloatArray] = []

    def next(self, x: si.FloatArray, image: si.FloatArray) -> si.FloatArray:
        self._x.append(x)
        self._f.append((image - x).ravel())
        del self._x[: -_MEMORY - 1], self._f[: -_MEMORY - 1]
        if len(self._x) == 1:
            return image
        dX = np.diff(np.array([row.ravel() for row in self._x]), axis=0).T
        dF = np.diff(np.array(self._f), axis=0).T
        weights = np.linalg.lstsq(dF, self._f[-1], rcond=1e-12)[0]
        mixed = image - ((dX + dF) @ weights).reshape(x.shape)
        # A mixture far off the map's own answer comes from a memory that no longer fits.
        if np.all((mixed > 0.5 * image) & (mixed < 2.0 * image)):
            return np.asarray(mixed)
        self._x.clear()
        self._f.clear()
        return image


@dataclass(frozen=True)
class FilmSettled:
    """The periodic state a march settles into.

    `over_pressure` is the period's mean load − 1, `error` its estimated absolute error (infinite on
    one grid); `mass_residual` the gas lost over the last period, relative to the gas held.
    """

    over_pressure: float
    error: float
    mass_residual: float
    centre: si.FloatArray
    gas: si.FloatArray


def settle_to_periodic(
    gap: Gap,
    squeeze_number: float,
    *,
    shape: str = "strip",
    tolerance: float | None = 1e-3,
    cells: int = 24,
    steps: int = 32,
    gas: FilmGas = ISOTHERMAL,
) -> FilmSettled:
    """The periodic state of the film under a gap H(X, T) of period 2π, by marching in time.

    `squeeze_number` σ is on the full length of the strip (X from −½ to ½) or the disc's radius.
    Starts with `cells` and `steps` a period and doubles both until the over-pressure, Richardson
    extrapolated, is known to `tolerance` (relative); `tolerance=None` takes the one resolution.
    """
    films = [_settled(gap, squeeze_number, shape, gas, cells, steps, None)]
    while tolerance is not None and films[-1].error > tolerance * films[-1].over_pressure:
        cells, steps = 2 * cells, 2 * steps
        assert cells <= 1600, f"{cells} cells do not reach the tolerance {tolerance}"
        film = _settled(gap, squeeze_number, shape, gas, cells, steps, films[-1])
        films.append(film)
        coarse, fine = (film.over_pressure for film in films[-2:])
        change = (fine - coarse) / 3.0
        # Two grids cannot tell whether the order is reached; three can.
        error = abs(change)
        if len(films) > 2:
            before = coarse + (coarse - films[-3].over_pressure) / 3.0
            error = min(error, max(abs(fine + change - before) / 2, abs(change) / 16))
        if error <= tolerance * abs(fine + change):
            return replace(film, over_pressure=fine + change, error=error + 1e-12)
    return films[-1]


def _settled(
    gap: Gap,
    sigma: float,
    shape: str,
    gas: FilmGas,
    cells: int,
    steps: int,
    start: FilmSettled | None,
) -> FilmSettled:
    """The film on one grid, from the gas of a coarser one."""
    eighths = np.pi / 4 * np.arange(8.0)
    centre, face, line = line_grid(
        shape, cells, sigma, lambda X: table(gap, X, eighths).mean(axis=0)
    )
    T = 2 * np.pi / steps * np.arange(1.0, steps + 1)
    H = table(gap, centre, T)
    gaps, compiled_gas = Gaps(H, table(gap, face, T)), gas.compiled()
    if start is None:
        # Part of the way from gas at rest to gas that cannot follow, whose m is constant in time.
        n, part = gas.polytropic_exponent, min(1.0, sigma / 30.0)
        mean = (np.mean(H**3, axis=0) / np.mean(H ** (2 - n), axis=0)) ** (1 / (n + 1))
        x = H[[-1, -2]] * (1 - part) + mean * part
    else:
        x = np.stack([np.interp(centre, start.centre, row) for row in start.gas])
    mixer, pressure = _Mixer(), np.empty((steps, cells))
    for _ in range(2000):
        image = x.copy()
        lost = march(image[0], image[1], gaps, line, float(sigma), compiled_gas, pressure)
        assert lost < np.inf, "a step does not converge"
        if np.max(np.abs(image / x - 1.0)) <= 1e-10:
            load = pressure.mean(axis=0) @ line.volume / line.volume.sum()
            missing = abs(lost) / float(line.volume @ image[0])
            return FilmSettled(float(load) - 1.0, np.inf, missing, centre, image)
        x = mixer.next(x, image)
    raise AssertionError("the film does not settle")


def table(gap: Gap, X: si.FloatArray, T: si.FloatArray) -> si.FloatArray:
    """H at every time and place, (times, places)."""
    H = np.broadcast_to(gap(X[None, :], T[:, None]), (T.size, X.size))
    return np.ascontiguousarray(H, dtype=float)
