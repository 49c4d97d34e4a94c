"""What the Search area shows of a search: plates, fronts and reasons, as JSON; numbers in SI where
they are drawn, in words where they are read."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from squeezefilm.design.search.candidate import Evaluated
from squeezefilm.design.search.criteria import CRITERIA, criterion_of
from squeezefilm.design.search.found import DesignSearch
from squeezefilm.design.search.reasons import corner_in_words, limit_in_words
from squeezefilm.design.search.report.words import setting_words
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.design.search.run import Glimpse
from squeezefilm.design.search.tolerance import Made

MOST_POINTS = 600
"""Of the screened front that are drawn; of a longer one as many, evenly."""
_ALL_WORDS = 40
"""Reasons that are told of one kind; the first are those of most designs."""


def plate(requirements: Requirements, one: Evaluated, made: Made | None = None) -> dict[str, Any]:
    """A plate: name, shape and objectives (SI), what was chosen and what it does in words."""
    design, space = one.design, requirements.spaces[one.design.shape]
    chosen = []
    for variable in space:
        words = setting_words(variable, design, requirements)
        chosen.append([variable.name.replace("_", " "), words])
    objectives = one.objectives(requirements.objectives)
    return {
        "name": design.address,
        "shape": space.shape,
        "objectives": list(objectives),
        "words": [
            criterion_of(name).shown(value)
            for name, value in zip(requirements.objectives, objectives, strict=True)
        ],
        "numbers": numbers(one),
        "chosen": chosen,
        "design": {"shape": design.shape, "values": design.settings},
        "yield": None if made is None else made.kept,
        "warnings": list(one.warnings),
    }


def numbers(one: Evaluated) -> list[list[str]]:
    """What a design does: by row a criterion's key, what people call it, and the value in words."""
    return [
        [key, CRITERIA[key].said, CRITERIA[key].shown(value)]
        for key, value in one.numbers.items()
        if key in CRITERIA and key != "cost"
    ]


def glimpse(requirements: Requirements, seen: Glimpse) -> dict[str, Any]:
    """What a search has so far."""
    return {
        "stage": seen.stage,
        "screened": seen.screened,
        "solved": seen.solved,
        "screened_front": _thinned(seen.screened_front),
        "front": [plate(requirements, one) for one in seen.front],
        "reference": reference(requirements, seen.reference),
    }


def _thinned(points: Sequence[Sequence[float]]) -> list[list[float]]:
    every = max(1, -(-len(points) // MOST_POINTS))
    return [list(one) for one in sorted(map(tuple, points))[::every]]


def reference(requirements: Requirements, one: Evaluated | None) -> dict[str, Any] | None:
    """The display that the front is set beside, which limits it breaks, and why it could not be
    judged ("" where it was)."""
    if one is None:
        return None
    return {
        "name": Path(requirements.compare_with).stem,
        "objectives": list(one.objectives(requirements.objectives)),
        "breaks": [breach.sentence for breach in one.broken],
        "reason": one.reason,
    }


def result(found: DesignSearch) -> dict[str, Any]:
    """What a search found, or what it had when it was stopped: the front, the plate that it would
    build, what each limit costs, the empty corners, what it rests on."""
    asked, chosen = found.requirements, found.chosen
    return {
        "screened": len(found.screened),
        "solved": found.plates_solved,
        "front": [plate(asked, one.evaluated, one.made) for one in found.front],
        "reference": reference(asked, found.reference),
        "chosen": None if chosen is None else chosen.name,
        "beats": [one.name for one in found.beats_reference],
        "plates_better": found.plates_better,
        "limits": [limit_in_words(one, len(found.screened)) for one in found.limits if one.broken],
        "corners": [corner_in_words(one) for one in found.corners[:_ALL_WORDS]],
        "hypervolume": found.hypervolume,
        "ranks": {criterion_of(key).said: value for key, value in found.ranks.items()},
        "assumed": list(asked.assumed),
        "computed": found.computed,
        "kept": found.kept,
        "stopped": found.stopped,
    }
