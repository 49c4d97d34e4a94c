"""Result of a sweep: a row for each point, with what was varied, what was asked, and the reason
where there is no answer."""

from __future__ import annotations

import collections
import itertools
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import Result
from squeezefilm.design.sweep.axes import Axis
from squeezefilm.design.sweep.followed import FollowedMode

NOT_YET = "not computed"
"""The reason of a point to which a sweep that was stopped did not come."""


def counted(texts: Iterable[str]) -> tuple[tuple[str, int], ...]:
    """Texts with how often each is said, the most common first; of those that differ in their
    numbers only, one stands for all."""
    alike: dict[str, str] = {}
    counts: collections.Counter[str] = collections.Counter()
    for text in texts:
        plain = re.sub(r"[-+]?\d[\d.e+-]*( [a-zµ%]?[A-Za-z%]+\b)?", "#", text)
        alike.setdefault(plain, text)
        counts[plain] += 1
    return tuple((alike[plain], count) for plain, count in counts.most_common())


@dataclass(frozen=True)
class SweptColumn:
    """A number over the points: its name with its unit, the unit, the values (SI; NaN for none),
    shape (points,)."""

    name: str
    unit: si.Unit
    values: si.FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class Sweep(Result):
    """Result of a sweep: a row for each point, in the order of its axes, the last varying fastest.

    Attributes:
        title: of what was swept.
        verbs: which verbs answered.
        axes: what was varied.
        columns: what was asked for.
        reasons: of each point, why it has no answer; empty where it has one.
        warnings: what was warned of at any point, with the number of points, the most common first.
        computed, kept: how many answers were computed now, and how many were there before.
        follows: the modes that were followed, where they were asked for.
    """

    title: str
    verbs: tuple[str, ...]
    axes: tuple[Axis, ...]
    columns: tuple[SweptColumn, ...]
    reasons: tuple[str, ...]
    warnings: tuple[tuple[str, int], ...]
    computed: int
    kept: int
    provenance: Mapping[str, Any]
    follows: tuple[FollowedMode, ...] = ()
    _shown: ClassVar[str] = "title shape names answered missing"

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of steps that each axis has."""
        return tuple(len(axis) for axis in self.axes)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns that were asked for."""
        return tuple(column.name for column in self.columns)

    @property
    def answered(self) -> int:
        """Number of points that have answers."""
        return sum(not reason for reason in self.reasons)

    @property
    def missing(self) -> int:
        """Number of points that were not computed, because the sweep was stopped."""
        return sum(reason == NOT_YET for reason in self.reasons)

    def settings(self) -> dict[str, list[Any]]:
        """Values varied at each point, by column; numbers are SI with the unit in the name."""
        steps = list(itertools.product(*(axis.steps for axis in self.axes)))
        names = [name for axis in self.axes for name in axis.columns]
        rows = [[value for step in point for value in step] for point in steps]
        return {name: [row[number] for row in rows] for number, name in enumerate(names)}

    def column(self, name: str) -> si.FloatArray:
        """The values (SI) of what was asked for, NaN where there is none, shape (points,). Raises
        `InputError` for a name that was not asked for."""
        for column in self.columns:
            if name in (column.name, column.name.removesuffix(column.unit.suffix)):
                return column.values
        raise InputError(
            f"the sweep has no column '{name}'.{si.did_you_mean(name, self.names)} It has: "
            f"{', '.join(self.names)}"
        )

    def grid(self, name: str) -> si.FloatArray:
        """The values of `column` on the grid of the axes, of the sweep's shape."""
        return self.column(name).reshape(self.shape)

    def table(self) -> dict[str, list[Any]]:
        """Table of what was varied, what was asked for (None without an answer), and the reason."""
        values = {
            column.name: [None if math.isnan(v) else v for v in column.values.tolist()]
            for column in self.columns
        }
        return {**self.settings(), **values, "reason": list(self.reasons)}

    _table = table

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values."""
        table = self.table()
        return {
            "title": self.title,
            "verbs": list(self.verbs),
            "axes": [
                {"names": list(axis.columns), "steps": [list(step) for step in axis.steps]}
                for axis in self.axes
            ],
            "asked": list(self.names),
            "rows": [
                dict(zip(table, row, strict=True)) for row in zip(*table.values(), strict=True)
            ],
            "warnings": [{"text": text, "points": points} for text, points in self.warnings],
            "followed": [
                {
                    "mode": follow.label,
                    "driven": follow.driven,
                    "likeness": follow.likeness.tolist(),
                }
                for follow in self.follows
            ],
            "answers_computed": self.computed,
            "answers_kept": self.kept,
            "provenance": dict(self.provenance),
        }
