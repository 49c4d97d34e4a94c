"""What is plainly good as it is: the quick look at an argument, before any check in full.

Checks of numbers stand in front of every call, and an analysis makes a hundred thousand of them;
what nearly all are given, a float or an array of floats within its bounds, is known by two
comparisons.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from typing import Any

import numpy as np

IsPlain = Callable[[Any], bool]

# Of fewer numbers Python's own least and most take less time than NumPy's.
_FEW = 48


def plainly_number(least: float, most: float) -> IsPlain:
    """Of one number: whether it is a float from `least` to `most`."""
    return lambda value: type(value) is float and least <= value <= most


def plainly_array(least: float, most: float) -> IsPlain:
    """Of an array: whether it holds floats from `least` to `most`, at least one."""

    def is_plain(value: Any) -> bool:
        if type(value) is not np.ndarray or value.dtype != float or not value.ndim:
            return False
        if value.ndim > 1 or value.size > _FEW:
            return value.size > 0 and bool(least <= value.min() and value.max() <= most)
        numbers = value.tolist()
        if not numbers or not (least <= min(numbers) and max(numbers) <= most):
            return False
        # What is not a number hides from the least and the most, but not from the sum.
        return not math.isnan(sum(numbers))

    return is_plain


def plainly_either(least: float, most: float) -> IsPlain:
    """Of one number or an array of them."""
    number, array = plainly_number(least, most), plainly_array(least, most)
    return lambda value: number(value) or array(value)


def plainly_complex(value: Any) -> bool:
    """Of a complex number: whether it is one and finite."""
    return type(value) is complex and cmath.isfinite(value)


def plainly_one_of(words: tuple[Any, ...]) -> IsPlain:
    """Of a word: whether it is one of those allowed."""
    return lambda value: type(value) is str and value in words


def or_none(is_plain: IsPlain) -> IsPlain:
    """Of what may be left out."""
    return lambda value: value is None or is_plain(value)


def never_plain(_: Any) -> bool:
    """Of what is always looked at in full."""
    return False
