"""Staircases, and runs of the methods of limits and of adjustment: levels that go step by step.

Transformed up–down rules (Levitt 1971, 10.1121/1.1912375): down after n correct answers in a row,
up after one that is not. Levels move on the axis; on a logarithmic axis a step is a difference of
ln intensity.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.design.rules import AdaptiveCondition
from squeezefilm.study.psychometric.function import Axis


@dataclass(frozen=True, slots=True)
class StaircaseRule:
    """Rule by which a staircase moves and ends; a design's series is checked by itself.

    Args:
        start: first intensity, in the unit of the stimulus.
        step: first step, above 0: in that unit, or a difference of ln intensity.
        smallest_step: steps are halved at every reversal as long as they stay at least this.
        down_after: correct answers in a row before a step down, at least 1.
        lowest, highest: intensities that are never left.
        axis: "linear" or "log".
        most_trials: after which it ends, at least 1.
    """

    start: float
    step: float
    smallest_step: float
    down_after: int = 2
    lowest: float = -math.inf
    highest: float = math.inf
    axis: Axis = "linear"
    most_trials: int = 200


@dataclass(frozen=True, slots=True)
class StaircaseTrial:
    """An answer: the intensity shown, whether it was correct, and whether it turned the stairs."""

    intensity: float
    correct: bool
    reversal: bool


class Staircase:
    """A staircase as it runs. `next_stimulus`, then `update`, until `finished`.

    Nothing in it is random: its rule and the answers so far are all its state, and playing them
    again (`update`) gives the staircase that was interrupted.
    """

    def __init__(self, rule: StaircaseRule) -> None:
        self.rule = rule
        self._level = math.log(rule.start) if rule.axis == "log" else rule.start
        self._step = rule.step
        self._streak = 0
        self._direction = 0
        self._trials: list[StaircaseTrial] = []

    @property
    def trials(self) -> tuple[StaircaseTrial, ...]:
        """The answers so far."""
        return tuple(self._trials)

    @property
    def finished(self) -> bool:
        """True where it has its trials."""
        return len(self._trials) >= self.rule.most_trials

    def next_stimulus(self) -> float:
        """The intensity to show next, in the unit of the stimulus.

        Raises:
            InputError: the staircase has finished.
        """
        if self.finished:
            raise InputError(
                f"this staircase has finished after {len(self._trials)} trials; start another"
            )
        value = math.exp(self._level) if self.rule.axis == "log" else self._level
        return min(max(value, self.rule.lowest), self.rule.highest)

    def update(self, intensity: float, correct: bool) -> None:
        """Take in an answer. The stairs move from where they were, whatever was shown.

        Raises:
            InputError: an intensity that is not finite, or the staircase has finished.
        """
        si.require("intensity", intensity)
        self.next_stimulus()
        rule = self.rule
        self._streak = self._streak + 1 if correct else 0
        direction = 0
        if not correct:
            direction = 1
        elif self._streak == rule.down_after:
            direction, self._streak = -1, 0
        turned = direction != 0 and self._direction not in (0, direction)
        if turned and 0.5 * self._step >= rule.smallest_step:
            self._step *= 0.5
        if direction:
            self._direction = direction
            self._level += direction * self._step
            self._hold_within_bounds()
        self._trials.append(StaircaseTrial(float(intensity), bool(correct), turned))

    def _hold_within_bounds(self) -> None:
        low, high = self.rule.lowest, self.rule.highest
        if self.rule.axis == "log":
            low = math.log(low) if low > 0 else -math.inf
            high = math.log(high)
        # Rounded, so that levels reached by different ways are equal and count as one stimulus.
        self._level = float(f"{min(max(self._level, low), high):.12g}")

    def threshold(self, discard: int = 2) -> float:
        """Mean of the intensities at the reversals (geometric on a logarithmic axis).

        The first `discard` reversals are left out, and one more where an odd number is left.
        It estimates where pⁿ = ½ after n in a row; a fit uses the answers better.

        Raises:
            InputError: fewer than two reversals are left.
        """
        si.require("discard", discard, at_least=0)
        turns = [trial.intensity for trial in self._trials if trial.reversal][discard:]
        turns = turns[len(turns) % 2 :]
        if not turns:
            raise InputError(
                f"no two reversals are left after {discard}; run the staircase on, or discard less"
            )
        if self.rule.axis == "log":
            return math.exp(sum(math.log(turn) for turn in turns) / len(turns))
        return sum(turns) / len(turns)


# Limits: from above a run goes down until the answer changes, from below another goes up; the place
# between the last two levels is its turning point. Adjustment: somebody asks for more or less until
# it is equal; that level is the setting (Gescheider 1997, Psychophysics, chapter 3). Runs begin
# alternately at either end, up to two steps within it, so that nobody counts steps. Where
# differences are of logarithms steps are of one ratio: half and twice the reference are as far from
# it, and so are both ends.
_STARTS = 3


@dataclass(frozen=True, slots=True)
class Ending:
    """Level at which a run ended, in parts of the reference (1) or as an amount, and whether it
    began above."""

    level: float
    is_down: bool


class Runs:
    """A series of runs as it goes: `next_stimulus`, then `update`, for as many trials as planned.

    Nothing in it is random: the answers are all its state. Levels are amounts from the series'
    lowest to its highest against a flat surface, else differences from the reference in its parts,
    from as far below it to as far above: in amounts, or in their logarithms.
    """

    def __init__(self, series: AdaptiveCondition, *, is_flat: bool, in_amounts: bool) -> None:
        self._series, self._in_amounts = series, in_amounts
        below = -series.highest if in_amounts else 1.0 / (1.0 + series.highest) - 1.0
        self._least = series.lowest if is_flat else below
        self._begun = 0
        self.endings: list[Ending] = []
        self._begin()

    def next_stimulus(self) -> si.Dimensionless:
        """The level to present next."""
        return self._level

    def update(self, intensity: si.Dimensionless, answer: str) -> None:
        """Take in an answer: "more", "less" or "equal" of an adjustment, else one of two, of which
        "yes" and "more" are for a level above."""
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
