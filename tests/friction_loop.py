"""One step of a loop that holds friction: a force sensor corrects what a table's inverse foretells.

The level for a wanted friction is looked up in the table of friction over level, turned around, so
that to the loop the plate is a first-order lag, P = 1/(τ s + 1). Expected of the finger is the
wanted friction behind that lag; what the sensor misses of it is corrected by C = ω τ + ω/s, which
cancels the lag: the wanted friction is followed with P, and what the table does not know (the
finger, its moisture) is left s/(s + ω) of.

The step runs at the rate of the amplitude (5 kHz), the sensor as often as it has a new force
(1 kHz). Integers alone (µN, µV), as `sf_friction_step` of `firmware/squeezefilm_loops.c`.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.instruments.control.plate_loop import clamped, quotient, scaled

POINTS = 33
"""Levels of the inverse table, at equal steps of friction."""
OUT_OF_REACH, CORRECTION_HELD = 1, 2
"""Flags: no level makes that friction; the sensor contradicts the table by more than is believed
(its sign is turned, the finger is gone, or the table is another finger's)."""


class FrictionGains(NamedTuple):
    """Settings: `lowest` friction of the table and the `pitch` of its points (µN); `proportional`
    (2^16) and `integral` (2^24 a sample); `lag` (2^24 a step) of what is expected; the largest
    `correction` (µN)."""

    lowest: int
    pitch: int
    proportional: int
    integral: int
    lag: int
    correction: int


class FrictionState(NamedTuple):
    """The friction expected (µN, 2^8), the error last seen (µN) and its sum (µN, 2^8)."""

    expected: int = 0
    error: int = 0
    sum: int = 0


class FrictionCommand(NamedTuple):
    """The level (µV) and flags."""

    level: int
    flags: int


@compiled()
def friction_step(
    gains: FrictionGains,
    levels: NDArray[np.int64],
    state: FrictionState,
    wanted: int,
    measured: int,
    fresh: bool,
) -> tuple[FrictionState, FrictionCommand]:
    """One step.

    Args:
        gains: of the loop.
        levels: of the inverse table (µV), `POINTS` of them.
        state: what the step before left.
        wanted: friction (µN, 0 to 2^30).
        measured: by the sensor (µN); read where it is `fresh`.
        fresh: whether the sensor has a new force since the last step.
    """
    expected, error, total = state.expected, state.error, state.sum
    flags = 0
    if fresh:
        error = clamped(scaled(expected, 8) - measured, -(1 << 30), 1 << 30)
        total += scaled(gains.integral * error, 16)
        most = gains.correction << 8
        if total > most or total < -most:
            flags = CORRECTION_HELD
        total = clamped(total, -most, most)
    expected += scaled(gains.lag * ((wanted << 8) - expected), 24)
    asked = wanted + scaled(gains.proportional * error, 16) + scaled(total, 8)
    highest = gains.lowest + (POINTS - 1) * gains.pitch
    held = clamped(asked, gains.lowest, highest)
    if held != asked:
        flags |= OUT_OF_REACH
        # A sum that pushes further out would only have to come back.
        if (asked > highest) == (total > state.sum):
            total = state.sum
    place = held - gains.lowest
    number = min(place // gains.pitch, POINTS - 2)
    rise = levels[number + 1] - levels[number]
    level = levels[number] + quotient(rise * (place - number * gains.pitch), gains.pitch)
    return FrictionState(expected, error, total), FrictionCommand(level, flags)


@si.checked_numbers
def friction_gains(
    voltage: si.VoltArray,
    friction: si.NewtonArray,
    bandwidth: Annotated[si.Hertz, si.Above(0.0)],
    time_constant: Annotated[si.Second, si.Above(0.0)],
    interval: Annotated[si.Second, si.Above(0.0)],
    sensor_interval: Annotated[si.Second, si.Above(0.0)],
    correction: Annotated[si.Newton, si.Above(0.0)],
) -> tuple[FrictionGains, NDArray[np.int64]]:
    """The settings and the inverse table of a finger on a plate.

    `friction` (N) falls over the `voltage` (V) that holds an amplitude; `bandwidth` ω/2π is that of
    the correction, `time_constant` τ the amplitude's, `correction` the most that the sensor may
    contradict the table by. Raises `InputError` for a friction that does not fall or a table of
    another shape, `OutOfRangeError` for a bandwidth above a tenth of the sensor's rate, whose delay
    would then ring.
    """
    if voltage.ndim != 1 or voltage.shape != friction.shape or voltage.size < 2:
        raise InputError(
            f"friction has the shape {friction.shape} and voltage {voltage.shape}; it needs one "
            "value at each of at least two voltages",
            quantity="friction",
        )
    if np.any(np.diff(voltage) <= 0) or np.any(np.diff(friction) >= 0):
        raise InputError(
            "voltage must rise and friction fall with it, so that the table can be turned around; "
            "leave out voltages at which friction no longer falls",
            quantity="friction",
        )
    if bandwidth * sensor_interval > 0.1:
        raise OutOfRangeError(
            f"bandwidth = {bandwidth:g} Hz is too fast for a sensor at {1 / sensor_interval:g} Hz; "
            f"at most {0.1 / sensor_interval:g} Hz"
        )
    micro = friction * 1e6
    pitch = max(1, math.floor((micro[0] - micro[-1]) / (POINTS - 1)))
    places = micro[-1] + pitch * np.arange(POINTS)
    levels = np.rint(np.interp(places, micro[::-1], voltage[::-1]) * 1e6).astype(np.int64)
    pace = 2 * math.pi * bandwidth
    gains = FrictionGains(
        lowest=round(float(micro[-1])),
        pitch=pitch,
        proportional=round(pace * time_constant * (1 << 16)),
        integral=round(pace * sensor_interval * (1 << 24)),
        lag=round((1 - math.exp(-interval / time_constant)) * (1 << 24)),
        correction=round(correction * 1e6),
    )
    return gains, levels
