"""Result of a design search: the front, the plate that it would build, and why others fail."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from scipy.stats import spearmanr

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import Result, to_json, values_of
from squeezefilm.design.search.candidate import Evaluated, plates_of, sourced_display_of
from squeezefilm.design.search.criteria import CRITERIA
from squeezefilm.design.search.limits import (
    EmptyCorner,
    LimitReason,
    Made,
    empty_corners,
    limit_reasons,
)
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.design.search.worth_solving import Correction, objectives_of, worst_corner
from squeezefilm.design.sweep.tradeoffs import dominates, front_of, hypervolume, knee_of
from squeezefilm.physics.display import Display


@dataclass(frozen=True)
class FrontMember:
    """A plate of the front at a voltage, solved in three dimensions, and what is made of its
    drawing (None where it was not asked)."""

    evaluated: Evaluated
    made: Made | None = None

    @property
    def name(self) -> str:
        """The design's short name."""
        return self.evaluated.design.address


@dataclass(frozen=True, eq=False, repr=False)
class DesignSearch(Result):
    """A search: every design that was looked at, and what follows.

    `front` are the feasible solved designs that none other beats, the best in the first objective
    first; one plate may stand there at several voltages. `reference` is the display of
    `compare_with`, judged by the same questions. `corrections` are by shape what solved plates
    taught the screening. `stopped` says that not all was done, `stage` in words what is done now,
    and `left` how long that takes at most ("" while nobody knows).
    """

    requirements: Requirements
    seed: int
    screened: tuple[Evaluated, ...]
    solved: tuple[Evaluated, ...]
    front: tuple[FrontMember, ...]
    reference: Evaluated | None
    corrections: tuple[Correction | None, ...]
    computed: int
    kept: int
    seconds: si.Second
    stopped: bool
    provenance: Mapping[str, Any]
    stage: str = ""
    left: str = ""
    _shown: ClassVar[str] = "requirements.name chosen_name hypervolume seconds"

    @functools.cached_property
    def limits(self) -> tuple[LimitReason, ...]:
        """Effect of every limit on the screened designs, see `limit_reasons`."""
        return limit_reasons(self.requirements, self.screened)

    @functools.cached_property
    def corners(self) -> tuple[EmptyCorner, ...]:
        """Parts of the space without a feasible design, see `empty_corners`."""
        return empty_corners(self.requirements, self.screened)

    @functools.cached_property
    def screened_front(self) -> si.FloatArray:
        """The objectives (SI) of the feasible screened designs that none other beats, shape
        (designs, objectives)."""
        feasible = [candidate for candidate in self.screened if candidate.is_feasible]
        rows = objectives_of(self.requirements, feasible)
        return np.asarray(rows[front_of(rows)])

    @functools.cached_property
    def objectives(self) -> si.FloatArray:
        """The objectives of the front (SI), shape (members of the front, objectives)."""
        return objectives_of(self.requirements, [member.evaluated for member in self.front])

    @property
    def chosen(self) -> FrontMember | None:
        """The plate nearest to the best of every objective; None where the front is empty."""
        return self.front[knee_of(self.objectives)] if self.front else None

    @property
    def chosen_name(self) -> str:
        """Short name of the chosen design."""
        return "none" if self.chosen is None else self.chosen.name

    @functools.cached_property
    def plates_solved(self) -> int:
        """Number of plates that were solved in three dimensions; `solved` has each at several
        voltages where there are any to choose."""
        return _plates(self.solved)

    @functools.cached_property
    def plates_feasible(self) -> int:
        """Number of the solved plates that keep all limits at one voltage or more."""
        return _plates(solution for solution in self.solved if solution.is_feasible)

    @functools.cached_property
    def plates_on_front(self) -> int:
        """Number of plates that the front has, each at one voltage or more."""
        return _plates(member.evaluated for member in self.front)

    @property
    def plates_better(self) -> int:
        """Number of plates of the front that beat the reference at one voltage or more."""
        return _plates(member.evaluated for member in self.beats_reference)

    @functools.cached_property
    def worst(self) -> si.FloatArray:
        """The corner from which the hypervolume is measured (SI), see `worst_corner`."""
        return worst_corner(self.requirements, self.objectives)

    @property
    def hypervolume(self) -> si.Dimensionless:
        """The share of the box between nothing and `worst` that the front dominates."""
        return hypervolume(self.objectives, self.worst) if self.front else 0.0

    @functools.cached_property
    def beats_reference(self) -> tuple[FrontMember, ...]:
        """The plates that are better than the reference in every objective or in one with none
        worse; none where it could not be judged."""
        if self.reference is None or self.reference.reason:
            return ()
        own = np.array(self.reference.objectives(self.requirements.objectives))
        return tuple(
            member
            for member, row in zip(self.front, self.objectives, strict=True)
            if dominates(row, own)
        )

    @functools.cached_property
    def ranks(self) -> dict[str, si.Dimensionless]:
        """Spearman's rank correlation of screened and solved numbers over the solved designs, by
        objective, where there are ten or more."""
        before = {
            candidate.design: candidate for candidate in self.screened if not candidate.reason
        }
        pairs = [
            (before[solution.design], solution)
            for solution in self.solved
            if not solution.reason and solution.design in before
        ]
        if len(pairs) < 10:
            return {}
        names = self.requirements.objectives
        first, second = (
            objectives_of(self.requirements, designs) for designs in zip(*pairs, strict=True)
        )
        return {
            name: float(spearmanr(first[:, k], second[:, k]).statistic)
            for k, name in enumerate(names)
        }

    def member(self, name: str) -> FrontMember:
        """The plate of the front with a short name, or with the beginning of one. Raises
        `InputError` for a name that none has, or several."""
        members = [each for each in self.front if each.name.startswith(name)] if name else []
        if len(members) == 1:
            return members[0]
        known = ", ".join(each.name for each in self.front) or "none"
        raise InputError(
            f"the front has {'several plates' if members else 'no plate'} '{name}'. It has: {known}"
        )

    def display(self, name: str | None = None) -> Display:
        """The display of a plate of the front, the chosen one without a name. Raises `InputError`
        as `member`, or where the front is empty."""
        if name is None and self.chosen is None:
            raise InputError("the front is empty: no plate meets the requirements")
        member = self.member(name or self.chosen_name)
        return sourced_display_of(self.requirements, member.evaluated.design)

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values; keys carry units."""
        chosen = self.chosen
        return {
            "requirements": self.requirements.name,
            **values_of(
                self,
                "requirements.title requirements.objectives requirements.assumed plates_solved "
                "plates_feasible plates_on_front hypervolume limits stopped provenance",
            ),
            "screened": len(self.screened),
            "screened_feasible": sum(candidate.is_feasible for candidate in self.screened),
            "front": [_row(self.requirements, member) for member in self.front],
            "chosen": None if chosen is None else chosen.name,
            "reference": None
            if self.reference is None
            else {
                "name": self.requirements.compare_with,
                **_numbers(self.reference),
                "breaks": [limit.sentence for limit in self.reference.broken],
                "reason": self.reference.reason,
                "beaten_by": [member.name for member in self.beats_reference],
            },
            "hypervolume_corner": self.worst.tolist(),
            "empty_corners": to_json(self.corners),
            "screening_ranks": self.ranks,
            "screening_errors": {
                space.shape: None
                if correction is None
                else {
                    "plates": correction.plates,
                    "raw": dict(correction.raw),
                    "corrected": dict(correction.errors),
                }
                for space, correction in zip(
                    self.requirements.spaces, self.corrections, strict=True
                )
            },
            "answers_computed": self.computed,
            "answers_kept": self.kept,
            "seconds": self.seconds,
        }

    def _table(self) -> Any:
        return [_row(self.requirements, member) for member in self.front]


def _plates(designs: Iterable[Evaluated]) -> int:
    return len(plates_of(evaluated.design for evaluated in designs))


def _numbers(evaluated: Evaluated) -> dict[str, Any]:
    return {
        key + CRITERIA[key].unit.suffix: to_json(value) for key, value in evaluated.numbers.items()
    }


def _row(requirements: Requirements, member: FrontMember) -> dict[str, Any]:
    design, space = member.evaluated.design, requirements.spaces[member.evaluated.design.shape]
    chosen = {
        variable.name + (getattr(variable, "unit", None) or si.Unit("1")).suffix: design.settings[
            variable.name
        ]
        for variable in space
    }
    made = None if member.made is None else {"yield": member.made.kept, "draws": member.made.draws}
    return {
        "name": member.name,
        "shape": space.shape,
        **chosen,
        **_numbers(member.evaluated),
        "made": made,
    }
