"""Strokes of a made-up bench: forces and places in time, of a finger whose friction is given."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.measure.recordings.kinds import FrictionBench

_STEP: si.Second = 5e-3
_LENGTH: si.Metre = 0.05
_RAMP: si.Second = 0.1
_PAUSE: si.Second = 0.5
# Of a normal force held by a finger, and of a position sensor.
_TREMOR, _PLACE = 0.03, 2e-6


class PlannedStrokes(NamedTuple):
    """Of every stroke its amplitude (m), speed (m/s), normal force (N) and true coefficient of
    friction, all (strokes,)."""

    amplitude: si.MetreArray
    speed: si.MetrePerSecondArray
    force: si.NewtonArray
    coefficient: si.DimensionlessArray


def recorded_strokes(
    planned: PlannedStrokes,
    random: np.random.Generator,
    *,
    noise: si.Dimensionless = 0.01,
    frequency: si.Hertz | None = None,
) -> FrictionBench:
    """The recording of strokes to and fro over 50 mm, lifted half a second between them.

    200 points a second; `noise` is that of the tangential force over the mean normal force.
    """
    rows, start, level = [], 0.0, noise * float(np.mean(planned.force))
    for number, (a, v, force, mu) in enumerate(zip(*planned, strict=True)):
        way = 1 if number % 2 else -1
        t = np.arange(max(int(_LENGTH / v / _STEP), 8)) * _STEP
        share = np.clip(np.minimum(t, t[-1] - t) / _RAMP, 0.0, 1.0)
        x = np.cumsum(v * share) * _STEP
        x = x if way > 0 else _LENGTH - x
        normal = force * (1 + _TREMOR * random.standard_normal(t.size))
        # The skin is stretched before it slides.
        pull = -way * mu * force * np.minimum(3 * share, 1.0)
        rows.append(np.stack([start + t, normal, pull, x, np.full(t.size, a)]))
        start += float(t[-1])
        rest = np.arange(1, int(_PAUSE / _STEP)) * _STEP
        nothing = np.zeros(rest.size)
        away = np.stack([start + rest, nothing, nothing, np.full(rest.size, x[-1]), nothing])
        rows.append(away)
        start += _PAUSE
    t, normal, pull, x, a = np.concatenate(rows, axis=1)
    return FrictionBench(
        time=t,
        normal_force=normal + 0.3 * level * random.standard_normal(t.size),
        tangential_force=pull + level * random.standard_normal(t.size),
        position=x + _PLACE * random.standard_normal(t.size),
        vibration_amplitude=a,
        frequency=frequency,
    )
