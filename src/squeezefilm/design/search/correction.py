"""Correction of the screening theory by the solved plates: a smooth correction, with its error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RBFInterpolator

from squeezefilm.core import quantities as si
from squeezefilm.design.search.candidate import Design, Evaluated
from squeezefilm.design.search.space import Space

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
    numbers: dict[Design, int] = {}
    plate = np.array([numbers.setdefault(after.design.plate, len(numbers)) for _, after in pairs])
    if len(numbers) < LEAST_PLATES:
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
    return Correction(space, fits, errors, raw, len(numbers))


def _spline(x: si.FloatArray, y: si.FloatArray) -> RBFInterpolator:
    # A plane needs more points than it has directions; with fewer, a constant.
    degree = 1 if x.shape[0] > 2 * (x.shape[1] + 1) and _spans(x) else 0
    return RBFInterpolator(x, y, smoothing=_SMOOTHING, kernel="linear", degree=degree)


def _spans(x: si.FloatArray) -> bool:
    return bool(np.linalg.matrix_rank(x - x.mean(axis=0), tol=1e-6) == x.shape[1])


def _logarithm(before: float | None, after: float | None) -> float:
    if before is None or after is None or not (0 < before < np.inf and 0 < after < np.inf):
        return float("nan")
    return float(np.log(after / before))
