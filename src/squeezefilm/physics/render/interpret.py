"""The compiled interpreter of a texture's code: its value at place, velocity and time of a finger.

Compiled once and cached; releases Python's lock, allocates nothing and calls no Python. The page's
port is `static/renderer.js`; the instructions are explained in `opcodes`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render import opcodes as op

_MASK = op.MASK
_WHOLE = 2.0**-32
# Cells and pixels farther than this have no 32-bit number.
_FARTHEST_CELL = 2.0**31
_MOST_ARGUMENT = 1e12
_NAMES = ("position x", "position y", "velocity v", "time t")


# Products may pass 63 bits; the low 32, which alone are kept, are right all the same.
_mixed = compiled(error_model="numpy")(op.mixed)


@compiled(error_model="numpy")
def _spline(f: float, a: float, b: float, c: float, d: float) -> float:
    g = 1.0 - f
    return (
        g * g * g / 6.0 * a
        + (4.0 + f * f * (3.0 * f - 6.0)) / 6.0 * b
        + (4.0 + g * g * (3.0 * g - 6.0)) / 6.0 * c
        + f * f * f / 6.0 * d
    )


@compiled(error_model="numpy")
def line_noise(u: float, seed: int, step: int) -> float:
    if not abs(u) < _FARTHEST_CELL:
        return math.nan
    below = math.floor(u)
    cell = int(below)
    return float(
        _spline(
            u - below,
            _mixed(seed ^ (((cell - 1) * step) & _MASK)) * _WHOLE,
            _mixed(seed ^ ((cell * step) & _MASK)) * _WHOLE,
            _mixed(seed ^ (((cell + 1) * step) & _MASK)) * _WHOLE,
            _mixed(seed ^ (((cell + 2) * step) & _MASK)) * _WHOLE,
        )
    )


@compiled(error_model="numpy")
def field_noise(u: float, w: float, seed: int) -> float:
    if not abs(u) < _FARTHEST_CELL:
        return math.nan
    below = math.floor(u)
    cell = int(below)
    return float(
        _spline(
            u - below,
            line_noise(w, _mixed(seed ^ (((cell - 1) * op.STEP_ALONG) & _MASK)), op.STEP_ACROSS),
            line_noise(w, _mixed(seed ^ ((cell * op.STEP_ALONG) & _MASK)), op.STEP_ACROSS),
            line_noise(w, _mixed(seed ^ (((cell + 1) * op.STEP_ALONG) & _MASK)), op.STEP_ACROSS),
            line_noise(w, _mixed(seed ^ (((cell + 2) * op.STEP_ALONG) & _MASK)), op.STEP_ACROSS),
        )
    )


@compiled(error_model="numpy")
def image(program: si.Array, tables: int, pc: int, x: float, y: float) -> float:
    start = tables + int(program[pc])
    rows, columns = int(program[pc + 1]), int(program[pc + 2])
    pixel = program[pc + 5]
    outside = int(program[pc + 6])
    u = (x - program[pc + 3]) / pixel
    w = (y - program[pc + 4]) / pixel
    if not (abs(u) < _FARTHEST_CELL and abs(w) < _FARTHEST_CELL):
        return math.nan
    if outside == 2 and not (0.0 <= u <= columns and 0.0 <= w <= rows):
        return 0.0
    if outside == 1:
        u -= columns * math.floor(u / columns) + 0.5
        w -= rows * math.floor(w / rows) + 0.5
    else:
        u = min(max(u - 0.5, 0.0), columns - 1.0)
        w = min(max(w - 0.5, 0.0), rows - 1.0)
    cell_u, cell_w = math.floor(u), math.floor(w)
    i, j = int(cell_u), int(cell_w)
    if outside == 1:
        i1, j1 = (i + 1) % columns, (j + 1) % rows
        i, j = i % columns, j % rows
    else:
        i1, j1 = min(i + 1, columns - 1), min(j + 1, rows - 1)
    fu, fw = u - cell_u, w - cell_w
    row = start + (rows - 1 - j) * columns
    next_row = start + (rows - 1 - j1) * columns
    low = (1.0 - fu) * program[row + i] + fu * program[row + i1]
    if next_row == row:
        return float(low)
    high = (1.0 - fu) * program[next_row + i] + fu * program[next_row + i1]
    return float((1.0 - fw) * low + fw * high)


@compiled(error_model="numpy")
def interpret(
    program: si.Array,
    starts: tuple[int, int],
    memory: si.Array,
    base: int,
    x: float,
    y: float,
    v: float,
    t: float,
) -> float:
    """The value of the code at place, velocity and time of a finger. Code and tables begin at
    `starts` of `program`; the stack is `memory` from `base` on."""
    pc, tables = starts
    top = base - 1
    while True:
        code = int(program[pc])
        pc += 1
        if code == op.END:
            return float(memory[top])
        if code == op.CONSTANT:
            top += 1
            memory[top] = program[pc]
            pc += 1
        elif code == op.ALONG:
            top += 1
            memory[top] = program[pc] * x + program[pc + 1] * y + program[pc + 2]
            pc += 3
        elif code == op.RADIUS:
            top += 1
            dx, dy = x - program[pc], y - program[pc + 1]
            memory[top] = math.sqrt(dx * dx + dy * dy)
            pc += 2
        elif code == op.TIME:
            top += 1
            memory[top] = t
        elif code == op.SPEED:
            top += 1
            memory[top] = abs(v)
        elif code == op.ADD:
            top -= 1
            memory[top] += memory[top + 1]
        elif code == op.MULTIPLY:
            top -= 1
            memory[top] *= memory[top + 1]
        elif code == op.LEAST:
            top -= 1
            if memory[top + 1] < memory[top]:
                memory[top] = memory[top + 1]
        elif code == op.GREATEST:
            top -= 1
            if memory[top + 1] > memory[top]:
                memory[top] = memory[top + 1]
        elif code == op.COMPLEMENT:
            memory[top] = 1.0 - memory[top]
        elif code == op.BETWEEN:
            s = memory[top]
            memory[top] = (1.0 - s) * program[pc] + s * program[pc + 1]
            pc += 2
        elif code == op.SQUARE:
            u = memory[top] / program[pc] + program[pc + 1]
            memory[top] = 1.0 if u - math.floor(u) < program[pc + 2] else 0.0
            pc += 3
        elif code == op.SINE:
            u = memory[top] / program[pc] + program[pc + 1]
            memory[top] = 0.5 + 0.5 * math.sin(2.0 * math.pi * u)
            pc += 2
        elif code == op.GAUSSIAN:
            u = (memory[top] - program[pc]) / program[pc + 1]
            memory[top] = math.exp(-0.5 * (u * u))
            pc += 2
        elif code == op.HANN:
            u = abs(memory[top] - program[pc]) / program[pc + 1]
            memory[top] = 0.5 + 0.5 * math.cos(math.pi * u) if u < 1.0 else 0.0
            pc += 2
        elif code == op.RAMP:
            u = (memory[top] - program[pc]) / (program[pc + 1] - program[pc])
            memory[top] = min(max(u, 0.0), 1.0)
            pc += 2
        elif code == op.SMOOTH:
            s = memory[top]
            memory[top] = s * s * (3.0 - 2.0 * s)
        elif code == op.BAND:
            s, start, end, fade = memory[top], program[pc], program[pc + 1], program[pc + 2]
            if fade == 0.0:
                memory[top] = 1.0 if start <= s < end else 0.0
            else:
                memory[top] = min(max(min(s - start, end - s) / fade + 0.5, 0.0), 1.0)
            pc += 3
        elif code == op.BUMP:
            u = (memory[top] - program[pc]) / program[pc + 1]
            way = -program[pc + 2] if v < 0.0 else program[pc + 2]
            s = 0.5 - 0.5 * way * u * math.exp(0.5 * (1.0 - u * u))
            memory[top] = min(max(s, 0.0), 1.0)
            pc += 3
        elif code == op.NOISE:
            memory[top] = line_noise(memory[top] / program[pc], int(program[pc + 1]), op.STEP_ALONG)
            pc += 2
        elif code == op.NOISE_FIELD:
            top += 1
            memory[top] = field_noise(x / program[pc], y / program[pc], int(program[pc + 1]))
            pc += 2
        elif code == op.IMAGE:
            top += 1
            memory[top] = image(program, tables, pc, x, y)
            pc += 7
        elif code == op.WITHIN:
            s = memory[top]
            memory[top] = 1.0 if program[pc] < s < program[pc + 1] else 0.0
            pc += 2
        elif code == op.DECAY:
            u = max(memory[top] - program[pc], 0.0)
            memory[top] = math.exp(-u / program[pc + 1])
            pc += 2
        elif code == op.FADE:
            top -= 1
            s = memory[top + 1]
            memory[top] = (1.0 - s) * program[pc] + s * memory[top]
            pc += 1
        elif code == op.CROSS:
            top -= 2
            s, edge, fade = memory[top + 2], program[pc], program[pc + 1]
            if fade == 0.0:
                s = 0.0 if s < edge else 1.0
            else:
                s = min(max((s - edge) / fade + 0.5, 0.0), 1.0)
            memory[top] = (1.0 - s) * memory[top] + s * memory[top + 1]
            pc += 2
        elif code == op.ENTER_SCALE:
            u = min(max(abs(v) / program[pc], program[pc + 1]), program[pc + 2])
            memory[top + 1] = x
            memory[top + 2] = y
            top += 2
            x /= u
            y /= u
            pc += 3
        elif code == op.LEAVE_SCALE:
            top -= 2
            x = memory[top]
            y = memory[top + 1]
            memory[top] = memory[top + 2]
        elif code == op.WEIGH:
            memory[top] *= program[pc]
            pc += 1
        else:
            return math.nan


@compiled(error_model="numpy")
def _march(
    program: si.Array,
    starts: tuple[int, int],
    memory: si.Array,
    samples: tuple[si.Array, ...],
    out: si.Array,
) -> None:
    """`interpret` over `samples`, which are x, y, v and t of one length; `memory` is the stack."""
    x, y, v, t = samples
    for i in range(x.size):
        out[i] = interpret(program, starts, memory, 0, x[i], y[i], v[i], t[i])


def values_of(
    program: si.FloatArray,
    starts: tuple[int, int],
    stack: int,
    finger: tuple[si.MetreLike, si.MetreLike, si.MetrePerSecondLike, si.SecondLike],
) -> si.FloatArray:
    """Values of code under a `finger`: its place x, y (m), velocity (m/s) and time (s), which
    broadcast; in the broadcast shape. Code and tables begin at `starts`; `stack` values are needed.

    Raises `InputError` for one that is not finite or beyond 1e12 in its SI unit, where a float no
    longer tells the periods of a texture apart, or for shapes that do not broadcast.
    """
    # A NaN would compare false and silently become the low side of an edge.
    for name, values, unit in zip(_NAMES, finger, ("m", "m", "m/s", "s"), strict=True):
        si.require(name, values, si.Unit(unit), at_least=-_MOST_ARGUMENT, at_most=_MOST_ARGUMENT)
    arrays = [np.asarray(values, dtype=float) for values in finger]
    try:
        joint = np.broadcast_arrays(*arrays)
    except ValueError as error:
        shapes = ", ".join(str(array.shape) for array in arrays)
        raise InputError(
            f"x, y, v, t of shapes {shapes} do not broadcast; give equal shapes or scalars"
        ) from error
    out = np.empty(joint[0].shape)
    _march(program, starts, np.empty(stack), samples_of(joint), out.ravel())
    return out


def samples_of(arrays: Iterable[si.FloatArray]) -> tuple[si.FloatArray, ...]:
    """Arrays as the compiled loops take them; copies, since NumPy warns when compiled code looks at
    the views that broadcasting makes."""
    return tuple(array.copy().ravel() for array in arrays)
