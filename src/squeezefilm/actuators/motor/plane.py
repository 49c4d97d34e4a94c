"""A motor whose slider is free in the plane, resolved in time: two modes, thrust both ways."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.actuators.motor.assembled import AssembledMotor, Working
from squeezefilm.actuators.motor.in_time import require_no_pull
from squeezefilm.actuators.motor.parts import Slider, Stator, mode_energy
from squeezefilm.actuators.motor.plane_kernel import TOTALS, PlaneMarch, march_plane
from squeezefilm.core import quantities as si

STEPS: int = 256
"""Steps of a period of the first mode: thrust within some 1e-3 of µ times the preload."""


@dataclass(frozen=True, eq=False)
class PlaneMotion:
    """A slider in the plane of a vibrating plate in time; arrays over periods of the first mode.

    Attributes:
        working: how it was driven.
        period_thrust: mean force along and sideways over each period (N), (periods, 2).
        period_normal: mean force across (N).
        period_velocity: along and sideways at the end of each period (m/s), (periods, 2).
        period_height: of the slider there (m).
        period_amplitude: of the modes there (m), (periods, modes).
        contact_share, stick_share: of the time, over all periods (1).
        works: since the start (J), as `kernel` orders them.
        stored_energy: kinetic and elastic energy at the end less that at the start (J).
        time: of the traced steps (s).
        path: the slider's place there (m), (steps, 2).
    """

    working: Working
    period_thrust: si.NewtonArray
    period_normal: si.NewtonArray
    period_velocity: si.MetrePerSecondArray
    period_height: si.MetreArray
    period_amplitude: si.MetreArray
    contact_share: si.Dimensionless
    stick_share: si.Dimensionless
    works: si.FloatArray
    stored_energy: si.Joule
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

    @property
    def energy_residual(self) -> si.Dimensionless:
        """Energy that the balance lacks, over all that was put in and lost: of the march."""
        w = self.works
        gap = w[0] + w[1] - np.sum(w[2:]) - self.stored_energy
        return float(abs(gap) / np.sum(np.abs(w)))


@si.checked_numbers
def simulate_plane(
    motor: AssembledMotor,
    working: Working,
    *,
    velocity: tuple[si.MetrePerSecond, si.MetrePerSecond] | None = None,
    periods: Annotated[int, si.AtLeast(2), si.AtMost(1_000_000)] = 400,
    steps: Annotated[int, si.AtLeast(16), si.AtMost(10_000)] = STEPS,
    traced: Annotated[int, si.AtLeast(0), si.AtMost(1_000_000)] = 0,
) -> PlaneMotion:
    """A motor in time whose slider may move along and sideways, from rest on.

    With `velocity` (m/s) the slider is moved so, whatever drives it. Without it the guide's
    friction holds it back against its motion, whatever the direction, and the load pulls along. The
    path of the last `traced` periods is kept step by step. Valid as `simulate`, whose steps between
    events are more exact along one line; these are of second order.

    Raises what `AssembledMotor.stator` and `require_no_pull` raise.
    """
    stator = motor.stator(working)
    require_no_pull(motor, stator)
    slider = motor.slider(working, imposed=velocity is not None)
    march = _resting(motor, stator, slider, velocity or (0.0, 0.0))
    period = 2 * np.pi / float(stator.omega[0])
    J, n_feet = len(motor.modes), motor.feet.mu.size
    begun = _energy(motor, stator, slider, march)
    track = np.zeros((min(traced, periods) * steps, 7 + J + n_feet))
    untraced = periods - min(traced, periods)
    rows = np.zeros((periods, 6 + J))
    parts = (stator, motor.feet, motor.sideways, slider, march)
    nothing, before = np.empty((0, 0)), march.totals.copy()
    for n in range(periods):
        place = (n - untraced) * steps
        target = track[place : place + steps] if place >= 0 else nothing
        march_plane(n * period, period / steps, steps, parts, target)
        rows[n, :3] = (march.totals - before)[7:] / period
        before = march.totals.copy()
        rows[n, 3:6] = march.slider[4], march.slider[5], march.slider[0]
        rows[n, 6:] = np.hypot(march.q, march.dq / stator.omega)
    whole = periods * period
    return PlaneMotion(
        working,
        rows[:, :2],
        rows[:, 2],
        rows[:, 3:5],
        rows[:, 5],
        rows[:, 6:],
        float(march.shares[0] / whole),
        float(march.shares[1] / whole),
        march.totals[:7].copy(),
        _energy(motor, stator, slider, march) - begun,
        track[:, 0],
        track[:, 3:5],
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
        np.zeros(2),
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
