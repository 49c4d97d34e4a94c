"""The averaged motor: inertia keeps the slider's height and speed, the feet follow at once.

What is left of the time is one period of each foot: pressed in by δ(t) = w(t) − z, dragged along
by its own motion less the slider's. The height z is where the mean of the normal forces is the
preload; the mean of the tangential forces is the thrust. Both come out of the share of the period
in contact and of how much of that is slip.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.actuators.motor.assembled import Feet, Stator, followed
from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled

MEANS = 11
"""Thrust along and sideways (N), normal force (N), share of contact, share of slip in it, contact
loss (W), friction loss (W), and the harmonic of each mode's own frequency in what the feet do to it
(N), cosine and sine; of at most two modes."""


class Swing(NamedTuple):
    """The slider's speed along and sideways (m/s), the instants of a period of the first mode, the
    periods taken before those that count, and those that count."""

    along: float
    sideways: float
    samples: int
    warm: int
    periods: int


@compiled()
def _swinging(t: float, stator: Stator, w: si.Array, dw: si.Array) -> None:
    """The held modes' deflections (m) and speeds (m/s) at a time (s)."""
    for j in range(w.size):
        angle = stator.omega[j] * t + stator.phase[j]
        w[j] = stator.amplitude[j] * math.cos(angle)
        dw[j] = -stator.amplitude[j] * stator.omega[j] * math.sin(angle)


@compiled()
def _tally(
    means: si.Array,
    i: int,
    forces: tuple[float, float, float],
    swinging: tuple[float, Stator, Feet, si.Array],
) -> None:
    """Add a foot's forces, and what it does to each mode in phase with it and after it."""
    t, stator, feet, sideways = swinging
    Fx, Fy, N = forces
    means[0] += Fx
    means[1] += Fy
    means[2] += N
    for j in range(stator.mass.size):
        push = -(N * feet.across[i, j] + Fx * feet.along[i, j] + Fy * sideways[i, j])
        angle = stator.omega[j] * t + stator.phase[j]
        means[7 + 2 * j] += 2.0 * push * math.cos(angle)
        means[8 + 2 * j] += 2.0 * push * math.sin(angle)


@compiled(error_model="numpy")
def average_contact(
    stator: Stator, feet: Feet, sideways: si.Array, height: float, swing: Swing, means: si.Array
) -> None:
    """The means over time of all feet's forces (`MEANS`), with the modes held at their amplitudes
    and the slider at `height` (m). `sideways` is as `Feet.along`, at right angles to it.

    The stretch is followed by the same law as in time, instant by instant: as it would stick, and
    back to the limit where that is more than friction gives (in the plane: along the force).
    """
    J, n_feet = stator.mass.size, feet.mu.size
    means[:] = 0.0
    dt = 2.0 * math.pi / stator.omega[0] / swing.samples
    count = swing.samples * (swing.warm + swing.periods)
    contact, slipping = 0.0, 0.0
    stretch = np.zeros((n_feet, 2))
    last = np.zeros((n_feet, 2))
    was = np.zeros(n_feet)
    w = np.zeros(J)
    dw = np.zeros(J)
    for n in range(count):
        t = n * dt
        counts = n >= swing.samples * swing.warm
        _swinging(t, stator, w, dw)
        for i in range(n_feet):
            depth, speed = -height, 0.0
            x, y = -swing.along * t, -swing.sideways * t
            for j in range(J):
                depth += feet.across[i, j] * w[j]
                speed += feet.across[i, j] * dw[j]
                x += feet.along[i, j] * w[j]
                y += sideways[i, j] * w[j]
            dx, dy = x - last[i, 0], y - last[i, 1]
            last[i, 0], last[i, 1] = x, y
            if was[i] < 0.0 < depth:
                # It met the slider within this step: only what came after counts.
                dx *= depth / (depth - was[i])
                dy *= depth / (depth - was[i])
            was[i] = depth
            if depth <= 0.0:
                stretch[i, 0] = stretch[i, 1] = 0.0
                continue
            Fx, Fy, elastic, slip_x, slip_y = followed(i, feet, depth, speed, (dx, dy), stretch)
            if counts:
                N = elastic * (1.0 + feet.chi[i] * speed)
                contact += 1.0
                slipping += 1.0 if slip_x != 0.0 or slip_y != 0.0 else 0.0
                means[5] += feet.chi[i] * speed * speed * elastic
                means[6] += (Fx * slip_x + Fy * slip_y) / dt
                _tally(means, i, (Fx, Fy, N), (t, stator, feet, sideways))
    total = swing.samples * swing.periods
    means[:] /= total
    means[3] = contact / (total * n_feet)
    means[4] = slipping / contact if contact > 0.0 else 0.0
