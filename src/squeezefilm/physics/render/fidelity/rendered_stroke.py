"""A whole stroke as a loop would render it: sensor, estimator, texture, compensation, envelope.

Offline and with a seed, but with the compiled steps that a loop runs. At each control step the
loop knows the samples that have arrived, asks the texture what it wants where the finger will be,
and commands an amplitude until the next step. `fidelity_report` judges the result.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import RENDER_STEPS, require_motion
from squeezefilm.physics.render.motion.estimator import (
    MotionEstimate,
    MotionEstimator,
    SensorModel,
    estimate_motion,
    sensor_stream,
)
from squeezefilm.physics.render.motion.stroke import Stroke, Trajectory
from squeezefilm.physics.render.resonator import kernel
from squeezefilm.physics.render.resonator.envelope import (
    CompensatedDrive,
    Compensation,
    DrivenEnvelope,
    compensated_drive,
    preview_samples,
    preview_work,
)
from squeezefilm.physics.render.texture.composition import Texture

RelativeFriction = Callable[[si.MetreArray, si.MetrePerSecondArray], si.DimensionlessArray]
"""Vibration amplitude (m, zero-to-peak) and the finger's signed speed (m/s), each of shape (n,) →
friction divided by that of the unexcited surface (1), of the same shape."""

_WINDOW_ROWS = 4096


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LoopRun:
    """A run of a loop: its inputs, how often the drive met an end, and what made it (`model`).

    `sensor` and `estimator` are None where the position is known; `saturated_top` and
    `saturated_bottom` are the share of steps whose command met a limit (1), `silent` that at which
    the finger's place was not known and the drive was off (1).
    """

    envelope: DrivenEnvelope
    compensation: Compensation
    control_rate: si.Hertz
    sensor: SensorModel | None
    estimator: MotionEstimator | None
    seed: int
    saturated_top: si.Dimensionless
    saturated_bottom: si.Dimensionless
    silent: si.Dimensionless
    model: str


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RenderedStroke(LoopRun):
    """A stroke as a finger meets it, and as it should have met it; arrays of shape (steps,).

    Attributes beside those of `LoopRun`:
        texture, trajectory: the inputs.
        time: of each control step (s).
        position: of the finger (m), and `speed` along x, signed (m/s).
        estimate: of the motion at each step, for that step; None without a sensor.
        wanted: amplitude that the texture wants at the finger's true place (m, zero-to-peak).
        command: amplitude commanded until the next step (m); negative in inverted phase.
        amplitude: of the envelope, its magnitude (m, zero-to-peak).
        relative_friction_wanted, relative_friction_rendered: at `wanted` and at `amplitude`, under
            the finger's true speed (1).
    """

    texture: Texture
    trajectory: Trajectory
    time: si.SecondArray
    position: si.MetreArray
    speed: si.MetrePerSecondArray
    estimate: MotionEstimate | None
    wanted: si.MetreArray
    command: si.MetreArray
    amplitude: si.MetreArray
    relative_friction_wanted: si.DimensionlessArray
    relative_friction_rendered: si.DimensionlessArray


@si.checked_numbers
def rendered_stroke(
    texture: Texture,
    trajectory: Trajectory,
    envelope: DrivenEnvelope,
    relative_friction: RelativeFriction,
    *,
    compensation: Compensation = "none",
    sensor: SensorModel | None = None,
    control_rate: Annotated[si.Hertz, si.Above(0.0)] = 20e3,
    seed: int = 0,
) -> RenderedStroke:
    """Render a stroke over a texture as a loop would.

    The finger touches at the start of the trajectory; the amplitude begins at what is wanted
    there (with a sensor: at rest). Friction is quasi-static. The trajectory runs along y = 0.

    Args:
        texture: vibration amplitude wanted, by position, speed and time.
        trajectory: the finger's motion: a `Stroke`, a `MinimumJerkStroke`, or anything with
            `duration` and `position(t)`.
        envelope: the resonator and the limits of its drive.
        relative_friction: vibration amplitudes (m, zero-to-peak) and the finger's true speed (m/s,
            signed), each of shape (n,) → relative friction (1; the same shape). Called twice.
        compensation: "none", "inverse" or "preview".
        sensor: what reports the finger's position; without one the position is known.
        control_rate: of commands (Hz).
        seed: of the sensor's noise.

    Raises:
        InputError: a value outside its range, fewer than two or more than three million control
            steps, or a texture or friction that does not return one finite value at least 0 per
            sample.
    """
    rounded = trajectory.duration * control_rate * (1 + 1e-12)
    require_motion(RENDER_STEPS, rounded, trajectory.duration, control_rate)
    steps = math.floor(rounded)
    dt = 1 / control_rate
    time: si.FloatArray = np.arange(steps + 1, dtype=np.float64) * dt
    inside: si.FloatArray = np.minimum(time, trajectory.duration)
    position = trajectory.position(inside)
    # A stroke turns at once: a difference over the turn would say that it stands still there.
    speed: si.FloatArray = np.gradient(position, dt)
    if isinstance(trajectory, Stroke):
        speed = trajectory.velocity(inside)
    wanted = _asked(texture, position, speed, time)
    estimator, estimate, known = None, None, np.ones(time.size, dtype=bool)
    # For whose place a command is meant: the middle of its step, or (compensated) the next step.
    lead = 0.5 * dt if compensation == "none" else dt
    later: si.FloatArray = np.minimum(time + lead, trajectory.duration)
    if sensor is None:
        ahead_position, ahead_speed = trajectory.position(later), speed
    else:
        stream = sensor_stream(sensor, trajectory.position, trajectory.duration, seed)
        estimator = MotionEstimator.for_sensor(sensor)
        estimate = estimate_motion(estimator, stream, time)
        ahead = estimate_motion(estimator, stream, time, lead)
        ahead_position, ahead_speed, known = ahead.position, ahead.speed, ahead.fresh
    asked = np.where(known, _asked(texture, ahead_position, ahead_speed, time + lead), 0.0)
    start = min(float(wanted[0]), envelope.amplitude_limit) if sensor is None else 0.0
    if compensation == "preview" and sensor is not None:
        drive = _previewed(texture, envelope, time, ahead, known, dt, start)
    else:
        goal = asked if compensation == "none" else np.concatenate([[start], asked[:-1]])
        drive = compensated_drive(goal, dt, envelope, compensation, start)
    # The envelope's sign is the carrier's phase; the finger meets its magnitude.
    amplitude = np.abs(envelope.response(drive.command, dt, start))
    eyes = "position known" if sensor is None else f"{sensor.name} ({sensor.evidence})"
    phase = "phase inversion allowed" if envelope.braking else "no phase inversion"
    return RenderedStroke(
        texture=texture,
        trajectory=trajectory,
        envelope=envelope,
        compensation=compensation,
        control_rate=control_rate,
        sensor=sensor,
        estimator=estimator,
        seed=seed,
        time=time,
        position=position,
        speed=speed,
        estimate=estimate,
        wanted=wanted,
        command=drive.command,
        amplitude=amplitude,
        relative_friction_wanted=friction_of(relative_friction, wanted, speed),
        relative_friction_rendered=friction_of(relative_friction, amplitude, speed),
        saturated_top=drive.saturated_top,
        saturated_bottom=drive.saturated_bottom,
        silent=float(np.mean(~known)),
        model=f"first-order envelope at resonance, compensation: {compensation}, {phase}; {eyes}",
    )


def _previewed(
    texture: Texture,
    envelope: DrivenEnvelope,
    time: si.FloatArray,
    ahead: MotionEstimate,
    known: np.ndarray[tuple[int], np.dtype[np.bool_]],
    dt: float,
    start: float,
) -> CompensatedDrive:
    """Commands where the way ahead is only predicted: at the estimated speed from each step on."""
    count = preview_samples(envelope, dt)
    state, parameters = envelope.new_state(start), envelope.parameters(dt)
    work = preview_work(count)
    command, code = np.empty_like(time), np.empty(time.size, dtype=np.int64)
    further = np.arange(count) * dt
    for first in range(0, time.size, _WINDOW_ROWS):
        rows = slice(first, first + _WINDOW_ROWS)
        place = ahead.position[rows, None] + ahead.speed[rows, None] * further
        when = time[rows, None] + dt + further
        speed = np.broadcast_to(ahead.speed[rows, None], place.shape)
        windows = np.where(known[rows, None], _asked(texture, place, speed, when), 0.0)
        kernel.previewed_windows(
            state, parameters, np.ascontiguousarray(windows), work, command[rows], code[rows]
        )
    return CompensatedDrive(command, code)


def _asked(texture: Texture, x: si.FloatArray, v: si.FloatArray, t: si.FloatArray) -> si.FloatArray:
    return per_sample("texture", texture(x, 0.0, np.abs(v), t), x, si.Unit("m"))


def friction_of(
    law: RelativeFriction, amplitude: si.MetreArray, speed: si.MetrePerSecondArray
) -> si.DimensionlessArray:
    """Friction of a law at amplitudes (m) and speeds (m/s), as `per_sample` lets it pass (1)."""
    return per_sample("relative_friction", law(amplitude, speed), amplitude, si.Unit("1"))


def per_sample(
    name: str, values: si.FloatArray, given: si.FloatArray, unit: si.Unit
) -> si.FloatArray:
    """Values that a callable `name` returned where samples were `given`.

    Raises `InputError` unless that is one finite value, at least 0, per sample.
    """
    array = si.returned(name, values, given, "one value per sample")
    si.require(f"a value returned by {name}", array, unit, at_least=0.0)
    return array
