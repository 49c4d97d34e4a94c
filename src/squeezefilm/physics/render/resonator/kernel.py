"""Compiled steps of envelope and compensation; nothing is allocated and nothing raises.

An envelope here is one whose amplitude a closes in on its command c with one time constant while
it rises and another while it falls; over a step with c held it keeps `keep_rise` (or `keep_fall`)
= exp(−Δt/τ) of its distance. See `compensation`.
"""

from __future__ import annotations

import math

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled

# Places in a compensator's state: the amplitude it takes the resonator to have, then counters.
AMPLITUDE, SAMPLES, AT_TOP, AT_BOTTOM, NOT_FINITE = range(5)
STATE_SIZE = 5
# Places in the parameters: what is kept over a step, and the command's limits.
KEEP_RISE, KEEP_FALL, BOTTOM, TOP = range(4)
PARAMETERS_SIZE = 4
# What a step's command is: what was asked for, or as near as the limits let it come.
FOLLOWS, TOPPED, BOTTOMED, SILENT = range(4)

ROUNDING = 1e-9
"""Share of the upper limit within which a command or an amplitude is at a limit."""


@compiled(inline="always")
def envelope_step(amplitude: float, command: float, keep_rise: float, keep_fall: float) -> float:
    """The amplitude one step later under a command held."""
    keep = keep_rise if command > amplitude else keep_fall
    return command + (amplitude - command) * keep


@compiled()
def envelope_march(
    command: si.Array, initial: float, keep_rise: float, keep_fall: float, amplitude: si.Array
) -> None:
    """Amplitude at each sample under a stepwise command; `amplitude[0]` takes `initial`."""
    a = initial
    for k in range(command.size):
        amplitude[k] = a
        a = envelope_step(a, command[k], keep_rise, keep_fall)


@compiled()
def compensated_step(state: si.Array, parameters: si.Array, wanted: float) -> tuple[float, int]:
    """The command that brings the amplitude to `wanted` in one step, or nearest to it.

    `wanted` is for the end of the step. One that is not finite silences the drive; a negative one
    counts as 0. Returns the command and one of the codes above.
    """
    a = state[AMPLITUDE]
    rise, fall = parameters[KEEP_RISE], parameters[KEEP_FALL]
    bottom, top = parameters[BOTTOM], parameters[TOP]
    state[SAMPLES] += 1.0
    if not math.isfinite(wanted):
        state[NOT_FINITE] += 1.0
        state[AMPLITUDE] = envelope_step(a, 0.0, rise, fall)
        return 0.0, SILENT
    goal = max(wanted, 0.0)
    keep = rise if goal > a else fall
    command = (goal - a * keep) / (1.0 - keep)
    code, slack = FOLLOWS, ROUNDING * top
    # A plan within the limits meets them to rounding; an amplitude that is held at one is wanted.
    if command > top + slack or (command > top - slack and a < top - slack):
        code = TOPPED
        state[AT_TOP] += 1.0
    elif command < bottom - slack or (command < bottom + slack and a > bottom + slack):
        code = BOTTOMED
        state[AT_BOTTOM] += 1.0
    command = min(max(command, bottom), top)
    state[AMPLITUDE] = envelope_step(a, command, rise, fall)
    return command, code


@compiled()
def compensated_march(
    state: si.Array, parameters: si.Array, wanted: si.Array, command: si.Array, code: si.Array
) -> None:
    """`compensated_step` over a block: `command[k]` leads to `wanted[k + 1]`, the last holds."""
    for k in range(wanted.size):
        command[k], code[k] = compensated_step(
            state, parameters, wanted[min(k + 1, wanted.size - 1)]
        )


@compiled()
def _least_place(places: si.Array, slopes: si.Array, knots: int) -> float:
    """Place where a rising piecewise linear slope crosses zero, or the end nearest to it."""
    if slopes[0] >= 0.0:
        return float(places[0])
    for i in range(1, knots):
        if slopes[i] >= 0.0:
            share = -slopes[i - 1] / (slopes[i] - slopes[i - 1])
            return float(places[i - 1] + share * (places[i] - places[i - 1]))
    return float(places[knots - 1])


@compiled()
def previewed_step(
    state: si.Array, parameters: si.Array, wanted: si.Array, work: si.Array
) -> tuple[float, int]:
    """The first command of the plan with least squared error over the samples ahead.

    `wanted[j]` is for the end of step j + 1 from now. Between neighbours the amplitude can only
    move within [keep_fall a + (1 − keep_fall) bottom, keep_rise a + (1 − keep_rise) top]: a chain
    of convex steps, whose least squares is found exactly by carrying along the slope of the least
    cost of being at each amplitude, a rising piecewise linear function. `work` has the shape
    (5, ≥ 2·wanted.size + 2).
    """
    a = state[AMPLITUDE]
    rise, fall = parameters[KEEP_RISE], parameters[KEEP_FALL]
    up, down = (1.0 - rise) * parameters[TOP], (1.0 - fall) * parameters[BOTTOM]
    places, slopes, new_places, new_slopes, best = work[0], work[1], work[2], work[3], work[4]
    for j in range(wanted.size):
        if not math.isfinite(wanted[j]):
            return compensated_step(state, parameters, math.nan)
    places[0], places[1] = max(fall * a + down, 0.0), rise * a + up
    slopes[0], slopes[1] = 2.0 * (places[0] - wanted[0]), 2.0 * (places[1] - wanted[0])
    knots = 2
    best[0] = _least_place(places, slopes, knots)
    for j in range(1, wanted.size):
        # What lies below the least is left by falling, what lies above by rising; every amplitude
        # between is reached from the least itself for nothing.
        k = 0
        while k < knots and slopes[k] < 0.0:
            new_places[k] = fall * places[k] + down
            new_slopes[k] = slopes[k] / fall
            k += 1
        m = best[j - 1]
        new_places[k], new_slopes[k] = fall * m + down, 0.0
        new_places[k + 1], new_slopes[k + 1] = rise * m + up, 0.0
        count = k + 2
        for i in range(k, knots):
            if slopes[i] > 0.0:
                new_places[count] = rise * places[i] + up
                new_slopes[count] = slopes[i] / rise
                count += 1
        # No amplitude lies below zero.
        skipped = 0
        while skipped < count - 1 and new_places[skipped + 1] <= 0.0:
            skipped += 1
        if new_places[skipped] < 0.0:
            i = skipped + 1
            share = -new_places[skipped] / (new_places[i] - new_places[skipped])
            new_slopes[skipped] += share * (new_slopes[i] - new_slopes[skipped])
            new_places[skipped] = 0.0
        knots = count - skipped
        for i in range(knots):
            places[i] = new_places[i + skipped]
            slopes[i] = new_slopes[i + skipped] + 2.0 * (places[i] - wanted[j])
        best[j] = _least_place(places, slopes, knots)
    # Backwards: each amplitude as near to its own least as the next one lets it be.
    goal = best[wanted.size - 1]
    for j in range(wanted.size - 2, -1, -1):
        goal = min(max(best[j], (goal - up) / rise), (goal - down) / fall)
    return compensated_step(state, parameters, goal)


@compiled()
def previewed_windows(
    state: si.Array,
    parameters: si.Array,
    windows: si.Array,
    work: si.Array,
    command: si.Array,
    code: si.Array,
) -> None:
    """`previewed_step` over a block where each step has its own view ahead: a row of `windows`."""
    for k in range(windows.shape[0]):
        command[k], code[k] = previewed_step(state, parameters, windows[k], work)
