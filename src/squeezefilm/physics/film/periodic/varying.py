"""The compiled solve of one film whose gap varies along it: waves, ridges, tilt, measurements.

The same three nested grids and time check as `uniform`, with the gap at every node and face.
It is sampled once, at the nodes and faces of the finest grid; those of the coarser grids are among
them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.film.gas import CompiledGas
from squeezefilm.physics.film.periodic.kernel import newton, prolong
from squeezefilm.physics.film.periodic.profile import evaluate, interpolant
from squeezefilm.physics.film.periodic.resolution import (
    STRIP,
    Cells,
    FilmResolution,
    GridGap,
    PeriodTimes,
    SolveRoom,
)
from squeezefilm.physics.film.periodic.uniform import (
    CHECK,
    COARSE,
    ERROR,
    FINE,
    ITERATIONS,
    MIDDLE,
    OVER,
    RESIDUAL,
    SPACE,
    TIME,
    rounding,
    space_error,
)


class GapRows(NamedTuple):
    """A gap at the nodes and faces of the finest grid, and the weights of p in the mean force at
    its nodes, one after the other: rows of the times of a period, 1 and 0 in the padding."""

    gap: si.FloatArray
    weight: si.FloatArray


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
    return GapRows(H.ravel(), weight.ravel())


class Profile(NamedTuple):
    """A gap that varies, at the nodes and faces of the finest grid, ξ from 0 (closed) or −1 to 1.

    dX/dξ; its rows at the times and at those that check them; the deepest relative
    excursion; and whether it is half the domain, from a plane of symmetry at X = 0 to the edge.
    """

    slope: si.FloatArray
    rows: GapRows
    check: GapRows
    depth: float
    closed: bool


@compiled(error_model="numpy")
def solve_varying(
    sigma: float,
    gas: CompiledGas,
    profile: Profile,
    resolution: FilmResolution,
    tolerance: float,
    out: si.FloatArray,
    keep: si.FloatArray,
) -> None:
    """Fill one result row and, if not empty, `keep`: p on the coarsest grid with the times that
    check, then on the three grids, one after the other. The profile has 2·cells + 1 points."""
    slope, at_times, at_checks, depth, closed = profile
    cells, times, fuller = resolution
    n, kn = gas.polytropic_exponent, gas.knudsen_number
    wide = max(times.row, fuller.row)
    rows = cells + 1
    width = 1.0 if closed else 2.0
    H, Hf, Hf3 = np.empty(rows * wide), np.empty(rows * wide), np.empty(rows * wide)
    weight = np.empty(rows * wide)
    g, vol, share = np.zeros(rows), np.zeros(rows), np.zeros(rows)
    p, other = np.zeros(rows * wide), np.zeros(rows * wide)
    blocks = max(rows * times.number * times.row, (cells // 4 + 1) * fuller.number * fuller.row)
    room = SolveRoom(np.zeros(10 * rows * wide), np.empty(blocks))
    close = 0.03 * tolerance
    level = np.zeros(3)
    check, left, its, kept = 0.0, 0.0, 0, 0
    for run in range(2):
        now = times if run == 1 else fuller
        row = now.row
        HJ, WJ = at_times if run == 1 else at_checks
        m = cells // 4
        for stage in range(3 if run == 1 else 1):
            stride = cells // m
            unknowns = m if closed else m - 1
            if stage == 0:
                p[: unknowns * row] = 0.0
            else:
                prolong(p, m // 2 if closed else m // 2 - 1, row, closed, other)
                p, other = other, p
            step = width / m
            for i in range(m):
                middle = stride * (2 * i + 1)
                face = i + 1 if closed else i
                g[face] = 1.0 / (step * slope[middle])
                source = middle * row
                for t in range(row):
                    h = HJ[source + t]
                    Hf[face * row + t] = h
                    Hf3[face * row + t] = h * h * h
            if closed:
                g[0] = 0.0
                Hf[:row] = 1.0
                Hf3[:row] = 1.0
            for k in range(unknowns):
                i = k if closed else k + 1
                volume = step * slope[2 * stride * i]
                if closed and i == 0:
                    volume *= 0.5
                vol[k] = sigma * volume
                share[k] = 2.0 * volume if closed else volume
                for t in range(row):
                    H[k * row + t] = HJ[2 * stride * i * row + t]
                    weight[k * row + t] = WJ[stride * i * row + t]
            over, more, remains = newton(
                unknowns,
                now,
                Cells(g, vol, share),
                GridGap(H, Hf, Hf3, weight, row),
                gas,
                p,
                room,
                close,
            )
            its += more
            left = max(left, remains)
            if run == 0:
                check = over
            else:
                level[stage] = over
            if keep.size > 0:
                keep[kept : kept + unknowns * row] = p[: unknowns * row]
                kept += unknowns * row
            if math.isnan(over):
                break
            if stage < 2:
                m *= 2
    out[ITERATIONS] = its
    out[RESIDUAL] = left
    L1, L2, L3 = level[0], level[1], level[2]
    out[OVER] = math.nan if math.isnan(over) else L3 + (L3 - L2) / 3.0
    out[COARSE], out[MIDDLE], out[FINE], out[CHECK] = L1, L2, L3, check
    local = sigma / (n * (1.0 + 6.0 * kn))
    out[SPACE] = space_error(L1, L2, L3, local, depth, cells if closed else cells // 2, STRIP)
    # Where the gap varies, the coarsest grid sees less of the time error: 3, where a uniform
    # gap takes 2.
    out[TIME] = 3.0 * abs(check - L1)
    out[ERROR] = out[SPACE] + out[TIME] + left * abs(out[OVER]) + rounding(sigma, n, out[OVER])
