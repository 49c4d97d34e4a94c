"""The resonator's envelope: how slowly vibration amplitude follows its command, and its inverse
within the voltage, which gets a texture through.

A plate driven at its resonance answers a change of drive with an amplitude that closes in
exponentially: da/dt = (c - a)/τ with τ = Q/(πf) (PHYSICS §4), where c is the amplitude commanded.
A grating swept under a finger asks for a change every half period, so the finer the grating and
the faster the finger, the less of its swing is left.

It approximates ẍ + (ω0/Q) ẋ + ω0² x = ω0²/Q · u(t) driven near ω0: one resonance, one direction.
Other modes, the ceramic's hysteresis and what a finger's load changes besides Q are not in it.

Everything here holds for a linear resonator driven at resonance whose envelope is slow beside
the carrier (Q ≫ 1). Q is that of the plate *with* the finger on it. The amplitude is driven
open-loop; a control loop or an inverse filter in front shortens τ while the voltage lasts.

The carrier itself: an amplitude command as samples for a converter, phase-continuous.

The converter holds each sample (zero order): at a frequency f and a rate f_s that weakens the
carrier by sinc(f/f_s) and delays it by half a sample, πf/f_s of phase (37.5° at 40 kHz and
192 kHz). Whoever makes up for the gain passes it; the phase matters only to whoever closes a loop
around it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.resonator import kernel


@si.closed_form(positive="quality_factor frequency")
def envelope_time_constant(
    quality_factor: si.DimensionlessLike, frequency: si.HertzLike
) -> si.SecondLike:
    """Time constant of the amplitude of a resonator (s): τ = Q/(πf), PHYSICS §4.

    `quality_factor` (1) and resonance `frequency` (Hz) broadcast. Raises `InputError` unless both
    are above 0. Holds for Q ≫ 1.
    """
    return quality_factor / (math.pi * frequency)


@si.closed_form(positive="quality_factor frequency")
def envelope_bandwidth(
    quality_factor: si.DimensionlessLike, frequency: si.HertzLike
) -> si.HertzLike:
    """Modulation frequency at which the envelope has fallen by 3 dB (Hz): f/2Q = 1/(2πτ).

    `quality_factor` (1) and resonance `frequency` (Hz) broadcast. Raises `InputError` unless both
    are above 0. Holds for Q ≫ 1 (PHYSICS §4).
    """
    return frequency / (2 * quality_factor)


@si.closed_form(positive="spatial_period speed time_constant")
def sine_swing_kept(
    spatial_period: si.MetreLike, speed: si.MetrePerSecondLike, time_constant: si.SecondLike
) -> si.DimensionlessLike:
    """Swing of amplitude left of a sine grating, divided by the swing commanded (1).

    1/√(1 + (2πτ/T)²) with T = spatial_period/speed: the gain of a first-order lag. All arguments
    (m, m/s, s) broadcast. Raises `InputError` unless all are above 0.
    """
    kept: si.DimensionlessLike = 1 / np.sqrt(
        1 + (2 * math.pi * speed * time_constant / spatial_period) ** 2
    )
    return kept


@si.closed_form(positive="speed time_constant")
def finest_period(
    speed: si.MetrePerSecondLike,
    time_constant: si.SecondLike,
    kept: si.DimensionlessLike = 0.9,
) -> si.MetreLike:
    """Finest spatial period (m) of a square grating, its grooves and ridges equal, that keeps a
    share `kept` of its swing at a finger's speed.

    In the steady state the share is tanh(T/4τ) with T = period/speed, and so the period 4τv
    artanh(kept). `speed` (m/s), `time_constant` (s) and `kept` (1) broadcast. Raises `InputError`
    for a speed or time constant not above 0, or a share not between 0 and 1.
    """
    return speed * time_constant * _time_constants_per_period(kept)


@si.closed_form(positive="spatial_period time_constant")
def fastest_speed(
    spatial_period: si.MetreLike,
    time_constant: si.SecondLike,
    kept: si.DimensionlessLike = 0.9,
) -> si.MetrePerSecondLike:
    """Fastest finger (m/s) under which a square grating keeps a share `kept` of its swing.

    The inverse of `finest_period` in speed. `spatial_period` (m), `time_constant` (s) and `kept`
    (1) broadcast. Raises `InputError` for a period or time constant not above 0, or a share not
    between 0 and 1.
    """
    return spatial_period / (time_constant * _time_constants_per_period(kept))


def _time_constants_per_period(kept: si.DimensionlessLike) -> si.DimensionlessLike:
    si.require("kept", kept, above=0.0, below=1.0)
    # 4 artanh(kept), by logarithms since an inverse hyperbolic counts as an angle to pint.
    square: si.DimensionlessLike = 2 * (np.log1p(kept) - np.log1p(-kept))
    return square


@si.checked_numbers
def one_row(name: str, values: si.MetreArray) -> si.MetreArray:
    """Samples (m) as the compiled steps take them. Raises `InputError` for another shape."""
    array = np.ascontiguousarray(values, dtype=float)
    if array.ndim != 1 or array.size == 0:
        raise InputError(
            f"{name} of shape {array.shape} cannot be used: give one row of at least one sample"
        )
    return array


DAC_RATE: si.Hertz = 192e3
"""Rate of common sound converters that reach an ultrasonic carrier (Hz)."""


@compiled()
def carrier_block(
    phase: float, advance: float, command: si.Array, samples: int, gain: float, out: si.Array
) -> float:
    """Fill `out` (samples per command × commands) with carrier; returns the phase to go on from.

    `advance` (rad) is the carrier's phase per sample; each command holds over `samples` samples,
    and a negative one is the inverted phase. Nothing is allocated.
    """
    turn = 2.0 * math.pi
    k = 0
    for c in command:
        level = c * gain
        for _ in range(samples):
            out[k] = level * math.sin(phase)
            k += 1
            phase += advance
            if phase >= turn:
                phase -= turn
    return phase


@si.checked_numbers
def samples_per_command(command_rate: si.Hertz, sample_rate: si.Hertz = DAC_RATE) -> int:
    """Number of converter samples that one command lasts, for rates that divide evenly.

    Raises:
        InputError: a rate not above 0, or a command rate that does not divide the sample rate.
    """
    si.require("command_rate", command_rate, si.Unit("Hz"), above=0.0, at_most=sample_rate)
    count = round(sample_rate / command_rate)
    if abs(count * command_rate - sample_rate) > 1e-9 * sample_rate:
        raise InputError(
            f"command_rate = {si.format_quantity(command_rate, si.Unit('Hz'))} does not divide "
            f"{si.format_quantity(sample_rate, si.Unit('Hz'))}; take "
            f"{si.format_quantity(sample_rate / count, si.Unit('Hz'))}"
        )
    return count


# The inverse of the envelope, c = w + τ dw/dt, would make the amplitude the one wanted; between
# samples, exactly,
#
#     c[k] = (w[k+1] − a[k] E) / (1 − E),   E = exp(−Δt/τ).
#
# The command is bounded by the drive's voltage, −b c_max ≤ c ≤ c_max with c_max the amplitude that
# the full voltage holds; b = 1 where the amplifier may invert the carrier's phase to brake, else 0.
# Many amplifiers can: the phase is a sign in the signal. Without it nothing makes the amplitude
# fall faster than the resonator's own loss. A compensator carries the amplitude that the resonator
# must have, so that it takes up where saturation left it, and counts the samples that saturate.
#
# Open loop: a time constant that is wrong by a share d leaves about d of each step's height as
# error for one τ (a finger put down changes Q). Rise and fall may differ (`rise_time_constant`,
# `fall_time_constant`): a linear plate has one, an amplifier with a slow side has two.
#
# Two laws: "inverse" wants each next sample as soon as the limits let it; "preview" looks ahead and
# takes the plan with least squared error, which starts edges before they are due.
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
