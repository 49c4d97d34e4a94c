"""Numbers that a host is asked to send, such as the wire can carry; anything else is refused here.

The device refuses a whole frame for one bad number, when it is too late to say whose it was.
"""

from __future__ import annotations

import operator
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import HIGHEST_VOLTAGE
from squeezefilm.core.errors import InputError


def number(name: str, value: Any, unit: si.Unit, at_least: float, at_most: float) -> float:
    """One finite number between two bounds in SI. Raises `InputError` for anything else."""
    array = _numbers(name, value, 0, f"one number in {unit.symbol}")
    # Every command of a loop in real time comes here: what is in order costs no more than this.
    if not at_least <= array <= at_most:
        si.require(name, array, unit, at_least=at_least, at_most=at_most)
    return float(array)


def whole_number(name: str, value: Any) -> int:
    """An integer. Raises `InputError` for anything else."""
    try:
        return operator.index(value)
    except TypeError as error:
        raise InputError(f"{name} is {value!r}; give a whole number", quantity=name) from error


def amplitudes(levels: Any, at_most: si.Volt = HIGHEST_VOLTAGE) -> si.FloatArray:
    """Amplitudes (V, zero-to-peak), shape (n,), each from 0 to `at_most`.

    Raises `InputError` for anything else.
    """
    array = _numbers("levels", levels, 1, "a row of amplitudes in V")
    if not (array.size and array.min() >= 0.0 and array.max() <= at_most):
        si.require("levels", array, si.Unit("V"), at_least=0.0, at_most=at_most)
    return array


def binary32_below(values: Any) -> np.ndarray[Any, np.dtype[np.float32]]:
    """The largest binary32 not above each value, which is not negative and below 1e38."""
    exact = np.asarray(values, dtype=float)
    near = exact.astype(np.float32)
    return np.where(near > exact, np.nextafter(near, np.float32(0)), near).astype(np.float32)


def _numbers(name: str, value: Any, dimensions: int, wanted: str) -> si.FloatArray:
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        array = np.asarray(None)
    if array.dtype.kind not in "biuf" or array.ndim != dimensions:
        raise InputError(f"{name} is {value!r:.60}; give {wanted}", quantity=name)
    return array.astype(float)
