"""The force law on a motor that is resolved in time: the table it needs, and the loop closed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.actuators.motor import kernel
from squeezefilm.actuators.motor.assembled import AssembledMotor, Working
from squeezefilm.actuators.motor.averaged import averaged
from squeezefilm.actuators.motor.force_law import ForceLaw, ForceState, force_step
from squeezefilm.actuators.motor.in_time import STEPS, require_no_pull, resting
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError

# Of a law: its interval in periods of the mode, and the time in which it takes an error away (s).
_INTERVAL, _CORRECTION = 20, 4e-3


@si.checked_numbers
def inverted_law(
    motor: AssembledMotor,
    speeds: si.MetrePerSecondArray,
    amplitudes: Annotated[si.MetreArray, si.Above(0.0)],
) -> ForceLaw:
    """The force law of a motor, from its averaged thrust over speeds (m/s) and amplitudes (m).

    Amplitudes from which on the thrust no longer grows at some speed are left out: there it cannot
    be commanded. Raises `InputError` where fewer than two are left, as at rest, where the thrust of
    feet that leave the slider does not depend on the amplitude.
    """
    si.require("speeds", speeds, si.Unit("m/s"), axes=1)
    si.require("amplitudes", amplitudes, si.Unit("m"), axes=1)
    thrust = np.array(
        [
            [averaged(motor, Working(amplitude=a), speed=v).force for a in amplitudes.tolist()]
            for v in speeds.tolist()
        ]
    )
    least = 1e-3 * motor.motor.contact.friction_coefficient * motor.motor.cradle.preload
    grows = np.all(np.diff(thrust, axis=1) > least, axis=0)
    # The longest run of amplitudes over which it grows.
    best = (0, 0)
    start = 0
    for j in range(grows.size + 1):
        if j == grows.size or not grows[j]:
            best = max(best, (j - start, -start))
            start = j + 1
    count, first = best[0], -best[1]
    if count < 1:
        raise InputError(
            "the thrust does not grow with the amplitude at every speed asked for, so that no "
            "amplitude can be found for a force: at rest a slider that the feet leave is pushed "
            "as hard at any amplitude; ask for speeds along the thrust, above some mm/s",
            quantity="speeds",
        )
    chosen = slice(first, first + count + 1)
    mode = motor.modes[0].working
    return ForceLaw(
        speed=speeds,
        amplitude=amplitudes[chosen],
        thrust=np.ascontiguousarray(thrust[:, chosen]),
        volts_per_metre=1 / mode.amplitude_per_volt,
        time_constant=mode.quality_factor / (np.pi * mode.resonance_frequency),
        interval=_INTERVAL / mode.resonance_frequency,
        correction_time=_CORRECTION,
        amplitude_time=mode.quality_factor / (np.pi * mode.resonance_frequency),
        highest_voltage=min(motor.highest_voltage, motor.motor.voltage),
    )


@dataclass(frozen=True, eq=False)
class TrackedForce:
    """A force law at work on a motor: arrays over its steps.

    `time` (s), `wanted` and `force` (N), `amplitude` (m) and `voltage` (V) at the end of each;
    `cut` commands were at the highest voltage.
    """

    time: si.SecondArray
    wanted: si.NewtonArray
    force: si.NewtonArray
    amplitude: si.MetreArray
    voltage: si.VoltArray
    cut: int


@si.checked_numbers
def track_force(
    motor: AssembledMotor,
    law: ForceLaw,
    wanted: si.NewtonArray,
    speed: si.MetrePerSecond,
) -> TrackedForce:
    """A motor, resolved in time, under a force law whose `wanted` (N) holds for one interval each.

    The slider is moved at `speed` (m/s) along its thrust, as a hand that yields does; the force is
    what a sensor between both shows, as the mean of an interval. The motor need not be the one that
    the law was made of. Raises `ConvergenceError` and `OutOfRangeError` as `simulate`.
    """
    si.require("wanted", wanted, si.Unit("N"), axes=1)
    top = Working(voltage=law.highest_voltage)
    stator = motor.stator(top)
    require_no_pull(motor, stator)
    march, slider = resting(motor, top, stator, speed)
    per_volt = stator.force / law.highest_voltage
    period = 2 * np.pi / stator.omega[0]
    count = max(1, round(law.interval / period))
    J, totals = stator.mass.size, 2 * stator.mass.size + 4 + motor.feet.mu.size
    state, force = ForceState(), 0.0
    rows = np.zeros((4, wanted.size))
    guide = slider.guide * np.sign(speed)
    for n, asked in enumerate(wanted.tolist()):
        amplitude = float(np.hypot(march.state[0], march.state[J] / stator.omega[0]))
        state = force_step(law, state, asked, force, amplitude, speed)
        driven = stator._replace(force=per_volt * state.voltage)
        begun = float(march.state[totals + kernel.THRUST])
        parts = (driven, motor.feet, slider, march)
        steps = count * STEPS
        done = kernel.march_steps(n * count * period, period / STEPS, steps, parts)
        if done < steps:
            raise ConvergenceError("too many contacts began and ended within one step of the loop")
        force = (float(march.state[totals + kernel.THRUST]) - begun) / (count * period) - guide
        rows[:, n] = (n + 1) * count * period, force, amplitude, state.voltage
    return TrackedForce(rows[0], wanted, rows[1], rows[2], rows[3], state.cut)
