"""The compiled solve of a film whose gap is the same everywhere: strip and disc, one or many.

Three grids with N/4, N/2 and N cells, each started from the one before, give the over-pressure
with its h² error removed and the size of what is left; the coarsest grid solved again with more
times gives the error of the time discretisation.
"""

from __future__ import annotations

import math

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.film.gas import CompiledGas
from squeezefilm.physics.film.periodic.kernel import newton, prolong
from squeezefilm.physics.film.periodic.resolution import (
    STRIP,
    Cells,
    FilmResolution,
    Films,
    GridGap,
    PeriodTimes,
    SolveRoom,
)

# Columns of a result row.
OVER, ERROR, STIFFNESS, DAMPING, ITERATIONS, RESIDUAL, SPACE, TIME, COARSE, MIDDLE, FINE, CHECK = (
    range(12)
)
FORCE_ERROR, FORCE_SPACE, FORCE_TIME = range(12, 15)  # of stiffness + i damping
COLUMNS = 15


@compiled(error_model="numpy")
def edge_grading(sigma: float, eps: float) -> float:
    """The grading a of the grid map x = ξ (1 + a (1 − ξ²)); a = 1/2 would be quadratic at the edge.

    The layer is as thick as the film's least gap makes it, hence (1 − ε)². Found by scanning the
    error over σ and ε: it is a flat optimum.
    """
    local = sigma / ((1.0 - eps) * (1.0 - eps))
    return 0.44 * local / (local + 10.0)


@compiled(error_model="numpy")
def load_weights(
    nt: int,
    ntp: int,
    eps: float,
    n: float,
    H: si.FloatArray,
    w: si.FloatArray,
    c: si.FloatArray,
    s: si.FloatArray,
) -> None:
    """Weights of p at the nt times for the mean force and its first harmonic.

    Ψ = P Hⁿ is nearly constant in time, P is not. So the trigonometric interpolant of Ψ − Hⁿ is
    integrated against H^-n exactly, through the Fourier coefficients of H^-n.
    """
    most = nt // 2
    a = np.zeros(most + 3)
    if n == 1.0:
        root = math.sqrt(1.0 - eps * eps)
        a[0] = 1.0 / root
        ratio = -eps / (1.0 + root)
        for k in range(1, most + 3):
            a[k] = a[k - 1] * ratio
    else:
        # Coefficients fall like (ε/(1 + √(1 − ε²)))^k: 96 half-period points reach round-off
        # at ε = 0.9 and 1e-13 at 0.95.
        half = 96
        for f in range(half + 1):
            angle = math.pi * f / half
            value = (1.0 + eps * math.cos(angle)) ** (-n) / half
            if f == 0 or f == half:
                value *= 0.5
            turn = 2.0 * math.cos(angle)
            before, now = math.cos(angle), 1.0
            for k in range(most + 3):
                a[k] += value * now
                before, now = now, turn * now - before
    for t in range(ntp):
        w[t] = 0.0
        c[t] = 0.0
        s[t] = 0.0
    for t in range(nt):
        angle = 2.0 * math.pi * t / nt
        turn = 2.0 * math.cos(angle)
        before, now = 1.0, math.cos(angle)
        mean, even, odd = a[0], 2.0 * a[1], 0.0
        sine_before, sine = 0.0, math.sin(angle)
        for k in range(1, most + 1):
            mean += 2.0 * a[k] * now
            even += 2.0 * (a[k - 1] + a[k + 1]) * now
            odd += 2.0 * (a[k - 1] - a[k + 1]) * sine
            before, now = now, turn * now - before
            sine_before, sine = sine, turn * sine - sine_before
        power = H[t] if n == 1.0 else H[t] ** n
        w[t] = mean / nt * power
        c[t] = even / nt * power
        s[t] = odd / nt * power


@compiled(error_model="numpy")
def grid(
    m: int,
    shape: int,
    sigma: float,
    a: float,
    g: si.FloatArray,
    vol: si.FloatArray,
    share: si.FloatArray,
) -> None:
    """Face conductances, σ × volumes and shares of the area for m cells between centre and edge.

    The map is odd in ξ about the centre and the same for every m, so that the error of the
    solution is a series in even powers of 1/m, which the extrapolation needs.
    """
    step = 1.0 / m
    length = 0.5 if shape == STRIP else 1.0
    g[0] = 0.0
    for i in range(m):
        x = i * step
        slope = length * (1.0 + a - 3.0 * a * x * x)
        h = (i + 0.5) * step
        face_slope = length * (1.0 + a - 3.0 * a * h * h)
        volume = step * slope
        conductance = 1.0 / (step * face_slope)
        if shape == STRIP:
            if i == 0:
                volume *= 0.5
        else:
            radius = h * (1.0 + a * (1.0 - h * h))
            conductance *= radius
            volume = volume * x * (1.0 + a * (1.0 - x * x)) if i > 0 else 0.5 * radius * radius
        g[i + 1] = conductance
        vol[i] = sigma * volume
        share[i] = 2.0 * volume


@compiled(error_model="numpy")
def gap(nt: int, ntp: int, eps: float, H: si.FloatArray, H3: si.FloatArray) -> None:
    """H = 1 + ε cos T at the nt times, and its cube; 1 in the padding."""
    for t in range(ntp):
        H[t] = 1.0 + eps * math.cos(2.0 * math.pi * t / nt) if t < nt else 1.0
        H3[t] = H[t] * H[t] * H[t]


@compiled(error_model="numpy")
def space_error(
    coarse: complex,
    middle: complex,
    fine: complex,
    sigma: float,
    eps: float,
    cells: int,
    shape: int,
) -> float:
    """The error that extrapolating `middle` and `fine` leaves, from three nested grids, of the
    over-pressure (real) or of a harmonic of the force (complex).

    Asymptotically it is a fifteenth of what the extrapolated value changed by; 1.5 is a margin.
    Where the grid does not yet resolve the edge layer (σ/N² is the square of cell over layer)
    that difference can vanish by accident, and the error is a part of the last change that grows
    with √σ/N, and with ε as the layer sharpens; the factors were measured over the whole range
    of σ, ε, n and Kn.
    """
    change = abs(4.0 * (fine - middle) - (middle - coarse)) / 3.0
    layer = sigma / (cells * cells)
    if shape == STRIP:
        floor = 0.08 * math.sqrt(layer) * (1.0 + 0.05 * layer)
    else:
        floor = 0.06 * math.sqrt(layer) * (1.0 + 0.32 * layer)
    floor *= 1.0 + 7.0 * eps**6
    if cells == 4:
        floor *= 2.0
    elif cells > 12:
        floor *= 12.0 / cells
    return max(change / 10.0, min(floor, 1.5) * abs(fine - middle))


@compiled(error_model="numpy")
def rounding(sigma: float, n: float, over: float) -> float:
    """Error that double precision leaves in the over-pressure, from the scatter of solves.

    For n = 1 all is computed from P − 1; otherwise P itself is rounded.
    """
    return 4e-18 * sigma + 1e-13 * abs(over) + (0.0 if n == 1.0 else 4e-17)


@compiled(error_model="numpy")
def solve_rows(
    start: int,
    stop: int,
    films: Films,
    resolution: FilmResolution,
    tolerance: float,
    out: si.FloatArray,
    keep: si.FloatArray,
) -> None:
    """Fill rows start:stop of `out` for the films of those rows, all with the same resolution.

    The number of cells is a multiple of 4. NaN marks a film that did not converge. `keep`, if
    not empty, receives p of the last film: on the coarsest grid with the times that check, then
    on the three grids, one after the other.
    """
    sigma, eps, n, kn, law, shape = films
    cells, times, fuller = resolution
    nt, ntp = times.number, times.row
    wide = max(ntp, fuller.row)
    rows = cells + 1
    H, H3 = np.empty(wide), np.empty(wide)
    w, c, s = np.empty(wide), np.empty(wide), np.empty(wide)
    g, vol, share = np.empty(rows), np.empty(rows), np.empty(rows)
    p, other = np.empty(rows * wide), np.empty(rows * wide)
    blocks = max(cells * nt * ntp, max(cells // 4, 2) * fuller.number * fuller.row)
    room = SolveRoom(np.zeros(10 * rows * wide), np.empty(blocks))
    nodes, gaps = Cells(g, vol, share), GridGap(H, H, H3, w, 0)
    close = 0.03 * tolerance
    # Over-pressure and first harmonic, of the three grids and of the check.
    level, harmonic = np.empty(4), np.empty(4, dtype=np.complex128)
    coarsest = cells // 4
    # A single node does not see how the time error varies over the film.
    checked = max(coarsest, 2)
    for case in range(start, stop):
        sig, e, poly, rare = sigma[case], eps[case], n[case], kn[case]
        # A disc of radius R films like a strip about 1.5 R wide.
        wide_sigma = sig if shape == STRIP else 2.25 * sig
        a = edge_grading(wide_sigma, e)
        gas = CompiledGas(poly, rare, law)
        gap(fuller.number, fuller.row, e, H, H3)
        load_weights(fuller.number, fuller.row, e, poly, H, w, c, s)
        grid(checked, shape, sig, a, g, vol, share)
        p[: checked * fuller.row] = 0.0
        check, its, left = newton(checked, fuller, nodes, gaps, gas, p, room, close)
        level[3] = check
        harmonic[3] = _first_harmonic(checked, fuller, share, c, s, p)
        kept = 0
        if keep.size > 0:
            kept = checked * fuller.row
            keep[:kept] = p[:kept]
        gap(nt, ntp, e, H, H3)
        load_weights(nt, ntp, e, poly, H, w, c, s)
        p[: coarsest * ntp] = 0.0
        grid(coarsest, shape, sig, a, g, vol, share)
        m = coarsest
        for stage in range(3):
            if stage > 0:
                prolong(p, m, ntp, True, other)
                p, other = other, p
                m *= 2
                grid(m, shape, sig, a, g, vol, share)
            over, more, remains = newton(m, times, nodes, gaps, gas, p, room, close)
            its += more
            left = max(left, remains)
            level[stage] = over
            harmonic[stage] = _first_harmonic(m, times, share, c, s, p)
            if math.isnan(over):
                break
            if keep.size > 0:
                keep[kept : kept + m * ntp] = p[: m * ntp]
                kept += m * ntp
        out[case, ITERATIONS] = its
        out[case, RESIDUAL] = left
        if math.isnan(over) or math.isnan(check):
            out[case, OVER] = math.nan
            out[case, ERROR] = math.nan
            continue
        L1, L2, L3 = level[0], level[1], level[2]
        best = L3 + (L3 - L2) / 3.0
        out[case, COARSE], out[case, MIDDLE], out[case, FINE] = L1, L2, L3
        out[case, CHECK] = check
        out[case, OVER] = best
        local = wide_sigma / (poly * (1.0 + 6.0 * rare))
        same = 0 if checked == coarsest else 1
        out[case, SPACE] = space_error(L1, L2, L3, local, e, cells, shape)
        out[case, TIME] = 2.0 * abs(check - level[same])
        lost = left * abs(best) + rounding(sig, poly, best)
        out[case, ERROR] = out[case, SPACE] + out[case, TIME] + lost
        # p = Re[F e^{iT}] with F = −(fk + i fd) ε.
        F1, F2, F3 = harmonic[0], harmonic[1], harmonic[2]
        force = -(F3 + (F3 - F2) / 3.0) / e
        out[case, STIFFNESS], out[case, DAMPING] = force.real, force.imag
        out[case, FORCE_SPACE] = space_error(F1, F2, F3, local, e, cells, shape) / e
        out[case, FORCE_TIME] = 2.0 * abs(harmonic[3] - harmonic[same]) / e
        out[case, FORCE_ERROR] = out[case, FORCE_SPACE] + out[case, FORCE_TIME] + lost / e


@compiled(error_model="numpy")
def _first_harmonic(
    m: int,
    times: PeriodTimes,
    share: si.FloatArray,
    c: si.FloatArray,
    s: si.FloatArray,
    p: si.FloatArray,
) -> complex:
    """F of the area mean Re[F e^{iT}] of p: `c` weighs cos T, `s` weighs sin T, which is −Im F."""
    real, imag = 0.0, 0.0
    for i in range(m):
        even, odd = 0.0, 0.0
        for t in range(times.number):
            even += c[t] * p[i * times.row + t]
            odd += s[t] * p[i * times.row + t]
        real += share[i] * even
        imag += share[i] * odd
    return complex(real, -imag)
