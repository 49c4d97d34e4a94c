"""The compiled laws of asperities: pressure and stiffness at a gap, and means over a period.

The constants of a law are a pressure, a gap and a decay length, p_ref exp(−(h − h_ref)/λ) being
the law or near it; of a table also its first gap, its step and the decay length at its end, in m.
All functions run without the interpreter.
"""

from __future__ import annotations

import math

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.compiled import compiled
from squeezefilm.contact.asperities import EXPONENTIAL, LINEAR_OVERLAP, CompiledAsperities


@compiled(error_model="numpy")
def bessel(order: int, z: float) -> float:
    """exp(−z) I_order(z) for order 0 or 1 and z ≥ 0: series below 18, asymptotics above."""
    if z < 18.0:
        quarter = 0.25 * z * z
        term = 1.0 if order == 0 else 0.5 * z
        total = term
        for k in range(1, 80):
            term *= quarter / (k * (k + order))
            total += term
            if term < 1e-17 * total:
                break
        return total * math.exp(-z)
    four = 4.0 * order * order
    term, total = 1.0, 1.0
    for k in range(1, 30):
        odd = 2.0 * k - 1.0
        term *= -(four - odd * odd) / (8.0 * z * k)
        total += term
        if abs(term) < 1e-16:
            break
    return float(total / math.sqrt(2.0 * math.pi * z))


# What is e^-30 of the most that a period carries is left out.
_FADED = 30.0


@compiled(error_model="numpy")
def asperities_at(asperities: CompiledAsperities, h: float) -> tuple[float, float]:
    """p_a at a gap h (Pa) and −dp_a/dh (Pa/m)."""
    kind, law, c, _ = asperities
    if kind == EXPONENTIAL:
        pressure = law[0] * math.exp(min(-(h - law[1]) / law[2], 700.0))
        return pressure, pressure / law[2]
    if kind == LINEAR_OVERLAP:
        return (-h * law[0] / law[2], law[0] / law[2]) if h < 0.0 else (0.0, 0.0)
    # ln p goes on straight below the first gap.
    x = (h - law[3]) / law[4]
    i = np.uint64(max(x, 0.0))
    if i >= len(c):
        return 0.0, 0.0
    x -= i
    if x < 0.0:
        pressure, slope = math.exp(c[i, 0] + x * c[i, 1]), c[i, 1]
    else:
        pressure = math.exp(c[i, 0] + x * (c[i, 1] + x * (c[i, 2] + x * c[i, 3])))
        slope = c[i, 1] + x * (2.0 * c[i, 2] + x * 3.0 * c[i, 3])
    return pressure, -pressure * slope / law[4]


@compiled(error_model="numpy")
def held_along(
    asperities: CompiledAsperities, u: float, a: float, step: float, rows: si.FloatArray
) -> None:
    """Over gaps u − a cos T at T = 0, step, …, into three `rows`: what friction can hold over µ
    (Pa), minus its slope over T (Pa), and −dp_a/dh (Pa/m).

    Each law has a loop of its own: a call for every point takes several times as long.
    """
    kind, law, table, area = asperities
    cosine, sine, c, s = math.cos(step), math.sin(step), 1.0, 0.0
    for k in range(rows.shape[1]):
        rows[0, k], rows[1, k] = u - a * c, a * s
        c, s = c * cosine - s * sine, s * cosine + c * sine
    if kind == EXPONENTIAL:
        for k in range(rows.shape[1]):
            rows[0, k] = law[0] * math.exp(min((law[1] - rows[0, k]) / law[2], 700.0))
            rows[2, k] = rows[0, k] / law[2]
            rows[1, k] *= rows[2, k]
        return
    if kind == LINEAR_OVERLAP:
        for k in range(rows.shape[1]):
            rows[2, k] = law[0] / law[2]
            rows[0, k] = max(-rows[0, k], 0.0) * rows[2, k]
            rows[1, k] *= rows[2, k]
        return
    for k in range(rows.shape[1]):
        x = (rows[0, k] - law[3]) / law[4]
        i = np.uint64(max(x, 0.0))
        if i >= len(table):
            rows[:, k] = 0.0
            continue
        x -= i
        onward = max(x, 0.0)
        rise = onward * (table[i, 2] + onward * table[i, 3])
        pressure = math.exp(table[i, 0] + x * table[i, 1] + onward * rise)
        slope = table[i, 1] + onward * (2.0 * table[i, 2] + onward * 3.0 * table[i, 3])
        rows[2, k] = -pressure * slope / law[4]
        if len(area) == 0:
            rows[0, k] = pressure
            rows[1, k] *= rows[2, k]
            continue
        x = onward
        share = area[i, 0] + x * (area[i, 1] + x * (area[i, 2] + x * area[i, 3]))
        change = area[i, 1] + x * (2.0 * area[i, 2] + x * 3.0 * area[i, 3])
        rows[0, k] = pressure * share
        rows[1, k] *= rows[2, k] * share - pressure * change / law[4]


@compiled(error_model="numpy")
def held_at(asperities: CompiledAsperities, h: float) -> tuple[float, float]:
    """What friction can hold over µ at a gap h (Pa), the pressure or in proportion to the real
    contact area, and −dp_a/dh (Pa/m)."""
    rows = np.empty((3, 1))
    held_along(asperities, h, 0.0, 0.0, rows)
    return rows[0, 0], rows[2, 0]


@compiled(error_model="numpy")
def _covered(reach: float, a: float) -> float:
    """The phase at which a gap is by `reach` above its least; π where it never is."""
    if reach >= 2.0 * a:
        return math.pi
    return math.acos(1.0 - reach / a) if reach > 0.0 else 0.0


@compiled(error_model="numpy")
def touching_phase(asperities: CompiledAsperities, u: float, a: float) -> float:
    """How far from the least gap u − a of a period anything touches that matters, in rad: 0 where
    nothing does, π where all of the period does."""
    law, least = asperities.constants, u - a
    if asperities.kind == LINEAR_OVERLAP:
        return _covered(-least, a)
    if asperities.kind == EXPONENTIAL:
        return _covered(_FADED * law[2], a)
    pressure, stiffness = asperities_at(asperities, least)
    if pressure <= 0.0:
        return 0.0
    # A law of rough contact falls off fastest at small gaps, one of Gaussian heights at large.
    reach = _FADED * max(pressure / stiffness, law[5])
    # Within the table to rounding.
    return _covered(min(reach, law[3] + law[4] * (len(asperities.table) - 1e-6) - least), a)


@compiled(error_model="numpy")
def _tabulated_mean(
    law: si.FloatArray, table: si.FloatArray, u: float, a: float
) -> tuple[float, float]:
    """`asperity_mean` by the trapezoidal rule over what touches: what is smooth and fades out, or
    comes back, is averaged by few points: to 1e-9, of rough contact to what its table holds."""
    middle, swing = (u - law[3]) / law[4], a / law[4]
    x = middle - swing
    i = np.uint64(max(x, 0.0))
    if i >= len(table):
        return 0.0, 0.0
    x -= i
    y = max(x, 0.0)
    fall = -(table[i, 1] + y * (2.0 * table[i, 2] + y * 3.0 * table[i, 3]))
    end = law[4] / law[5]
    # Rough contact, whose table is a joint of cubics, must have one number of points whatever u:
    # where it changed, the mean would jump by more than a balance may be off.
    steepness = swing * min(fall, end)
    count = 8 if steepness < 0.7 else 12 if steepness < 2.0 else 16 if steepness < 4.0 else 24
    reach = min(_FADED * max(1.0 / fall, 1.0 / end), len(table) - 1e-6 - x - i)
    phase = _covered(reach, swing)
    cosine = math.cos(phase / count)
    mean, first, c, before = 0.0, 0.0, 1.0, cosine
    for k in range(count + 1):
        x = middle - swing * c
        i = np.uint64(max(x, 0.0))
        if i >= len(table):
            break
        x -= i
        # Written out: with a call for every point it takes twice as long.
        p = table[i, 0] + x * table[i, 1]
        if x > 0.0:
            p += x * x * (table[i, 2] + x * table[i, 3])
        p = math.exp(p)
        if k == 0 or k == count:
            p *= 0.5
        mean += p
        first += p * c
        c, before = 2.0 * cosine * c - before, c
    share = phase / (math.pi * count)
    return mean * share, 2.0 * first * share


@compiled(error_model="numpy")
def asperity_mean(asperities: CompiledAsperities, u: float, a: float) -> tuple[float, float]:
    """⟨p_a(u − a cos T)⟩ and its first harmonic 2⟨p_a cos T⟩, in Pa, of a law that is smooth."""
    law = asperities.constants
    if asperities.kind == EXPONENTIAL:
        least = law[0] * math.exp(min(-(u - a - law[1]) / law[2], 700.0))
        z = a / law[2]
        return least * bessel(0, z), 2.0 * least * bessel(1, z)
    return _tabulated_mean(law, asperities.table, u, a)
