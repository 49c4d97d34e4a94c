"""Curves of a motor against speed, preload, amplitude, frequency and the place of its feet."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from squeezefilm.actuators.motor.assembled import AssembledMotor, FaceMode, Working, assembled
from squeezefilm.actuators.motor.averaged import (
    AveragedMotor,
    averaged,
    no_load_speed,
    require_moving,
)
from squeezefilm.actuators.motor.description import Motor
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.core.progress import CountProgress
from squeezefilm.physics.plate.working_mode import PlateTheory

# Between rest and no load.
_SPEEDS = np.array([0.2, 0.35, 0.5, 0.65, 0.8])


@si.checked_numbers
def speed_force_curve(
    motor: AssembledMotor, working: Working, points: Annotated[int, si.AtLeast(2)] = 15
) -> tuple[AveragedMotor, ...]:
    """The motor from rest to no load, at speeds alike far apart. Raises as `no_load_speed`."""
    top = no_load_speed(motor, working)
    return tuple(averaged(motor, working, speed=v) for v in np.linspace(0.0, top, points).tolist())


@dataclass(frozen=True, eq=False)
class MotorMap:
    """A motor over preload (N) × amplitude (m); arrays (preloads, amplitudes).

    `stall_force` (N), `no_load_speed` (m/s) and `efficiency` at the best of five loads. NaN where
    the motor stalls without a load.
    """

    preload: si.NewtonArray
    amplitude: si.MetreArray
    stall_force: si.NewtonArray
    no_load_speed: si.MetrePerSecondArray
    efficiency: si.FloatArray


@si.checked_numbers
def motor_map(
    motor: AssembledMotor,
    preloads: Annotated[si.NewtonArray, si.Above(0.0)],
    amplitudes: Annotated[si.MetreArray, si.Above(0.0)],
    *,
    progress: CountProgress | None = None,
) -> MotorMap:
    """The averaged motor over preloads (N) and amplitudes (m) at which its mode is held.

    `progress` is told how many points of how many are done. Raises `InputError` for what are no
    lists, and what `averaged` raises but for stalling.
    """
    si.require("preloads", preloads, si.Unit("N"), axes=1)
    si.require("amplitudes", amplitudes, si.Unit("m"), axes=1)
    answers = np.full((3, preloads.size, amplitudes.size), np.nan)
    for i, preload in enumerate(preloads.tolist()):
        for j, amplitude in enumerate(amplitudes.tolist()):
            working = Working(amplitude=amplitude, preload=preload)
            rest = averaged(motor, working)
            try:
                require_moving(motor, rest)
                top = no_load_speed(motor, working)
            except OutOfRangeError:
                top = None
            if top is not None:
                loaded = [averaged(motor, working, speed=top * part) for part in _SPEEDS.tolist()]
                answers[:, i, j] = rest.force, top, max(point.efficiency for point in loaded)
            if progress is not None:
                progress(i * amplitudes.size + j + 1, answers[0].size)
    return MotorMap(preloads, amplitudes, *answers)


@si.checked_numbers
def over_foot_position(
    motor: Motor, working: Working, shifts: si.MetreArray, theory: PlateTheory = "solid"
) -> tuple[AveragedMotor | None, ...]:
    """The motor at rest with all feet moved along the wave by `shifts` (m); None over a node.

    Raises as `assembled` for anything else, so for feet beside the plate.
    """
    si.require("shifts", shifts, si.Unit("m"), axes=1)
    along_width = motor.plate.lines_across == "width"
    modes: tuple[FaceMode, ...] | None = None
    motors: list[AveragedMotor | None] = []
    for shift in shifts.tolist():
        feet = tuple(
            replace(foot, y=foot.y + shift) if along_width else replace(foot, x=foot.x + shift)
            for foot in motor.feet
        )
        moved = replace(motor, feet=feet)
        try:
            there = assembled(moved, theory, modes)
            modes = there.modes
            motors.append(averaged(there, working))
        except OutOfRangeError as error:
            if error.quantity != "feet":
                raise
            motors.append(None)
    return tuple(motors)
