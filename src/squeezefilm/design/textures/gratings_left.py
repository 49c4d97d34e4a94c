"""Square gratings that a display's resonator leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.render.resonator.envelope import (
    fastest_speed,
    finest_period,
    sine_swing_kept,
)

PAPER_PERIODS: tuple[si.Metre, ...] = (0.4e-3, 2e-3, 4e-3, 8e-3, 10e-3)
"""Spatial periods of the paper's match-to-sample experiment (m)."""

EXPLORING_SPEEDS: tuple[si.MetrePerSecond, ...] = (0.01, 0.02, 0.05, 0.1, 0.2)
"""Finger speeds from slow to brisk exploration (m/s)."""

KEPT: si.Dimensionless = 0.9
"""Share of its swing that a grating keeps which survives."""


@dataclass(frozen=True, slots=True, eq=False)
class GratingsLeft:
    """Square gratings that keep their swing of amplitude, and at which finger speeds, by the closed
    forms of `envelope`.

    Attributes:
        kept: the share of its swing, peak to peak, that a grating must keep to survive (1).
        fundamental: share of the wave of its own period that is left of one that just survives (1).
        spatial_periods, speeds: those that are looked at (m, m/s).
        finest_period: that survives at each speed (m).
        fastest_speed: of a finger under which each period survives (m/s).
    """

    kept: si.Dimensionless
    fundamental: si.Dimensionless
    spatial_periods: si.MetreArray
    speeds: si.MetrePerSecondArray
    finest_period: si.MetreArray
    fastest_speed: si.MetrePerSecondArray


def what_survives(prediction: Prediction, time_constant: si.Second) -> GratingsLeft | None:
    """Gratings that survive an envelope's time constant (s); None where the amplitude changes no
    friction."""
    if prediction.relative_friction == 1 or prediction.vibration_amplitude == 0:
        return None
    periods, speeds = np.array(PAPER_PERIODS), np.array(EXPLORING_SPEEDS)
    just = finest_period(1.0, time_constant, KEPT)
    return GratingsLeft(
        kept=KEPT,
        fundamental=float(sine_swing_kept(just, 1.0, time_constant)),
        spatial_periods=periods,
        speeds=speeds,
        finest_period=np.asarray(finest_period(speeds, time_constant, KEPT)),
        fastest_speed=np.asarray(fastest_speed(periods, time_constant, KEPT)),
    )
