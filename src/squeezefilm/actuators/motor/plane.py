"""A motor whose slider is free in the plane, resolved in time: two modes, thrust both ways.

In the plane a foot slips in any direction, which turns while it slips: there is no list of states
to march between events as along one line. Each step moves everything to its middle, asks there what
every foot does (`parts.followed`: as it would stick, and back to what friction gives), and ends
with the speeds that follow. Of second order, through contacts too, since forces begin at nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from squeezefilm.actuators.motor.assembled import (
    AssembledMotor,
    Feet,
    Slider,
    Stator,
    Working,
    damping_at,
    followed,
    mode_energy,
    spring_at,
)
from squeezefilm.actuators.motor.in_time import Motion, require_no_pull
from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled

HEIGHT, RISE, X, Y, V_X, V_Y = range(6)
"""The slider's height (m), its speed (m/s), its place and its velocity in the plane (m, m/s)."""
TOTALS = 9
"""Works (J) as `kernel` orders them, then the impulses along and sideways (N·s)."""


class PlaneMarch(NamedTuple):
    """The modes' deflections (m) and speeds (m/s), the last step's accelerations of modes and
    height, the slider (`HEIGHT` and so on), per foot where it stood to the slider (m), its depth
    (m), stretch (m) and force (N), the works and impulses, and the time in contact (s)."""

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
    path: si.Array,
) -> None:
    """March `steps` steps of `h` (s) from the time `start`; the rows of `path`, shape (steps, 2),
    get the slider's place after each."""
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
        path[step, 0], path[step, 1] = s[X], s[Y]


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


STEPS: int = 256
"""Steps of a period of the first mode: thrust within some 1e-3 of µ times the preload."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PlaneMotion(Motion):
    """Motion in the plane; the share of the time is that over all periods.

    Attributes beside those of `Motion`:
        period_thrust: mean force along and sideways over each period (N), (periods, 2).
        period_velocity: along and sideways at the end of each period (m/s), (periods, 2).
        period_amplitude: of the modes there (m), (periods, modes).
        time: at the end of each period (s).
        path: the slider's place after each step (m), (periods · steps, 2).
    """

    period_thrust: si.NewtonArray
    period_velocity: si.MetrePerSecondArray
    period_amplitude: si.MetreArray
    time: si.SecondArray
    path: si.MetreArray
    model: str = "modes, unilateral contact with Coulomb friction in the plane, steps of one length"

    @property
    def thrust(self) -> si.NewtonArray:
        """Thrust along and sideways, mean over the periods of the second half (N)."""
        return np.asarray(np.mean(self.period_thrust[self.period_thrust.shape[0] // 2 :], axis=0))

    @property
    def final_velocity(self) -> si.MetrePerSecondArray:
        """Velocity along and sideways, mean over the last tenth of the periods (m/s)."""
        return np.asarray(
            np.mean(self.period_velocity[-max(1, len(self.period_velocity) // 10) :], 0)
        )


@si.checked_numbers
def simulate_plane(
    motor: AssembledMotor,
    working: Working,
    *,
    velocity: tuple[si.MetrePerSecond, si.MetrePerSecond] | None = None,
    periods: Annotated[int, si.AtLeast(2), si.AtMost(1_000_000)] = 400,
    steps: Annotated[int, si.AtLeast(16), si.AtMost(10_000)] = STEPS,
) -> PlaneMotion:
    """A motor in time whose slider may move along and sideways, from rest on.

    With `velocity` (m/s) the slider is moved so, whatever drives it. Without it the guide's
    friction holds it back against its motion, whatever the direction, and the load pulls along.
    Valid as `simulate`, whose steps between events are more exact along one line; these are of
    second order.

    Raises what `AssembledMotor.stator` and `require_no_pull` raise.
    """
    stator = motor.stator(working)
    require_no_pull(motor, stator)
    slider = motor.slider(working, imposed=velocity is not None)
    march = _resting(motor, stator, slider, velocity or (0.0, 0.0))
    period = 2 * np.pi / float(stator.omega[0])
    begun = _energy(motor, stator, slider, march)
    path = np.empty((periods, steps, 2))
    rows = np.zeros((periods, 4 + len(motor.modes)))
    parts = (stator, motor.feet, motor.sideways, slider, march)
    before = march.totals.copy()
    for n in range(periods):
        march_plane(n * period, period / steps, steps, parts, path[n])
        rows[n, :2] = (march.totals - before)[7:] / period
        before = march.totals.copy()
        rows[n, 2:4] = march.slider[V_X], march.slider[V_Y]
        rows[n, 4:] = np.hypot(march.q, march.dq / stator.omega)
    return PlaneMotion(
        working=working,
        period_thrust=rows[:, :2],
        period_velocity=rows[:, 2:4],
        period_amplitude=rows[:, 4:],
        contact_share=float(march.shares[0] / (periods * period)),
        works=march.totals[:7].copy(),
        stored_energy=_energy(motor, stator, slider, march) - begun,
        time=np.linspace(period, periods * period, periods),
        path=path.reshape(-1, 2),
    )


def _resting(
    motor: AssembledMotor, stator: Stator, slider: Slider, velocity: tuple[float, float]
) -> PlaneMarch:
    """The state before the march: a slider that rests on the feet."""
    J, n_feet = stator.mass.size, motor.feet.mu.size
    q, dq = np.zeros(J), np.zeros(J)
    if stator.held:
        q = stator.amplitude * np.cos(stator.phase)
        dq = -stator.amplitude * stator.omega * np.sin(stator.phase)
    place = np.array([-slider.preload / float(np.sum(motor.feet.k_nn)), 0.0, 0.0, 0.0, *velocity])
    last = np.stack([motor.feet.along @ q, motor.sideways @ q], axis=1)
    depth = motor.feet.across @ q - place[0]
    return PlaneMarch(
        q,
        dq,
        np.zeros(J + 1),
        place,
        last,
        depth,
        np.zeros((n_feet, 2)),
        np.zeros((n_feet, 2)),
        np.zeros(TOTALS),
        np.zeros(1),
    )


def _energy(motor: AssembledMotor, stator: Stator, slider: Slider, march: PlaneMarch) -> si.Joule:
    """Kinetic and elastic energy (J) of slider and feet, and of modes that are not held."""
    feet, s = motor.feet, march.slider
    depth = feet.across @ march.q - s[0]
    # The stretch is that of the last step's middle: what the foot moved since is added.
    since = np.stack([feet.along @ march.q - s[2], motor.sideways @ march.q - s[3]], 1) - march.last
    ex, ey = (march.stretch + since).T
    held = 0.5 * feet.k_nn * depth**2 + feet.k_nt * depth * ex + 0.5 * feet.k_tt * (ex**2 + ey**2)
    own = float(np.sum(held[depth > 0])) + 0.5 * slider.mass * float(s[1] ** 2)
    if not slider.imposed:
        own += 0.5 * slider.mass * float(s[4] ** 2 + s[5] ** 2)
    if not stator.held:
        own += float(mode_energy(stator, march.q, march.dq))
    return own
