"""The compiled solve of one film on three nested grids, under any gap.

Three grids with N/4, N/2 and N cells, each started from the one before, give the over-pressure
with its h² error removed and the size of what is left; the coarsest grid solved again with more
times gives the error of the time discretisation. The gap is sampled once, at the nodes and faces of
the finest grid; those of the coarser grids are among them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.film.gas import CompiledGas
from squeezefilm.physics.film.periodic.kernel import FAST, newton
from squeezefilm.physics.film.periodic.profile import evaluate, interpolant
from squeezefilm.physics.film.periodic.resolution import (
    Cells,
    FilmResolution,
    GridGap,
    PeriodTimes,
    SolveRoom,
)


class Mesh(NamedTuple):
    """The finest grid at its nodes and faces, one after the other, ξ from 0 (`closed`, the middle
    of a film) or −1 to 1: dX/dξ, and how wide the film is there, 1 or the radius of a disc."""

    slope: si.FloatArray
    width: si.FloatArray
    closed: bool


class GapRows(NamedTuple):
    """A gap at the nodes and faces of the finest grid, and the weights of p in the mean force at
    its nodes, one after the other: rows of the times of a period, 1 and 0 in the padding, `row`
    apart. Of a uniform gap one row, 0 apart."""

    gap: si.FloatArray
    weight: si.FloatArray
    row: int


def gap_rows(harmonics: si.ComplexArray, n: float, times: PeriodTimes, fine: int) -> GapRows:
    """The rows of a gap with `harmonics`, shape (orders, 2·cells + 1), under a gas of exponent n.

    For the mean over `fine` times Ψ = P Hⁿ is interpolated to them and divided by Hⁿ there.
    """
    nt = times.number
    H = np.ones((harmonics.shape[1], times.row))
    H[:, :nt] = evaluate(harmonics, 2.0 * np.pi * np.arange(nt) / nt)
    weight = np.zeros((len(H[::2]), times.row))
    inverse = evaluate(harmonics[:, ::2], 2.0 * np.pi * np.arange(fine) / fine) ** -n
    weight[:, :nt] = inverse @ interpolant(nt, fine).T / fine * H[::2, :nt] ** n
    return GapRows(H.ravel(), weight.ravel(), times.row)


class NestedRoom(NamedTuple):
    """Memory for a solve on nested grids: the cells of one, p on one and on the next, Newton's."""

    cells: Cells
    p: si.FloatArray
    other: si.FloatArray
    newton: SolveRoom


@compiled(error_model="numpy")
def room_for(resolution: FilmResolution) -> NestedRoom:
    """Memory for solves of one resolution."""
    cells, times, check = resolution
    rows, wide = cells + 1, max(times.row, check.row)
    blocks = max(rows * times.number * times.row, max(cells // 4 + 1, 2) * check.number * check.row)
    return NestedRoom(
        Cells(np.zeros(rows), np.zeros(rows), np.zeros(rows)),
        np.zeros(rows * wide),
        np.zeros(rows * wide),
        SolveRoom(np.zeros(10 * rows * wide), np.empty(blocks)),
    )


@compiled(error_model="numpy", forceinline=True)
def fill_cells(m: int, sigma: float, mesh: Mesh, cells: Cells) -> int:
    """Fill the cells of a grid of m from those of the finest; the number of its unknown nodes."""
    slope, width, closed = mesh
    g, vol, share = cells
    stride = (len(slope) // 2) // m
    step = (1.0 if closed else 2.0) / m
    g[0] = 0.0
    for i in range(m):
        middle = stride * (2 * i + 1)
        g[i + 1 if closed else i] = width[middle] / (step * slope[middle])
    unknowns = m if closed else m - 1
    for k in range(unknowns):
        at = 2 * stride * (k if closed else k + 1)
        volume = step * slope[at] * width[at]
        if at == 0:
            # Half a cell, and of a disc a small one.
            volume = 0.5 * volume if width[0] > 0.0 else 0.5 * width[stride] ** 2
        vol[k] = sigma * volume
        share[k] = 2.0 * volume if closed else volume
    return unknowns


@compiled(error_model="numpy")
def kept_size(resolution: FilmResolution) -> int:
    """The numbers that `solve_nested` keeps, at the most."""
    cells, times, check = resolution
    return max(cells // 4, 2) * (check.row + 1) + cells // 4 * 7 * (times.row + 1)


@compiled(error_model="numpy", forceinline=True)
def solve_nested(
    sigma: float,
    gas: CompiledGas,
    mesh: Mesh,
    at_times: GapRows,
    at_checks: GapRows,
    resolution: FilmResolution,
    tolerance: float,
    room: NestedRoom,
    over: si.FloatArray,
    keep: si.FloatArray,
) -> tuple[int, float]:
    """Fill the over-pressures of the coarsest grid with the times that check and of the three
    grids, `over` (4,), NaN where Newton's method fails; return its steps and largest residual.

    The number of cells is a multiple of 4. `keep`, if not empty, receives p and the nodes' shares
    of the area on the four, one after the other.
    """
    cells, p, other = resolution.cells, room.p, room.other
    over[:] = math.nan
    steps, left, kept, unknowns = 0, 0.0, 0, 0
    for grid in range(4):
        times = resolution.check if grid == 0 else resolution.times
        rows = at_checks if grid == 0 else at_times
        # A single node does not see how the time error varies over the film.
        m = max(cells // 4, 2) if grid == 0 else cells // 4 << grid - 1
        before = unknowns
        unknowns = fill_cells(m, sigma, mesh, room.cells)
        if grid < 2:
            p[: unknowns * times.row] = 0.0
        else:
            prolong(p, before, times.row, mesh.closed, other)
            p, other = other, p
        stride = 2 * (cells // m) * rows.row
        gap = GridGap(rows.gap, rows.weight, 0 if mesh.closed else stride, stride)
        over[grid], more, remains = newton(
            unknowns, times, room.cells, gap, gas, p, room.newton, 0.03 * tolerance
        )
        steps += more
        left = max(left, remains)
        if keep.size > 0:
            # In loops: for slices numba would ask whether they overlap.
            for i in range(unknowns * times.row):
                keep[kept + i] = p[i]
            kept += unknowns * times.row
            for i in range(unknowns):
                keep[kept + i] = room.cells.share[i]
            kept += unknowns
        if grid > 0 and math.isnan(over[grid]):
            break
    return steps, left


@compiled(fastmath=FAST, error_model="numpy")
def prolong(coarse: si.FloatArray, m: int, ntp: int, closed: bool, fine: si.FloatArray) -> None:
    """Carry m rows of p to the grid with twice the cells, by cubics.

    With `closed`, node 0 is a plane of symmetry and the edge follows node m − 1 (2m rows come
    out); without, both neighbours outside are edges (2m + 1 rows come out).
    """
    for t in range(ntp):
        if closed:
            for i in range(m):
                a = coarse[i * ntp + t]
                b = coarse[(i + 1) * ntp + t] if i + 1 < m else 0.0
                fine[2 * i * ntp + t] = a
                before = coarse[abs(i - 1) * ntp + t] if m > 1 or i > 1 else 0.0
                if i + 1 < m:
                    after = coarse[(i + 2) * ntp + t] if i + 2 < m else 0.0
                    middle = (9.0 * (a + b) - before - after) / 16.0
                elif m == 1:
                    middle = 0.75 * a
                else:
                    second = coarse[abs(i - 2) * ntp + t]
                    middle = (15.0 * a - 5.0 * before + second) / 16.0
                fine[(2 * i + 1) * ntp + t] = middle
        else:
            for i in range(m + 1):
                a = coarse[(i - 1) * ntp + t] if i > 0 else 0.0
                b = coarse[i * ntp + t] if i < m else 0.0
                if i > 0:
                    fine[(2 * i - 1) * ntp + t] = a
                if m < 3:
                    middle = 0.5 * (a + b)
                elif i == 0:
                    middle = (15.0 * b - 5.0 * coarse[ntp + t] + coarse[2 * ntp + t]) / 16.0
                elif i == m:
                    before = coarse[(m - 2) * ntp + t]
                    second = coarse[(m - 3) * ntp + t]
                    middle = (15.0 * a - 5.0 * before + second) / 16.0
                else:
                    before = coarse[(i - 2) * ntp + t] if i > 1 else 0.0
                    after = coarse[(i + 1) * ntp + t] if i + 1 < m else 0.0
                    middle = (9.0 * (a + b) - before - after) / 16.0
                fine[2 * i * ntp + t] = middle
