"""Trials of a design that are not plain repetitions: catch trials and adaptive series."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.stimuli import Stimulus, Varied

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,79}")


_LEAST_RANGE = 2.0
"""Least ratio of a Bayesian series' highest difference to its lowest."""


@si.checked_numbers
@dataclass(frozen=True)
class CatchTrial:
    """A trial whose answer is plain to everyone who attends, and how often it comes.

    `answer` is what is right. In a task of two surfaces `stimulus` comes with the reference.
    """

    stimulus: Stimulus
    answer: str
    count: Annotated[int, si.AtLeast(1), si.AtMost(1000)] = 1


@si.checked_numbers
@dataclass(frozen=True)
class AdaptiveCondition:
    """A series of trials in which a method chooses each comparison after the last answer.

    Args:
        name: of the series.
        method: "staircase" or "bayesian"; "limits" (runs from either end until the answer changes)
            or "adjustment" (somebody asks for more or less until it is equal).
        varied: what of the design's reference is changed; what the design's `judged` asks about.
        start: of a staircase: first difference from the reference, in parts of the reference's
            value (1).
        lowest, highest: differences allowed, likewise (1); runs that are not of a flat reference go
            as far below it as above.
        step: in parts of the reference's value (1); a staircase halves it at the first reversals.
        down: correct answers in a row that make a staircase harder.
        count: trials; of same-different half present the reference twice, in random order.
    """

    name: str
    method: Literal["staircase", "bayesian", "limits", "adjustment"]
    varied: Varied = "spatial_period"
    start: si.Dimensionless = 0.4
    lowest: Annotated[si.Dimensionless, si.Above(0.0)] = 0.005
    highest: si.Dimensionless = 0.9
    step: si.Dimensionless = 0.1
    down: Annotated[int, si.AtLeast(1), si.AtMost(10)] = 2
    count: Annotated[int, si.AtLeast(1), si.AtMost(10000)] = 60

    @property
    def in_runs(self) -> bool:
        """True of runs whose next level follows from what was answered, right or wrong."""
        return self.method in ("limits", "adjustment")

    def __post_init__(self) -> None:
        require_name(self.name)
        si.require("highest", self.highest, above=self.lowest, at_most=100.0)
        if self.in_runs:
            si.require("step", self.step, above=0.0)
        if self.method == "staircase":
            si.require("start", self.start, at_least=self.lowest, at_most=self.highest)
            si.require("step", self.step, above=0.0, at_most=self.highest)
        if self.method == "staircase" and self.highest - self.lowest < self.step / 4:
            raise InputError(
                f"series '{self.name}' cannot move: from lowest = {self.lowest:g} to highest = "
                f"{self.highest:g} there is less than its smallest step, {self.step / 4:g}; take a "
                "smaller step or a wider range",
                quantity="step",
            )
        if self.in_runs and not 3 * self.step <= self.highest - self.lowest:
            raise InputError(
                f"series '{self.name}' has no room: from highest = {self.highest:g} to lowest = "
                f"{self.lowest:g} there are fewer than three steps of {self.step:g}; take smaller "
                "steps or a wider range",
                quantity="step",
            )
        if self.method == "bayesian" and self.highest < _LEAST_RANGE * self.lowest:
            raise InputError(
                f"series '{self.name}' cannot move: its highest difference, {self.highest:g}, is "
                f"less than {_LEAST_RANGE:g} times its lowest, {self.lowest:g}, and all of its "
                "forty choices are alike; take a wider range",
                quantity="highest",
            )


def require_name(name: str) -> None:
    """Refuse a name that cannot go into a file's name. Raises `InputError`."""
    if not _NAME.fullmatch(name):
        raise InputError(
            f"name = {name!r} cannot be used: it goes into file names; write up to 80 of the "
            "letters A-Z a-z, digits, dot, dash and underscore, beginning with a letter or digit",
            quantity="name",
        )


def require_different(what: str, names: list[str]) -> None:
    """Refuse a name that is there twice. Raises `InputError`."""
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise InputError(
            f"{what} have a name twice ({', '.join(twice)}); name each differently", quantity=what
        )
