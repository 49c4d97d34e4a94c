"""Lateness of the loop's ticks, in a histogram of logarithmic classes, and how many were lost."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.errors import InputError
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


@si.checked_numbers
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

    Raises:
        InputError: counts of another shape, below 0 or with another sum than `made`.
    """

    rate: Annotated[si.Hertz, si.Above(0.0)]
    made: int
    lost: int
    longest: Annotated[si.Second, si.AtLeast(0.0)]
    counts: Annotated[NDArray[np.int64], si.Unit("1")]

    def __post_init__(self) -> None:
        if self.counts.shape != (CLASSES,) or np.any(self.counts < 0):
            raise InputError(f"counts must be {CLASSES} numbers at least 0")
        if int(np.sum(self.counts)) != self.made or self.lost < 0:
            raise InputError(
                f"made = {self.made} and lost = {self.lost} do not fit counts of "
                f"{int(np.sum(self.counts))} ticks"
            )

    @property
    def share_made(self) -> si.Dimensionless:
        """Share of the ticks due that were made (1); not a number before the first."""
        due = self.made + self.lost
        return self.made / due if due else math.nan

    def quantile(self, share: si.Dimensionless) -> si.Second:
        """The lateness (s) that a share of the ticks made did not exceed; NaN if none was made.

        The upper end of its class, at most 12 % too high; never above `longest`.

        Raises:
            InputError: a share not above 0 or above 1.
        """
        si.require("share", share, above=0.0, at_most=1.0)
        if self.made == 0:
            return math.nan
        place = int(np.searchsorted(np.cumsum(self.counts), math.ceil(share * self.made)))
        return min(float(class_ends()[place]), self.longest)

    @property
    def p50(self) -> si.Second:
        """Median lateness of the ticks made (s)."""
        return self.quantile(0.5)

    @property
    def p99(self) -> si.Second:
        """Lateness that 99 % of the ticks made did not exceed (s)."""
        return self.quantile(0.99)

    @property
    def p99_9(self) -> si.Second:
        """Lateness that 99.9 % of the ticks made did not exceed (s)."""
        return self.quantile(0.999)

    def to_json(self) -> dict[str, Any]:
        """Plain JSON values: the fields, and the figures that people ask for."""
        values: dict[str, Any] = to_json(self)
        figures: dict[str, float] = {
            "share_made": self.share_made,
            "p50_s": self.p50,
            "p99_s": self.p99,
            "p99_9_s": self.p99_9,
        }
        return {**values, **to_json(figures)}

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> Lateness:
        """Lateness that `to_json` wrote. Raises `InputError` for anything else."""
        try:
            return cls(
                rate=float(values["rate_Hz"]),
                made=int(values["made"]),
                lost=int(values["lost"]),
                longest=float(values["longest_s"]),
                counts=np.array(values["counts"], dtype=np.int64),
            )
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(f"this is no lateness as a session writes it: {error!r}") from error
