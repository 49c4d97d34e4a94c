"""Noise and images by place, compiled: what a texture's program looks up."""

from __future__ import annotations

import math

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.render.program import layout as at
from squeezefilm.physics.render.texture.noise import STEP_ACROSS, STEP_ALONG, mixed

_MASK = 0xFFFFFFFF
_WHOLE = 2.0**-32
# Cells and pixels farther than this have no 32-bit number.
_FARTHEST_CELL = 2.0**31


# Products may pass 63 bits; the low 32, which alone are kept, are right all the same.
_mixed = compiled(error_model="numpy")(mixed)


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
            line_noise(w, _mixed(seed ^ (((cell - 1) * STEP_ALONG) & _MASK)), STEP_ACROSS),
            line_noise(w, _mixed(seed ^ ((cell * STEP_ALONG) & _MASK)), STEP_ACROSS),
            line_noise(w, _mixed(seed ^ (((cell + 1) * STEP_ALONG) & _MASK)), STEP_ACROSS),
            line_noise(w, _mixed(seed ^ (((cell + 2) * STEP_ALONG) & _MASK)), STEP_ACROSS),
        )
    )


@compiled(error_model="numpy")
def image(program: si.Array, pc: int, x: float, y: float) -> float:
    start = int(program[at.H_TABLES]) + int(program[pc])
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
