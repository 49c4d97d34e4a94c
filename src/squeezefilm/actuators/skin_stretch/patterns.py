"""Textures that move over a fingertip, sampled where the contactors stand: voltages over time.

A contactor at x, y of the finger feels the place x + s(t) of a pattern of the render room
(`physics.render.texture.pattern`): 0 is −V, 1 is +V, a half is rest.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from squeezefilm.actuators.skin_stretch.cradle import FingerCradle
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import MOTION_SAMPLES, require_within
from squeezefilm.physics.render.texture.pattern import Pattern, require_pattern

VoltArray = Annotated[si.FloatArray, si.Unit("V")]


@si.checked_numbers
def pattern_voltages(
    pattern: Pattern,
    cradle: FingerCradle,
    times: si.SecondArray,
    velocity: tuple[si.MetrePerSecond, si.MetrePerSecond],
    voltage: Annotated[si.Volt, si.AtLeast(0)],
) -> VoltArray:
    """The voltages (V) of all actuators while the finger moves over a pattern: shape (times,
    contactors).

    `velocity` (m/s) is the finger's along x and y over the pattern; at time 0 (s) its middle is at
    the pattern's origin. The speed reaches the pattern, as do the times. Places finer than two
    pitches are not resolved (`finest_period`). Raises `InputError` for what is no pattern, times
    that are no row, or more than 20 million samples.
    """
    require_pattern("pattern", pattern)
    si.require("times", times, si.Unit("s"), axes=1)
    if times.size == 0:
        raise InputError("times is empty; give at least one", quantity="times")
    require_within(MOTION_SAMPLES, float(max(times.size * cradle.count, 2)), "samples")
    x, y = cradle.places
    at = times[:, None]
    speed = float(np.hypot(*velocity))
    values = pattern(x + velocity[0] * at, y + velocity[1] * at, speed, at)
    return np.asarray(voltage * (2 * values - 1))


@si.checked_numbers
def finest_period(cradle: FingerCradle, along: bool = True) -> si.Metre:
    """The shortest period (m) of a grating along (or across) the finger that contactors still tell
    from a longer one: two pitches (Nyquist). At the period itself the phase decides what comes."""
    return 2 * (cradle.pitch_along if along else cradle.pitch_across)
