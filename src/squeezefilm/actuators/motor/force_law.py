"""The force law of a motor: a wanted force in, a voltage out, by inverting what makes the force.

Three elements stand between voltage and force, and each is inverted in turn: the force over the
amplitude, which has no memory, by its table at the slider's speed; what the table is wrong by
(friction is never known well) is observed, as what it says at the measured amplitude less the
measured force, and added to what is wanted; the amplitude over the voltage, which has a memory, by
a proportional loop around it with the resonance's gain fed forward. Nothing is integrated that
could wind up.

One step is a pure function: state and measurements in, state and command out; `track_force` closes
the loop on a motor that is resolved in time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from squeezefilm.actuators.motor import kernel
from squeezefilm.actuators.motor.assembled import AssembledMotor, Working
from squeezefilm.actuators.motor.averaged import averaged
from squeezefilm.actuators.motor.in_time import STEPS, require_no_pull, resting
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class ForceLaw:
    """Law of a step: what is known of a motor, and how hard it corrects.

    `thrust` (N) is a table over `speed` (m/s) and `amplitude` (m), which it grows with at every
    speed; `volts_per_metre` holds an amplitude and `time_constant` (s) is the amplitude's own.
    `interval` (s) is from one step to the next; within `correction_time` (s) the table's error is
    believed, within `amplitude_time` (s) one of the amplitude is mended. `highest_voltage` (V) is
    the one place where a command is cut.

    Raises `InputError` for a table that does not fit, or does not grow with the amplitude.
    """

    speed: si.MetrePerSecondArray
    amplitude: si.MetreArray
    thrust: si.NewtonArray
    volts_per_metre: Annotated[si.VoltPerMetre, si.Above(0.0)]
    time_constant: Annotated[si.Second, si.Above(0.0)]
    interval: Annotated[si.Second, si.Above(0.0)]
    correction_time: Annotated[si.Second, si.Above(0.0)]
    amplitude_time: Annotated[si.Second, si.Above(0.0)]
    highest_voltage: Annotated[si.Volt, si.Above(0.0)]

    def __post_init__(self) -> None:
        if self.thrust.shape != (self.speed.size, self.amplitude.size) or self.amplitude.size < 2:
            raise InputError(
                f"thrust has the shape {self.thrust.shape}; it needs a row for each of "
                f"{self.speed.size} speeds and a column for each of {self.amplitude.size} "
                "amplitudes, at least two",
                quantity="thrust",
            )
        rising = (np.all(np.diff(axis) > 0) for axis in (self.speed, self.amplitude))
        if not all(rising) or np.any(np.diff(self.thrust, axis=1) <= 0):
            raise InputError(
                "speed and amplitude must rise, and thrust with the amplitude, so that the table "
                "can be turned around; leave out amplitudes at which it no longer grows",
                quantity="thrust",
            )


class ForceState(NamedTuple):
    """State of a law: by how much the table is too high (N), what the feet add to the amplitude
    (m), amplitude (m) and voltage (V) a step before, and how many commands were cut."""

    correction: float = 0.0
    offset: float = 0.0
    amplitude: float = 0.0
    voltage: float = 0.0
    cut: int = 0


class ForceCommand(NamedTuple):
    """The voltage's amplitude (V), the amplitude it is for (m), and the force that is expected of
    it (N)."""

    voltage: float
    amplitude: float
    expected_thrust: float


@si.checked_numbers
def amplitude_for_force(
    law: ForceLaw, force: si.Newton, speed: si.MetrePerSecond
) -> tuple[si.Metre, si.Newton]:
    """The amplitude (m) for a force (N) at a speed (m/s) by the law's table, and its force there.

    Linear between the table's points; at its ends where the force, or the speed, lies beyond them.
    """
    row = _thrust_at(law, speed)
    amplitude = float(np.interp(force, row, law.amplitude))
    return amplitude, float(np.interp(amplitude, law.amplitude, row))


@si.checked_numbers
def force_step(
    law: ForceLaw,
    state: ForceState,
    wanted: si.Newton,
    force: si.Newton,
    amplitude: Annotated[si.Metre, si.AtLeast(0.0)],
    speed: si.MetrePerSecond,
) -> tuple[ForceState, ForceCommand]:
    """Make a step of the law.

    Args:
        law: what is known of the motor.
        state: what the step before left.
        wanted: the force that is asked for (N).
        force: measured over the last interval (N).
        amplitude: of the mode, measured now (m).
        speed: of the slider, measured now (m/s).

    Valid for steps several times shorter than both correction times, and those longer than the
    force sensor and the slider take to settle on the feet.
    """
    row = _thrust_at(law, speed)
    # The force is the mean of an interval in which the amplitude went from one to the other.
    believed = float(np.interp(0.5 * (state.amplitude + amplitude), law.amplitude, row))
    share = min(1.0, law.interval / law.correction_time)
    correction = state.correction + share * (believed - force - state.correction)
    target, expected = amplitude_for_force(law, wanted + correction, speed)
    # τ A' + A = V/G + offset, turned around for an error that vanishes within amplitude_time; the
    # offset, of the feet's load on the mode, is observed as the force's is.
    kept = float(np.exp(-law.interval / law.time_constant))
    apart = (amplitude - kept * state.amplitude) / (1 - kept) - state.voltage / law.volts_per_metre
    offset = state.offset + share * (apart - state.offset)
    ahead = target - offset + law.time_constant / law.amplitude_time * (target - amplitude)
    asked = law.volts_per_metre * ahead
    voltage = min(max(asked, 0.0), law.highest_voltage)
    return (
        ForceState(correction, offset, amplitude, voltage, state.cut + (voltage != asked)),
        ForceCommand(voltage, target, expected - correction),
    )


def _thrust_at(law: ForceLaw, speed: si.MetrePerSecond) -> si.NewtonArray:
    """The table's thrust over its amplitudes at a speed (m/s)."""
    columns = range(law.amplitude.size)
    return np.array([np.interp(speed, law.speed, law.thrust[:, j]) for j in columns])


@si.checked_numbers
def inverted_law(
    motor: AssembledMotor,
    speeds: si.MetrePerSecondArray,
    amplitudes: Annotated[si.MetreArray, si.Above(0.0)],
    *,
    interval_periods: Annotated[int, si.AtLeast(1)] = 20,
    correction_time: Annotated[si.Second, si.Above(0.0)] = 4e-3,
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
        interval=interval_periods / mode.resonance_frequency,
        correction_time=correction_time,
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
    def mean_error(self, start: si.Second, end: si.Second) -> si.Dimensionless:
        """Mean force less the wanted one, over that, between two times (s)."""
        there = (self.time >= start) & (self.time <= end)
        if not there.any():
            raise InputError("no step of the law lies between these times", quantity="start")
        return float(np.mean(self.force[there]) / np.mean(self.wanted[there]) - 1)


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
    march, slider = resting(motor, top, stator, speed, 0.0)
    per_volt = stator.force / law.highest_voltage
    period = 2 * np.pi / stator.omega[0]
    count = max(1, round(law.interval / period))
    J, totals = stator.mass.size, 2 * stator.mass.size + 4 + motor.feet.mu.size
    state, command, force = ForceState(), 0.0, 0.0
    rows = np.zeros((4, wanted.size))
    guide = slider.guide * np.sign(speed)
    for n, asked in enumerate(wanted.tolist()):
        amplitude = float(np.hypot(march.state[0], march.state[J] / stator.omega[0]))
        state, ordered = force_step(law, state, asked, force, amplitude, speed)
        command = ordered.voltage
        driven = stator._replace(force=per_volt * command)
        begun = float(march.state[totals + kernel.THRUST])
        parts = (driven, motor.feet, slider, march)
        steps = count * STEPS
        done = kernel.march_steps(
            n * count * period, period / STEPS, steps, parts, np.empty((0, 0))
        )
        if done < steps:
            raise ConvergenceError("too many contacts began and ended within one step of the loop")
        force = (float(march.state[totals + kernel.THRUST]) - begun) / (count * period) - guide
        rows[:, n] = (n + 1) * count * period, force, amplitude, command
    return TrackedForce(rows[0], wanted, rows[1], rows[2], rows[3], state.cut)
