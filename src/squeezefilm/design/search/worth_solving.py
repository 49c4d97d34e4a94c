"""Choice of the screened designs that are worth solving in three dimensions.

What the solved plates say of the screening theory is learned as a smooth correction, with its
error; by it the next are chosen.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.stats import qmc

from squeezefilm.core import quantities as si
from squeezefilm.design.search.candidate import Design, Evaluated, Level, plates_of
from squeezefilm.design.search.criteria import breaches, criterion_of
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.design.search.space import Space
from squeezefilm.design.sweep.tradeoffs import layers_of

LEAST_PLATES = 4
"""Smallest number of plates from which anything is learned."""

_FOLDS = 8
# As rough as what neighbouring modes do to single designs, in the square of a logarithm.
_SMOOTHING = 1.0
# A correction is of what was seen: no design's number is moved by more than this factor.
_MOST = 2.0

CORRECTED = (
    "relative_friction",
    "finest_period",
    "resonance_frequency",
    "squeeze_number",
    "vibration_amplitude",
    "current",
    "power",
    "temperature_rise",
    "stress",
)
"""The numbers that a correction is learned for; the others follow from the drawing."""


@dataclass(frozen=True, eq=False)
class Correction:
    """The logarithm of the solved over the screened number, as a smooth function of a design.

    `errors` are, by key, the standard deviation of what is left of that logarithm in designs that
    were left out of the fit with all of their plate (`_FOLDS` groups of plates), and `raw` what
    there is without a correction; `plates` is the number of those that it was learned from. A thin
    plate spline with smoothing (SciPy's `RBFInterpolator`) in the shares of the free variables and
    the ratio of half wavelength to thickness.
    """

    space: Space
    fits: Mapping[str, RBFInterpolator]
    errors: Mapping[str, si.Dimensionless]
    raw: Mapping[str, si.Dimensionless]
    plates: int

    def of_all(self, screened: Sequence[Evaluated]) -> list[dict[str, float]]:
        """The numbers of screened designs, corrected (SI)."""
        corrected = [dict(candidate.numbers) for candidate in screened]
        if not corrected or not self.fits:
            return corrected
        places = np.array([_features(self.space, candidate) for candidate in screened])
        for key, fit in self.fits.items():
            moved = np.clip(fit(places), -np.log(_MOST), np.log(_MOST))
            for numbers, by in zip(corrected, moved, strict=True):
                if key in numbers:
                    numbers[key] *= float(np.exp(by))
        return corrected


def _features(space: Space, candidate: Evaluated) -> list[float]:
    slender = candidate.numbers["half_wavelength"] / candidate.numbers["total_thickness"]
    return [*space.shares(candidate.design.settings), np.log(slender)]


def learned(
    space: Space, screened: Mapping[Design, Evaluated], solved: Sequence[Evaluated]
) -> Correction | None:
    """The correction that solved designs of one space tell; None where there are too few."""
    pairs = [
        (screened[solution.design], solution)
        for solution in solved
        if not solution.reason
        and solution.design in screened
        and not screened[solution.design].reason
    ]
    plate = _numbered([after.design.plate for _, after in pairs])
    plates = np.unique(plate).size
    if plates < LEAST_PLATES:
        return None
    places = np.array([_features(space, before) for before, _ in pairs])
    fits, errors, raw = {}, {}, {}
    for key in CORRECTED:
        values = np.array(
            [_logarithm(before.numbers.get(key), after.numbers.get(key)) for before, after in pairs]
        )
        good = np.isfinite(values)
        if np.unique(plate[good]).size < LEAST_PLATES:
            continue
        x, y = places[good], values[good]
        left = np.empty(y.size)
        for fold in np.unique(plate[good] % _FOLDS):
            out = plate[good] % _FOLDS == fold
            left[out] = y[out] - _spline(x[~out], y[~out])(x[out])
        errors[key], raw[key] = float(np.std(left)), float(np.sqrt(np.mean(y**2)))
        if errors[key] < raw[key]:
            fits[key] = _spline(x, y)
        else:
            errors[key] = raw[key]
    return Correction(space, fits, errors, raw, plates)


def _spline(x: si.FloatArray, y: si.FloatArray) -> RBFInterpolator:
    # A plane needs more points than it has directions; with fewer, a constant.
    points, directions = x.shape
    spans = np.linalg.matrix_rank(x - x.mean(axis=0), tol=1e-6) == directions
    degree = 1 if points > 2 * (directions + 1) and spans else 0
    return RBFInterpolator(x, y, smoothing=_SMOOTHING, kernel="linear", degree=degree)


def _logarithm(before: float | None, after: float | None) -> float:
    if before is None or after is None or not (0 < before < np.inf and 0 < after < np.inf):
        return float("nan")
    return float(np.log(after / before))


# A design is solved though the screening says that it breaks a limit by up to this share; it tells
# frequencies better than what depends on losses.
_DOUBT, _CORRECTED_DOUBT, _OF_FREQUENCY = 0.25, 0.08, 0.08
_DEVIATIONS = 2.0  # of a corrected frequency, by which it may lie beyond a limit
_FREQUENCIES = ("resonance_frequency", "highest_frequency")
# By what share a corrected objective is taken to be off, where nothing or too much is known of it.
_ERROR, _MOST_ERROR = 0.1, 0.2

_NATURAL_WORST: Mapping[str, float] = {"relative_friction": 1.0, "finest_period": 5e-3}
_POINTS = 4096

Seen = Mapping[Level, Mapping[Design, Evaluated]]


def objectives_of(requirements: Requirements, designs: Sequence[Evaluated]) -> si.FloatArray:
    """The objectives of designs (SI), shape (designs, objectives)."""
    names = requirements.objectives
    return np.array([design.objectives(names) for design in designs]).reshape(-1, len(names))


def worth_solving(
    requirements: Requirements,
    seen: Seen,
    corrections: Sequence[Correction | None],
    count: int,
) -> list[Design]:
    """Designs of plates not solved yet, at most `count` of all shapes together, that might enter
    the front: those expected to add most to what it dominates, at all voltages that were screened
    of a plate, each beside those chosen before it; then, since what is expected errs, layer by
    layer, of a layer too large those far apart. No two are of one plate."""
    pool = list(_expected(requirements, seen, corrections))
    rows = objectives_of(requirements, pool)
    solved = [candidate for candidate in seen["solved"].values() if candidate.is_feasible]
    known = objectives_of(requirements, solved)
    # What the front beats by more than the correction errs has no chance.
    nearest = rows * (1 - _error(requirements, corrections))
    might = np.array([not np.any(np.all(known <= row, axis=1)) for row in nearest], dtype=bool)
    at = np.flatnonzero(might)
    worst = worst_corner(requirements, rows[at])
    plates = _numbered([pool[k].design.plate for k in at])
    first = at[:0]
    # Of a screening that no solved plate has corrected, the most is expected of what cannot be.
    if all(corrections[pool[k].design.shape] is not None for k in at):
        first = at[_adding_most(rows[at], known, worst, count, plates)]
    others = ~np.isin(plates, plates[np.isin(at, first)])
    left, room = at[others], count - first.size
    left = left[_one_each(plates[others], rows[left] / worst)]
    taken = left[layers_of(rows[left], room)]
    if taken.size > room:
        taken = _far_apart(rows, taken, room)
    return [pool[k].design for k in (*first, *taken)]


def worst_corner(requirements: Requirements, rows: si.FloatArray) -> si.FloatArray:
    """The corner from which a hypervolume is measured (SI): limits where there are any, µ′/µ of 1,
    gratings of 5 mm, else a tenth beyond the worst of rows of objectives."""
    corner = []
    for number, name in enumerate(requirements.objectives):
        own = criterion_of(name).limit
        bound = getattr(requirements.limits, own) if own else None
        if bound is None:
            bound = _NATURAL_WORST.get(name)
        if bound is None:
            bound = 1.1 * float(np.max(rows[:, number], initial=0.0)) or 1.0
        corner.append(float(bound))
    return np.array(corner)


def _numbered(plates: Sequence[Design]) -> si.IntArray:
    """A number for each plate, equal for equal ones."""
    numbers: dict[Design, int] = {}
    return np.array([numbers.setdefault(plate, len(numbers)) for plate in plates], dtype=np.intp)


def _one_each(plates: si.IntArray, shares: si.FloatArray) -> si.IntArray:
    """Row of each plate whose objectives, as shares of the worst, add up to the least."""
    order = np.argsort(shares.sum(axis=1), kind="stable")
    _, first = np.unique(plates[order], return_index=True)
    return np.sort(order[first])


def _adding_most(
    rows: si.FloatArray,
    known: si.FloatArray,
    worst: si.FloatArray,
    count: int,
    plates: si.IntArray,
) -> si.IntArray:
    """Rows, at most so many and each of another plate, that dominate most of what known rows do
    not, one after the other, by points spread evenly over the box from the best of all to the worst
    corner. Of a plate all rows count: it is solved once for all of them."""
    if not rows.size:
        return np.array([], dtype=np.intp)
    best = np.min(np.concatenate((rows, known)), axis=0)
    shares = qmc.Sobol(worst.size, seed=1).random(_POINTS)
    points = best + shares * np.maximum(worst - best, 0.0)
    free = np.ones(_POINTS, dtype=bool)
    for row in known:
        free &= ~np.all(row <= points, axis=1)
    reached = np.array([np.all(row <= points, axis=1) for row in rows])
    together = np.zeros((plates.max() + 1, _POINTS), dtype=bool)
    np.logical_or.at(together, plates, reached)
    chosen: list[int] = []
    while len(chosen) < count:
        gain = together[:, free].sum(axis=1)
        most = int(np.argmax(gain))
        if gain[most] == 0:
            break
        own = np.flatnonzero(plates == most)
        chosen.append(int(own[np.argmax(reached[own][:, free].sum(axis=1))]))
        free &= ~together[most]
    return np.array(chosen, dtype=np.intp)


def _expected(
    requirements: Requirements, seen: Seen, corrections: Sequence[Correction | None]
) -> Iterator[Evaluated]:
    """The screened designs of plates not solved yet that may keep the limits, with corrected
    numbers."""
    known = plates_of(seen["solved"])
    for shape, correction in enumerate(corrections):
        here = [
            candidate
            for candidate in seen["screened"].values()
            if candidate.design.shape == shape
            and not candidate.reason
            and candidate.design.plate not in known
        ]
        numbers: list[Mapping[str, float]] = [candidate.numbers for candidate in here]
        doubt, of_frequency = _DOUBT, _OF_FREQUENCY
        if correction is not None:
            numbers, doubt = list(correction.of_all(here)), _CORRECTED_DOUBT
            # Else what lies just beyond a limit, and moves more for it, is solved again and again.
            errors = [correction.errors[key] for key in _FREQUENCIES if key in correction.errors]
            of_frequency = min([_OF_FREQUENCY, *(_DEVIATIONS * error for error in errors)])
        for candidate, expected in zip(here, numbers, strict=True):
            broken = breaches(expected, requirements.limits)
            if all(b.excess <= (of_frequency if b.key in _FREQUENCIES else doubt) for b in broken):
                yield replace(candidate, numbers=expected)


def _error(requirements: Requirements, corrections: Sequence[Correction | None]) -> float:
    """Share by which a corrected objective may be off."""
    errors = [
        correction.errors.get(name, 0.0)
        for correction in corrections
        if correction is not None
        for name in requirements.objectives
    ]
    return min(max(errors, default=_ERROR), _MOST_ERROR)


def _far_apart(rows: si.FloatArray, taken: si.IntArray, count: int) -> si.IntArray:
    """Choice of so many of the rows taken: the one best in the first objective, then always the
    farthest from all chosen, each objective over its spread."""
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
