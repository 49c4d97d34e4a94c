"""What compensation gains on a square grating, in closed form, and what no drive could gain.

Two numbers, because they part: the swing from peak to peak, and the fundamental, the wave of the
grating's own period. What rounds the edges takes from the fundamental long before the peaks fall
short: a square that keeps 90 % of its swing behind one time constant keeps 68 % of its fundamental.
"""

from __future__ import annotations

import cmath
import math
from typing import Annotated, Literal, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.physics.render.resonator.compensation import DrivenEnvelope

Compensating = Literal["none", "inverse"]


@si.checked_numbers
def square_swing_compensated(
    spatial_period: Annotated[si.MetreLike, si.Above(0.0)],
    speed: Annotated[si.MetrePerSecondLike, si.Above(0.0)],
    envelope: DrivenEnvelope,
    low: si.Metre,
    high: si.Metre,
    compensation: Compensating = "inverse",
) -> si.DimensionlessLike:
    """Swing of amplitude left of a square grating of duty ½ in the steady state (1).

    For half a period h = spatial_period/(2 speed) the amplitude closes in on the limit above (with
    "none": on `high`) and stops at `high`; for the other half on the limit below (`low`) and stops
    at `low`:

        a_high = min(high, top − (top − a_low) exp(−h/τ_rise))
        a_low = max(low, bottom + (a_high − bottom) exp(−h/τ_fall)),

    solved for the cycle that repeats. Without compensation and with one time constant this is
    tanh(h/2τ), `square_swing_kept`. `spatial_period` (m) and `speed` (m/s) broadcast.

    Raises:
        InputError: a period or speed not above 0, or not 0 ≤ low < high ≤ limit.
    """
    half = np.asarray(spatial_period, dtype=float) / (2 * np.asarray(speed, dtype=float))
    cycle = _cycle(half, envelope, low, high, compensation)
    kept = np.asarray((cycle.highest - cycle.lowest) / (high - low))
    return float(kept) if kept.ndim == 0 else kept


@si.checked_numbers
def square_fundamental_compensated(
    spatial_period: Annotated[si.Metre, si.Above(0.0)],
    speed: Annotated[si.MetrePerSecond, si.Above(0.0)],
    envelope: DrivenEnvelope,
    low: si.Metre,
    high: si.Metre,
    compensation: Compensating = "inverse",
) -> si.Dimensionless:
    """Share of the fundamental that is left of a square grating of duty ½ in the steady state (1).

    The wave of the grating's own period in the cycle of `square_swing_compensated`, over that of
    the square commanded, 2 (high − low)/π. Without compensation and with one time constant it is
    the gain of a first-order lag, `sine_swing_kept`. `spatial_period` in m, `speed` in m/s.

    Raises:
        InputError: a period or speed not above 0, or not 0 ≤ low < high ≤ limit.
    """
    half = spatial_period / (2 * speed)
    cycle = _cycle(np.asarray(half), envelope, low, high, compensation)
    lowest, highest = float(cycle.lowest), float(cycle.highest)
    up = _wave_of_half(cycle.top, lowest, high, envelope.rise_time_constant, half)
    down = _wave_of_half(cycle.bottom, highest, low, envelope.fall_time_constant, half)
    # A half period later the wave e^(−iπt/h) has turned by −1. Of the square it is −2i h/π a unit.
    return abs(up - down) / ((high - low) * 2 * half / math.pi)


class _Cycle(NamedTuple):
    """The cycle that repeats: its ends (m), and the limits that rise and fall close in on (m)."""

    lowest: si.FloatArray
    highest: si.FloatArray
    top: float
    bottom: float


def _cycle(
    half: si.FloatArray,
    envelope: DrivenEnvelope,
    low: si.Metre,
    high: si.Metre,
    compensation: Compensating,
) -> _Cycle:
    """Of half periods (s). Raises as `square_swing_compensated`."""
    si.require("low", low, si.Unit("m"), at_least=0.0, below=high)
    si.require("high", high, si.Unit("m"), at_most=envelope.amplitude_limit)
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
    return _Cycle(a_low, a_high, top, bottom)


def _wave_of_half(
    limit: si.Metre, start: si.Metre, stop: si.Metre, tau: si.Second, half: si.Second
) -> complex:
    """∫ a(t) e^(−iπt/half) dt over a half period (m·s): from `start` toward `limit`, to `stop`."""
    turn = 1j * math.pi / half
    to_stop = (limit - stop) / (limit - start) if limit != start else 1.0
    met = min(half, -tau * math.log(to_stop)) if to_stop > 0.0 else half
    held = cmath.exp(-turn * met)
    wave = limit * (1 - held) / turn
    slow = turn + 1 / tau
    wave -= (limit - start) * (1 - cmath.exp(-slow * met)) / slow
    # e^(−iπ) = −1 at the end of the half.
    return wave + stop * (held + 1) / turn if met < half else wave


@si.checked_numbers
def fastest_compensated_speed(
    spatial_period: si.Metre,
    envelope: DrivenEnvelope,
    low: si.Metre,
    high: si.Metre,
    compensation: Compensating = "inverse",
    kept: Annotated[si.Dimensionless, si.Above(0.0), si.Below(1.0)] = 0.9,
) -> si.MetrePerSecond:
    """Fastest finger (m/s) under which a square grating keeps a share `kept` of its swing.

    The inverse of `square_swing_compensated` in speed, found to 1e-12; proportional to the period.

    Raises:
        InputError: see `square_swing_compensated`, or a share not between 0 and 1.
    """
    from scipy.optimize import brentq

    unit = spatial_period / max(envelope.rise_time_constant, envelope.fall_time_constant)

    def lacking(log_speed: float) -> float:
        speed = unit * math.exp(log_speed)
        return (
            float(
                square_swing_compensated(spatial_period, speed, envelope, low, high, compensation)
            )
            - kept
        )

    if lacking(30.0) > 0.0:
        raise OutOfRangeError(
            f"kept = {kept:.4g} of the swing is left at any speed; ask for a larger share",
            quantity="kept",
        )
    return float(unit * math.exp(brentq(lacking, -30.0, 30.0, xtol=1e-13, rtol=1e-13)))


@si.checked_numbers
def least_cycle(
    envelope: DrivenEnvelope, swing: si.Metre, highest: si.Metre | None = None
) -> si.Second:
    """Shortest period in which any drive within the limits swings the amplitude by so much (s).

    Rise at the full limit, fall at the lowest command, from the level where the two together are
    quickest; the amplitude stays between 0 and `highest` (m; the limit without one). No law of
    command, preview included, does better, so it says what is impossible.

    Raises:
        InputError: not 0 < swing < limit, or a swing above `highest`.
    """
    ceiling = envelope.amplitude_limit if highest is None else highest
    si.require("highest", ceiling, si.Unit("m"), above=0.0, at_most=envelope.amplitude_limit)
    si.require(
        "swing", swing, si.Unit("m"), above=0.0, below=envelope.amplitude_limit, at_most=ceiling
    )
    from scipy.optimize import minimize_scalar

    def period(level: float) -> float:
        up = (envelope.amplitude_limit - level) / max(
            envelope.amplitude_limit - level - swing, 1e-300
        )
        down = (level + swing - envelope.lowest_command) / max(
            level - envelope.lowest_command, 1e-300
        )
        rising = envelope.rise_time_constant * float(np.log(up))
        return rising + envelope.fall_time_constant * float(np.log(down))

    room = ceiling - swing
    found = minimize_scalar(
        period,
        bounds=(0.0, max(room, 1e-300)),
        method="bounded",
        options={"xatol": 1e-12 * envelope.amplitude_limit},
    )
    return min(float(found.fun), period(0.0), period(room))
