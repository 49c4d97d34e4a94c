"""Newton solve of the periodic film on one grid, compiled: the inner loop of everything here.

Unknowns are the pressure deviations p = P − 1 at m nodes × nt times. The equation at node i, with
M = P^{1/n} H the gas stored there,

    F[i+1] − F[i] − vol[i] · D M[i] = 0,   F[f] = g[f] Hf[f]³ φ[f] (Φ[f] − Φ[f−1]),
    Φ = n/(n+1) (P^{(n+1)/n} − 1),

is linearised in M: then its diagonal blocks are diag + vol·D with D the constant Fourier
differentiation matrix, its off-diagonal blocks are diagonal in time, and one block elimination
needs one small dense inverse a node and no other product of matrices.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.film.gas import NO_SLIP, Aim, CompiledGas
from squeezefilm.physics.film.mobility import slip_factor
from squeezefilm.physics.film.periodic.resolution import Cells, GridGap, PeriodTimes

# `reassoc` and `contract` only: NaN must stay visible, so `nnan` and `ninf` stay off.
_FAST = {"reassoc", "contract", "arcp", "nsz"}


class _Flow(NamedTuple):
    """At nodes (m, times) storage R = P^{1/n}, q = dp/dM and potential Φ; at faces (m + 1, times)
    the flux F and its slopes, −∂F/∂M of the node on the left and ∂F/∂M of that on the right."""

    storage: si.FloatArray
    q: si.FloatArray
    potential: si.FloatArray
    flux: si.FloatArray
    left: si.FloatArray
    right: si.FloatArray


@compiled(fastmath=_FAST, error_model="numpy")
def _invert(S: si.FloatArray) -> None:
    """Invert a block in place, without pivoting.

    The blocks are a positive diagonal plus an antisymmetric matrix (up to diagonal scaling), for
    which elimination without pivoting is stable.
    """
    nt = S.shape[0]
    for k in range(nt):
        pivot = 1.0 / S[k, k]
        S[k, k] = 1.0
        for j in range(nt):
            S[k, j] *= pivot
        for i in range(nt):
            if i != k:
                factor = S[i, k]
                S[i, k] = 0.0
                for j in range(nt):
                    S[i, j] -= factor * S[k, j]


@compiled(fastmath=_FAST, error_model="numpy")
def _apply(S: si.FloatArray, right: si.FloatArray, out: si.FloatArray) -> None:
    """out += Sᵀ right for a block S, the transposed inverse."""
    for j in range(S.shape[0]):
        value = right[j]
        for t in range(S.shape[0]):
            out[t] += value * S[j, t]


@compiled(fastmath=_FAST, error_model="numpy")
def _fill(g: si.FloatArray, gap: GridGap, gas: CompiledGas, p: si.FloatArray, flow: _Flow) -> None:
    """Fill the rows of `flow` at p."""
    H, Hf, stride = gap.node, gap.face, gap.stride
    n, kn, law = gas
    R, q, Phi, F, left, right = flow
    m, nt = p.shape
    for i in range(m):
        for t in range(nt):
            P = 1.0 + p[i, t]
            if n == 1.0:
                R[i, t] = P
                q[i, t] = 1.0 / H[i * stride, t]
                # p + p²/2 keeps its digits where p is small; (P² − 1)/2 would not.
                Phi[i, t] = p[i, t] * (1.0 + 0.5 * p[i, t])
            else:
                root = math.exp(math.log(P) / n)
                R[i, t] = root
                q[i, t] = n * P / (H[i * stride, t] * root)
                Phi[i, t] = n / (n + 1.0) * (P * root - 1.0)
    for f in range(m + 1):
        for t in range(nt):
            Phi_a, R_a, q_a, p_a = 0.0, 1.0, 1.0, 0.0
            Phi_b, R_b, q_b, p_b = 0.0, 1.0, 1.0, 0.0
            if f > 0:
                Phi_a, R_a, q_a, p_a = Phi[f - 1, t], R[f - 1, t], q[f - 1, t], p[f - 1, t]
            if f < m:
                Phi_b, R_b, q_b, p_b = Phi[f, t], R[f, t], q[f, t], p[f, t]
            h = Hf[f * stride, t]
            c, rise, factor, bend = g[f] * h * h * h, Phi_b - Phi_a, 1.0, 0.0
            if law != NO_SLIP:
                mean = 1.0 + 0.5 * (p_a + p_b)
                local = kn / (mean * h)
                factor, slope = slip_factor(law, local)
                bend = -0.5 * slope * local / mean * rise
            F[f, t] = c * factor * rise
            left[f, t] = c * (factor * R_a - bend) * q_a
            right[f, t] = c * (factor * R_b + bend) * q_b


@compiled(fastmath=_FAST, error_model="numpy")
def newton(
    times: PeriodTimes, cells: Cells, gap: GridGap, gas: CompiledGas, p: si.FloatArray, aim: Aim
) -> tuple[float, int, float]:
    """Improve p (nodes, times) in place; return the over-pressure, iterations, last residual.

    The residual returned is the estimated relative error that the iteration leaves in the
    over-pressure; above the tolerance aimed at means not converged.
    """
    DT = times.derivative
    g, vol, share = cells
    H, weight, stride = gap.node, gap.weight, gap.stride
    n = gas.polytropic_exponent
    m, nt = p.shape
    nodes, faces, S = np.empty((5, m, nt)), np.empty((5, m + 1, nt)), np.empty((m, nt, nt))
    flow = _Flow(nodes[0], nodes[1], nodes[2], faces[0], faces[1], faces[2])
    R, F, r, z, lower, upper = nodes[0], faces[0], nodes[3], nodes[4], faces[3], faces[4]

    over, before, remaining = 0.0, 1e300, 1e300
    fresh = True
    iteration = 0
    while iteration < aim.most:
        iteration += 1
        _fill(g, gap, gas, p, flow)
        if fresh:
            faces[3:] = faces[1:3]
        for i in range(m):
            for t in range(nt):
                r[i, t] = F[i + 1, t] - F[i, t]
            for j in range(nt):
                stored = vol[i] * R[i, j] * H[i * stride, j]
                for t in range(nt):
                    r[i, t] -= stored * DT[j, t]
            if fresh:
                for j in range(nt):
                    for t in range(nt):
                        S[i, j, t] = vol[i] * DT[j, t]
                        if i > 0:
                            S[i, j, t] -= upper[i, j] * lower[i, t] * S[i - 1, j, t]
                    S[i, j, j] += lower[i + 1, j] + upper[i, j]
                _invert(S[i])
            if i > 0:
                for t in range(nt):
                    r[i, t] += lower[i, t] * z[i - 1, t]
            z[i] = 0.0
            _apply(S[i], r[i], z[i])
        for i in range(m - 2, -1, -1):
            for t in range(nt):
                r[i, t] = upper[i + 1, t] * z[i + 1, t]
            _apply(S[i], r[i], z[i])
        largest, deepest = 0.0, 0.0
        for i in range(m):
            for t in range(nt):
                part = z[i, t] / (H[i * stride, t] * R[i, t])
                largest, deepest = max(largest, abs(part)), max(deepest, -part)
        # A full step must leave gas everywhere; 0.8 keeps a margin for the logarithm.
        scale = 0.8 / deepest if deepest > 0.8 else 1.0
        over = 0.0
        for i in range(m):
            part = 0.0
            for t in range(nt):
                rise = scale * z[i, t] / H[i * stride, t]
                if n == 1.0:
                    p[i, t] += rise
                else:
                    p[i, t] = math.exp(n * math.log(R[i, t] + rise)) - 1.0
                part += weight[i * stride, t] * p[i, t]
            over += share[i] * part
        if not abs(over) < 1e300:
            return math.nan, iteration, math.inf
        # What remains after a Newton step is about its square; after a chord step, the
        # geometric tail of the steps so far.
        goal = aim.tolerance * abs(over) / (1.0 + abs(over))
        if scale < 1.0:
            rest = 1.0
        elif fresh:
            rest = largest * largest
        else:
            rate = largest / before
            rest = largest * rate / (1.0 - rate) if rate < 1.0 else 1.0
        remaining = rest * (1.0 + abs(over)) / max(abs(over), 1e-300)
        if rest <= goal:
            break
        # Keep the old inverses while they gain: a chord step costs a fifth of a Newton step.
        fresh = scale < 1.0 or largest > 0.03 or (largest > 0.1 * before and not fresh)
        before = largest
    return over, iteration, remaining


@compiled(fastmath=_FAST, error_model="numpy")
def prolong(coarse: si.FloatArray, closed: bool) -> si.FloatArray:
    """Carry p (m, times) to the grid with twice the cells, by cubics.

    With `closed`, node 0 is a plane of symmetry and the edge follows node m − 1 (2m rows come
    out); without, both neighbours outside are edges (2m + 1 rows come out).
    """
    m, nt = coarse.shape
    parts = 2 * m if closed else m + 1
    whole = np.zeros((parts + 1, nt))
    for i in range(m):
        whole[m + i if closed else i + 1] = coarse[i]
        if closed:
            whole[m - i] = coarse[i]
    fine = np.zeros((2 * parts + 1, nt))
    fine[::2] = whole
    for i in range(parts):
        if parts < 3:
            # The edges are 0: the parabola through what is between.
            fine[2 * i + 1] = 0.75 * whole[1]
            continue
        # Of four neighbours, between the first two, the middle ones or the last.
        first = min(max(i - 1, 0), parts - 3)
        a, b, c, d = whole[first], whole[first + 1], whole[first + 2], whole[first + 3]
        if i == first:
            fine[2 * i + 1] = (5.0 * a + 15.0 * b - 5.0 * c + d) / 16.0
        elif i == first + 1:
            fine[2 * i + 1] = (9.0 * (b + c) - a - d) / 16.0
        else:
            fine[2 * i + 1] = (a - 5.0 * b + 15.0 * c + 5.0 * d) / 16.0
    return fine[parts : 2 * parts] if closed else fine[1 : 2 * parts]
