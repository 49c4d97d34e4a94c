"""What a display's resonator leaves of gratings, and what compensation does for them."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Display
from squeezefilm.physics.render.fidelity.survival import FidelityTable, fidelity_table
from squeezefilm.physics.render.resonator.compensation import (
    DrivenEnvelope,
)
from squeezefilm.physics.render.resonator.square_swing import (
    Compensating,
    fastest_compensated_speed,
    least_cycle,
    square_fundamental_compensated,
)


@dataclass(frozen=True, slots=True)
class DriveLaw:
    """A way to drive a resonator: with or without the inverse filter and phase inversion."""

    name: str
    compensated: bool
    braking: bool


DRIVE_LAWS: tuple[DriveLaw, ...] = (
    DriveLaw("no compensation", False, False),
    DriveLaw("compensated, no phase inversion", True, False),
    DriveLaw("compensated, phase inversion", True, True),
)
"""The drives that are compared everywhere here."""


def driven_envelope(prediction: Prediction) -> DrivenEnvelope:
    """The envelope of a display without a finger at its resonance, driven with up to the voltage of
    the prediction.

    Raises `InputError` for a prediction made from an amplitude, a voltage not above 0, or a mode
    that the drive does not reach.
    """
    if prediction.voltage is None:
        raise InputError("the prediction was made from an amplitude, not a voltage: give a voltage")
    mode = prediction.mode
    return DrivenEnvelope.of_resonator(
        mode.quality_factor, mode.resonance_frequency, mode.amplitude_per_volt, prediction.voltage
    )


@dataclass(frozen=True, slots=True, eq=False)
class TextureSurvival:
    """Which square gratings keep their swing at which finger speeds, by drive.

    Attributes:
        name: of the display.
        time_constant: of its envelope (s).
        level: upper amplitude of the swing from 0, over what the full voltage holds (1).
        kept: share of the swing to keep, peak to peak (1).
        fundamental: share of the wave of the grating's own period that is left where just `kept`
            of the swing is (1), shape (d,).
        laws: the drives, shape (d,).
        speeds: of the finger (m/s), shape (v,).
        finest_period: that survives (m), shape (d, v).
        gain: of speed over the first drive at any period (1), shape (d,).
        bound: most that any law of command could gain, preview included (1), shape (d,).
        model: of the resonator.
    """

    name: str
    time_constant: si.Second
    level: si.Dimensionless
    kept: si.Dimensionless
    fundamental: si.DimensionlessArray
    laws: tuple[DriveLaw, ...]
    speeds: si.MetrePerSecondArray
    finest_period: si.MetreArray
    gain: si.DimensionlessArray
    bound: si.DimensionlessArray
    model: str = "first-order envelope at resonance, duty ½, closed forms"


def texture_survival(
    name: str,
    envelope: DrivenEnvelope,
    level: si.Dimensionless = 0.8,
    kept: si.Dimensionless = 0.9,
    speeds: Sequence[si.MetrePerSecond] | None = None,
) -> TextureSurvival:
    """Finest surviving period against speed for each of `DRIVE_LAWS`; see `TextureSurvival`.

    `envelope.braking` is not looked at: each law says whether it inverts. Without `speeds`,
    10 to 400 mm/s.

    Raises:
        InputError: a level not above 0 or above 1, a share not between 0 and 1, or a speed not
            above 0.
    """
    si.require("level", level, above=0.0, at_most=1.0)
    row = np.geomspace(0.01, 0.4, 41) if speeds is None else np.array(speeds, dtype=float)
    si.require("speeds", row, si.Unit("m/s"), above=0.0)
    high = level * envelope.amplitude_limit
    per_metre, bound, wave = [], [], []
    for law in DRIVE_LAWS:
        driven = dataclasses.replace(envelope, braking=law.braking)
        compensation: Compensating = "inverse" if law.compensated else "none"
        speed = fastest_compensated_speed(1.0, driven, 0.0, high, compensation, kept)
        per_metre.append(speed)
        # Scaled with the period, the speed leaves the same cycle: a metre stands for all.
        wave.append(square_fundamental_compensated(1.0, speed, driven, 0.0, high, compensation))
        bound.append(1 / least_cycle(driven, kept * high) / per_metre[0])
    fastest = np.array(per_metre)
    return TextureSurvival(
        name=name,
        time_constant=max(envelope.rise_time_constant, envelope.fall_time_constant),
        level=level,
        kept=kept,
        fundamental=np.array(wave),
        laws=DRIVE_LAWS,
        speeds=row,
        finest_period=row / fastest[:, None],
        gain=fastest / fastest[0],
        bound=np.array(bound),
    )


def survival_by_drive(display: Display, prediction: Prediction) -> TextureSurvival | None:
    """Which square gratings survive at which speeds, by drive; None where no voltage makes an
    amplitude."""
    if not prediction.voltage or prediction.vibration_amplitude == 0:
        return None
    return texture_survival(display.name, driven_envelope(prediction))


def what_survives(prediction: Prediction, tau: si.Second) -> FidelityTable | None:
    """Which grating survives at which speed; None where the amplitude changes no friction."""
    if prediction.relative_friction == 1 or prediction.vibration_amplitude == 0:
        return None
    return fidelity_table(tau, prediction.friction, low=0.0, high=prediction.vibration_amplitude)
