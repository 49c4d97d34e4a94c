"""A motor's motion resolved in time, with its balance of energy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.actuators.motor import kernel
from squeezefilm.actuators.motor.assembled import (
    AssembledMotor,
    Feet,
    Slider,
    Stator,
    Working,
    mode_energy,
)
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, OutOfRangeError

STEPS: int = 64
"""Steps of a period of the first mode: the forces' error is then some 1e-6 of them."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Motion:
    """A slider over a vibrating plate in time; arrays over periods of the first mode.

    Attributes:
        working: how it was driven.
        contact_share: of the time (1).
        works: since the start (J), by the names in `kernel`: what drive and preload put in, what
            the load got, what modes, contacts, friction and guide lost.
        stored_energy: kinetic and elastic energy at the end less that at the start (J).
    """

    working: Working
    contact_share: si.Dimensionless
    works: si.FloatArray
    stored_energy: si.Joule

    @property
    def energy_residual(self) -> si.Dimensionless:
        """Energy that the balance lacks, over all that was put in and lost: of the march."""
        w = self.works
        gap = w[kernel.DRIVE] + w[kernel.PRELOAD] - np.sum(w[kernel.OUTPUT :]) - self.stored_energy
        return float(abs(gap) / np.sum(np.abs(w)))


@dataclass(frozen=True, eq=False, kw_only=True)
class MotorMotion(Motion):
    """Motion along one line; the share of the time is that over the periods of the second half.

    Attributes beside those of `Motion`:
        frequency: of the drive (Hz).
        period_thrust: mean force along over each period (N).
        period_speed: at the end of each period (m/s).
        period_amplitude: of the first mode over each period (m).
    """

    frequency: si.Hertz
    period_thrust: si.NewtonArray
    period_speed: si.MetrePerSecondArray
    period_amplitude: si.MetreArray
    model: str = "modes, unilateral contact with Coulomb friction, event-driven Runge–Kutta"

    @property
    def thrust(self) -> si.Newton:
        """Mean over the periods of the second half (N)."""
        return float(np.mean(self.period_thrust[self.period_thrust.size // 2 :]))


@si.checked_numbers
def simulate(
    motor: AssembledMotor,
    working: Working,
    *,
    speed: si.MetrePerSecond | None = None,
    periods: Annotated[int, si.AtLeast(2), si.AtMost(1_000_000)] = 400,
    steps: Annotated[int, si.AtLeast(8), si.AtMost(10_000)] = STEPS,
) -> MotorMotion:
    """A motor in time, from rest on.

    With `speed` (m/s) the slider is moved so fast along, whatever drives it: its `thrust` is then a
    point of the speed–force curve. Without it moves by itself. A slider is rigid and does not tilt;
    feet have no mass; Coulomb's law and one χ hold at every speed.

    Raises:
        InputError: as `AssembledMotor.stator`.
        OutOfRangeError: contact damping so strong that it would pull (χ times the speed of the
            face above 1).
        ConvergenceError: more contacts than can be told apart in one step.
    """
    stator = motor.stator(working)
    require_no_pull(motor, stator)
    march, slider = resting(motor, working, stator, speed)
    period = 2 * np.pi / stator.omega[0]
    begun = _energy(motor, stator, slider, march)
    totals = 2 * stator.mass.size + 4 + motor.feet.mu.size
    rows, half = _periods((stator, motor.feet, slider, march), periods, steps)
    counted = (march.shares - half) / ((periods - periods // 2) * period)
    return MotorMotion(
        working=working,
        frequency=float(stator.omega[0] / 2 / np.pi),
        period_thrust=rows[0],
        period_speed=rows[1],
        period_amplitude=rows[2],
        contact_share=float(np.mean(counted)),
        works=march.state[totals : totals + 7].copy(),
        stored_energy=_energy(motor, stator, slider, march) - begun,
    )


def _periods(
    parts: tuple[Stator, Feet, Slider, kernel.March], periods: int, steps: int
) -> tuple[si.FloatArray, si.FloatArray]:
    """March the periods; what each came to, and the times in contact halfway."""
    stator, feet, _, march = parts
    J = stator.mass.size
    at, totals = 2 * J, 2 * J + 4 + feet.mu.size
    period = 2 * np.pi / stator.omega[0]
    rows, half = np.zeros((3, periods)), np.zeros_like(march.shares)
    before = march.state.copy()
    for n in range(periods):
        if n == periods // 2:
            half = march.shares.copy()
        done = kernel.march_steps(n * period, period / steps, steps, parts)
        if done < steps:
            raise ConvergenceError(
                f"more than {kernel.MOST_EVENTS} contacts began and ended within one step of "
                f"{period / steps:.3g} s in period {n + 1}; use more steps",
                partial=rows[:, :n],
                iterations=n,
            )
        thrust = totals + kernel.THRUST
        gained = (march.state[thrust] - before[thrust]) / period
        before = march.state.copy()
        rows[:, n] = (
            gained,
            before[at + 3],
            np.hypot(before[0], before[J] / stator.omega[0]),
        )
    return rows, half


def require_no_pull(motor: AssembledMotor, stator: Stator) -> None:
    """Refuse contact damping under which a foot would pull. Raises `OutOfRangeError`."""
    fastest = np.max(np.abs(motor.feet.across) @ (stator.amplitude * stator.omega))
    pull = float(np.max(motor.feet.chi) * fastest)
    if pull >= 1:
        raise OutOfRangeError(
            f"contact damping of {np.max(motor.feet.chi):.3g} s/m is too strong for a face that "
            f"moves at {fastest:.3g} m/s: their product is {pull:.3g} and must stay below 1, or "
            "feet would pull the slider; use less damping or amplitude",
            quantity="damping",
        )


def resting(
    motor: AssembledMotor, working: Working, stator: Stator, speed: float | None
) -> tuple[kernel.March, Slider]:
    """The state before the march: a slider that rests on the feet, in its place."""
    slider = motor.slider(working, imposed=speed is not None)
    J, n_feet = stator.mass.size, motor.feet.mu.size
    at = 2 * J
    state = np.zeros(at + 4 + n_feet + kernel.TOTALS)
    state[at] = -slider.preload / float(np.sum(motor.feet.k_nn))
    state[at + 3] = speed or 0.0
    if stator.held:
        state[:J] = stator.amplitude * np.cos(stator.phase)
        state[J:at] = -stator.amplitude * stator.omega * np.sin(stator.phase)
    # A held plate may stand so that a foot is open at first.
    depth = motor.feet.across @ state[:J] - state[at]
    contact = np.where(depth > 0, kernel.STICK, kernel.OPEN).astype(float)
    free = speed is None and slider.guide > 0
    guide = np.array([0.0 if free else np.copysign(1.0, state[at + 3] or 1.0)])
    scale = np.array([abs(state[at]), slider.preload] * n_feet + [slider.preload])
    march = kernel.March(
        state,
        contact,
        guide,
        np.zeros(n_feet),
        np.zeros((8, state.size)),
        np.ones(2 * n_feet + 1),
        1e-12 * scale,
    )
    return march, slider


def _energy(motor: AssembledMotor, stator: Stator, slider: Slider, march: kernel.March) -> si.Joule:
    """Kinetic and elastic energy (J) of slider and feet, and of modes that are not held."""
    J, n_feet = stator.mass.size, motor.feet.mu.size
    at, y, feet = 2 * J, march.state, motor.feet
    depth = np.where(march.contact != kernel.OPEN, feet.across @ y[:J] - y[at], 0.0)
    e = y[at + 4 : at + 4 + n_feet]
    feet_hold = 0.5 * feet.k_nn * depth**2 + feet.k_nt * depth * e + 0.5 * feet.k_tt * e**2
    own = float(np.sum(feet_hold)) + 0.5 * slider.mass * float(y[at + 1] ** 2)
    if not slider.imposed:
        own += 0.5 * slider.mass * float(y[at + 3] ** 2)
    if not stator.held:
        own += float(mode_energy(stator, y[:J], y[J:at]))
    return own
