"""Record of a calibration in a calibrated display's file: how its values vary together, and when it
was made, on what, and how it went.

`JointSpread` is computed with, as the values' own spreads are; `CalibrationRecord` is for people,
and for the lab.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

_Ends = tuple[Annotated[si.Dimensionless, si.AtLeast(0)], ...]


@si.checked_numbers
@dataclass(frozen=True)
class UsedRecording:
    """A recording that a calibration learned from: its file's name and SHA-256, its kind, who took
    it when with what, and where it is from (one that was made up says so).

    An empty text is not told.
    """

    file: str
    kind: str = ""
    who: str = ""
    when: str = ""
    instrument: str = ""
    origin: str = ""
    sha256: str = ""


@si.checked_numbers
@dataclass(frozen=True)
class ComparedAnswer:
    """A number that was measured beside what the model alone says of it, before and after.

    `said` names the number in words, `measured` is it with its unit, `error` its standard error as
    a share of it. `before` and `after` are the model's low end, median and high end (90 %), each
    divided by what was measured; empty where the model has none. They are without what the model is
    believed to be off by, so that a model that does not fit is seen. A friction has its conditions.

    Raises `InputError` for ends that are not three in rising order.
    """

    said: str
    measured: str
    error: Annotated[si.Dimensionless, si.AtLeast(0)]
    before: _Ends = ()
    after: _Ends = ()
    recording: str = ""
    relative_friction: Annotated[si.Dimensionless, si.AtLeast(0)] | None = None
    vibration_amplitude: Annotated[si.Metre, si.AtLeast(0)] | None = None

    def __post_init__(self) -> None:
        for name in ("before", "after"):
            ends = getattr(self, name)
            if ends and (len(ends) != 3 or list(ends) != sorted(ends)):
                raise InputError(
                    f"{name} = {list(ends)} is no interval; give its low end, median and high end "
                    "as shares of what was measured, or leave it out",
                    quantity=name,
                )


@si.checked_numbers
@dataclass(frozen=True)
class CalibratedAnswer:
    """Draws of a number that the calibrated display answers with (in SI units, of equal weights),
    with what the model is believed to be off by; `said` names it in words."""

    said: str
    draws: tuple[si.Dimensionless, ...]


@si.checked_numbers
@dataclass(frozen=True)
class CalibrationRecord:
    """A calibration as a file remembers it: the day (UTC), the version that made it, whether the
    model explains what was observed, what came out in sentences, the recordings, every observation
    beside the model, and `answers` of the actuator with the digest `actuator`."""

    when: str
    version: str
    fits: bool
    said: tuple[str, ...] = ()
    recordings: tuple[UsedRecording, ...] = ()
    compared: tuple[ComparedAnswer, ...] = ()
    answers: tuple[CalibratedAnswer, ...] = ()
    actuator: str = ""

    @property
    def sentence(self) -> str:
        """A sentence: when it was calibrated, on what, and whether the model explains that."""
        count, files = len(self.compared), len(self.recordings)
        numbers = f"{count} measured number{'' if count == 1 else 's'}"
        of = f" of {files} recording{'' if files == 1 else 's'}" if files else ""
        how = "The model explains them" if self.fits else "The model does NOT explain them"
        return f"Calibrated on {self.when} from {numbers}{of}. {how}."


_MOST_DRAWS = 4096


@si.checked_numbers
@dataclass(frozen=True)
class JointSpread:
    """Draws of all that a calibration found uncertain, with equal weights.

    A row of `draws` has a share from 0 to 1 for each of `paths`: the value (or law) that is not
    exceeded with this probability by its own spread. `amplitude_share` is the amplitude per volt
    relative to the solved one, `friction_offset` what is added to the law's relative friction: each
    a middle and a standard deviation.

    Raises `InputError` for rows that are not as long as paths, or shares that are none.
    """

    paths: tuple[str, ...] = ()
    amplitude_share: Annotated[si.Dimensionless, si.Above(0)] = 1.0
    amplitude_share_deviation: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(1)] = 0.0
    friction_offset: Annotated[si.Dimensionless, si.AtLeast(-1), si.AtMost(1)] = 0.0
    friction_offset_deviation: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(1)] = 0.0
    draws: tuple[tuple[Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(1)], ...], ...] = ()

    def __post_init__(self) -> None:
        if len(self.draws) > _MOST_DRAWS or len(self.paths) > 100:
            raise InputError(
                f"joint has {len(self.draws)} draws of {len(self.paths)} values; at most "
                f"{_MOST_DRAWS} of 100 are read",
                quantity="draws",
            )
        if any(len(row) != len(self.paths) for row in self.draws) or len(set(self.paths)) < len(
            self.paths
        ):
            raise InputError(
                f"every row of draws needs {len(self.paths)} numbers, one for each of paths, which "
                "differ; take the table as a calibration wrote it",
                quantity="draws",
            )

    def _common(
        self, paths: tuple[str, ...], points: si.FloatArray
    ) -> tuple[list[int], si.FloatArray]:
        """The places of those `paths` that stand here, and their columns of the draws; none without
        draws. Raises `InputError` for points with another number of coordinates."""
        if points.shape[1:] != (len(paths),):
            raise InputError(
                f"points has the shape {points.shape}; give a row of {len(paths)} shares, one for "
                "each of paths, for each point",
                quantity="points",
            )
        common = [path for path in self.paths if path in paths and self.draws]
        table = np.array(self.draws or [()])[:, [self.paths.index(path) for path in common]]
        return [paths.index(path) for path in common], table

    @si.checked_numbers
    def picked(self, paths: tuple[str, ...], points: si.DimensionlessArray) -> si.FloatArray:
        """Points of the unit cube with coordinates `paths`, shape (points, paths), in which what
        was calibrated is a row of the draws, each row as often as any other. Raises `InputError`
        for points of another shape."""
        columns, table = self._common(paths, points)
        if not columns:
            return points
        drawn = np.array(points, dtype=float)
        row = np.minimum((drawn[:, columns[0]] * len(table)).astype(int), len(table) - 1)
        drawn[:, columns] = table[row]
        return drawn

    @si.checked_numbers
    def moved(self, paths: tuple[str, ...], points: si.DimensionlessArray) -> si.FloatArray:
        """Points of the unit cube (points, paths) moved so that their normal scores have the draws'
        means and covariances: independent coordinates stay what they are named after, which a
        design that changes one at a time needs. A Gaussian about the draws, so an approximation.
        Raises `InputError` for points of another shape."""
        from scipy.special import ndtr, ndtri

        columns, table = self._common(paths, points)
        if not columns:
            return points
        scores = ndtri(np.clip(table, 1e-4, 1 - 1e-4))
        values, vectors = np.linalg.eigh(np.atleast_2d(np.cov(scores.T)))
        root = vectors @ np.diag(np.sqrt(np.maximum(values, 0.0))) @ vectors.T
        moved_points = np.array(points, dtype=float)
        own = ndtri(np.clip(moved_points[:, columns], 1e-9, 1 - 1e-9))
        moved_points[:, columns] = ndtr(scores.mean(axis=0) + own @ root)
        return moved_points
