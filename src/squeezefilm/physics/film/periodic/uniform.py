"""The compiled solve of films whose gap is the same everywhere: strip and disc, one or many."""

from __future__ import annotations

import math

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.film.gas import CompiledGas
from squeezefilm.physics.film.periodic.grids import (
    GapRows,
    Mesh,
    kept_size,
    room_for,
    solve_nested,
)
from squeezefilm.physics.film.periodic.resolution import STRIP, FilmResolution, Films, PeriodTimes

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


@compiled(error_model="numpy", forceinline=True)
def fill_times(
    times: PeriodTimes,
    eps: float,
    n: float,
    H: si.FloatArray,
    w: si.FloatArray,
    c: si.FloatArray,
    s: si.FloatArray,
) -> None:
    """H = 1 + ε cos T at the times, 1 in the padding, and the weights of p there for the mean force
    and its first harmonic, 0 in it.

    Ψ = P Hⁿ is nearly constant in time, P is not. So the trigonometric interpolant of Ψ − Hⁿ is
    integrated against H^-n exactly, through the Fourier coefficients of H^-n.
    """
    nt = times.number
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
    H[:] = 1.0
    w[:], c[:], s[:] = 0.0, 0.0, 0.0
    for t in range(nt):
        angle = 2.0 * math.pi * t / nt
        H[t] = 1.0 + eps * math.cos(angle)
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


@compiled(error_model="numpy", forceinline=True)
def fill_mesh(shape: int, a: float, mesh: Mesh) -> None:
    """Fill the grid from centre to edge, graded by a.

    The map is odd in ξ about the centre and the same for every number of cells, so that the error
    of the solution is a series in even powers of it, which the extrapolation needs.
    """
    count = len(mesh.slope)
    length = 0.5 if shape == STRIP else 1.0
    step = 1.0 / (count - 1)
    for i in range(count):
        x = i * step
        mesh.slope[i] = length * (1.0 + a - 3.0 * a * x * x)
        mesh.width[i] = 1.0 if shape == STRIP else x * (1.0 + a * (1.0 - x * x))


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


@compiled(error_model="numpy", forceinline=True)
def judge(
    over: si.FloatArray,
    sigma: float,
    local: float,
    n: float,
    depth: float,
    cells: int,
    shape: int,
    margin: float,
    out: si.FloatArray,
) -> None:
    """Fill a result row, which has its residual, with the over-pressure and its error.

    `over` is as by `solve_nested`, `local` σ of the gas as it flows, `depth` the largest relative
    excursion, `cells` those from the centre to an edge, `margin` what the error in time is of what
    more times change.
    """
    check, coarse, middle, fine = over[0], over[1], over[2], over[3]
    best = fine + (fine - middle) / 3.0 if not math.isnan(check) else math.nan
    out[OVER], out[CHECK], out[COARSE], out[MIDDLE], out[FINE] = best, check, coarse, middle, fine
    out[SPACE] = space_error(coarse, middle, fine, local, depth, cells, shape)
    out[TIME] = margin * abs(check - (coarse if cells > 4 else middle))
    lost = out[RESIDUAL] * abs(best) + rounding(sigma, n, best)
    out[ERROR] = out[SPACE] + out[TIME] + lost


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

    NaN marks a film that did not converge. `keep`, if not empty, receives what `solve_nested` keeps
    of the last film.
    """
    sigma, eps, n, kn, law, shape = films
    cells, times, fuller = resolution
    room = room_for(resolution)
    mesh = Mesh(np.empty(2 * cells + 1), np.empty(2 * cells + 1), True)
    # Rows of the gap and of the weights for the mean, for cos T and for sin T.
    size, more = times.row, fuller.row
    H, w, c, s = np.empty(size), np.empty(size), np.empty(size), np.empty(size)
    H2, w2, c2, s2 = np.empty(more), np.empty(more), np.empty(more), np.empty(more)
    at_times, at_checks = GapRows(H, w, 0), GapRows(H2, w2, 0)
    kept = keep if keep.size > 0 else np.empty(kept_size(resolution))
    # Over-pressure and first harmonic, of the check and of the three grids.
    level, harmonic = np.empty(4), np.empty(4, dtype=np.complex128)
    for case in range(start, stop):
        sig, e, poly, rare = sigma[case], eps[case], n[case], kn[case]
        # A disc of radius R films like a strip about 1.5 R wide.
        wide_sigma = sig if shape == STRIP else 2.25 * sig
        fill_mesh(shape, edge_grading(wide_sigma, e), mesh)
        fill_times(times, e, poly, H, w, c, s)
        fill_times(fuller, e, poly, H2, w2, c2, s2)
        gas = CompiledGas(poly, rare, law)
        row = out[case]
        row[ITERATIONS], row[RESIDUAL] = solve_nested(
            sig, gas, mesh, at_times, at_checks, resolution, tolerance, room, level, kept
        )
        local = wide_sigma / (poly * (1.0 + 6.0 * rare))
        judge(level, sig, local, poly, e, cells, shape, 2.0, row)
        if math.isnan(row[OVER]):
            continue
        m = max(cells // 4, 2)
        harmonic[0] = _first_harmonic(m, fuller, c2, s2, kept, 0)
        at, m = m * (fuller.row + 1), cells // 4
        for grid in range(1, 4):
            harmonic[grid] = _first_harmonic(m, times, c, s, kept, at)
            at, m = at + m * (times.row + 1), 2 * m
        # p = Re[F e^{iT}] with F = −(fk + i fd) ε.
        F0, F1, F2, F3 = harmonic[0], harmonic[1], harmonic[2], harmonic[3]
        force = -(F3 + (F3 - F2) / 3.0) / e
        row[STIFFNESS], row[DAMPING] = force.real, force.imag
        row[FORCE_SPACE] = space_error(F1, F2, F3, local, e, cells, shape) / e
        row[FORCE_TIME] = 2.0 * abs(F0 - (F1 if cells > 4 else F2)) / e
        lost = row[RESIDUAL] * abs(row[OVER]) + rounding(sig, poly, row[OVER])
        row[FORCE_ERROR] = row[FORCE_SPACE] + row[FORCE_TIME] + lost / e


@compiled(error_model="numpy", forceinline=True)
def _first_harmonic(
    m: int, times: PeriodTimes, c: si.FloatArray, s: si.FloatArray, kept: si.FloatArray, at: int
) -> complex:
    """F of the area mean Re[F e^{iT}] of p on m nodes, kept from `at` on: `c` weighs cos T, `s`
    weighs sin T, which is −Im F."""
    real, imag, shares = 0.0, 0.0, at + m * times.row
    for i in range(m):
        even, odd = 0.0, 0.0
        for t in range(times.number):
            p = kept[at + i * times.row + t]
            even += c[t] * p
            odd += s[t] * p
        real += kept[shares + i] * even
        imag += kept[shares + i] * odd
    return complex(real, -imag)
