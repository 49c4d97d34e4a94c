"""A compiled step of the finger's motion estimator, and its prediction; nothing is allocated.

The state is one array of `STATE_SIZE` floats, so that it can lie in shared memory and be read
whole by another process; `STATE` indices name its places. See `motion` for the equations.
"""

from __future__ import annotations

import math

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled

# Places in the state: the estimate at the last sample used, its covariance, then counters.
X, V, A = 0, 1, 2
XX, XV, XA, VV, VA, AA = 3, 4, 5, 6, 7, 8
STAMP, ALIVE, REJECTED_IN_A_ROW = 9, 10, 11
USED, NOT_FINITE, DUPLICATE, BACKWARDS, OUTLIER, STALL, RESTART = 12, 13, 14, 15, 16, 17, 18
STATE_SIZE = 19

# Places in the parameters.
ACCELERATION_DENSITY, JERK_DENSITY, POSITION_VARIANCE, STAMP_VARIANCE = 0, 1, 2, 3
SPEED_VARIANCE, ACCELERATION_VARIANCE, GATE_SQUARED, STALL_LIMIT, MOST_REJECTED = 4, 5, 6, 7, 8

# What a step did with its sample.
STEP_USED, STEP_STARTED, STEP_NOT_FINITE, STEP_DUPLICATE, STEP_BACKWARDS, STEP_OUTLIER = range(6)
# What a prediction rests on.
FRESH, STALLED, EMPTY, PAST, BAD_TIME = range(5)


@compiled(inline="always")
def _begin(state: si.Array, parameters: si.Array, stamp: float, position: float) -> None:
    state[X], state[V], state[A] = position, 0.0, 0.0
    state[XX] = parameters[POSITION_VARIANCE]
    state[XV], state[XA], state[VA] = 0.0, 0.0, 0.0
    state[VV] = parameters[SPEED_VARIANCE]
    state[AA] = parameters[ACCELERATION_VARIANCE]
    state[STAMP], state[ALIVE], state[REJECTED_IN_A_ROW] = stamp, 1.0, 0.0
    state[USED] += 1.0


@compiled(inline="always")
def _ahead(state: si.Array, parameters: si.Array, h: float) -> tuple[float, ...]:
    """Mean and covariance `h` (s) after the last sample used."""
    qa, qj = parameters[ACCELERATION_DENSITY], parameters[JERK_DENSITY]
    a = state[A]
    v = state[V] + a * h
    x = state[X] + h * (state[V] + 0.5 * h * a)
    h2 = h * h
    half = 0.5 * h2
    # F P: rows of P carried along, then the same for the columns.
    px = state[XX] + h * state[XV] + half * state[XA]
    pxv = state[XV] + h * state[VV] + half * state[VA]
    pxa = state[XA] + h * state[VA] + half * state[AA]
    pv = state[VV] + h * state[VA]
    pva = state[VA] + h * state[AA]
    xx = px + h * pxv + half * pxa + qa * h * h2 / 3.0 + qj * h * h2 * h2 / 20.0
    xv = pxv + h * pxa + qa * half + qj * h2 * h2 / 8.0
    xa = pxa + qj * h * h2 / 6.0
    vv = pv + h * pva + qa * h + qj * h * h2 / 3.0
    va = pva + qj * half
    aa = state[AA] + qj * h
    return x, v, a, xx, xv, xa, vv, va, aa


@compiled()
def motion_step(state: si.Array, parameters: si.Array, stamp: float, position: float) -> int:
    """Take one sample (s, m) into the state, or count why not. Returns one of the STEP codes."""
    if not (math.isfinite(stamp) and math.isfinite(position)):
        state[NOT_FINITE] += 1.0
        return STEP_NOT_FINITE
    if state[ALIVE] == 0.0:
        _begin(state, parameters, stamp, position)
        return STEP_STARTED
    h = stamp - state[STAMP]
    if h == 0.0:
        state[DUPLICATE] += 1.0
        return STEP_DUPLICATE
    if h < 0.0:
        state[BACKWARDS] += 1.0
        if h >= -parameters[STALL_LIMIT]:
            return STEP_BACKWARDS
        # Further back than a stall is another clock; to wait for the old one could take for ever.
        state[RESTART] += 1.0
        _begin(state, parameters, stamp, position)
        return STEP_STARTED
    if h > parameters[STALL_LIMIT]:
        # The finger may have left and come back; what it did before says nothing.
        state[STALL] += 1.0
        state[RESTART] += 1.0
        _begin(state, parameters, stamp, position)
        return STEP_STARTED
    x, v, a, xx, xv, xa, vv, va, aa = _ahead(state, parameters, h)
    spread = xx + parameters[POSITION_VARIANCE] + parameters[STAMP_VARIANCE] * (v * v + vv)
    missed = position - x
    if missed * missed > parameters[GATE_SQUARED] * spread:
        state[OUTLIER] += 1.0
        state[REJECTED_IN_A_ROW] += 1.0
        if state[REJECTED_IN_A_ROW] < parameters[MOST_REJECTED]:
            return STEP_OUTLIER
        # So many in a row are no outliers: the finger is elsewhere.
        state[RESTART] += 1.0
        _begin(state, parameters, stamp, position)
        return STEP_STARTED
    gx, gv, ga = xx / spread, xv / spread, xa / spread
    state[X] = x + gx * missed
    state[V] = v + gv * missed
    state[A] = a + ga * missed
    state[XX] = xx - gx * xx
    state[XV] = xv - gx * xv
    state[XA] = xa - gx * xa
    state[VV] = vv - gv * xv
    state[VA] = va - gv * xa
    state[AA] = aa - ga * xa
    state[STAMP] = stamp
    state[REJECTED_IN_A_ROW] = 0.0
    state[USED] += 1.0
    return STEP_USED


@compiled()
def motion_at(
    state: si.Array, parameters: si.Array, t: float
) -> tuple[float, float, float, float, int]:
    """Position (m), speed (m/s), their standard deviations, and what they rest on, at time t (s).

    Past the stall limit the finger is taken to rest where it was at the limit. A little before the
    last sample (clocks never agree quite) it is carried back at its speed; by more than the stall
    limit it is another clock's time, and the finger rests at the last sample. Always finite
    positions and speeds; a renderer must silence the drive where the code is not FRESH.
    """
    if state[ALIVE] == 0.0:
        return 0.0, 0.0, math.inf, math.inf, EMPTY
    if not math.isfinite(t):
        return state[X], 0.0, math.inf, math.inf, BAD_TIME
    h = t - state[STAMP]
    limit = parameters[STALL_LIMIT]
    if h > limit:
        return _ahead(state, parameters, limit)[0], 0.0, math.inf, math.inf, STALLED
    if h < -limit:
        return state[X], 0.0, math.inf, math.inf, PAST
    x, v, _, xx, _, _, vv, _, _ = _ahead(state, parameters, max(h, 0.0))
    return x + v * min(h, 0.0), v, math.sqrt(max(xx, 0.0)), math.sqrt(max(vv, 0.0)), FRESH


@compiled()
def motion_march(
    state: si.Array,
    parameters: si.Array,
    stamp: si.Array,
    arrival: si.Array,
    position: si.Array,
    render: si.Array,
    ahead: float,
    out: si.Array,
    code: si.Array,
) -> None:
    """March through render times (s): take what has arrived, predict to `ahead` (s) after it.

    `out` takes rows of place, speed and their standard deviations, as `motion_at` gives them.
    """
    k = 0
    for i in range(render.size):
        while k < stamp.size and arrival[k] <= render[i]:
            motion_step(state, parameters, stamp[k], position[k])
            k += 1
        out[0, i], out[1, i], out[2, i], out[3, i], code[i] = motion_at(
            state, parameters, render[i] + ahead
        )
