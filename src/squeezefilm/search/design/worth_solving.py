"""Which of the screened designs are worth solving in three dimensions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.search.design.candidate import Design, Evaluated, Level
from squeezefilm.search.design.correction import Correction
from squeezefilm.search.design.criteria import breaches
from squeezefilm.search.design.front import layers_of
from squeezefilm.search.design.requirements import Requirements

# A design is solved though the screening says that it breaks a limit by up to this share.
_DOUBT, _CORRECTED_DOUBT = 0.25, 0.08
# By what share a corrected objective is taken to be off, where nothing or too much is known of it.
_ERROR, _MOST_ERROR = 0.1, 0.2

Seen = Mapping[Level, Mapping[Design, Evaluated]]


def objectives_of(requirements: Requirements, designs: Sequence[Evaluated]) -> si.FloatArray:
    """The objectives of designs (SI), shape (designs, objectives)."""
    names = requirements.objectives
    return np.array([one.objectives(names) for one in designs]).reshape(-1, len(names))


def worth_solving(
    requirements: Requirements,
    seen: Seen,
    corrections: Sequence[Correction | None],
    count: int,
) -> list[Design]:
    """At most `count` designs not solved yet, of all shapes together, by what is expected of them:
    those that might enter the front, layer by layer; of a layer too large those far apart."""
    pool = list(_expected(requirements, seen, corrections))
    rows = objectives_of(requirements, pool)
    solved = [one for one in seen["solved"].values() if one.is_feasible]
    known = objectives_of(requirements, solved)
    # What the front beats by more than the correction errs has no chance.
    nearest = rows * (1 - _error(requirements, corrections))
    might = np.array([not np.any(np.all(known <= row, axis=1)) for row in nearest], dtype=bool)
    at = np.flatnonzero(might)
    taken = at[layers_of(rows[at], count)]
    if taken.size > count:
        taken = _far_apart(rows, taken, count)
    return [pool[k].design for k in taken]


def _expected(
    requirements: Requirements, seen: Seen, corrections: Sequence[Correction | None]
) -> Iterator[Evaluated]:
    """The screened designs not solved yet that may keep the limits, with corrected numbers."""
    for shape, correction in enumerate(corrections):
        here = [
            one
            for one in seen["screened"].values()
            if one.design.shape == shape and not one.reason and one.design not in seen["solved"]
        ]
        numbers: list[Mapping[str, float]] = [one.numbers for one in here]
        slack = _DOUBT
        if correction is not None:
            numbers, slack = list(correction.of_all(here)), _CORRECTED_DOUBT
        for one, expected in zip(here, numbers, strict=True):
            if not breaches(expected, requirements.limits, slack=slack):
                yield replace(one, numbers=expected)


def _error(requirements: Requirements, corrections: Sequence[Correction | None]) -> float:
    """By what share a corrected objective may be off."""
    errors = [
        one.errors.get(name, 0.0)
        for one in corrections
        if one is not None
        for name in requirements.objectives
    ]
    return min(max(errors, default=_ERROR), _MOST_ERROR)


def _far_apart(rows: si.FloatArray, taken: si.IntArray, count: int) -> si.IntArray:
    """So many of the rows taken: the one best in the first objective, then always the farthest from
    all chosen, each objective over its spread."""
    here = rows[taken]
    span = np.ptp(here, axis=0)
    here = (here - here.min(axis=0)) / np.where(span > 0, span, 1.0)
    chosen = [int(np.argmin(here[:, 0]))]
    distance = np.linalg.norm(here - here[chosen[0]], axis=1)
    while len(chosen) < count:
        far = int(np.argmax(distance))
        chosen.append(far)
        distance = np.minimum(distance, np.linalg.norm(here - here[far], axis=1))
    return taken[chosen]
