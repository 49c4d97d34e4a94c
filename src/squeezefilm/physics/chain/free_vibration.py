"""A display that vibrates without a finger: how far, at which voltage and frequency."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import TOUCHED_VIBRATION, require_within
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.working_mode import WorkingMode


class FreeVibration(NamedTuple):
    """A plate that vibrates without a finger: its voltage where that is known, and what made the
    amplitude (m, zero-to-peak, at the antinode)."""

    frequency: si.Hertz
    voltage: si.Volt | None
    amplitude: si.Metre
    source: str


def free_vibration(
    display: Display,
    mode: WorkingMode,
    frequency: si.Hertz | None,
    voltage: si.Volt | None,
    vibration_amplitude: si.Metre | None,
) -> FreeVibration:
    """The vibration at a voltage (V), the display's own by default, or the one given (m).

    The frequency (Hz) is the resonance without one. Raises `InputError` for values
    below 0, or an amplitude beyond what is touched.
    """
    frequency = mode.resonance_frequency if frequency is None else frequency
    si.require("frequency", frequency, si.Unit("Hz"), above=0)
    if vibration_amplitude is not None:
        require_within(TOUCHED_VIBRATION, vibration_amplitude, "vibration_amplitude")
        return FreeVibration(frequency, None, vibration_amplitude, "given")
    volts = display.drive.voltage if voltage is None else voltage
    si.require("voltage", volts, si.Unit("V"), at_least=0)
    amplitude = volts * amplitude_per_volt(mode, frequency)
    return FreeVibration(frequency, volts, float(amplitude), mode.model)


def amplitude_per_volt(mode: WorkingMode, frequency: si.Hertz) -> si.MetrePerVolt:
    """The amplitude per volt (m/V) without a finger; off resonance with the mode's neighbours."""
    if frequency == mode.resonance_frequency:
        return mode.amplitude_per_volt
    return float(mode.response(np.array([frequency]))[0])
