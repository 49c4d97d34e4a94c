"""The force law of a motor: a wanted force in, a voltage out, by inverting what makes the force.

Three elements stand between voltage and force, and each is inverted in turn: the force over the
amplitude, which has no memory, by its table at the slider's speed; what the table is wrong by
(friction is never known well) is observed, as what it says at the measured amplitude less the
measured force, and added to what is wanted; the amplitude over the voltage, which has a memory, by
a proportional loop around it with the resonance's gain fed forward. Nothing is integrated that
could wind up.

One step is a pure function: state and measurements in, state with the command out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError


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

    speed: Annotated[si.MetrePerSecondArray, si.Rising()]
    amplitude: Annotated[si.MetreArray, si.Rising(2)]
    thrust: si.NewtonArray
    volts_per_metre: Annotated[si.VoltPerMetre, si.Above(0.0)]
    time_constant: Annotated[si.Second, si.Above(0.0)]
    interval: Annotated[si.Second, si.Above(0.0)]
    correction_time: Annotated[si.Second, si.Above(0.0)]
    amplitude_time: Annotated[si.Second, si.Above(0.0)]
    highest_voltage: Annotated[si.Volt, si.Above(0.0)]

    def __post_init__(self) -> None:
        if self.thrust.shape != (self.speed.size, self.amplitude.size):
            raise InputError(
                f"thrust has the shape {self.thrust.shape}; it needs a row for each of "
                f"{self.speed.size} speeds and a column for each of {self.amplitude.size} "
                "amplitudes",
                quantity="thrust",
            )
        if np.any(np.diff(self.thrust, axis=1) <= 0):
            raise InputError(
                "thrust must rise with the amplitude, so that the table can be turned around; "
                "leave out amplitudes at which it no longer grows",
                quantity="thrust",
            )


class ForceState(NamedTuple):
    """State of a law: by how much the table is too high (N), what the feet add to the amplitude
    (m), the amplitude measured last (m), the voltage commanded there (V, zero-to-peak), and how
    many commands were cut."""

    correction: float = 0.0
    offset: float = 0.0
    amplitude: float = 0.0
    voltage: float = 0.0
    cut: int = 0


@si.checked_numbers
def amplitude_for_force(law: ForceLaw, force: si.Newton, speed: si.MetrePerSecond) -> si.Metre:
    """The amplitude (m) for a force (N) at a speed (m/s) by the law's table.

    Linear between the table's points; at its ends where the force, or the speed, lies beyond them.
    """
    return float(np.interp(force, _thrust_at(law, speed), law.amplitude))


@si.checked_numbers
def force_step(
    law: ForceLaw,
    state: ForceState,
    wanted: si.Newton,
    force: si.Newton,
    amplitude: Annotated[si.Metre, si.AtLeast(0.0)],
    speed: si.MetrePerSecond,
) -> ForceState:
    """The state after a step of the law; its `voltage` is the command.

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
    target = amplitude_for_force(law, wanted + correction, speed)
    # τ A' + A = V/G + offset, turned around for an error that vanishes within amplitude_time; the
    # offset, of the feet's load on the mode, is observed as the force's is.
    kept = float(np.exp(-law.interval / law.time_constant))
    apart = (amplitude - kept * state.amplitude) / (1 - kept) - state.voltage / law.volts_per_metre
    offset = state.offset + share * (apart - state.offset)
    ahead = target - offset + law.time_constant / law.amplitude_time * (target - amplitude)
    asked = law.volts_per_metre * ahead
    voltage = min(max(asked, 0.0), law.highest_voltage)
    return ForceState(correction, offset, amplitude, voltage, state.cut + (voltage != asked))


def _thrust_at(law: ForceLaw, speed: si.MetrePerSecond) -> si.NewtonArray:
    """The table's thrust over its amplitudes at a speed (m/s)."""
    columns = range(law.amplitude.size)
    return np.array([np.interp(speed, law.speed, law.thrust[:, j]) for j in columns])
