"""Textures in NumPy, class by class as docstrings say: what their programs must agree with."""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np

from squeezefilm.physics.render.opcodes import MASK, STEP_ACROSS, STEP_ALONG, mixed
from squeezefilm.physics.render.texture import composition, image, levels, pattern, shapes
from squeezefilm.physics.render.texture.image import Image


class Finger(NamedTuple):
    """Place (m), velocity (m/s) and time (s); arrays of one shape."""

    x: np.ndarray
    y: np.ndarray
    v: np.ndarray
    t: np.ndarray


def numpy_values(texture: Any, *finger: Any) -> np.ndarray:
    """The values of a pattern or a texture under a finger."""
    return _values(
        texture, Finger(*np.broadcast_arrays(*(np.asarray(one, float) for one in finger)))
    )


@functools.singledispatch
def _values(texture: Any, finger: Finger) -> np.ndarray:
    raise TypeError(f"{texture!r} is not written in NumPy; add it here")


def _place(shape: Any, finger: Finger) -> np.ndarray:
    return shape.along.at(finger.x, finger.y)


def _square(cycles: np.ndarray, duty: float) -> np.ndarray:
    return np.where(cycles - np.floor(cycles) < duty, 1.0, 0.0)


@_values.register
def _(shape: shapes.Constant, finger: Finger) -> np.ndarray:
    return np.full(finger.x.shape, float(shape.share))


@_values.register
def _(shape: shapes.SquareWave, finger: Finger) -> np.ndarray:
    cycles = _place(shape, finger) / shape.spatial_period + shape.phase / (2 * math.pi)
    return _square(cycles, shape.duty)


@_values.register
def _(shape: shapes.SineWave, finger: Finger) -> np.ndarray:
    cycles = _place(shape, finger) / shape.spatial_period + shape.phase / (2 * math.pi)
    return 0.5 + 0.5 * np.sin(2 * math.pi * cycles)


@_values.register
def _(shape: shapes.Pulse, finger: Finger) -> np.ndarray:
    off = (_place(shape, finger) - shape.centre) / shape.width
    if shape.shape == "gaussian":
        return np.exp(-4.0 * math.log(2.0) * off**2)
    return np.where(np.abs(off) < 1.0, 0.5 + 0.5 * np.cos(math.pi * np.clip(off, -1.0, 1.0)), 0.0)


@_values.register
def _(shape: shapes.Ramp, finger: Finger) -> np.ndarray:
    done = np.clip((_place(shape, finger) - shape.start) / (shape.end - shape.start), 0.0, 1.0)
    return done if shape.profile == "linear" else done * done * (3.0 - 2.0 * done)


@_values.register
def _(shape: shapes.Band, finger: Finger) -> np.ndarray:
    s = _place(shape, finger)
    if shape.fade == 0.0:
        return np.where((s >= shape.start) & (s < shape.end), 1.0, 0.0)
    return np.clip(np.minimum(s - shape.start, shape.end - s) / shape.fade + 0.5, 0.0, 1.0)


@_values.register
def _(shape: shapes.Bump, finger: Finger) -> np.ndarray:
    d = (_place(shape, finger) - shape.centre) / shape.width
    sign = 1.0 if shape.kind == "bump" else -1.0
    way = np.where(finger.v < 0.0, -sign, sign)
    return np.clip(0.5 - 0.5 * way * d * np.exp(0.5 * (1.0 - d * d)), 0.0, 1.0)


@_values.register
def _(gate: shapes.SpeedGate, finger: Finger) -> np.ndarray:
    low = -1.0 if gate.above is None else gate.above
    high = math.inf if gate.below is None else gate.below
    return np.where((np.abs(finger.v) > low) & (np.abs(finger.v) < high), 1.0, 0.0)


@_values.register
def _(gate: shapes.Attack, finger: Finger) -> np.ndarray:
    end = gate.start + gate.duration
    return np.clip((finger.t - gate.start) / (end - gate.start), 0.0, 1.0)


@_values.register
def _(gate: shapes.Decay, finger: Finger) -> np.ndarray:
    return np.exp(-np.maximum(finger.t - gate.start, 0.0) / gate.time_constant)


@_values.register
def _(gate: shapes.Periodic, finger: Finger) -> np.ndarray:
    cycles = finger.t / (1.0 / gate.frequency) + gate.phase / (2 * math.pi)
    if gate.shape == "sine":
        return 0.5 + 0.5 * np.sin(2 * math.pi * cycles)
    return _square(cycles, gate.duty)


def _hashed(numbers: np.ndarray, state: Any, step: int) -> Any:
    cells = numbers.astype(np.int64).astype(np.uint64) & MASK
    return mixed(state ^ ((cells * step) & MASK))


def _weights(f: np.ndarray) -> tuple[np.ndarray, ...]:
    g = 1.0 - f
    return (
        g * g * g / 6.0,
        (4.0 + f * f * (3.0 * f - 6.0)) / 6.0,
        (4.0 + g * g * (3.0 * g - 6.0)) / 6.0,
        f * f * f / 6.0,
    )


def _line(u: np.ndarray, state: int) -> np.ndarray:
    cell, start = np.floor(u), np.full(u.shape, state, dtype=np.uint64)
    total = np.zeros(u.shape)
    for offset, weight in zip((-1, 0, 1, 2), _weights(u - cell), strict=True):
        total = total + weight * (_hashed(cell + offset, start, STEP_ALONG) / 2.0**32)
    return total


def _field(u: np.ndarray, w: np.ndarray, state: int) -> np.ndarray:
    column, row = np.floor(u), np.floor(w)
    start, total = np.full(u.shape, state, dtype=np.uint64), np.zeros(u.shape)
    for i, along in zip((-1, 0, 1, 2), _weights(u - column), strict=True):
        first = _hashed(column + i, start, STEP_ALONG)
        for j, across in zip((-1, 0, 1, 2), _weights(w - row), strict=True):
            total = total + along * across * _hashed(row + j, first, STEP_ACROSS) / 2.0**32
    return total


@_values.register
def _(noises: image._Added, finger: Finger) -> np.ndarray:
    weights = [noises.persistence ** (noises.octaves - 1 - k) for k in range(noises.octaves)]
    total = np.zeros(finger.x.shape)
    for k, weight in enumerate(weights):
        period, state = noises.finest_period * 2.0**k, mixed(noises.seed + k)
        if isinstance(noises, image.Noise):
            octave = _line(_place(noises, finger) / period, state)
        else:
            octave = _field(finger.x / period, finger.y / period, state)
        total = total + weight / sum(weights) * octave
    return total


def _neighbours(u: np.ndarray, count: int, wraps: bool) -> tuple[Any, Any, np.ndarray]:
    """The two pixels around `u` pixels from the first centre, and how far between them."""
    if not wraps:
        u = np.clip(u, 0.0, count - 1.0)
    cell = np.floor(u)
    i = cell.astype(np.int64)
    if wraps:
        return i % count, (i + 1) % count, u - cell
    return i, np.minimum(i + 1, count - 1), u - cell


@_values.register
def _(image: Image, finger: Finger) -> np.ndarray:
    grid = np.array(image.values)
    rows, columns = grid.shape
    u, w = (finger.x - image.left) / image.pixel, (finger.y - image.bottom) / image.pixel
    inside = (u >= 0.0) & (u <= columns) & (w >= 0.0) & (w <= rows)
    wraps = image.outside == "repeat"
    if wraps:
        u, w = u - columns * np.floor(u / columns), w - rows * np.floor(w / rows)
    i, i1, fu = _neighbours(u - 0.5, columns, wraps)
    j, j1, fw = _neighbours(w - 0.5, rows, wraps)
    top = rows - 1
    low = (1.0 - fu) * grid[top - j, i] + fu * grid[top - j, i1]
    high = (1.0 - fu) * grid[top - j1, i] + fu * grid[top - j1, i1]
    value = (1.0 - fw) * low + fw * high
    return np.where(inside, value, 0.0) if image.outside == "zero" else value


@_values.register
def _(changed: pattern.Complement, finger: Finger) -> np.ndarray:
    return 1.0 - _values(changed.pattern, finger)


@_values.register
def _(joined: pattern._Joined, finger: Finger) -> np.ndarray:
    operations = {pattern.Least: np.minimum, pattern.Greatest: np.maximum}
    operation: Any = operations.get(type(joined), np.multiply)
    return np.asarray(operation.reduce([_values(part, finger) for part in joined.patterns]))


@_values.register
def _(scaled: pattern.SpeedScaled, finger: Finger) -> np.ndarray:
    x, y, v, t = finger
    factor = np.clip(np.abs(v), scaled.slowest, scaled.fastest) / scaled.reference_speed
    return _values(scaled.pattern, Finger(x / factor, y / factor, v, t))


@_values.register
def _(level: levels._Level, finger: Finger) -> np.ndarray:
    share = _values(level.pattern, finger)
    return (1.0 - share) * level.low + share * level.high


@_values.register
def _(total: composition.Sum, finger: Finger) -> np.ndarray:
    return np.asarray(np.add.reduce([_values(texture, finger) for texture in total.textures]))


@_values.register
def _(product: composition.Product, finger: Finger) -> np.ndarray:
    return _values(product.texture, finger) * _values(product.pattern, finger)


@_values.register
def _(scaled: composition.Scaled, finger: Finger) -> np.ndarray:
    return scaled.factor * _values(scaled.texture, finger)


@_values.register
def _(masked: composition.Masked, finger: Finger) -> np.ndarray:
    share, rest = _values(masked.pattern, finger), composition.AT_REST[masked.quantity]
    return (1.0 - share) * rest + share * _values(masked.texture, finger)


@_values.register
def _(sequence: composition.Sequence, finger: Finger) -> np.ndarray:
    s, blended = _place(sequence, finger), _values(sequence.textures[0], finger)
    for edge, after in zip(sequence.edges, sequence.textures[1:], strict=True):
        if sequence.fade == 0.0:
            share = np.where(s < edge, 0.0, 1.0)
        else:
            share = np.clip((s - edge) / sequence.fade + 0.5, 0.0, 1.0)
        blended = (1.0 - share) * blended + share * _values(after, finger)
    return blended
