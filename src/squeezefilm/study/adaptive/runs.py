"""Runs of the methods of limits and of adjustment: a level that goes step by step to its end.

Limits: from above a run goes down until the answer changes, from below another goes up; the place
between the last two levels is its turning point. Adjustment: somebody asks for more or less until
it is equal; that level is the setting (Gescheider 1997, Psychophysics, chapter 3). Runs begin
alternately at either end, up to two steps within it, so that nobody counts steps. Where differences
are of logarithms steps are of one ratio: half and twice the reference are as far from it, and so
are both ends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from squeezefilm.core import quantities as si
from squeezefilm.study.design.special_trials import AdaptiveCondition

_STARTS = 3


@dataclass(frozen=True, slots=True)
class Ending:
    """Level at which a run ended, in parts of the reference (1) or as an amount, and whether it
    began above."""

    level: float
    is_down: bool


class Runs:
    """A series of runs as it goes: `next_stimulus`, then `update`, until `finished`.

    Nothing in it is random: the answers are all its state. Levels are amounts from the series'
    lowest to its highest against a flat surface, else differences from the reference in its parts,
    from as far below it to as far above: in amounts, or in their logarithms.
    """

    def __init__(self, series: AdaptiveCondition, *, is_flat: bool, in_amounts: bool) -> None:
        self._series, self._in_amounts = series, in_amounts
        below = -series.highest if in_amounts else 1.0 / (1.0 + series.highest) - 1.0
        self._least = series.lowest if is_flat else below
        self._trials = self._begun = 0
        self.endings: list[Ending] = []
        self._begin()

    @property
    def finished(self) -> bool:
        """True where it has its trials."""
        return self._trials >= self._series.count

    def next_stimulus(self) -> si.Dimensionless:
        """The level to present next."""
        return self._level

    def update(self, intensity: si.Dimensionless, answer: str) -> None:
        """Take in an answer: "more", "less" or "equal" of an adjustment, else one of two, of which
        "yes" and "more" are for a level above."""
        self._trials += 1
        if self._series.method == "adjustment":
            if answer == "equal":
                self._end(intensity)
            else:
                self._move(self._beside(intensity, 1.0 if answer == "more" else -1.0))
            return
        toward = -1.0 if self._is_down else 1.0
        if (answer in ("yes", "more")) == self._is_down:
            beyond = self._beside(intensity, toward)
            if self._least <= beyond <= self._series.highest:
                self._move(beyond)
            else:
                # The answer never changed: a run without an end.
                self._begin()
        elif self._is_first:
            # Nor did it here: it was the other one from the beginning.
            self._begin()
        else:
            self._end(self._beside(intensity, -0.5 * toward))

    def _beside(self, level: float, steps: float) -> float:
        step = self._series.step
        if self._in_amounts:
            return level + steps * step
        return math.expm1(math.log1p(level) + steps * math.log1p(step))

    def _move(self, level: float) -> None:
        self._is_first = False
        # Rounded, so that a level that is reached from either side is one stimulus.
        self._level = float(f"{min(max(level, self._least), self._series.highest):.12g}")

    def _end(self, level: float) -> None:
        self.endings.append(Ending(float(f"{level:.12g}"), self._is_down))
        self._begin()

    def _begin(self) -> None:
        self._is_down = self._begun % 2 == 0
        within = float(self._begun // 2 % _STARTS)
        self._begun += 1
        begin = self._series.highest if self._is_down else self._least
        self._move(self._beside(begin, -within if self._is_down else within))
        self._is_first = True
