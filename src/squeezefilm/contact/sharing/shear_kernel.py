"""The compiled shear of what touches within a period: stick, slip and the load that comes and goes.

Shear over µ is the limit that friction sets less a deficit, which is 0 while it slides. Phases are
counted from the least gap. Both halves of the period see the same gaps, so that what is needed
along them (limit, stiffness and their integrals) is found once per plateau, on points that cover
where anything touches, and serves every speed. All functions run without the interpreter.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.compiled import compiled
from squeezefilm.contact.asperities import LINEAR_OVERLAP, CompiledAsperities
from squeezefilm.contact.asperity_kernel import (
    asperities_at,
    held_along,
    held_at,
    touching_phase,
)

RIGID, CONSTANT, FOLLOWING = range(3)

_STEPS = 64
# Rows of what is known along the half period. The integrals are over phase, from the least gap on;
# DRAGGED is that of STIFFNESS, SHED of STIFFNESS/LIMIT, KEPT of LIMIT times SHED.
_LIMIT, _RISE, _STIFFNESS, _HELD, _DRAGGED, _DRAGGED_TWICE, _SHED, _KEPT = range(8)
_ROWS = 8


def _step_weights() -> si.FloatArray:
    """The integral over step i of the polynomial through six points 0 … 5, as weights of these."""
    powers = np.arange(6.0)
    moments = ((powers[:5, None] + 1) ** (powers + 1) - powers[:5, None] ** (powers + 1)) / (
        powers + 1
    )
    return np.asarray(np.linalg.solve(powers[None, :] ** powers[:, None], moments.T).T)


_WEIGHTS = _step_weights()


class CompiledShear(NamedTuple):
    """An elastic tangential element: its kind, and `advance` κ U/(µ ω) in m at each speed."""

    kind: int
    advance: si.FloatArray


@compiled(error_model="numpy")
def _integrate(values: si.FloatArray, step: float, out: si.FloatArray) -> None:
    """The integral from the first point on, by sixth-order pieces."""
    last = len(values) - 1
    near, middle, far = step * _WEIGHTS[2, 2], step * _WEIGHTS[2, 1], step * _WEIGHTS[2, 0]
    for k in range(last - 4):
        out[k + 3] = (
            near * (values[k + 2] + values[k + 3])
            + middle * (values[k + 1] + values[k + 4])
            + far * (values[k] + values[k + 5])
        )
    for k in range(2):
        first, final = 0.0, 0.0
        for j in range(6):
            first += _WEIGHTS[k, j] * values[j]
            final += _WEIGHTS[k, j] * values[last - j]
        out[k + 1], out[last - k] = step * first, step * final
    total = 0.0
    out[0] = 0.0
    for k in range(1, last + 1):
        total += out[k]
        out[k] = total


@compiled(error_model="numpy")
def _fill(
    asperities: CompiledAsperities, u: float, a: float, constant: float, rows: si.FloatArray
) -> float:
    """What is known along the half period, into `rows`; the phase per step. A `constant` stiffness
    (Pa/m) above 0 takes the place of that at every moment."""
    step = touching_phase(asperities, u, a) / _STEPS
    held_along(asperities, u, a, step, rows[:3])
    if constant > 0.0:
        rows[_STIFFNESS] = constant
    _integrate(rows[_LIMIT], step, rows[_HELD])
    _integrate(rows[_STIFFNESS], step, rows[_DRAGGED])
    _integrate(rows[_DRAGGED], step, rows[_DRAGGED_TWICE])
    if constant <= 0.0:
        for k in range(_STEPS + 1):
            rows[_KEPT, k] = rows[_STIFFNESS, k] / rows[_LIMIT, k]
        _integrate(rows[_KEPT], step, rows[_SHED])
        _integrate(rows[_LIMIT] * rows[_SHED], step, rows[_KEPT])
    return step


@compiled(error_model="numpy")
def _between(row: si.FloatArray, x: float) -> float:
    """A row at a place between its points, by the polynomial through the six around it."""
    first = min(max(int(x) - 2, 0), len(row) - 6)
    t, total = x - first, 0.0
    for j in range(6):
        weight = 1.0
        for m in range(6):
            if m != j:
                weight *= (t - m) / (j - m)
        total += weight * row[first + j]
    return total


@compiled(error_model="numpy")
def _onset(rows: si.FloatArray, advance: float, k: int) -> float:
    """Where between points k and k + 1 the limit begins to rise faster than the shear."""
    near = rows[_RISE, k] - advance * rows[_STIFFNESS, k]
    far = rows[_RISE, k + 1] - advance * rows[_STIFFNESS, k + 1]
    x, slope = k + near / (near - far), far - near
    for _ in range(2):
        miss = _between(rows[_RISE], x) - advance * _between(rows[_STIFFNESS], x)
        x = min(max(x - miss / slope, float(k)), k + 1.0)
    return float(x)


@compiled(error_model="numpy")
def _along(values: si.FloatArray, integrals: si.FloatArray, advance: float, x: float) -> float:
    return _between(values, x) + advance * _between(integrals, x)


@compiled(error_model="numpy")
def _slip(
    rows: si.FloatArray, step: float, level: float, advance: float, ends: tuple[float, float]
) -> float:
    """Where between two places level + LIMIT + advance · DRAGGED, the deficit, is 0: by Newton's
    method, since an error of the place counts by its square."""
    low, high = ends
    near = level + _along(rows[_LIMIT], rows[_DRAGGED], advance, low)
    far = level + _along(rows[_LIMIT], rows[_DRAGGED], advance, high)
    x = low + (high - low) * near / (near - far) if near != far else 0.5 * (low + high)
    for _ in range(2):
        miss = level + _along(rows[_LIMIT], rows[_DRAGGED], advance, x)
        slope = step * (advance * _between(rows[_STIFFNESS], x) - _between(rows[_RISE], x))
        if slope != 0.0:
            x = min(max(x - miss / slope, low), high)
    return float(x)


@compiled(error_model="numpy")
def _loading(
    rows: si.FloatArray, step: float, advance: float, deficit: float
) -> tuple[float, float, bool]:
    """From the largest gap to the least: the deficit (Pa over µ) there, its integral over the
    phase, and whether anything slid on the way.

    While it sticks the deficit is level + LIMIT + advance · DRAGGED.
    """
    limit, dragged, held, twice = rows[_LIMIT], rows[_DRAGGED], rows[_HELD], rows[_DRAGGED_TWICE]
    grew = rows[_RISE, _STEPS] > advance * rows[_STIFFNESS, _STEPS]
    stuck, slid, total, begun = deficit > 0.0 or grew, deficit <= 0.0, 0.0, float(_STEPS)
    level = deficit - limit[_STEPS] - advance * dragged[_STEPS]
    area = held[_STEPS] + advance * twice[_STEPS]
    for k in range(_STEPS - 1, -1, -1):
        grows = rows[_RISE, k] > advance * rows[_STIFFNESS, k]
        # Where the limit begins to rise faster than the shear the deficit is least.
        trough = grows and not grew
        x, left = float(k), level + limit[k] + advance * dragged[k]
        if trough:
            x = _onset(rows, advance, k)
            left = level + _along(limit, dragged, advance, x)
        if stuck and left <= 0.0 and not (grows and grew):
            end = _slip(rows, step, level, advance, (x, k + 1.0))
            total += level * (begun - end) * step + area - _along(held, twice, advance, end)
            stuck, slid = False, True
        if trough and not stuck:
            stuck, begun = True, x
            level = -_along(limit, dragged, advance, x)
            area = _along(held, twice, advance, x)
        grew = grows
    if not stuck:
        return 0.0, total, True
    return level + limit[0], total + level * begun * step + area, slid


@compiled(error_model="numpy")
def _unloading(
    rows: si.FloatArray, step: float, advance: float, deficit: float
) -> tuple[float, float]:
    """From the least gap to the largest under a constant stiffness: the deficit there and its
    integral. It falls all the way."""
    level = deficit - rows[_LIMIT, 0]
    for k in range(1, _STEPS + 1):
        if level + rows[_LIMIT, k] - advance * rows[_DRAGGED, k] <= 0.0:
            end = _slip(rows, step, level, -advance, (k - 1.0, float(k)))
            return 0.0, level * end * step + _along(
                rows[_HELD], rows[_DRAGGED_TWICE], -advance, end
            )
    left = level + rows[_LIMIT, _STEPS] - advance * rows[_DRAGGED, _STEPS]
    held = rows[_HELD, _STEPS] - advance * rows[_DRAGGED_TWICE, _STEPS]
    return left, level * _STEPS * step + held


@compiled(error_model="numpy")
def _parting(
    rows: si.FloatArray, step: float, advance: float, deficit: float
) -> tuple[float, float]:
    """`_unloading` where asperities that part take their share of the shear with them: what sticks
    is scaled, and the deficit over the limit falls by the advance alone."""
    lack = deficit / rows[_LIMIT, 0]
    for k in range(1, _STEPS + 1):
        if advance * rows[_SHED, k] >= lack:
            near, far = rows[_SHED, k - 1], rows[_SHED, k]
            end = k - 1 + (lack / advance - near) / (far - near)
            slope = _between(rows[_STIFFNESS], end) / _between(rows[_LIMIT], end) * step
            end += (lack / advance - _between(rows[_SHED], end)) / slope
            return 0.0, lack * _along(rows[_HELD], rows[_KEPT], -advance / lack, end)
    left = (lack - advance * rows[_SHED, _STEPS]) * rows[_LIMIT, _STEPS]
    return left, lack * rows[_HELD, _STEPS] - advance * rows[_KEPT, _STEPS]


@compiled(error_model="numpy")
def _lost(rows: si.FloatArray, step: float, advance: float, following: bool) -> float:
    """The deficit's integral over a period that repeats (Pa over µ, times phase).

    Begun without a deficit at the largest gap, the next period begins with what is left at its
    end. Where that one slides at all, nothing is left of how it began, and it repeats. Where it
    does not, which a constant stiffness never does, deficits are linear in the one at the start.
    """
    apart = step * _STEPS < math.pi * (1.0 - 1e-12)
    start, total = 0.0, 0.0
    for _ in range(2):
        deficit, total, slid = _loading(rows, step, advance, start)
        if deficit > 0.0:
            if following:
                start, more = _parting(rows, step, advance, deficit)
            else:
                start, more = _unloading(rows, step, advance, deficit)
            total += more
            slid = slid or start <= 0.0
        else:
            start = 0.0
        if apart or start <= 0.0:
            return total
    if slid or not following:
        return total
    most, least = rows[_LIMIT, 0], rows[_LIMIT, _STEPS]
    dragged, shed = advance * rows[_DRAGGED, _STEPS], advance * rows[_SHED, _STEPS]
    lack = 1.0 - (dragged + least * shed) / (most - least)
    level = lack * most - most
    loading = level * step * _STEPS + rows[_HELD, _STEPS]
    loading += advance * rows[_DRAGGED_TWICE, _STEPS]
    parting = lack * rows[_HELD, _STEPS] - advance * rows[_KEPT, _STEPS]
    return float(loading + parting)


@compiled(error_model="numpy")
def gap_at_rest(asperities: CompiledAsperities, pressure: float) -> float:
    """The gap (m) at which asperities alone carry a pressure (Pa), by Newton's method in ln p."""
    u = asperities.constants[1]
    for _ in range(60):
        found, stiffness = asperities_at(asperities, u)
        if found <= 0.0:
            u -= asperities.constants[2]
            continue
        step = math.log(found / pressure) * found / stiffness
        u += step
        if abs(step) <= 1e-12 * asperities.constants[2]:
            break
    return float(u)


@compiled(error_model="numpy")
def sheared_rows(
    asperities: CompiledAsperities, shared: si.FloatArray, shear: CompiledShear, out: si.FloatArray
) -> None:
    """µ′/µ of plateaus at speeds, into `out` (speeds by plateaus); the columns of `shared` are
    their mean gap and its amplitude (m) and their pressure (Pa)."""
    rows = np.empty((_ROWS, _STEPS + 1))
    known, rest, stiffness = math.nan, math.nan, 0.0
    for i in range(len(shared)):
        gap, swing, pressure = shared[i]
        if pressure != known:
            known = pressure
            rest, stiffness = held_at(asperities, gap_at_rest(asperities, pressure))
        if touching_phase(asperities, gap, swing) <= 0.0:
            out[:, i] = 0.0
            continue
        constant = 0.0 if shear.kind == FOLLOWING else stiffness
        step = _fill(asperities, gap, swing, constant, rows)
        held = rows[_HELD, _STEPS]
        if asperities.kind != LINEAR_OVERLAP:
            # What is smooth over the period is averaged best by the plainest rule.
            limit = rows[_LIMIT]
            held = step * (0.5 * (limit[0] + limit[_STEPS]) + limit[1:_STEPS].sum())
        for j in range(len(shear.advance)):
            lost = 0.0
            if shear.kind != RIGID:
                lost = _lost(rows, step, shear.advance[j], shear.kind == FOLLOWING)
            out[j, i] = (held - 0.5 * lost) / (math.pi * rest)
