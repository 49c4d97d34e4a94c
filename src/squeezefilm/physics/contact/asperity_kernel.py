"""The compiled law of asperities: mean pressures over a period.

The constants of a law are a pressure, a gap and a decay length, p_ref exp(−(h − h_ref)/λ) being
the law or near it, then of its table the first gap, the step and the decay length at the end, in m.
All functions run without the interpreter.
"""

from __future__ import annotations

import math

import numpy as np

from squeezefilm.core.compiled import compiled
from squeezefilm.physics.contact.asperities import CompiledAsperities

# What is e^-30 of the most that a period carries is left out.
_FADED = 30.0
# Of ln p: what a float holds, however far two surfaces are pushed into each other.
_LARGEST = 700.0


@compiled(error_model="numpy")
def _covered(reach: float, a: float) -> float:
    """The phase at which a gap is by `reach` above its least; π where it never is."""
    if reach >= 2.0 * a:
        return math.pi
    return math.acos(1.0 - reach / a) if reach > 0.0 else 0.0


@compiled(error_model="numpy")
def asperity_mean(asperities: CompiledAsperities, u: float, a: float) -> tuple[float, float]:
    """⟨p_a(u − a cos T)⟩ and its first harmonic 2⟨p_a cos T⟩, in Pa, of a law that is smooth.

    By the trapezoidal rule over what touches: what is smooth and fades out, or comes back, is
    averaged by few points: to 1e-9, of rough contact to what its table holds.
    """
    law, table = asperities
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
        p = math.exp(min(p, _LARGEST))
        if k == 0 or k == count:
            p *= 0.5
        mean += p
        first += p * c
        c, before = 2.0 * cosine * c - before, c
    share = phase / (math.pi * count)
    return mean * share, 2.0 * first * share
