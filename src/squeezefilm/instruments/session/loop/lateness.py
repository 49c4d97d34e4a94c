"""Lateness of a loop's ticks and how many were lost, by the rows that it made."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.instruments.session.loop import rows as column


@dataclass(frozen=True, slots=True)
class Lateness:
    """Lateness of ticks, and the number of those that were not made at all.

    A tick is late by the time from when it was due to when it was begun. One that could not begin
    before the next was due is lost: it is not made up for. `made` and `lost` are those from the
    loop's first tick to the last row; `longest` is the greatest time by which the loop was late at
    any moment (s), those that cost ticks included; `p50`, `p99` and `p99_9` are what these shares
    of the ticks made did not exceed (s). All times are NaN where no tick was made.
    """

    made: int
    lost: int
    longest: si.Second = math.nan
    p50: si.Second = math.nan
    p99: si.Second = math.nan
    p99_9: si.Second = math.nan

    @property
    def share_made(self) -> si.Dimensionless:
        """Share of the ticks due that were made (1); not a number before the first."""
        due = self.made + self.lost
        return self.made / due if due else math.nan


def lateness_of(rows: si.FloatArray, period: si.Second) -> Lateness:
    """Lateness of all ticks that a loop of this period (s) made, by its `rows` (n, columns)."""
    if not len(rows):
        return Lateness(0, 0)
    tick, late = rows[:, column.TICK], rows[:, column.LATENESS]
    lost_before = np.diff(tick, prepend=-1.0) - 1
    quantiles = (float(late_by) for late_by in np.quantile(late, [0.5, 0.99, 0.999]))
    longest = float(np.max(lost_before * period + late))
    return Lateness(len(rows), int(lost_before.sum()), longest, *quantiles)
