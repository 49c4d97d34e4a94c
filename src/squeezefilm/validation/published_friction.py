"""All friction in a folder beside every model: curves, published fits, fingertips, and thresholds
of its modulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import to_json
from squeezefilm.measure.fits.friction.friction_curve import (
    LEVELS,
    CurveComparison,
    compare_friction_curve,
    display_of,
)
from squeezefilm.measure.fits.friction.friction_scores import ModelScore, rest_friction
from squeezefilm.measure.recordings.kinds import (
    DetectionThresholds,
    FingertipImpedances,
    FrictionCurve,
    FrictionDecays,
)
from squeezefilm.measure.recordings.read import check_folder
from squeezefilm.validation.populations import (
    DetectionComparison,
    PopulationComparison,
    compare_decays,
    compare_detection,
    compare_impedances,
)


@dataclass(frozen=True)
class TotalScore:
    """A model over several units (a finger, or a paper whose fingers are not told apart), each
    counted once.

    `difference` is the root mean square over units; `log_score` the mean of the logarithmic density
    of a point, in units of the friction at rest, with the spread of the model's error over the
    *other* units, `log_score_error` its standard error over units. None where the model does not
    answer everywhere, or with fewer than two units (of the error fewer than three).
    """

    model: str
    fitted: int
    units: int
    difference: si.Dimensionless | None
    log_score: si.Dimensionless | None
    log_score_error: si.Dimensionless | None


@dataclass(frozen=True, eq=False)
class FolderComparison:
    """All friction that a folder holds beside every model: curves with their total scores, the
    numbers of many people, and thresholds of modulation beside the rival senses."""

    curves: tuple[CurveComparison, ...]
    totals: tuple[TotalScore, ...]
    populations: tuple[PopulationComparison, ...]
    detections: tuple[DetectionComparison, ...] = ()

    @property
    def units_covered(self) -> tuple[int, int, tuple[float, float]]:
        """Number of units (fingers or papers) with their curves in the default's interval, of how
        many, and the 95 % interval of that share (Clopper and Pearson)."""
        from scipy.stats import binomtest

        covered: dict[str, bool] = {}
        for compared in self.curves:
            unit = compared.curve.unit
            covered[unit] = covered.get(unit, True) and compared.covered
        if not covered:
            return 0, 0, (0.0, 1.0)
        ends = binomtest(sum(covered.values()), len(covered)).proportion_ci(0.95)
        return sum(covered.values()), len(covered), (float(ends.low), float(ends.high))

    @property
    def coverage(self) -> dict[str, tuple[si.IntArray, int]]:
        """Coverage by unit (finger or paper): how many of its points that vibrate lie in the
        default's central interval of each of `LEVELS`, shape (levels,), and how many do vibrate."""
        counts: dict[str, tuple[si.IntArray, int]] = {}
        for compared in self.curves:
            moves = compared.curve.vibration_amplitude > 0
            inside = compared.inside_levels[:, moves].sum(axis=1)
            before, points = counts.get(compared.curve.unit, (0, 0))
            counts[compared.curve.unit] = before + inside, points + int(moves.sum())
        return counts

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values; keys carry units."""
        within, units, ends = self.units_covered
        return {
            "curves": [compared.summary() for compared in self.curves],
            "totals": to_json(self.totals),
            "units_covered": {"covered": within, "units": units, "share_interval": list(ends)},
            "coverage": {
                "levels": list(LEVELS),
                "units": {
                    unit: {"points": points, "inside": inside.tolist()}
                    for unit, (inside, points) in self.coverage.items()
                },
            },
            "populations": [compared.summary() for compared in self.populations],
            "detections": [compared.summary() for compared in self.detections],
        }


def compare_folder(folder: str | Path, progress: SayProgress | None = None) -> FolderComparison:
    """`compare_friction_curve` for every friction curve that a folder's TOML files describe, and
    the same for published fits, fingertips and detection thresholds.

    Recordings of other kinds are passed over. Raises `InputError` for a folder that has none, and
    for a file that cannot be read, before anything is computed.
    """
    checked = check_folder(folder)
    if checked.refused:
        raise InputError(checked.refused[0].why)
    kinds = FrictionCurve | FrictionDecays | FingertipImpedances | DetectionThresholds
    recordings = [check.recording for check in checked.checks if isinstance(check.recording, kinds)]
    if not recordings:
        raise InputError(
            f"{folder} holds no friction curve, only: "
            + ", ".join(sorted({check.kind for check in checked.checks}))
            + '; write kind = "friction curve" into the description of one'
        )
    detections = tuple(
        compare_detection(recording)
        for recording in recordings
        if isinstance(recording, DetectionThresholds)
    )
    on_displays = [r for r in recordings if not isinstance(r, DetectionThresholds)]
    displays = [display_of(recording.told.name, recording.display) for recording in on_displays]
    for recording in on_displays:
        if isinstance(recording, FrictionCurve):
            rest_friction(recording)
    curves: list[CurveComparison] = []
    populations: list[PopulationComparison] = []
    for recording, display in zip(on_displays, displays, strict=True):
        if isinstance(recording, FrictionCurve):
            curves.append(compare_friction_curve(recording, progress, display))
        elif isinstance(recording, FrictionDecays):
            populations.append(compare_decays(recording, display, progress))
        else:
            populations += compare_impedances(recording, display)
    totals: tuple[TotalScore, ...] = ()
    if curves:
        scores = [compared.models for compared in curves]
        totals = total_scores([compared.curve for compared in curves], scores)
    return FolderComparison(tuple(curves), totals, tuple(populations), detections)


def total_scores(
    curves: Sequence[FrictionCurve], scores: Sequence[Sequence[ModelScore]]
) -> tuple[TotalScore, ...]:
    """The scores of each model over all curves, the least difference first; those that do not
    answer everywhere last."""
    by_unit: dict[str, list[int]] = {}
    for number, curve in enumerate(curves):
        by_unit.setdefault(curve.unit, []).append(number)
    totals = []
    for model in (score.model for score in scores[0]):
        own = [next(score for score in row if score.model == model) for row in scores]
        totals.append(_total(own, curves, list(by_unit.values())))
    totals.sort(key=lambda total: (total.difference is None, total.difference or 0.0))
    return tuple(totals)


def _total(
    scores: Sequence[ModelScore], curves: Sequence[FrictionCurve], units: Sequence[Sequence[int]]
) -> TotalScore:
    model, fitted = scores[0].model, scores[0].fitted
    if any(score.answered < score.friction.size for score in scores):
        return TotalScore(model, fitted, len(units), None, None, None)
    errors = [
        np.concatenate(
            [(curves[k].friction - scores[k].friction) / rest_friction(curves[k]) for k in unit]
        )
        for unit in units
    ]
    squares = np.array([np.mean(error**2) for error in errors])
    difference = float(np.sqrt(np.mean(squares)))
    if len(units) < 2:
        return TotalScore(model, fitted, len(units), difference, None, None)
    others = (squares.sum() - squares) / (len(units) - 1)
    # A model that fits all other units exactly says nothing of its error on this one.
    others = np.maximum(others, 1e-12)
    log_scores = -0.5 * (np.log(2 * np.pi * others) + squares / others)
    error = None
    if len(units) > 2:
        error = float(np.std(log_scores, ddof=1) / np.sqrt(len(units)))
    return TotalScore(model, fitted, len(units), difference, float(np.mean(log_scores)), error)
