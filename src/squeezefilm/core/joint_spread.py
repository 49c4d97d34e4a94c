"""How sure a calibrated display is of its values together: what their own spreads do not say.

A calibration often fixes a combination of values and neither of them alone, and believes a law the
more the rougher the skin is. So draws of its posterior stand beside the values, and an interval of
friction is made of these.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

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
    draws: tuple[tuple[si.Dimensionless, ...], ...] = ()

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
        if self.draws and not (np.min(self.draws) >= 0 and np.max(self.draws) <= 1):
            raise InputError("a share in draws is not from 0 to 1", quantity="draws")

    def _common(self, paths: tuple[str, ...]) -> tuple[list[int], si.FloatArray]:
        """Which of `paths` stand here, and their columns of the draws."""
        common = [path for path in self.paths if path in paths]
        table = np.array(self.draws)[:, [self.paths.index(path) for path in common]]
        return [paths.index(path) for path in common], table

    @si.checked_numbers
    def picked(self, paths: tuple[str, ...], points: si.DimensionlessArray) -> si.FloatArray:
        """Points of the unit cube with coordinates `paths`, shape (points, paths), in which what
        was calibrated is a row of the draws, each row as often as any other."""
        if not self.draws:
            return points
        columns, table = self._common(paths)
        if not columns:
            return points
        found = np.array(points, dtype=float)
        row = np.minimum((found[:, columns[0]] * len(table)).astype(int), len(table) - 1)
        found[:, columns] = table[row]
        return found

    @si.checked_numbers
    def moved(self, paths: tuple[str, ...], points: si.DimensionlessArray) -> si.FloatArray:
        """Points of the unit cube (points, paths) moved so that their normal scores have the draws'
        means and covariances: independent coordinates stay what they are named after, which a
        design that changes one at a time needs. A Gaussian about the draws, so an approximation."""
        from scipy.special import ndtr, ndtri

        if not self.draws:
            return points
        columns, table = self._common(paths)
        if not columns:
            return points
        scores = ndtri(np.clip(table, 1e-4, 1 - 1e-4))
        values, vectors = np.linalg.eigh(np.atleast_2d(np.cov(scores.T)))
        root = vectors @ np.diag(np.sqrt(np.maximum(values, 0.0))) @ vectors.T
        found = np.array(points, dtype=float)
        own = ndtri(np.clip(found[:, columns], 1e-9, 1 - 1e-9))
        found[:, columns] = ndtr(scores.mean(axis=0) + own @ root)
        return found
