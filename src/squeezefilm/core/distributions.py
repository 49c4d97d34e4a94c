"""Distributions that a description may give beside a value: how sure it is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

_WIDEST = 3.0  # standard deviations kept of a normal distribution


@si.checked_numbers
@dataclass(frozen=True)
class Normal:
    """A normal distribution cut at three standard deviations, in the unit of its quantity.

    Raises `InputError` for a standard deviation that is not above 0.
    """

    mean: float
    standard_deviation: float

    def __post_init__(self) -> None:
        si.require("uncertainty", self.standard_deviation, above=0)

    @si.checked_numbers
    def quantile(self, p: si.DimensionlessArray) -> si.FloatArray:
        """The values (in the quantity's unit, the shape of `p`) not exceeded with probability p."""
        from scipy.special import ndtr, ndtri

        tail = ndtr(-_WIDEST)
        spread = ndtri(tail + np.asarray(p, dtype=float) * (1 - 2 * tail))
        return np.asarray(self.mean + self.standard_deviation * spread)

    @property
    def support(self) -> tuple[float, float]:
        """The least and the largest value."""
        reach = _WIDEST * self.standard_deviation
        return self.mean - reach, self.mean + reach


@si.checked_numbers
@dataclass(frozen=True)
class Uniform:
    """Distribution between two values, all alike. Raises `InputError` unless low < high."""

    low: float
    high: float

    def __post_init__(self) -> None:
        if not self.low < self.high:
            raise InputError(
                f"range = [{self.low:.6g}, {self.high:.6g}] is none; write the lower value first",
                quantity="range",
            )

    @si.checked_numbers
    def quantile(self, p: si.DimensionlessArray) -> si.FloatArray:
        """The values (in the quantity's unit, the shape of `p`) not exceeded with probability p."""
        return self.low + (self.high - self.low) * np.asarray(p, dtype=float)

    @property
    def support(self) -> tuple[float, float]:
        """The least and the largest value."""
        return self.low, self.high


@si.checked_numbers
@dataclass(frozen=True)
class LogNormal:
    """A quantity whose logarithm is `Normal`: as people differ around a median. Raises `InputError`
    for a median or a standard deviation of the logarithm that is not above 0."""

    median: Annotated[float, si.Above(0)]
    log_deviation: Annotated[float, si.Above(0)]

    @property
    def of_logarithm(self) -> Normal:
        """The distribution of the natural logarithm."""
        return Normal(math.log(self.median), self.log_deviation)

    @si.checked_numbers
    def quantile(self, p: si.DimensionlessArray) -> si.FloatArray:
        """The values (in the quantity's unit, the shape of `p`) not exceeded with probability p."""
        return np.exp(self.of_logarithm.quantile(p))

    @property
    def support(self) -> tuple[float, float]:
        """The least and the largest value."""
        low, high = self.of_logarithm.support
        return math.exp(low), math.exp(high)


Distribution = Normal | Uniform | LogNormal
