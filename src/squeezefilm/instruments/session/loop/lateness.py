"""Lateness of the loop's ticks, in a histogram of logarithmic classes, and how many were lost."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.results import to_json

CLASSES_PER_DECADE = 20
_DECADES = 8
_FIRST_NS = 100.0
CLASSES = CLASSES_PER_DECADE * _DECADES + 2
"""Classes of the histogram: below 100 ns, 20 per decade up to 10 s, and above."""


@compiled()
def lateness_class(late: float) -> int:
    """The class of the histogram that a lateness (ns) falls into."""
    if not late >= _FIRST_NS:
        return 0
    return min(1 + int(CLASSES_PER_DECADE * math.log10(late / _FIRST_NS)), CLASSES - 1)


def class_ends() -> si.SecondArray:
    """The upper end of every class (s), the last infinite; shape (CLASSES,)."""
    decades = np.arange(CLASSES - 1) / CLASSES_PER_DECADE
    return np.append(_FIRST_NS * 1e-9 * 10.0**decades, math.inf)


@dataclass(frozen=True, slots=True, eq=False)
class Lateness:
    """Lateness of ticks, and the number of those that were not made at all.

    A tick is late by the time from when it was due to when it was begun. One that could not begin
    before the next was due is lost: it is not made up for, and stands in no class.

    Attributes:
        rate: of the ticks (Hz).
        made, lost: ticks; together those that were due.
        longest: greatest time by which the loop was late at any moment (s), those that cost ticks
            included.
        counts: ticks made in each class, see `class_ends`.
    """

    rate: si.Hertz
    made: int
    lost: int
    longest: si.Second
    counts: NDArray[np.int64]

    @property
    def share_made(self) -> si.Dimensionless:
        """Share of the ticks due that were made (1); not a number before the first."""
        due = self.made + self.lost
        return self.made / due if due else math.nan

    def quantile(self, share: si.Dimensionless) -> si.Second:
        """The lateness (s) that a share of the ticks made did not exceed; NaN if none was made.

        The upper end of its class, at most 12 % too high; never above `longest`.
        """
        if self.made == 0:
            return math.nan
        place = int(np.searchsorted(np.cumsum(self.counts), math.ceil(share * self.made)))
        return min(float(class_ends()[place]), self.longest)

    def to_json(self) -> dict[str, Any]:
        """Plain JSON values: the fields, and the figures that people ask for."""
        values: dict[str, Any] = to_json(self)
        figures: dict[str, float] = {
            "share_made": self.share_made,
            "p50_s": self.quantile(0.5),
            "p99_s": self.quantile(0.99),
            "p99_9_s": self.quantile(0.999),
        }
        return {**values, **to_json(figures)}
