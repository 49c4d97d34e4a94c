"""The result of analyses of all tasks other than match-to-sample."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from squeezefilm.core import quantities as si
from squeezefilm.core.results import Result, stamp
from squeezefilm.physics.perception.stimuli import Varied
from squeezefilm.study.design.tasks.task import JUDGED, Task
from squeezefilm.study.identification.analysis import DisplayAnalysis
from squeezefilm.study.psychometric.estimate import Estimate

EQUALITY = "point of equality"
"""Measure of adjustments and of limits about a reference: a difference from it."""
PARTS = ("Weber fraction", "threshold")
"""Measures whose logarithms are normal over people, and whose precision is in parts of them."""


@dataclass(frozen=True, slots=True)
class PersonEstimate:
    """A person's Weber fraction, threshold or exponent.

    `unbounded` says that the answers alone do not bound it: an end of the interval is the prior's.
    """

    person: str
    estimate: Estimate
    trials: int
    unbounded: bool


@dataclass(frozen=True, slots=True)
class PersonFunction:
    """A person's answers as a function of the difference: Weber fraction (1) or threshold (SI),
    bias (of the logarithm or the amount) or criterion, and lapse rate (1)."""

    threshold: float
    bias: float
    lapse_rate: si.Dimensionless


@dataclass(frozen=True, slots=True)
class ConditionFinding:
    """Answers to one comparison or stimulus.

    Attributes:
        name: of the stimulus, or of the pair.
        value: of what is judged (SI); NaN of a surface without any.
        trials, participants: that have answers.
        share: of answers "the comparison has more", or "different", with Wilson's interval over
            trials; None for magnitudes.
        d_prime: from the reference: mean over people of the task's model, with its t interval
            (Jeffreys' for one person); None for magnitudes and for the reference itself.
        magnitude: geometric mean of the numbers with people's scales taken out, with its t
            interval over people; None for other tasks.
    """

    name: str
    value: float
    trials: int
    participants: int
    share: Estimate | None = None
    d_prime: Estimate | None = None
    magnitude: Estimate | None = None


@dataclass(frozen=True, eq=False)
class Measured:
    """What a task measures, of each person, of the population and by condition.

    Attributes:
        measure: what `persons` and `pooled` are: "Weber fraction", "threshold" (SI), "exponent",
            or "sensitivity d′" of surfaces without an amount to compare.
        persons: of each person.
        pooled: of the population, see `population` and `scales`.
        spread: standard deviation over people of the logarithm of `PARTS`, or of the exponent.
        conditions: by comparison or stimulus.
        notes: what could not be computed, or needs care, and why.
        more: other numbers by name, such as the bias for an interval.
        functions: each person's, of Weber fractions.
        robust: `pooled` as people who do not do the task hardly move it.
    """

    measure: str
    persons: tuple[PersonEstimate, ...]
    pooled: Estimate | None
    spread: Estimate | None
    conditions: tuple[ConditionFinding, ...]
    notes: tuple[str, ...]
    more: Mapping[str, Estimate] = field(default_factory=dict)
    functions: Mapping[str, PersonFunction] = field(default_factory=dict)
    robust: Estimate | None = None


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class TaskAnalysis(Measured, DisplayAnalysis):
    """Analysis of a two-interval, same-different or magnitude task on one display.

    Attributes:
        task, judged: of the design.
        people: pseudonyms.
        trials: main trials.
        standard: the reference's value of what is judged (SI); NaN without a reference.
        is_adaptive: whether series chose the comparisons: `conditions` are then eighths of the
            trials by their difference, which is their value.
        assumed: what simulated answers rest on; empty for people.
    """

    task: Task
    judged: Varied
    people: tuple[str, ...]
    trials: int
    standard: float
    is_adaptive: bool
    assumed: tuple[str, ...]
    _shown: ClassVar[str] = "name origin measure participants trials"

    @property
    def participants(self) -> int:
        """Number of people who answered."""
        return len(self.people)

    @property
    def main_number(self) -> Estimate | None:
        """The population's `measure`."""
        return self.pooled

    def summary(self) -> dict[str, Any]:
        """All numbers as plain JSON values, units in the keys."""
        judged = JUDGED[self.judged].si_unit
        unit = "" if judged == "1" else f"_{judged}"
        values = Result.summary(self)
        values[f"standard{unit}"] = values.pop("standard")
        values["spread_over_people"] = values.pop("spread")
        return {
            **values,
            "participants": self.participants,
            "provenance": stamp({"name": self.name, "persons": self.persons}, self.seed),
        }

    def _table(self) -> Any:
        """Table with a row a condition."""
        return [
            {
                "condition": condition.name,
                "value": condition.value,
                "trials": condition.trials,
                "share": None if condition.share is None else condition.share.value,
                "d_prime": None if condition.d_prime is None else condition.d_prime.value,
                "magnitude": None if condition.magnitude is None else condition.magnitude.value,
            }
            for condition in self.conditions
        ]


def through(estimate: Estimate, rising: Callable[[float], float]) -> Estimate:
    """An estimate on another scale, by a rising function of it."""
    value, low, high = (rising(end) for end in (estimate.value, estimate.low, estimate.high))
    return Estimate(value, low, high, estimate.level, estimate.method)
