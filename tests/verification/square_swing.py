"""Swing that a square grating keeps behind a slow envelope with a compensated drive, in closed
form: the oracle of what compensation gives in speed."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from squeezefilm.core import quantities as si
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope

Way = Literal["none", "inverse"]


def square_swing_compensated(
    spatial_period: si.MetreLike,
    speed: si.MetrePerSecondLike,
    envelope: DrivenEnvelope,
    low: float,
    high: float,
    compensation: Way = "inverse",
) -> si.DimensionlessArray:
    """Swing of amplitude left of a square grating of duty ½ in the steady state (1).

    For half a period h = spatial_period/(2 speed) the amplitude closes in on the limit above (with
    "none": on `high`) and stops at `high`; for the other half on the limit below (`low`) and stops
    at `low`:

        a_high = min(high, top − (top − a_low) exp(−h/τ_rise))
        a_low = max(low, bottom + (a_high − bottom) exp(−h/τ_fall)),

    solved for the cycle that repeats.
    """
    half = np.asarray(spatial_period, dtype=float) / (2 * np.asarray(speed, dtype=float))
    rise = np.exp(-half / envelope.rise_time_constant)
    fall = np.exp(-half / envelope.fall_time_constant)
    bare = compensation == "none"
    top = high if bare else envelope.amplitude_limit
    bottom = low if bare else envelope.lowest_command
    # The cycle that meets neither stop; then those that meet one, which are then the cycle.
    free_high = (top * (1 - rise) + rise * bottom * (1 - fall)) / (1 - rise * fall)
    a_high = np.minimum(free_high, high)
    a_low = np.maximum(low, bottom + (a_high - bottom) * fall)
    a_high = np.minimum(high, top - (top - a_low) * rise)
    a_low = np.maximum(low, bottom + (a_high - bottom) * fall)
    return np.asarray((a_high - a_low) / (high - low))


def fastest_compensated_speed(
    spatial_period: float,
    envelope: DrivenEnvelope,
    low: float,
    high: float,
    compensation: Way = "inverse",
    kept: float = 0.9,
) -> float:
    """Fastest finger (m/s) under which a square grating keeps a share `kept` of its swing."""
    unit = spatial_period / max(envelope.rise_time_constant, envelope.fall_time_constant)

    def lacking(log_speed: float) -> float:
        speed = unit * math.exp(log_speed)
        swing = square_swing_compensated(spatial_period, speed, envelope, low, high, compensation)
        return float(swing) - kept

    return float(unit * math.exp(brentq(lacking, -30.0, 30.0, xtol=1e-13, rtol=1e-13)))
