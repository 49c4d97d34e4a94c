"""The compiled march of a slider that is free in the plane, by steps of one length.

In the plane a foot slips in any direction, which turns while it slips: there is no list of states
to march between events as along one line. Each step moves everything to its middle, asks there what
every foot does (`parts.followed`: as it would stick, and back to what friction gives), and ends
with the speeds that follow. Of second order, through contacts too, since forces begin at nothing.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.actuators.motor.parts import (
    Feet,
    Slider,
    Stator,
    damping_at,
    followed,
    spring_at,
)
from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled

HEIGHT, RISE, X, Y, V_X, V_Y = range(6)
"""The slider's height (m), its speed (m/s), its place and its velocity in the plane (m, m/s)."""
TOTALS = 10
"""Works (J) as `kernel` orders them, then the impulses along, sideways and across (N·s)."""


class PlaneMarch(NamedTuple):
    """The modes' deflections (m) and speeds (m/s), the last step's accelerations of modes and
    height, the slider (`HEIGHT` and so on), per foot where it stood to the slider (m), its depth
    (m), stretch (m) and force (N), the works and impulses, and the time in contact and sticking
    (s)."""

    q: si.Array
    dq: si.Array
    ddq: si.Array
    slider: si.Array
    last: si.Array
    depth: si.Array
    stretch: si.Array
    force: si.Array
    totals: si.Array
    shares: si.Array


@compiled(error_model="numpy")
def march_plane(
    start: float,
    h: float,
    steps: int,
    parts: tuple[Stator, Feet, si.Array, Slider, PlaneMarch],
    track: si.Array,
) -> None:
    """March `steps` steps of `h` (s) from the time `start`; the rows of `track`, where it has any,
    get time, height, place, velocity, the modes and the feet's depths after each."""
    stator, feet, sideways, slider, march = parts
    J, n_feet = stator.mass.size, feet.mu.size
    s, totals = march.slider, march.totals
    half, speed_half, before = np.zeros(J), np.zeros(J), np.zeros(J)
    onto, lossy = np.zeros(J), np.zeros(n_feet)
    for step in range(steps):
        t = start + (step + 0.5) * h
        for j in range(J):
            if stator.held:
                angle = stator.omega[j] * t + stator.phase[j]
                half[j] = stator.amplitude[j] * math.cos(angle)
                speed_half[j] = -stator.amplitude[j] * stator.omega[j] * math.sin(angle)
            else:
                half[j] = march.q[j] + 0.5 * h * march.dq[j]
                speed_half[j] = march.dq[j] + 0.5 * h * march.ddq[j]
        z, x, y = s[HEIGHT] + 0.5 * h * s[RISE], s[X] + 0.5 * h * s[V_X], s[Y] + 0.5 * h * s[V_Y]
        rise = s[RISE] + 0.5 * h * march.ddq[J]
        onto[:] = 0.0
        before[:] = march.q
        z_before = s[HEIGHT]
        Fx, Fy, N = 0.0, 0.0, 0.0
        for i in range(n_feet):
            depth, speed, at_x, at_y = -z, -rise, -x, -y
            for j in range(J):
                depth += feet.across[i, j] * half[j]
                speed += feet.across[i, j] * speed_half[j]
                at_x += feet.along[i, j] * half[j]
                at_y += sideways[i, j] * half[j]
            dx, dy = at_x - march.last[i, 0], at_y - march.last[i, 1]
            was = march.depth[i]
            march.last[i, 0], march.last[i, 1], march.depth[i] = at_x, at_y, depth
            lossy[i] = 0.0
            if depth <= 0.0:
                march.stretch[i, 0] = march.stretch[i, 1] = 0.0
                march.force[i, 0] = march.force[i, 1] = 0.0
                continue
            if was < 0.0:
                # It met the slider within this step: only what came after counts.
                dx *= depth / (depth - was)
                dy *= depth / (depth - was)
            f_x, f_y, elastic, slip_x, slip_y = followed(
                i, feet, depth, speed, (dx, dy), march.stretch
            )
            lossy[i] = feet.chi[i] * speed * elastic
            n = elastic + lossy[i]
            Fx, Fy, N = Fx + f_x, Fy + f_y, N + n
            # Of second order: slip begins at the force before and ends at the one after.
            totals[5] += 0.5 * (march.force[i, 0] + f_x) * slip_x
            totals[5] += 0.5 * (march.force[i, 1] + f_y) * slip_y
            march.force[i, 0], march.force[i, 1] = f_x, f_y
            march.shares[0] += h / n_feet
            if slip_x == 0.0 and slip_y == 0.0:
                march.shares[1] += h / n_feet
            for j in range(J):
                onto[j] -= n * feet.across[i, j] + f_x * feet.along[i, j] + f_y * sideways[i, j]
        _modes(t, h, stator, half, speed_half, onto, march)
        _moved(h, (Fx, Fy, N), slider, march)
        # The work of the contact's damper, at the speeds that the step really had.
        for i in range(n_feet):
            gone = z_before - s[HEIGHT]
            for j in range(J):
                gone += feet.across[i, j] * (march.q[j] - before[j])
            totals[4] += lossy[i] * gone
        if track.shape[0] > step:
            track[step, 0] = start + (step + 1) * h
            track[step, 1:7] = s
            track[step, 7 : 7 + J] = march.q
            track[step, 7 + J :] = march.depth


@compiled()
def _modes(
    t: float,
    h: float,
    stator: Stator,
    half: si.Array,
    speed_half: si.Array,
    onto: si.Array,
    march: PlaneMarch,
) -> None:
    """The modes to the end of a step, from the feet's forces on them in its middle, and the drive's
    and the modes' own works."""
    for j in range(stator.mass.size):
        if stator.held:
            angle, before = stator.omega[j] * (t + 0.5 * h) + stator.phase[j], march.q[j]
            march.q[j] = stator.amplitude[j] * math.cos(angle)
            march.dq[j] = -stator.amplitude[j] * stator.omega[j] * math.sin(angle)
            march.totals[0] -= onto[j] * (march.q[j] - before)
            continue
        push = stator.force[j] * math.cos(stator.omega[j] * t + stator.phase[j])
        c = damping_at(stator, j, half[j], speed_half[j])
        free = (push + onto[j] - spring_at(stator, j, half[j]) * half[j]) * h / stator.mass[j]
        share = 0.5 * h * c / stator.mass[j]
        after = (march.dq[j] * (1.0 - share) + free) / (1.0 + share)
        mean = 0.5 * (after + march.dq[j])
        march.totals[0] += push * mean * h
        march.totals[3] += c * mean * mean * h
        march.ddq[j] = (after - march.dq[j]) / h
        march.dq[j] = after
        march.q[j] = half[j] + 0.5 * h * after


@compiled()
def _moved(h: float, forces: tuple[float, float, float], slider: Slider, march: PlaneMarch) -> None:
    """The slider to the end of a step, its preload, its guide and its load."""
    Fx, Fy, N = forces
    s, totals = march.slider, march.totals
    share = 0.5 * h * slider.damping / slider.mass
    after = (s[RISE] * (1.0 - share) + (N - slider.preload) * h / slider.mass) / (1.0 + share)
    mean = 0.5 * (after + s[RISE])
    totals[1] -= slider.preload * mean * h
    totals[6] += slider.damping * mean * mean * h
    march.ddq[-1] = (after - s[RISE]) / h
    s[HEIGHT] += h * mean
    s[RISE] = after
    vx, vy = s[V_X], s[V_Y]
    if slider.imposed:
        size = math.hypot(vx, vy)
        totals[2] += (Fx * vx + Fy * vy - slider.guide * size) * h
        totals[6] += slider.guide * size * h
    else:
        vx += (Fx - slider.load) * h / slider.mass
        vy += Fy * h / slider.mass
        # Coulomb's law in the plane: as much of the motion as friction can, it takes away.
        size = math.hypot(vx, vy)
        kept = max(0.0, 1.0 - slider.guide * h / slider.mass / size) if size > 0.0 else 0.0
        taken = (1.0 - kept) * slider.mass
        mean_x, mean_y = 0.5 * (s[V_X] + kept * vx), 0.5 * (s[V_Y] + kept * vy)
        totals[2] += slider.load * mean_x * h
        totals[6] += taken * (vx * mean_x + vy * mean_y)
        vx, vy = kept * vx, kept * vy
    s[X] += 0.5 * h * (s[V_X] + vx)
    s[Y] += 0.5 * h * (s[V_Y] + vy)
    s[V_X], s[V_Y] = vx, vy
    totals[7] += Fx * h
    totals[8] += Fy * h
    totals[9] += N * h
