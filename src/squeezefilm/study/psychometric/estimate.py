"""A number with its interval, which never lies outside of it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

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
    estimate: si.FloatLike, low: si.FloatLike, high: si.FloatLike
) -> tuple[si.FloatArray, si.FloatArray]:
    """The ends of an interval, opened to an estimate that lies beyond one of them; NaN ends stay.

    An estimate and its interval often come of two computations: the mode of a posterior at the
    bound of its prior and the posterior's quantiles, a corrected share and draws without the
    correction, a resample of a handful. The estimate may then lie in a tail. An interval that is
    opened holds at least what its level says.
    """
    ends = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    # A comparison with NaN is false: an end that is not known stays so.
    below, above = estimate < ends[0], estimate > ends[1]
    return np.where(below, estimate, ends[0]), np.where(above, estimate, ends[1])


def t_interval(values: si.FloatArray, level: si.Dimensionless) -> Estimate:
    """The mean of people's values with Student's interval; NaN ends for one person."""
    mean, reach = float(values.mean()), math.nan
    if values.size > 1:
        error = float(values.std(ddof=1)) / math.sqrt(values.size)
        reach = float(stats.t.isf((1 - level) / 2, values.size - 1)) * error
    return Estimate(mean, mean - reach, mean + reach, level, "t, over people")
