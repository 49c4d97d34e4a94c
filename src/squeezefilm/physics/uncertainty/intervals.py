"""The ends of an interval from draws, of which some may be refused and some out of reach."""

from __future__ import annotations

import numpy as np

from squeezefilm.core import quantities as si

LEVEL: si.Dimensionless = 0.9
MOST_REFUSED: si.Dimensionless = 0.02
"""Share of the draws: where more have no friction, an interval of the others would be a condition
that nobody asked for."""


def quantiles(
    friction: si.DimensionlessArray, level: si.Dimensionless = LEVEL
) -> si.DimensionlessArray:
    """The lower end of the interval that holds `level`, the median and the upper end, of draws
    along the first axis.

    A refused draw (NaN) may be anything: it counts as 0 at the lower end and as 1 at the upper.
    Positions k/(n + 1), with which an interval of independent draws holds its level in the mean.
    """
    tails = (1 - level) / 2
    lost = np.isnan(friction)
    ends = [
        np.quantile(np.where(lost, fill, friction), at, axis=0, method="weibull")
        for fill, at in ((0.0, tails), (1.0, 1 - tails))
    ]
    return np.stack([ends[0], np.nanmedian(friction, axis=0), ends[1]])


def ends(values: si.FloatArray) -> tuple[float, float, float]:
    """Lower end, median, upper end as by `quantiles`, of values without an upper bound, shape (n,).

    Infinite ones are those that nothing reaches; a refused one (NaN) counts as 0 at the lower end
    and as infinite at the upper. An end that lies among the infinite is infinite.
    """
    tails = (1 - LEVEL) / 2
    lost = np.isnan(values)
    low = _quantile(np.where(lost, 0.0, values), tails)
    high = _quantile(np.where(lost, np.inf, values), 1 - tails)
    return low, _quantile(values[~lost], 0.5), high


def _quantile(values: si.FloatArray, share: float) -> float:
    """Value at position share × (n + 1) of the sorted values (Weibull's), between two in a line."""
    if not values.size:
        return float("nan")
    row = np.sort(values)
    place = min(max(share * (row.size + 1) - 1, 0.0), row.size - 1.0)
    below = int(place)
    rest = place - below
    if rest == 0 or row[below] == np.inf:
        return float(row[below])
    return float(row[below] + rest * (row[below + 1] - row[below]))
