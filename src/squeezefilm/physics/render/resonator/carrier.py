"""The carrier itself: an amplitude command as samples for a converter, phase-continuous.

The converter holds each sample (zero order): at a frequency f and a rate f_s that weakens the
carrier by sinc(f/f_s) and delays it by half a sample, πf/f_s of phase (37.5° at 40 kHz and
192 kHz). Whoever makes up for the gain passes it; the phase matters only to whoever closes a loop
around it.
"""

from __future__ import annotations

import math

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.errors import InputError

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
