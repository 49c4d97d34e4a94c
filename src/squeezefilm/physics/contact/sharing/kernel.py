"""The compiled load balance of a plateau: gas from the table of solved films, asperities by law.

All functions run without the interpreter. A balance that needs a part of the table that is not
solved yet says which, and is asked again once it is.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.contact.asperities import CompiledAsperities
from squeezefilm.physics.contact.asperity_kernel import asperity_mean
from squeezefilm.physics.contact.finger.load import CompiledFinger, felt

BALANCED, NEEDS_PANEL, PRESSED_THROUGH, OUT_OF_TABLE, UNSETTLED = range(5)
"""Outcomes of a balance."""

# Columns of a balance's row.
GAP, GAS, ASPERITIES, RESIDUAL, STEPS, STATUS = range(6)
COLUMNS = 6

_MOST_STEPS = 80
_SETTLED = 1e-10
_HALVINGS = 32


class CompiledFilms(NamedTuple):
    """A table of films: scales, edges of the rows, which panels are solved, their coefficients."""

    scale: si.FloatArray
    edges: si.FloatArray
    built: si.IntArray
    panels: si.FloatArray


class CompiledRidges(NamedTuple):
    """Ridges tied to one gap: what they meet (m), and which share of them all each stands for; the
    shares sum to 1."""

    amplitudes: si.FloatArray
    shares: si.FloatArray


class CompiledPad(NamedTuple):
    """Plateaus, each at its own balance under a `pressure` (Pa), whose ridges meet `amplitudes`
    over an antinode's; `least_gap` (m) is where the contact's law ends."""

    ridges: CompiledRidges
    pressure: float
    finger: CompiledFinger
    least_gap: float
    asperities: CompiledAsperities


@compiled(error_model="numpy")
def _panel_value(c: si.FloatArray, xi: float, eta: float) -> float:
    """A two-dimensional Chebyshev sum by Clenshaw's recurrence, along η for each row, then ξ."""
    b1, b2 = 0.0, 0.0
    for i in range(c.shape[0] - 1, -1, -1):
        d1, d2 = 0.0, 0.0
        for j in range(c.shape[1] - 1, 0, -1):
            d1, d2 = c[i, j] + 2.0 * eta * d1 - d2, d1
        row = c[i, 0] + eta * d1 - d2
        if i > 0:
            b1, b2 = row + 2.0 * xi * b1 - b2, b1
        else:
            return float(row + xi * b1 - b2)
    return math.nan


@compiled(error_model="numpy")
def film_value(which: int, u: float, a: float, films: CompiledFilms) -> tuple[float, int]:
    """A tabulated film quantity at mean gap u and amplitude a, and the panel that lacks (or −1).

    0: the over-pressure in Pa; 1, 2: stiffness and damping in Pa/m of gap amplitude. −2 for a
    point outside the table.
    """
    scale, edges, built, panels = films
    if a <= 0.0 and which == 0:
        return 0.0, -1
    eps = a / u
    t = -math.log1p(-eps * eps)
    x = math.log(u / scale[0]) - scale[2]
    column = math.floor(x)
    if column < 0 or column >= built.shape[0] or not t <= edges[-1]:
        return math.nan, -2
    row = 0
    while t > edges[row + 1]:
        row += 1
    if built[column, row] == 0:
        return math.nan, column * built.shape[1] + row
    xi = 2.0 * (x - column) - 1.0
    eta = 2.0 * (t - edges[row]) / (edges[row + 1] - edges[row]) - 1.0
    value = math.exp(_panel_value(panels[column, row, which], xi, eta))
    if which == 0:
        return scale[1] * eps * eps * value, -1
    return scale[1] * value / u, -1


@compiled(error_model="numpy")
def _carried(
    u: float, ridges: CompiledRidges, asperities: CompiledAsperities, films: CompiledFilms
) -> tuple[float, float, int]:
    """Mean gas and asperity pressure (Pa) of ridges at a gap u, and the panel lacking."""
    amplitudes, shares = ridges
    gas, solid = 0.0, 0.0
    for i in range(len(amplitudes)):
        over, lack = film_value(0, u, amplitudes[i], films)
        if lack != -1:
            return 0.0, 0.0, lack
        gas += shares[i] * over
        solid += shares[i] * asperity_mean(asperities, u, amplitudes[i])[0]
    return gas, solid, -1


@compiled(error_model="numpy")
def balance(
    ridges: CompiledRidges,
    pressure: float,
    asperities: CompiledAsperities,
    films: CompiledFilms,
    out: si.FloatArray,
) -> int:
    """The mean gap u at which ridges tied together carry a mean pressure (Pa), into `out`; the
    panel that lacks, or −1.

    What is carried falls steadily with u; ln of it is nearly linear, hence a false position in
    logarithms, with the factor of Anderson and Björck where an end stays.
    """
    amplitudes, _ = ridges
    out[:] = 0.0
    law = asperities.constants
    deepest = math.sqrt(-math.expm1(-films.edges[-1]))
    low = 1e-9
    # Nearer than the table goes a film is not known: where that is not near enough, nothing is.
    nearest = films.scale[0] * math.exp(films.scale[2]) * (1.0 + 1e-9)
    for i in range(len(amplitudes)):
        if amplitudes[i] > 0.0:
            low = max(low, nearest)
        low = max(low, amplitudes[i] / deepest * (1.0 + 1e-9))
    # Where exponential asperities alone would carry the load; with the gas it is further out.
    step = law[2]
    swing = amplitudes.max()
    # Of an exponential a period's mean is its most times I0(z) exp(−z), near (1 + 2πz)^−½.
    most = math.log(law[0] / pressure) - 0.5 * math.log1p(2.0 * math.pi * swing / step)
    alone = law[1] + swing + step * most
    guess = max(low + 0.5 * step, alone)
    u, at, spent = guess, math.nan, 0
    gas, solid, lack = _carried(u, ridges, asperities, films)
    if lack == -1:
        at = math.log((gas + solid) / pressure)
    left, right, f_left, f_right = math.nan, math.nan, math.nan, math.nan
    if at >= 0.0:
        left, f_left = u, at
    else:
        right, f_right = u, at
    while lack == -1 and spent < _MOST_STEPS and (math.isnan(left) or math.isnan(right)):
        spent += 1
        if math.isnan(right):
            u = left + step
        else:
            if right <= low * (1.0 + 1e-9):
                out[STATUS] = PRESSED_THROUGH
                return -1
            # Toward the deepest excursion, never past it.
            u = max(right - step, 0.5 * (low + right)) if right - step <= low else right - step
            if u - low < 1e-6 * low:
                u = low
        gas, solid, lack = _carried(u, ridges, asperities, films)
        if lack != -1:
            break
        at = math.log((gas + solid) / pressure)
        if at >= 0.0:
            left, f_left = u, at
        else:
            right, f_right = u, at
        step *= 1.6
    side = 0
    while lack == -1 and spent < _MOST_STEPS and abs(at) > _SETTLED:
        spent += 1
        u = (left * f_right - right * f_left) / (f_right - f_left)
        if not left < u < right or right - left < 1e-15 * u:
            u = 0.5 * (left + right)
        gas, solid, lack = _carried(u, ridges, asperities, films)
        if lack != -1:
            break
        at = math.log((gas + solid) / pressure)
        if at >= 0.0:
            if side == 1:
                f_right *= 1.0 - at / f_left if at < f_left else 0.5
            left, f_left, side = u, at, 1
        else:
            if side == -1:
                f_left *= 1.0 - at / f_right if at > f_right else 0.5
            right, f_right, side = u, at, -1
    out[STEPS] = spent + 1
    if lack >= 0:
        out[STATUS] = NEEDS_PANEL
        return lack
    if lack == -2:
        out[STATUS] = OUT_OF_TABLE
        return -1
    out[GAP], out[GAS], out[ASPERITIES] = u, gas, solid
    out[RESIDUAL] = (gas + solid) / pressure - 1.0
    # Where panels of the table meet, it may step by rounding: that much is allowed.
    out[STATUS] = BALANCED if abs(out[RESIDUAL]) < 1e-8 else UNSETTLED
    return -1


@compiled(error_model="numpy")
def balance_rows(
    amplitude: si.FloatArray,
    pressure: si.FloatArray,
    asperities: CompiledAsperities,
    films: CompiledFilms,
    out: si.FloatArray,
) -> int:
    """Each plateau at its own balance; returns the first panel lacking, or −1.

    Rows that are balanced already (their status says so and they have taken steps) are kept.
    """
    lacking = -1
    whole = np.ones(1)
    for i in range(len(amplitude)):
        if out[i, STEPS] > 0.0 and out[i, STATUS] != NEEDS_PANEL:
            continue
        one = CompiledRidges(amplitude[i : i + 1], whole)
        lack = balance(one, pressure[i], asperities, films, out[i])
        lacking = lack if lacking < 0 else lacking
    return lacking


@compiled(error_model="numpy")
def lifted_rows(
    amplitude: si.FloatArray,
    pressure: float,
    length: float,
    films: CompiledFilms,
    gaps: si.FloatArray,
) -> int:
    """The gaps (m) at which films carry p (1 − exp(−u/ℓ)) of a pressure (Pa) and length (m), each
    at an amplitude (m) of its own, by bisection; returns the first panel lacking, or −1. Where
    no gap that the vibration leaves is thin enough it is the thinnest."""
    deepest = math.sqrt(-math.expm1(-films.edges[-1]))
    nearest = films.scale[0] * math.exp(films.scale[2])
    furthest = nearest * math.exp(films.built.shape[0]) * (1.0 - 1e-9)
    for i in range(len(amplitude)):
        low = max(amplitude[i] / deepest, nearest) * (1.0 + 1e-9)
        # Further off the contact carries e^-40 of the load.
        high = max(low, min(low + 40.0 * length, furthest))
        for _ in range(_HALVINGS):
            gap = math.sqrt(low * high)
            film, lack = film_value(0, gap, amplitude[i], films)
            if lack != -1:
                return lack
            if film > -pressure * math.expm1(-gap / length):
                low = gap
            else:
                high = gap
        gaps[i] = low
    return -1


@compiled(error_model="numpy")
def felt_stiffness(
    antinode: float, pad: CompiledPad, films: CompiledFilms, out: si.FloatArray
) -> tuple[float, complex, int]:
    """The mean gap of a pad's plateaus (m) over a wave whose antinode has an amplitude (m), and
    what the plate feels of them per area of contact (Pa/m).

    The third is the first panel lacking, −1 where none does, and −2 where a plateau finds no
    balance or comes nearer than the contact's law goes.
    """
    met, shares = pad.ridges
    swings, pressure = antinode * met, np.full(met.size, pad.pressure)
    lacking = balance_rows(swings, pressure, pad.asperities, films, out)
    if lacking >= 0:
        return math.nan, complex(math.nan), lacking
    gap = 0.0
    for i in range(met.size):
        if out[i, STATUS] != BALANCED or out[i, GAP] - swings[i] < pad.least_gap:
            return math.nan, complex(math.nan), -2
        gap += shares[i] * out[i, GAP]
    # The plateaus' mean gap beside the antinode's swing, which most of them do not meet: no deeper
    # than the contact's law goes.
    deepest = min(0.9 * gap, gap - pad.least_gap)
    return gap, felt(gap, min(antinode, deepest), pad.finger, pad.asperities), -1
