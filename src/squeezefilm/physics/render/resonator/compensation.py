"""Getting a texture through a slow resonator: the envelope's inverse, within the voltage.

The envelope follows its command by τ da/dt = c − a (`envelope`). Its inverse, c = w + τ dw/dt,
would make the amplitude the one wanted; between samples, exactly,

    c[k] = (w[k+1] − a[k] E) / (1 − E),   E = exp(−Δt/τ).

The command is bounded by the drive's voltage, −b c_max ≤ c ≤ c_max with c_max the amplitude that
the full voltage holds; b = 1 where the amplifier may invert the carrier's phase to brake, else 0.
Many amplifiers can: the phase is a sign in the signal. Without it nothing makes the amplitude
fall faster than the resonator's own loss. A compensator carries the amplitude that the resonator
must have, so that it takes up where saturation left it, and counts the samples that saturate.

Open loop: a time constant that is wrong by a share d leaves about d of each step's height as
error for one τ (a finger put down changes Q). Rise and fall may differ (`rise_time_constant`,
`fall_time_constant`): a linear plate has one, an amplifier with a slow side has two.

Two laws: "inverse" wants each next sample as soon as the limits let it; "preview" looks ahead and
takes the plan with least squared error, which starts edges before they are due.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from squeezefilm.core import quantities as si
from squeezefilm.physics.render.resonator import kernel
from squeezefilm.physics.render.resonator.envelope import one_row

Compensation = Literal["none", "inverse", "preview"]
COMPENSATIONS: tuple[Compensation, ...] = ("none", "inverse", "preview")

# Past three time constants ahead a plan's first command no longer changes by a percent.
_PREVIEW_TIME_CONSTANTS = 3.0


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class DrivenEnvelope:
    """A resonator's envelope and the command that its drive can give.

    Args:
        rise_time_constant, fall_time_constant: of the amplitude while it rises and falls (s);
            above 0. Equal for a linear resonator.
        amplitude_limit: amplitude that the full voltage holds (m, zero-to-peak); above 0.
        braking: whether the drive may invert the carrier's phase.

    Raises:
        InputError: a value outside its range.
    """

    rise_time_constant: Annotated[si.Second, si.Above(0.0)]
    fall_time_constant: Annotated[si.Second, si.Above(0.0)]
    amplitude_limit: Annotated[si.Metre, si.Above(0.0)]
    braking: bool = False

    @property
    def lowest_command(self) -> si.Metre:
        """Least command (m): minus the limit where the phase may be inverted, else 0."""
        return -self.amplitude_limit if self.braking else 0.0

    @si.checked_numbers
    def parameters(self, time_step: Annotated[si.Second, si.Above(0.0)]) -> si.FloatArray:
        """Parameters of the compiled steps at a time step (s): shape (4,), see the kernel."""
        return np.array(
            [
                math.exp(-time_step / self.rise_time_constant),
                math.exp(-time_step / self.fall_time_constant),
                self.lowest_command,
                self.amplitude_limit,
            ]
        )

    @si.checked_numbers
    def new_state(
        self,
        amplitude: Annotated[si.Metre, si.AtLeast(0.0), si.AtMost("self.amplitude_limit")] = 0.0,
    ) -> si.FloatArray:
        """A compensator's state where the resonator has `amplitude` (m); shape (5,).

        Raises:
            InputError: an amplitude below 0 or above the limit.
        """
        state = np.zeros(kernel.STATE_SIZE)
        state[kernel.AMPLITUDE] = amplitude
        return state

    @si.checked_numbers
    def response(
        self, command: si.MetreArray, time_step: si.Second, initial: si.Metre = 0.0
    ) -> si.MetreArray:
        """Amplitude at each sample under a stepwise command (m), exactly; may be negative.

        A negative amplitude is vibration in the inverted phase, whose friction is that of its
        magnitude. `command` (m), shape (n,), is held from each sample to the next.

        Raises:
            InputError: a command that is empty, of another shape or not finite, or a time step
                not above 0.
        """
        held = one_row("command", command)
        rise, fall, _, _ = self.parameters(time_step)
        amplitude = np.empty_like(held)
        kernel.envelope_march(held, initial, rise, fall, amplitude)
        return amplitude


class CompensatedDrive(NamedTuple):
    """A command made for amplitudes wanted: the amplitude from each sample to the next (m, negative
    where it brakes), and the kernel's code of what became of it; shape (n,)."""

    command: si.MetreArray
    code: si.IntArray

    @property
    def saturated_top(self) -> si.Dimensionless:
        """The share of samples whose command met the upper limit (1)."""
        return float(np.mean(self.code == kernel.TOPPED))

    @property
    def saturated_bottom(self) -> si.Dimensionless:
        """The share of samples whose command met the lower limit (1)."""
        return float(np.mean(self.code == kernel.BOTTOMED))


@si.checked_numbers
def compensated_drive(
    wanted: si.MetreArray,
    time_step: si.Second,
    envelope: DrivenEnvelope,
    compensation: Compensation = "inverse",
    initial: si.Metre | None = None,
) -> CompensatedDrive:
    """The command for amplitudes wanted at samples; `DrivenEnvelope.response` is what it makes.

    Args:
        wanted: amplitude wanted at each sample (m, zero-to-peak), shape (n,); at least 0.
        time_step: between samples (s).
        envelope: the resonator and its limits.
        compensation: "none" commands what is wanted from each sample on, within the limit.
        initial: amplitude at the first sample (m); without one, the first wanted (or the limit).

    Raises:
        InputError: amplitudes that are empty, not finite or negative, a time step not above 0, an
            initial amplitude outside the limits, or an unknown compensation.
    """
    goal = one_row("wanted", wanted)
    si.require("wanted", goal, si.Unit("m"), at_least=0.0)
    first = min(float(goal[0]), envelope.amplitude_limit) if initial is None else initial
    state, parameters = envelope.new_state(first), envelope.parameters(time_step)
    command, code = np.empty_like(goal), np.zeros(goal.size, dtype=np.int64)
    if compensation == "none":
        np.minimum(goal, envelope.amplitude_limit, out=command)
        code[goal > envelope.amplitude_limit * (1 + kernel.ROUNDING)] = kernel.TOPPED
    elif compensation == "inverse":
        kernel.compensated_march(state, parameters, goal, command, code)
    else:
        ahead = preview_samples(envelope, time_step)
        # The last sample holds.
        windows = sliding_window_view(np.append(goal[1:], np.full(ahead, goal[-1])), ahead)
        kernel.previewed_windows(state, parameters, windows, preview_work(ahead), command, code)
    return CompensatedDrive(command, code)


@si.checked_numbers
def preview_samples(
    envelope: DrivenEnvelope, time_step: Annotated[si.Second, si.Above(0.0)]
) -> int:
    """Number of samples that a preview of three time constants looks ahead.

    Raises:
        InputError: a time step not above 0.
    """
    slowest = max(envelope.rise_time_constant, envelope.fall_time_constant)
    return max(1, math.ceil(_PREVIEW_TIME_CONSTANTS * slowest / time_step - 1e-9))


@si.checked_numbers
def preview_work(samples: Annotated[int, si.AtLeast(0)]) -> si.FloatArray:
    """Working memory of `previewed_step` for so many samples ahead, shape (5, 2·samples + 2)."""
    return np.zeros((5, 2 * samples + 2))
