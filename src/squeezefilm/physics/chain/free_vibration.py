"""A display that vibrates without a finger: how far, at which voltage and frequency."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfTimeError
from squeezefilm.core.hard_limits import TOUCHED_VIBRATION, require_within
from squeezefilm.core.progress import NO_HURRY, Pace
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import Actuator, RectangularPlate
from squeezefilm.physics.plate.working_mode import PlateTheory, WorkingMode, working_mode

Objections = tuple[str, ...]


def chosen_mode(
    actuator: Actuator,
    theory: PlateTheory | None = None,
    *,
    strict: bool = False,
    pace: Pace = NO_HURRY,
) -> tuple[WorkingMode, Objections]:
    """The working mode of an actuator, and what speaks against it, in sentences.

    Without a `theory` a plate is solved in three dimensions, and taken as a beam, with an
    objection, where that finds no such mode or the budget of `pace` does not allow it; with
    `strict` it raises then. Raises what `working_mode` raises.
    """
    if theory is not None or strict or not isinstance(actuator, RectangularPlate):
        mode = working_mode(actuator, theory or "solid", pace=pace)
        return mode, _coarseness(mode)
    try:
        mode = working_mode(actuator, "solid", pace=pace)
    except OutOfTimeError as error:
        return working_mode(actuator, "timoshenko"), (
            f"{error}; the numbers are those of a beam, whose frequency lies within 13 % of the "
            "solved one (on 95 random plates) and whose amplitude mostly within a factor of two",
        )
    except InputError as error:
        return working_mode(actuator, "timoshenko"), (
            f"the solved plate does not give the working mode ({error}); a beam's, whose numbers "
            "these are, need not exist in such a plate",
        )
    return mode, _coarseness(mode)


def _coarseness(mode: WorkingMode) -> Objections:
    if mode.solid is None or not mode.solid.coarseness:
        return ()
    return (mode.solid.coarseness,)


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
