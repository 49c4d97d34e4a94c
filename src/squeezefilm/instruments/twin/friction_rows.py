"""The tables of friction over force, amplitude and speed, read as a row over the skin's speeds."""

from __future__ import annotations

from typing import NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled


class FrictionTables(NamedTuple):
    """What a skin's friction is made of.

    `speed` (k,) rises from 0 (m/s), and is one place where friction does not depend on it.
    `relative` is µ′/µ, shape (forces, points, k), the speeds side by side in memory; `coefficient`
    (forces,) is µ without vibration. Forces and amplitudes are those of `envelope_step.Fingers`.
    """

    speed: si.Array
    relative: si.Array
    coefficient: si.Array


@compiled()
def row_between(tables: FrictionTables, i: int, p: float, j: int, q: float, row: si.Array) -> float:
    """Write µ′/µ over the speeds into `row` (k,), at a place that `table_place` found; returns µ
    there."""
    _, relative, coefficient = tables
    for m in range(row.size):
        low = relative[i, j, m] + q * (relative[i, j + 1, m] - relative[i, j, m])
        high = relative[i + 1, j, m] + q * (relative[i + 1, j + 1, m] - relative[i + 1, j, m])
        row[m] = low + p * (high - low)
    return float(coefficient[i] + p * (coefficient[i + 1] - coefficient[i]))


@compiled()
def at_speed(speed: si.Array, row: si.Array, pace: float) -> float:
    """A row's value at a speed (m/s, at least 0): linear between the knots, held beyond the
    last."""
    m = 0
    while m < speed.size - 1 and speed[m + 1] <= pace:
        m += 1
    if m == speed.size - 1:
        return float(row[m])
    return float(row[m] + (pace - speed[m]) / (speed[m + 1] - speed[m]) * (row[m + 1] - row[m]))
