"""The compiled shear of what touches within a period: stick, slip and the load that comes and goes.

All functions run without the interpreter.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.compiled import compiled
from squeezefilm.contact.asperities import CompiledAsperities
from squeezefilm.contact.asperity_kernel import asperities_at, asperity_mean

RIGID, CONSTANT, FOLLOWING = range(3)

_HALF = 64
_ROUNDS = 12


class CompiledShear(NamedTuple):
    """An elastic tangential element: its kind, `advance` κ U/(µ ω) in m, and for a constant
    stiffness −dp_a/dh at rest in Pa/m. `full` is that pressure at which real contact is full, of
    which friction is in proportion to erf(√2 p/full); 0 where it is in proportion to the load."""

    kind: int
    advance: float
    stiffness: float
    full: float


@compiled(error_model="numpy")
def friction_limit(pressure: float, full: float) -> float:
    """What friction can hold over µ, in Pa: the pressure, or in proportion to the real contact
    area and equal to the pressure where that is small."""
    if full <= 0.0:
        return pressure
    slope = math.sqrt(2.0) / full
    return math.sqrt(math.pi) / (2.0 * slope) * math.erf(slope * pressure)


@compiled(error_model="numpy")
def _profiles(
    asperities: CompiledAsperities, u: float, a: float, shear: CompiledShear
) -> si.FloatArray:
    """Limit (Pa over µ), its rise and the advance of sticking shear (Pa/rad) over half a period,
    from the largest gap on."""
    rows = np.empty((3, _HALF + 1))
    for k in range(_HALF + 1):
        theta = math.pi * k / _HALF
        h = u + a * math.cos(theta)
        pressure, stiffness = asperities_at(asperities, h)
        rows[0, k] = friction_limit(pressure, shear.full)
        rows[1, k] = stiffness * a * math.sin(theta)
        if shear.full > 0.0:
            rows[1, k] *= math.exp(-2.0 * (pressure / shear.full) ** 2)
        rows[2, k] = shear.advance * (stiffness if shear.kind == FOLLOWING else shear.stiffness)
    return rows


@compiled(error_model="numpy")
def _over(values: si.FloatArray, k: int) -> float:
    """The integral from point k to k + 1, in steps, of what is even at both ends: fourth order."""
    before = values[k - 1] if k > 0 else values[1]
    after = values[k + 2] if k + 2 <= _HALF else values[_HALF - 1]
    return float((13.0 * (values[k] + values[k + 1]) - before - after) / 24.0)


@compiled(error_model="numpy")
def _part(start: float, end: float, slope_start: float, slope_end: float) -> tuple[float, float]:
    """How the deficit goes on over one step, and its integral, both in steps."""
    if start == 0.0 and slope_start < 0.0:
        # Sliding at first: sticking begins where the limit rises as fast as the shear.
        if slope_end <= 0.0:
            return 0.0, 0.0
        left = slope_end / (slope_end - slope_start)
        end = 0.5 * left * slope_end
        return end, end * left / 3.0
    if end <= 0.0:
        # Sliding at the end: the shear meets the limit on the way.
        return 0.0, 0.5 * start * start / (start - end) if start > 0.0 else 0.0
    return end, 0.5 * (start + end) + (slope_start - slope_end) / 12.0


@compiled(error_model="numpy")
def _period(rows: si.FloatArray, following: bool, deficit: float) -> tuple[float, float]:
    """A period from the largest gap on, begun with a deficit of shear under its limit (Pa over µ):
    the deficit at its end and its integral over the phase, in steps."""
    limit, rise, advance = rows
    step = math.pi / _HALF
    total = 0.0
    for k in range(_HALF):
        end = deficit + limit[k + 1] - limit[k] - step * _over(advance, k)
        slopes = step * (rise[k] - advance[k]), step * (rise[k + 1] - advance[k + 1])
        deficit, part = _part(deficit, end, slopes[0], slopes[1])
        total += part
    share = advance / limit
    for k in range(_HALF - 1, -1, -1):
        if deficit <= 0.0:
            break
        if following:
            # Asperities that part take their share of the shear with them: what sticks is scaled.
            lack = deficit / limit[k + 1]
            left = lack - step * _over(share, k)
            slopes = (
                step * (-rise[k + 1] * lack - advance[k + 1]),
                step * (-rise[k] * left - advance[k]),
            )
            end = left * limit[k]
        else:
            end = deficit + limit[k] - limit[k + 1] - step * _over(advance, k)
            slopes = step * (-rise[k + 1] - advance[k + 1]), step * (-rise[k] - advance[k])
        deficit, part = _part(deficit, end, slopes[0], slopes[1])
        total += part
    return deficit, total * step


@compiled(error_model="numpy")
def shear_mean(asperities: CompiledAsperities, u: float, a: float, shear: CompiledShear) -> float:
    """The mean shear stress over a period, over µ (Pa), of asperities over a gap u − a cos T."""
    if shear.full <= 0.0:
        mean = asperity_mean(asperities, u, a)[0]
        if shear.kind == RIGID:
            return float(mean)
    rows = _profiles(asperities, u, a, shear)
    if shear.full > 0.0:
        limit = rows[0]
        mean = (0.5 * (limit[0] + limit[_HALF]) + limit[1:_HALF].sum()) / _HALF
        if shear.kind == RIGID:
            return float(mean)
    # The period repeats where it ends with the deficit that it began with: the map from one to the
    # other is nearly straight, and its secant ends the search.
    start, last_start, last_end, total = 0.0, math.nan, math.nan, 0.0
    for _ in range(_ROUNDS):
        end, total = _period(rows, shear.kind == FOLLOWING, start)
        if abs(end - start) <= 1e-12 * rows[0, 0]:
            break
        gain = (end - last_end) / (start - last_start)
        last_start, last_end = start, end
        # The first time there is no secant yet (the gain is no number): go where it ended.
        start = max(start + (end - start) / (1.0 - gain), 0.0) if gain < 1.0 else end
    return float(mean - total / (2.0 * math.pi))


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
    """µ′/µ of plateaus, into `out`; the columns of `shared` are their mean gap and its amplitude
    (m) and their pressure (Pa)."""
    for i in range(len(shared)):
        gap, swing, pressure = shared[i]
        stiffness = asperities_at(asperities, gap_at_rest(asperities, pressure))[1]
        element = CompiledShear(shear.kind, shear.advance, stiffness, shear.full)
        held = shear_mean(asperities, gap, swing, element)
        out[i] = held / friction_limit(pressure, shear.full)
