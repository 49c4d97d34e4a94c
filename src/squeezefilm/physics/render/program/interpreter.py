"""The compiled tick of programs: an amplitude for one sample of a finger, and for many.

Compiled once and cached; releases Python's lock, allocates nothing and calls no Python. It runs
any program that `program.checked` let pass: nothing else is checked here but what depends on the
samples. The page's port is `static/renderer.js`; the numbers of program and state are explained in
`layout`.
"""

from __future__ import annotations

import math

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.render.interpret import interpret
from squeezefilm.physics.render.program import layout as at


@compiled(error_model="numpy")
def _friction_row(program: si.Array, v: float) -> tuple[int, float]:
    """Index of the inverse's row at or below the speed of `v`, and the share of the next."""
    count = int(program[at.H_INVERSE_COUNT])
    speeds = int(program[at.H_INVERSE_SPEEDS])
    first = int(program[at.H_INVERSE]) + count
    if speeds == 0:
        return first, 0.0
    place = first + count * speeds
    pace = abs(v)
    if pace <= program[place]:
        return first, 0.0
    low, high = 0, speeds - 1
    if pace >= program[place + high]:
        return first + count * (high - 1), 1.0
    while high - low > 1:
        middle = (low + high) >> 1
        if program[place + middle] <= pace:
            low = middle
        else:
            high = middle
    below = program[place + low]
    return first + count * low, float((pace - below) / (program[place + high] - below))


@compiled(error_model="numpy")
def _at(program: si.Array, place: int, count: int, share: float) -> float:
    """Friction at a knot of a row, with the share of the next row there."""
    if share == 0.0:
        return float(program[place])
    return float((1.0 - share) * program[place] + share * program[place + count])


@compiled(error_model="numpy")
def _inverse(program: si.Array, row: int, share: float, wanted: float) -> float:
    """The least amplitude (m) of a relative friction within a row, by bisection."""
    count = int(program[at.H_INVERSE_COUNT])
    low, high = 0, count - 1
    while high - low > 1:
        middle = (low + high) >> 1
        if _at(program, row + middle, count, share) > wanted:
            low = middle
        else:
            high = middle
    above = _at(program, row + low, count, share)
    part = 0.0
    # Equal where friction is flat from rest on.
    if above > wanted:
        part = (above - wanted) / (above - _at(program, row + high, count, share))
    amplitude = int(program[at.H_INVERSE])
    first, second = program[amplitude + low], program[amplitude + high]
    return float((1.0 - part) * first + part * second)


@compiled(error_model="numpy")
def _wave_factor(program: si.Array, x: float, y: float) -> float:
    """The wave's local share of its amplitude, linear between the factors of one period."""
    count = int(program[at.H_WAVE_COUNT])
    start = int(program[at.H_WAVE])
    place = program[at.H_WAVE_P] * x + program[at.H_WAVE_Q] * y + program[at.H_WAVE_R]
    u = place / program[at.H_WAVE_PERIOD]
    u = (u - math.floor(u)) * count
    # A period rounded up to its end is the next one's start.
    i = int(u)
    f = u - i
    i %= count
    return float((1.0 - f) * program[start + i] + f * program[start + (i + 1) % count])


@compiled(error_model="numpy")
def _amplitude(
    program: si.Array, state: si.Array, wanted: float, x: float, y: float, v: float
) -> tuple[float, int]:
    """The amplitude for a value of the texture, within 0…LARGEST, and the flags it raised.

    A friction becomes the amplitude that makes it under a finger at the speed of `v`.
    """
    flags = 0
    largest = program[at.H_LARGEST]
    if program[at.H_QUANTITY] == 0.0:
        amplitude = wanted
    else:
        friction = wanted
        if program[at.H_QUANTITY] == 2.0:
            friction = 1.0 - wanted / program[at.H_FRICTION]
        count = int(program[at.H_INVERSE_COUNT])
        row, share = _friction_row(program, v)
        most, least = (
            _at(program, row, count, share),
            _at(program, row + count - 1, count, share),
        )
        if friction > most:
            amplitude = 0.0
            if friction > most + at.REACH:
                flags |= at.F_TOO_STICKY
                state[at.S_TOO_STICKY] += 1.0
        else:
            if friction < least - at.REACH:
                flags |= at.F_TOO_SLIPPERY
                state[at.S_TOO_SLIPPERY] += 1.0
            amplitude = _inverse(program, row, share, max(friction, least))
    if program[at.H_WAVE_COUNT] > 0.0:
        amplitude /= _wave_factor(program, x, y)
    if amplitude < 0.0:
        if amplitude < -at.REACH * largest:
            flags |= at.F_NEGATIVE
            state[at.S_NEGATIVE] += 1.0
        amplitude = 0.0
    elif amplitude > largest:
        if amplitude > (1.0 + at.REACH) * largest:
            flags |= at.F_SATURATED
            state[at.S_SATURATED] += 1.0
        amplitude = largest
    return float(amplitude), flags


@compiled(error_model="numpy")
def tick(program: si.Array, state: si.Array, x: float, y: float, v: float, t: float) -> float:
    """The vibration amplitude (m, zero-to-peak) for one sample of the finger.

    `program` and `state` are arrays of floats as `layout` says; `x`, `y` (m), `v` (m/s), `t` (s)
    the sample. Never raises. A sample that cannot be used (place, velocity or time not finite,
    place farther than FARTHEST, time running backwards, a texture without a finite value) is
    counted, and so is one that brings nothing new (the time of the last). Then the last good
    amplitude is held for HOLD ticks and taken to 0 linearly over FADE further ones; it stays 0
    until a good sample comes, whose amplitude counts at once. Before the first good sample it is
    0. Time that jumped back is good again when it passes the last good time, or after a reset.
    """
    state[at.S_TICKS] += 1.0
    flags = 0
    far = program[at.H_FARTHEST]
    # Each comparison is false for a NaN.
    if not (abs(x) <= far and abs(y) <= far and abs(v) <= at.FASTEST):
        flags |= at.F_BAD_PLACE
        state[at.S_BAD_PLACE] += 1.0
    if not abs(t) < math.inf:
        flags |= at.F_BAD_TIME
        state[at.S_BAD_TIME] += 1.0
    elif state[at.S_STARTED] == 1.0:
        if t < state[at.S_LAST_TIME]:
            flags |= at.F_BACKWARDS
            state[at.S_BACKWARDS] += 1.0
        elif t == state[at.S_LAST_TIME]:
            flags |= at.F_REPEATED
            state[at.S_REPEATED] += 1.0
    if flags == 0:
        starts = int(program[at.H_CODE]), int(program[at.H_TABLES])
        wanted = interpret(program, starts, state, at.STATE, x, y, v, t)
        state[at.S_WANTED] = wanted
        if abs(wanted) < math.inf:
            amplitude, flags = _amplitude(program, state, wanted, x, y, v)
            state[at.S_STARTED] = 1.0
            state[at.S_LAST_TIME] = t
            state[at.S_HELD] = amplitude
            state[at.S_IDLE] = 0.0
            state[at.S_AMPLITUDE] = amplitude
            state[at.S_FLAGS] = flags
            return float(amplitude)
        flags |= at.F_BAD_VALUE
        state[at.S_BAD_VALUE] += 1.0
    idle = state[at.S_IDLE] + 1.0
    late = idle - program[at.H_HOLD]
    amplitude = state[at.S_HELD]
    if late > 0.0:
        flags |= at.F_STALLED
        if late == 1.0:
            state[at.S_STALLS] += 1.0
        amplitude *= max(1.0 - late / program[at.H_FADE], 0.0)
    state[at.S_IDLE] = idle
    state[at.S_AMPLITUDE] = amplitude
    state[at.S_FLAGS] = flags
    return float(amplitude)


@compiled(error_model="numpy")
def tick_march(
    program: si.Array,
    state: si.Array,
    samples: tuple[si.Array, ...],
    out: si.Array,
    flags: si.Array,
) -> None:
    """`tick` over `samples`, one after another."""
    x, y, v, t = samples
    for i in range(x.size):
        out[i] = tick(program, state, x[i], y[i], v[i], t[i])
        flags[i] = int(state[at.S_FLAGS])
