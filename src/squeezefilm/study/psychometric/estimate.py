"""A number with its interval, which never lies outside of it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from squeezefilm.core import quantities as si


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number with its interval of `level`; `low` and `high` are NaN where there is none."""

    value: float
    low: float
    high: float
    level: si.Dimensionless
    method: str

    def __contains__(self, value: float) -> bool:
        return self.low <= value <= self.high


def holding(
    value: float, low: float, high: float, level: si.Dimensionless, method: str
) -> Estimate:
    """An estimate whose interval is opened to it where it lies beyond an end; NaN ends stay.

    An estimate and its interval often come of two computations: the mode of a posterior at the
    bound of its prior and the posterior's quantiles, a corrected share and draws without the
    correction, a resample of a handful. The estimate may then lie in a tail. An interval that is
    opened holds at least what its level says.
    """
    # A comparison with NaN is false: an end that is not known stays so.
    return Estimate(value, min(float(low), value), max(float(high), value), level, method)


def student(
    value: float, error: float, free: float, level: si.Dimensionless, method: str
) -> Estimate:
    """An estimate of a standard error with Student's interval of so many degrees of freedom; with
    infinitely many a normal one."""
    from scipy import stats

    reach = float(stats.t.isf((1 - level) / 2, free)) * error
    return Estimate(value, value - reach, value + reach, level, method)


def t_interval(
    values: si.FloatArray, level: si.Dimensionless, method: str = "t, over people"
) -> Estimate:
    """The mean of values, of a person each, with Student's interval; NaN ends for one."""
    mean = float(values.mean())
    if values.size < 2:
        return Estimate(mean, math.nan, math.nan, level, method)
    error = float(values.std(ddof=1)) / math.sqrt(values.size)
    return student(mean, error, values.size - 1, level, method)
