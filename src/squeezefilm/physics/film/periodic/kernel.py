"""Newton solve of the periodic film on one grid, compiled: the inner loop of everything here.

Unknowns are the pressure deviations p = P − 1 at m nodes × nt times; a row of nt times is padded
to a multiple of eight lanes. The equation at node i, with M = P^{1/n} H the gas stored there,

    F[i+1] − F[i] − vol[i] · D M[i] = 0,   F[f] = g[f] Hf[f]³ φ[f] (Φ[f] − Φ[f−1]),
    Φ = n/(n+1) (P^{(n+1)/n} − 1),

is linearised in M: then its diagonal blocks are diag + vol·D with D the constant Fourier
differentiation matrix, its off-diagonal blocks are diagonal in time, and one block elimination
needs one small dense inverse a node and no other product of matrices.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.film.gas import NO_SLIP, CompiledGas
from squeezefilm.physics.film.mobility import slip_factor
from squeezefilm.physics.film.periodic.lanes import (
    LANES,
    add,
    broadcast,
    div,
    fma,
    item,
    largest_magnitude,
    load,
    mul,
    peak,
    store,
    sub,
    total,
)
from squeezefilm.physics.film.periodic.resolution import Cells, GridGap, PeriodTimes, SolveRoom

# `reassoc` and `contract` only: NaN must stay visible, so `nnan` and `ninf` stay off.
FAST = {"reassoc", "contract", "arcp", "nsz"}

MOST_STEPS = 60


class _Flow(NamedTuple):
    """Offsets of the rows in a solve's memory: storage R = P^{1/n}, q = dp/dM, potential Φ at
    nodes; fluxes at faces and their slopes. Numbers and not arrays, whose references numba counts:
    that took a tenth of the time of a small film."""

    storage: int
    q: int
    potential: int
    flux: int
    left: int
    right: int


@compiled(fastmath=FAST, error_model="numpy")
def _invert(S: si.FloatArray, start: int, nt: int, ntp: int, mask: si.FloatArray) -> None:
    """Invert the nt × nt block at `start` in place, without pivoting.

    The blocks are a positive diagonal plus an antisymmetric matrix (up to diagonal scaling), for
    which elimination without pivoting is stable. `mask` is one minus the unit matrix: it clears
    the pivot column inside the vector operation, where a scalar store would stall the next load.
    """
    for k in range(nt):
        pivot_row = start + k * ntp
        pivot = broadcast(1.0 / item(S, pivot_row + k))
        for v in range(0, ntp, LANES):
            keep = load(mask, k * ntp + v)
            one = sub(broadcast(1.0), keep)
            store(S, pivot_row + v, mul(fma(load(S, pivot_row + v), keep, one), pivot))
        for i in range(nt):
            if i != k:
                at = start + i * ntp
                factor = broadcast(-item(S, at + k))
                for v in range(0, ntp, LANES):
                    keep = load(mask, k * ntp + v)
                    row = load(S, pivot_row + v)
                    store(S, at + v, fma(factor, row, mul(load(S, at + v), keep)))


@compiled(fastmath=FAST, error_model="numpy")
def _apply(
    S: si.FloatArray,
    start: int,
    nt: int,
    ntp: int,
    work: si.FloatArray,
    at: int,
    to: int,
    accumulate: bool,
) -> None:
    """work[to:] (+)= Sᵀ work[at:] for the block at `start`, which holds the transposed inverse."""
    for v in range(0, ntp, LANES):
        result = load(work, to + v) if accumulate else broadcast(0.0)
        for j in range(nt):
            result = fma(broadcast(item(work, at + j)), load(S, start + j * ntp + v), result)
        store(work, to + v, result)


@compiled(inline="always")
def _face(gap: GridGap, f: int) -> int:
    """Where the gap's row of a face begins; that of a wall, where nothing flows, is any."""
    return max(gap.first + f * gap.stride - gap.stride // 2, 0)


@compiled(fastmath=FAST, error_model="numpy")
def _coefficients(
    m: int,
    ntp: int,
    g: si.FloatArray,
    gap: GridGap,
    gas: CompiledGas,
    p: si.FloatArray,
    work: si.FloatArray,
    flow: _Flow,
) -> None:
    """Fill the rows of `flow` at p: the slope of the flux F is −∂F/∂M left of the face, ∂F/∂M right
    of it."""
    H, _, first, stride = gap
    n, kn, law = gas
    R, q, Phi, F, cl, cr = flow
    one = broadcast(1.0)
    if n == 1.0:
        half = broadcast(0.5)
        for i in range(m):
            for v in range(0, ntp, LANES):
                at = i * ntp + v
                dev = load(p, at)
                P = add(one, dev)
                store(work, R + at, P)
                store(work, q + at, div(one, load(H, first + i * stride + v)))
                # p + p²/2 keeps its digits where p is small; (P² − 1)/2 would not.
                store(work, Phi + at, mul(dev, fma(half, dev, one)))
    else:
        inverse, share = 1.0 / n, n / (n + 1.0)
        for i in range(m):
            for t in range(ntp):
                at = i * ntp + t
                P = 1.0 + p[at]
                root = math.exp(inverse * math.log(P))
                work[R + at] = root
                work[q + at] = n * P / (H[first + i * stride + t] * root)
                work[Phi + at] = share * (P * root - 1.0)
    zero = broadcast(0.0)
    if law == NO_SLIP:
        for f in range(m + 1):
            geometry, face = broadcast(item(g, f)), _face(gap, f)
            for v in range(0, ntp, LANES):
                h = load(H, face + v)
                c = mul(geometry, mul(mul(h, h), h))
                left, right = (f - 1) * ntp + v, f * ntp + v
                a = load(work, Phi + left) if f > 0 else zero
                b = load(work, Phi + right) if f < m else zero
                store(work, F + right, mul(c, sub(b, a)))
                if f > 0:
                    store(work, cl + right, mul(c, mul(load(work, R + left), load(work, q + left))))
                if f < m:
                    store(
                        work, cr + right, mul(c, mul(load(work, R + right), load(work, q + right)))
                    )
        return
    for f in range(m + 1):
        if g[f] == 0.0:
            for v in range(0, ntp, LANES):
                store(work, F + f * ntp + v, zero)
                store(work, cl + f * ntp + v, zero)
                store(work, cr + f * ntp + v, zero)
            continue
        face = _face(gap, f)
        for t in range(ntp):
            left, right = (f - 1) * ntp + t, f * ntp + t
            Phi_a, R_a, q_a, p_a = 0.0, 1.0, 1.0, 0.0
            Phi_b, R_b, q_b, p_b = 0.0, 1.0, 1.0, 0.0
            if f > 0:
                Phi_a, R_a, q_a, p_a = work[Phi + left], work[R + left], work[q + left], p[left]
            if f < m:
                Phi_b, R_b, q_b, p_b = work[Phi + right], work[R + right], work[q + right], p[right]
            mean = 1.0 + 0.5 * (p_a + p_b)
            h = H[face + t]
            local = kn / (mean * h)
            factor, slope = slip_factor(law, local)
            c = g[f] * (h * h * h)
            rise = Phi_b - Phi_a
            bend = -0.5 * slope * local / mean * rise
            work[F + right] = c * factor * rise
            work[cl + right] = c * (factor * R_a - bend) * q_a
            work[cr + right] = c * (factor * R_b + bend) * q_b


@compiled(fastmath=FAST, error_model="numpy")
def newton(
    m: int,
    times: PeriodTimes,
    cells: Cells,
    gap: GridGap,
    gas: CompiledGas,
    p: si.FloatArray,
    room: SolveRoom,
    tolerance: float,
) -> tuple[float, int, float]:
    """Improve p (m rows of times) in place; return the over-pressure, iterations, last residual.

    The residual returned is the estimated relative error that the iteration leaves in the
    over-pressure; above the tolerance aimed at means not converged.
    """
    nt, ntp, DT, mask = times
    g, vol, share = cells
    H, weight, first, stride = gap
    n = gas.polytropic_exponent
    work, S = room
    size = m * ntp
    faces = size + ntp
    R, q, Phi, r, z, F = 0, size, 2 * size, 3 * size, 4 * size, 5 * size
    cl, cr, ol, our = F + faces, F + 2 * faces, F + 3 * faces, F + 4 * faces
    block = nt * ntp

    over = 0.0
    before = 1e300
    remaining = 1e300
    fresh = True
    iteration = 0
    while iteration < MOST_STEPS:
        iteration += 1
        _coefficients(m, ntp, g, gap, gas, p, work, _Flow(R, q, Phi, F, cl, cr))
        if fresh:
            our, cr = cr, our
            ol, cl = cl, ol
        for i in range(m):
            amount = broadcast(-item(vol, i))
            for v in range(0, ntp, LANES):
                at = i * ntp + v
                change = broadcast(0.0)
                for j in range(nt):
                    M = broadcast(item(work, R + i * ntp + j) * item(H, first + i * stride + j))
                    change = fma(M, load(DT, j * ntp + v), change)
                flow = sub(load(work, F + at + ntp), load(work, F + at))
                store(work, r + at, fma(amount, change, flow))
        for i in range(m):
            start = i * block
            at = i * ntp
            if fresh:
                for j in range(nt):
                    row = start + j * ntp
                    diagonal = broadcast(item(work, ol + at + ntp + j) + item(work, our + at + j))
                    for v in range(0, ntp, LANES):
                        unit = sub(broadcast(1.0), load(mask, j * ntp + v))
                        entry = mul(broadcast(item(vol, i)), load(DT, j * ntp + v))
                        entry = fma(diagonal, unit, entry)
                        if i > 0:
                            link = mul(
                                broadcast(-item(work, our + at + j)), load(work, ol + at + v)
                            )
                            entry = fma(link, load(S, row - block + v), entry)
                        store(S, row + v, entry)
                _invert(S, start, nt, ntp, mask)
            if i > 0:
                for v in range(0, ntp, LANES):
                    carried = mul(load(work, ol + at + v), load(work, z + at - ntp + v))
                    store(work, r + at + v, add(load(work, r + at + v), carried))
            _apply(S, start, nt, ntp, work, r + at, z + at, False)
        for i in range(m - 2, -1, -1):
            at = i * ntp
            for v in range(0, ntp, LANES):
                carried = mul(load(work, our + at + ntp + v), load(work, z + at + ntp + v))
                store(work, r + at + v, carried)
            _apply(S, i * block, nt, ntp, work, r + at, z + at, True)
        size_of_step = broadcast(0.0)
        for i in range(m):
            for v in range(0, ntp, LANES):
                at = i * ntp + v
                held = mul(load(H, first + i * stride + v), load(work, R + at))
                size_of_step = largest_magnitude(size_of_step, div(load(work, z + at), held))
        largest = peak(size_of_step)
        # A full step must leave gas everywhere; 0.8 keeps a margin for the logarithm.
        scale = 1.0
        if largest > 0.8:
            deepest = 0.0
            for i in range(m):
                for t in range(nt):
                    at = i * ntp + t
                    deepest = max(
                        deepest, -work[z + at] / (H[first + i * stride + t] * work[R + at])
                    )
            if deepest > 0.8:
                scale = 0.8 / deepest
        over = 0.0
        for i in range(m):
            part = broadcast(0.0)
            for v in range(0, ntp, LANES):
                at = i * ntp + v
                rise = mul(
                    broadcast(scale), div(load(work, z + at), load(H, first + i * stride + v))
                )
                if n == 1.0:
                    store(p, at, add(rise, load(p, at)))
                else:
                    store(work, R + at, add(rise, load(work, R + at)))
                    for t in range(at, at + LANES):
                        p[t] = math.exp(n * math.log(work[R + t])) - 1.0
                part = fma(load(weight, (first + i * stride) // 2 + v), load(p, at), part)
            over += share[i] * total(part)
        if not abs(over) < 1e300:
            return math.nan, iteration, math.inf
        # What remains after a Newton step is about its square; after a chord step, the
        # geometric tail of the steps so far.
        goal = tolerance * abs(over) / (1.0 + abs(over))
        if scale < 1.0:
            left = 1.0
        elif fresh:
            left = largest * largest
        else:
            rate = largest / before
            left = largest * rate / (1.0 - rate) if rate < 1.0 else 1.0
        remaining = left * (1.0 + abs(over)) / max(abs(over), 1e-300)
        if left <= goal:
            break
        # Keep the old inverses while they gain: a chord step costs a fifth of a Newton step.
        fresh = scale < 1.0 or largest > 0.03 or (largest > 0.1 * before and not fresh)
        before = largest
    return over, iteration, remaining
