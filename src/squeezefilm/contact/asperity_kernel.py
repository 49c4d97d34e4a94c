"""The compiled laws of asperities: pressure and stiffness at a gap, and means over a period.

All functions run without the interpreter.
"""

from __future__ import annotations

import math

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.compiled import compiled
from squeezefilm.contact.asperities import CompiledAsperities


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


@compiled(error_model="numpy")
def _gaussian(h: float, law: si.FloatArray, table: si.FloatArray) -> float:
    t = h / law[2]
    x = (2.0 * t - law[3] - law[4]) / (law[4] - law[3])
    if x > 1.0:
        return 0.0
    # Crushed flat: the balance will not be found there, but its search may pass.
    x = max(x, -1.0)
    b1, b2 = 0.0, 0.0
    for k in range(len(table) - 1, 0, -1):
        b1, b2 = table[k] + 2.0 * x * b1 - b2, b1
    return float(law[0] * math.exp(table[0] + x * b1 - b2 - law[5]))


@compiled(error_model="numpy")
def _self_affine(h: float, law: si.FloatArray, table: si.FloatArray) -> tuple[float, float]:
    """`RoughContact.pressure` and −dp/dh; ln p goes on straight below the least gap tabulated."""
    x = (h / law[3] - law[4]) / law[5]
    last = len(table) // 2 - 1
    if x >= last:
        return 0.0, 0.0
    i = max(int(x), 0)
    x -= i
    m0, m1 = table[2 * i + 1] * law[5], table[2 * i + 3] * law[5]
    value, slope = table[2 * i] + m0 * min(x, 0.0), m0
    if x > 0.0:
        rise = table[2 * i + 2] - table[2 * i]
        b, c = 3.0 * rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * rise
        value += x * (m0 + x * (b + x * c))
        slope += x * (2.0 * b + x * 3.0 * c)
    pressure = math.exp(law[6] + value)
    return pressure, -pressure * slope / (law[5] * law[3])


@compiled(error_model="numpy")
def asperities_at(asperities: CompiledAsperities, h: float) -> tuple[float, float]:
    """p_a at a gap h (Pa) and −dp_a/dh (Pa/m), for Gaussian heights to 1e-6 by differences."""
    kind, law, table = asperities
    if kind == 0:
        pressure = law[0] * math.exp(min(-(h - law[1]) / law[2], 700.0))
        return pressure, pressure / law[2]
    if kind == 2:
        return _self_affine(h, law, table)
    step = 1e-3 * law[2]
    slope = (_gaussian(h - step, law, table) - _gaussian(h + step, law, table)) / (2.0 * step)
    return _gaussian(h, law, table), slope


@compiled(error_model="numpy")
def _self_affine_mean(
    law: si.FloatArray, table: si.FloatArray, u: float, a: float
) -> tuple[float, float]:
    """`asperity_mean` of `_self_affine`, written out: with a call for every point it takes twice
    as long (benchmarks/contact.py)."""
    middle, swing = (u / law[3] - law[4]) / law[5], a / (law[3] * law[5])
    last = len(table) // 2 - 1
    ratio = a / law[2]
    half = 8 if ratio < 3.0 else 16 if ratio < 9.0 else 32 if ratio < 30.0 else 64
    mean, first = 0.0, 0.0
    for k in range(half + 1):
        c = math.cos(math.pi * k / half)
        x = middle - swing * c
        if x >= last:
            break
        i = np.uint64(max(x, 0.0))
        x -= i
        j = np.uint64(2) * i
        value, slope = table[j], table[j + np.uint64(1)] * law[5]
        if x > 0.0:
            rise, end = table[j + np.uint64(2)] - value, table[j + np.uint64(3)] * law[5]
            value += x * (
                slope + x * (3.0 * rise - 2.0 * slope - end + x * (slope + end - 2.0 * rise))
            )
        else:
            value += x * slope
        p = math.exp(law[6] + value)
        if k == 0 or k == half:
            p *= 0.5
        mean += p
        first += p * c
    return mean / half, 2.0 * first / half


@compiled(error_model="numpy")
def asperity_mean(asperities: CompiledAsperities, u: float, a: float) -> tuple[float, float]:
    """⟨p_a(u − a cos T)⟩ and its first harmonic 2⟨p_a cos T⟩, in Pa."""
    kind, law, table = asperities
    if kind == 0:
        least = law[0] * math.exp(min(-(u - a - law[1]) / law[2], 700.0))
        z = a / law[2]
        return least * bessel(0, z), 2.0 * least * bessel(1, z)
    if kind == 2:
        return _self_affine_mean(law, table, u, a)
    mean = 0.5 * (_gaussian(u - a, law, table) + _gaussian(u + a, law, table))
    first = 0.5 * (_gaussian(u - a, law, table) - _gaussian(u + a, law, table))
    # The trapezoidal rule over the period; the deeper the swing over the length in which pressure
    # falls by e, which is shorter out in the tail of the heights, the narrower the peak.
    ratio = a / law[2] * max(1.0, (u - a) / law[2])
    half = 16 if ratio < 3.0 else 32 if ratio < 10.0 else 64
    for k in range(1, half):
        c = math.cos(math.pi * k / half)
        p = _gaussian(u - a * c, law, table)
        mean += p
        first += p * c
    return mean / half, 2.0 * first / half
