"""The resonator's envelope: how slowly vibration amplitude follows its command.

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

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.errors import InputError


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
