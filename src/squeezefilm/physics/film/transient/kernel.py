"""One compiled march of the conservative film equation on a line of finite volumes.

The unknown is the gas held per area, m = P^{1/n} H, because its balance is what must close; the
pressure follows as P = (m/H)^n. Splitting ∂m/∂T into H Ṗ + P Ḣ errs by tens of percent at
large squeeze numbers; this form does not.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.film.gas import Aim, Gas
from squeezefilm.physics.film.mobility import mobility


class Line(NamedTuple):
    """Volume of the cells (N,) and conductance of the faces (N+1,): 0 at a wall or a line of
    symmetry."""

    volume: si.Array
    conductance: si.Array


class Gaps(NamedTuple):
    """The gap in cells (N,) and at faces (N+1,), or with a row of them for every stage."""

    cell: si.Array
    face: si.Array


class Pace(NamedTuple):
    """The step in time (rad), the squeeze number, and the scheme's code."""

    time_step: float
    squeeze_number: float
    scheme: int


class Track(NamedTuple):
    """What a march writes: the load after each step, and into row `keep[k]` of `field` the pressure
    after step k, nowhere for −1."""

    load: si.Array
    field: si.Array
    keep: si.Array


@compiled()
def implicit_stage(
    m: si.Array,
    held: si.Array,
    gap: Gaps,
    line: Line,
    step: float,
    gas: Gas,
    aim: Aim,
    outflow: si.Array,
) -> Any:
    """Solve volume (m − held) = step · (net inflow at m) for m, by Newton with one sweep a step.

    `m` (start and answer) and `held` have shape (N,). `step` is γΔT/σ. `outflow[0]`, `[1]` take
    the flow through the left and the right end. Returns (largest relative change, iterations).
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
    iteration = 0
    last = np.inf
    for iteration in range(1, aim.most + 1):
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
            return np.inf, iteration
        # Quadratic convergence: a change below sqrt(tolerance) leaves an error below tolerance,
        # but only rounding stops a change that no longer falls.
        if change <= aim.tolerance or (change < 1e-10 and change >= 0.5 * last):
            break
        last = change
    for side in range(2):
        j = 0 if side == 0 else N
        outflow[side] = 0.0
        if conductance[j] != 0.0:
            i = 0 if side == 0 else N - 1
            P_i = m[i] / H[i] if n == 1.0 else (m[i] / H[i]) ** n
            value, _ = mobility(H_face[j], 0.5 * (P_i + 1.0), n, knudsen, model)
            outflow[side] = step * conductance[j] * value * (P_i - 1.0)
    return change, iteration


BACKWARD_EULER, SDIRK2, BDF2 = 1, 2, 3


@compiled()
def march(
    m: si.Array,
    before: si.Array,
    gaps: Gaps,
    line: Line,
    pace: Pace,
    gas: Gas,
    aim: Aim,
    track: Track,
) -> Any:
    """March `m` in place over as many steps as the track's load is long.

    `gaps` are those of every stage in order: two stages a step for SDIRK2 (Alexander: L-stable,
    its last stage is the new value), one for the others. `before` (N,) is the gas one step before
    `m`; BDF2 reads it, all keep it up to date. Returns (gas lost through the ends, largest change
    of the last Newton step, Newton steps made, steps done); steps done is short where one failed.
    """
    H, H_face = gaps
    volume = line.volume
    scheme, n = pace.scheme, gas.polytropic_exponent
    load, field, keep = track
    gamma = 1.0
    if scheme == SDIRK2:
        gamma = 1.0 - np.sqrt(0.5)
    elif scheme == BDF2:
        gamma = 2.0 / 3.0
    step = gamma * pace.time_step / pace.squeeze_number
    N = m.size
    held = np.empty(N)
    outflow = np.zeros(2)
    total = 0.0
    for i in range(N):
        total += volume[i]
    lost = 0.0
    worst = 0.0
    made = 0
    for k in range(load.size):
        stage = k
        for i in range(N):
            held[i] = m[i]
            if scheme == BDF2:
                held[i] = (4.0 * m[i] - before[i]) / 3.0
            before[i] = m[i]
        weight = 1.0
        if scheme == SDIRK2:
            stage = 2 * k
            gap = Gaps(H[stage], H_face[stage])
            change, count = implicit_stage(m, held, gap, line, step, gas, aim, outflow)
            made += count
            if not change < 1e-6:
                return lost, change, made, k
            share = (1.0 - gamma) / gamma
            lost += share * (outflow[0] + outflow[1])
            for i in range(N):
                held[i] += share * (m[i] - held[i])
            stage += 1
        elif scheme == BDF2:
            weight = 1.5
        gap = Gaps(H[stage], H_face[stage])
        change, count = implicit_stage(m, held, gap, line, step, gas, aim, outflow)
        made += count
        if not change < 1e-6:
            return lost, change, made, k
        lost += weight * (outflow[0] + outflow[1])
        worst = max(worst, change)
        W = 0.0
        for i in range(N):
            P = m[i] / H[stage, i]
            if n != 1.0:
                P = P**n
            W += volume[i] * P
            if keep[k] >= 0:
                field[keep[k], i] = P
        load[k] = W / total
    return lost, worst, made, load.size
