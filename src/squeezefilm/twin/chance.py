"""Noise by number: the n-th value of a stream is a function of seed, stream and n alone.

So a twin's noise does not depend on how often or in which pieces its time is advanced. The mixing
is that of splitmix64 (Steele, Lea and Flood 2014, 10.1145/2714064.2660195).
"""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

_STEP = np.uint64(0x9E3779B97F4A7C15)
_FIRST = np.uint64(0xBF58476D1CE4E5B9)
_SECOND = np.uint64(0x94D049BB133111EB)
_THIRTY, _SEVEN, _ONE = np.uint64(30), np.uint64(27), np.uint64(31)
_DROPPED = np.uint64(11)
_TWO_53 = 2.0**-53


@numba.njit(cache=True, nogil=True)
def mixed(number: Any) -> Any:
    """A 64-bit number with its bits mixed."""
    z = np.uint64(number) + _STEP
    z = (z ^ (z >> _THIRTY)) * _FIRST
    z = (z ^ (z >> _SEVEN)) * _SECOND
    return z ^ (z >> _ONE)


@numba.njit(cache=True, nogil=True)
def uniform(seed: int, stream: int, number: int) -> float:
    """The `number`-th uniform value of a stream, above 0 and below 1."""
    z = mixed(mixed(np.uint64(seed)) ^ mixed(np.uint64(stream) + _FIRST))
    z = mixed(z ^ mixed(np.uint64(number) + _SECOND))
    return (float(z >> _DROPPED) + 0.5) * _TWO_53


@numba.njit(cache=True, nogil=True)
def gaussian(seed: int, stream: int, number: int) -> float:
    """The `number`-th standard normal value of a stream (Box and Muller)."""
    radius = math.sqrt(-2.0 * math.log(uniform(seed, 2 * stream, number)))
    return radius * math.cos(2.0 * math.pi * uniform(seed, 2 * stream + 1, number))
