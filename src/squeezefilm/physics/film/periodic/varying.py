"""The compiled solve of one film whose gap varies along it: waves, ridges, tilt, measurements.

The same three nested grids and time check as `uniform`, with the gap as Fourier series in time
at every node and face. The gap is sampled once, at the nodes and faces of the finest grid; those
of the coarser grids are among them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.film.gas import Aim, CompiledGas
from squeezefilm.physics.film.periodic.kernel import newton, prolong
from squeezefilm.physics.film.periodic.resolution import Cells, FilmResolution, GridGap, SolveRoom
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
    STRIP,
    TIME,
    rounding,
    space_error,
)


@compiled(error_model="numpy")
def _gaps(even: si.FloatArray, odd: si.FloatArray, nt: int, ntp: int, out: si.FloatArray) -> None:
    """H at all points (rows) and nt times from cosine and sine coefficients; padding 1."""
    orders, points = even.shape
    for t in range(ntp):
        if t >= nt:
            for j in range(points):
                out[j * ntp + t] = 1.0
            continue
        for j in range(points):
            out[j * ntp + t] = even[0, j]
        for k in range(1, orders):
            angle = 2.0 * math.pi * ((k * t) % nt) / nt
            c, s = math.cos(angle), math.sin(angle)
            for j in range(points):
                out[j * ntp + t] += even[k, j] * c + odd[k, j] * s


@compiled(error_model="numpy")
def _weights(
    even: si.FloatArray,
    odd: si.FloatArray,
    n: float,
    nt: int,
    ntp: int,
    fine: int,
    H: si.FloatArray,
    out: si.FloatArray,
) -> None:
    """Weights of p at the nt times in the mean force over `fine` times, for every other point.

    Ψ = P Hⁿ is interpolated to the fine times and divided by Hⁿ there.
    """
    orders, points = even.shape
    kernel = np.empty((fine, nt))
    for f in range(fine):
        for t in range(nt):
            x = math.pi * (f / fine - t / nt)
            bottom = nt * math.sin(x)
            kernel[f, t] = math.sin(nt * x) / bottom if abs(bottom) > 1e-9 else 1.0
    c, s = np.empty((orders, fine)), np.empty((orders, fine))
    for k in range(orders):
        for f in range(fine):
            angle = 2.0 * math.pi * ((k * f) % fine) / fine
            c[k, f], s[k, f] = math.cos(angle), math.sin(angle)
    inverse = np.empty(fine)
    row = np.empty(nt)
    for i in range((points + 1) // 2):
        j = 2 * i
        for f in range(fine):
            inverse[f] = even[0, j]
        for k in range(1, orders):
            for f in range(fine):
                inverse[f] += even[k, j] * c[k, f] + odd[k, j] * s[k, f]
        for f in range(fine):
            inverse[f] = (1.0 / inverse[f] if n == 1.0 else inverse[f] ** (-n)) / fine
        row[:] = 0.0
        for f in range(fine):
            value = inverse[f]
            for t in range(nt):
                row[t] += value * kernel[f, t]
        for t in range(ntp):
            if t < nt:
                h = H[j * ntp + t]
                out[i * ntp + t] = row[t] * (h if n == 1.0 else h**n)
            else:
                out[i * ntp + t] = 0.0


class Profile(NamedTuple):
    """A gap that varies, at the nodes and faces of the finest grid, ξ from 0 (closed) or −1 to 1.

    dX/dξ and the Fourier coefficients in time of cosines and sines there; the deepest relative
    excursion; and whether it is half the domain, from a plane of symmetry at X = 0 to the edge.
    """

    slope: si.FloatArray
    even: si.FloatArray
    odd: si.FloatArray
    depth: float
    closed: bool


@compiled(error_model="numpy")
def solve_varying(
    sigma: float,
    gas: CompiledGas,
    profile: Profile,
    resolution: FilmResolution,
    fine: tuple[int, int],
    aim: Aim,
    out: si.FloatArray,
    keep: si.FloatArray,
) -> None:
    """Fill one result row and, if not empty, `keep`: p on the coarsest grid with the times that
    check, then on the three grids, one after the other.

    The profile has 2·cells + 1 points; `fine` are the numbers of times of the load integral for
    the times of the resolution and for those that check them.
    """
    slope, even, odd, depth, closed = profile
    cells, times, fuller = resolution
    n, kn = gas.polytropic_exponent, gas.knudsen_number
    wide = max(times.row, fuller.row)
    rows = cells + 1
    points = 2 * cells + 1
    width = 1.0 if closed else 2.0
    HJ, WJ = np.empty(points * wide), np.empty(rows * wide)
    H, Hf, Hf3 = np.empty(rows * wide), np.empty(rows * wide), np.empty(rows * wide)
    weight = np.empty(rows * wide)
    g, vol, share = np.zeros(rows), np.zeros(rows), np.zeros(rows)
    p, other = np.zeros(rows * wide), np.zeros(rows * wide)
    blocks = max(rows * times.number * times.row, (cells // 4 + 1) * fuller.number * fuller.row)
    room = SolveRoom(np.zeros(10 * rows * wide), np.empty(blocks))
    close = Aim(0.03 * aim.tolerance, aim.most)
    level = np.zeros(3)
    check, left, its, kept = 0.0, 0.0, 0, 0
    for run in range(2):
        now = times if run == 1 else fuller
        row = now.row
        _gaps(even, odd, now.number, row, HJ)
        _weights(even, odd, n, now.number, row, fine[1 - run], HJ, WJ)
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
