"""The carrier itself: an amplitude command as samples for a converter, and what a resonator does.

The envelope (`envelope`, `compensation`) is a model of this. Here the carrier is made sample by
sample, phase-continuous, and a resonator of the second order,

    ẍ + (ω0/Q) ẋ + ω0² x = ω0²/Q · u(t),

answers it; u is the drive in metres of the amplitude that it holds at resonance. The converter
holds each sample (zero order): at a frequency f and a rate f_s that weakens the carrier by
sinc(f/f_s) and delays it by half a sample, πf/f_s of phase (37.5° at 40 kHz and 192 kHz). The
gain is made up for on request; the phase matters only to whoever closes a loop around it.

Between samples u is constant, so the resonator is stepped exactly. One resonance, one direction:
other modes of the plate, ceramic hysteresis and the finger's load are not in it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numba
import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.render.resonator.envelope import envelope_response, envelope_time_constant, one_row

DAC_RATE: si.Hertz = 192e3
"""Rate of common sound converters that reach an ultrasonic carrier (Hz)."""


@si.closed_form(positive="frequency sample_rate")
def hold_gain(frequency: si.HertzLike, sample_rate: si.HertzLike) -> si.DimensionlessLike:
    """What is left of a carrier after a converter's zero-order hold (1): sin(πr)/(πr), r = f/f_s.

    `frequency` and `sample_rate` (Hz) broadcast. Raises `InputError` unless both are above 0.
    """
    ratio = math.pi * frequency / sample_rate
    gain: si.DimensionlessLike = np.sin(ratio) / ratio
    return gain


@numba.njit(cache=True, nogil=True)
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


@numba.njit(cache=True, nogil=True)
def _resonate(
    drive: si.Array,
    m00: float,
    m01: float,
    m10: float,
    m11: float,
    b0: float,
    b1: float,
    x: float,
    v: float,
    place: si.Array,
    quadrature: si.Array,
) -> None:
    for k in range(drive.size):
        place[k] = x
        quadrature[k] = v
        u = drive[k]
        x, v = m00 * x + m01 * v + b0 * u, m10 * x + m11 * v + b1 * u


@si.checked_numbers
def resonator_response(
    drive: si.MetreArray,
    sample_rate: Annotated[si.Hertz, si.Above(0.0)],
    frequency: Annotated[si.Hertz, si.Above(0.0)],
    quality_factor: Annotated[si.Dimensionless, si.Above(0.5)],
) -> tuple[si.MetreArray, si.MetreArray]:
    """Displacement x and quadrature ẋ/ω0 of a resonator at rest before, at each held sample (m).

    `drive` (m), shape (n,), is in metres of the amplitude that a carrier of it holds at resonance.
    Exact for a drive held from sample to sample.

    Raises:
        InputError: a drive that is empty or not finite, a rate or frequency not above 0, or a
            quality factor not above ½ (no resonance).
    """
    held = one_row("drive", drive)
    # In units of 1/ω0: x' = y, y' = −x − y/Q + u/Q. Damped rotation, in closed form.
    turn = 2 * math.pi * frequency / sample_rate
    loss = 0.5 / quality_factor
    ring = math.sqrt(1 - loss**2)
    decay = math.exp(-loss * turn)
    cos, sin = float(np.cos(ring * turn)), float(np.sin(ring * turn))
    m00, m01 = decay * (cos + loss / ring * sin), decay * sin / ring
    m10, m11 = -decay * sin / ring, decay * (cos - loss / ring * sin)
    # A constant u moves the rest position to u/Q.
    rest = 1 / quality_factor
    place, quadrature = np.empty_like(held), np.empty_like(held)
    _resonate(held, m00, m01, m10, m11, (1 - m00) * rest, -m10 * rest, 0.0, 0.0, place, quadrature)
    return place, quadrature


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class CarrierTrace:
    """An amplitude command played as a carrier into a resonator; arrays of shape (samples,).

    Attributes:
        frequency, resonance_frequency, quality_factor, sample_rate: the inputs (Hz, Hz, 1, Hz).
        time: of each converter sample (s).
        command: amplitude commanded (m).
        displacement: of the resonator (m).
        amplitude: its envelope √(x² + (ẋ/ω0)²) (m), never negative.
        amplitude_modelled: magnitude of the first-order envelope under the same command (m).
        model: what made it.
    """

    frequency: si.Hertz
    resonance_frequency: si.Hertz
    quality_factor: si.Dimensionless
    sample_rate: si.Hertz
    time: si.SecondArray
    command: si.MetreArray
    displacement: si.MetreArray
    amplitude: si.MetreArray
    amplitude_modelled: si.MetreArray
    model: str = "second-order resonator, converter with zero-order hold"

    @property
    def envelope_error(self) -> si.Metre:
        """Largest difference of the two envelopes anywhere (m)."""
        return float(np.max(np.abs(self.amplitude - self.amplitude_modelled)))


@si.checked_numbers
def carrier_trace(
    command: si.MetreArray,
    samples_per_command: int,
    frequency: si.Hertz,
    quality_factor: si.Dimensionless,
    *,
    resonance_frequency: si.Hertz | None = None,
    sample_rate: Annotated[si.Hertz, si.Above(0.0)] = DAC_RATE,
    phase: si.Radian = 0.0,
    hold_compensated: bool = True,
) -> CarrierTrace:
    """Play an amplitude command as a carrier into a resonator that is at rest.

    Args:
        command: amplitudes (m), each held over `samples_per_command` converter samples; negative
            in inverted phase.
        samples_per_command: at least 1.
        frequency: of the carrier (Hz); below half the sample rate.
        quality_factor: of the resonator (1).
        resonance_frequency: of the resonator (Hz); the carrier's without one.
        sample_rate: of the converter (Hz).
        phase: of the carrier at the first sample (rad).
        hold_compensated: make up for the hold's gain.

    Raises:
        InputError: a value outside its range.
    """
    si.require("frequency", frequency, si.Unit("Hz"), above=0.0, below=sample_rate / 2)
    levels = _levels(command, samples_per_command)
    own = frequency if resonance_frequency is None else resonance_frequency
    gain = 1 / float(hold_gain(frequency, sample_rate)) if hold_compensated else 1.0
    drive = np.empty(levels.size * samples_per_command)
    carrier_block(
        math.fmod(phase, 2 * math.pi),
        2 * math.pi * frequency / sample_rate,
        levels,
        samples_per_command,
        gain,
        drive,
    )
    place, quadrature = resonator_response(drive, sample_rate, own, quality_factor)
    held = np.repeat(levels, samples_per_command)
    tau = float(envelope_time_constant(quality_factor, own))
    return CarrierTrace(
        frequency=frequency,
        resonance_frequency=own,
        quality_factor=quality_factor,
        sample_rate=sample_rate,
        time=np.arange(drive.size) / sample_rate,
        command=held,
        displacement=place,
        amplitude=np.hypot(place, quadrature),
        amplitude_modelled=np.abs(envelope_response(held, 1 / sample_rate, tau)),
    )


def _levels(command: si.MetreArray, samples_per_command: int) -> si.MetreArray:
    levels = np.ascontiguousarray(command, dtype=float)
    if levels.ndim != 1 or levels.size == 0 or samples_per_command < 1:
        raise InputError(
            f"command of shape {levels.shape} at {samples_per_command} samples each makes no "
            "carrier: give one row of at least one, and at least 1 sample each"
        )
    return levels


@si.checked_numbers
def samples_per_command(command_rate: si.Hertz, sample_rate: si.Hertz = DAC_RATE) -> int:
    """How many converter samples one command lasts, for rates that divide evenly.

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
