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
from squeezefilm.physics.film.periodic.resolution import Cells, FilmResolution, GridGap
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
def _gaps(even: si.FloatArray, odd: si.FloatArray, nt: int) -> si.FloatArray:
    """H at all points and nt times (points, times) from cosine and sine coefficients."""
    orders, points = even.shape
    H = np.empty((points, nt))
    for t in range(nt):
        H[:, t] = even[0]
        for k in range(1, orders):
            angle = 2.0 * math.pi * ((k * t) % nt) / nt
            H[:, t] += even[k] * math.cos(angle) + odd[k] * math.sin(angle)
    return H


@compiled(error_model="numpy")
def _weights(
    even: si.FloatArray, odd: si.FloatArray, n: float, fine: int, H: si.FloatArray
) -> si.FloatArray:
    """Weights of p at the times of H in the mean force over `fine` times, for every other point.

    Ψ = P Hⁿ is interpolated to the fine times and divided by Hⁿ there.
    """
    nodes, nt = H[::2].shape
    kernel = np.empty((fine, nt))
    for f in range(fine):
        for t in range(nt):
            x = math.pi * (f / fine - t / nt)
            bottom = nt * math.sin(x)
            kernel[f, t] = math.sin(nt * x) / bottom if abs(bottom) > 1e-9 else 1.0
    inverse = _gaps(even[:, ::2], odd[:, ::2], fine) ** -n / fine
    out = np.zeros((nodes, nt))
    for i in range(nodes):
        for f in range(fine):
            for t in range(nt):
                out[i, t] += inverse[i, f] * kernel[f, t]
    return out * H[::2] ** n


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
    close = Aim(0.03 * aim.tolerance, aim.most)
    level = np.zeros(4)
    over, left, its, kept = 0.0, 0.0, 0, 0
    for now, loads, first, grids in ((fuller, fine[1], 3, 1), (times, fine[0], 0, 3)):
        H = _gaps(even, odd, now.number)
        weights = _weights(even, odd, n, loads, H)
        m = cells // 4
        p = np.zeros((m if closed else m - 1, now.number))
        for stage in range(first, first + grids):
            if stage in (1, 2):
                p = prolong(p, closed)
                m *= 2
            stride, step = cells // m, (1.0 if closed else 2.0) / m
            # The edges, one or both, are no unknowns; a plane of symmetry is a face without flow.
            begin = 0 if closed else 1
            faces = np.ascontiguousarray(H[stride :: 2 * stride])
            conductance = 1.0 / (step * slope[stride :: 2 * stride])
            volume = step * slope[2 * stride * begin : -1 : 2 * stride]
            share = volume.copy()
            if closed:
                faces = np.concatenate((np.ones((1, now.number)), faces))
                conductance = np.append(np.zeros(1), conductance)
                volume[0] *= 0.5
                share = 2.0 * volume
            nodes = np.ascontiguousarray(H[2 * stride * begin : -1 : 2 * stride])
            weight = np.ascontiguousarray(weights[stride * begin : -1 : stride])
            over, more, remains = newton(
                now,
                Cells(conductance, sigma * volume, share),
                GridGap(nodes, faces, weight, 1),
                gas,
                p,
                close,
            )
            its += more
            left = max(left, remains)
            level[stage] = over
            if keep.size > 0:
                keep[kept : kept + p.size] = p.ravel()
                kept += p.size
            if math.isnan(over):
                break
    out[ITERATIONS] = its
    out[RESIDUAL] = left
    L1, L2, L3, check = level[0], level[1], level[2], level[3]
    out[OVER] = math.nan if math.isnan(over) else L3 + (L3 - L2) / 3.0
    out[COARSE], out[MIDDLE], out[FINE], out[CHECK] = L1, L2, L3, check
    local = sigma / (n * (1.0 + 6.0 * kn))
    out[SPACE] = space_error(L1, L2, L3, local, depth, cells if closed else cells // 2, STRIP)
    # Where the gap varies, the coarsest grid sees less of the time error: 3, where a uniform
    # gap takes 2.
    out[TIME] = 3.0 * abs(check - L1)
    out[ERROR] = out[SPACE] + out[TIME] + left * abs(out[OVER]) + rounding(sigma, n, out[OVER])
