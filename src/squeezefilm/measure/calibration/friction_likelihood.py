"""Likelihood of draws of finger and law by observations of µ′/µ, with an error of the law itself.

The law's error is a continuous function of amplitude, force and speed: a Gaussian process over
their logarithms with an exponential correlation, so that many points along one curve do not count
as many independent judges of the law, and beyond them it is soon unknown again.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.calibration.discrepancy import (
    BELIEVED,
    FRICTION_SCALES,
    Misfit,
    misfit_of,
)
from squeezefilm.measure.calibration.solved_answers import FRICTION
from squeezefilm.measure.fits.estimate import Observation

GRID = np.geomspace(*FRICTION_SCALES, 7)
"""Scales of the discrepancy that are summed over."""
_ALIKE = 0.7  # as a difference of logarithms: at twice the amplitude the error is mostly another


class Touching(NamedTuple):
    """Conditions under which µ′/µ is observed or predicted: vibration amplitude (m, with the finger
    on), normal force (N) and speed (m/s); None where it is the display's own, the force as
    uncertain as it is there."""

    amplitude: si.Metre
    force: si.Newton | None = None
    speed: si.MetrePerSecond | None = None

    @property
    def said(self) -> str:
        """Conditions in words."""
        words = f"relative friction at {1e6 * self.amplitude:.3g} µm"
        if self.force is not None:
            words += f", {self.force:.3g} N"
        return words + (f", {1e3 * self.speed:.3g} mm/s" if self.speed is not None else "")


def touching(observation: Observation) -> Touching:
    """The conditions of an observed µ′/µ.

    Raises `InputError` for one without its amplitude, or conditions that are not above 0.
    """
    given = observation.conditions
    if observation.answer != FRICTION or "vibration_amplitude" not in given:
        raise InputError(
            f"a {FRICTION} was observed without its vibration_amplitude; give it in its conditions "
            "(m, zero to peak, with the finger on)",
            quantity="observations",
        )
    for name in ("vibration_amplitude", "normal_force", "finger_speed"):
        si.require(name, given.get(name, 1.0), above=0)
    if not observation.standard_error > 0:
        raise InputError(f"a {FRICTION} needs a standard error above 0", quantity="observations")
    return Touching(
        given["vibration_amplitude"], given.get("normal_force"), given.get("finger_speed")
    )


@dataclass(frozen=True, eq=False)
class FrictionLikelihood:
    """Observations of µ′/µ, as judges of curves: µ′/µ of draws at the same conditions, shape
    (draws, observations)."""

    observations: tuple[Observation, ...]

    @cached_property
    def where(self) -> tuple[Touching, ...]:
        """The conditions, in the order of the observations."""
        return tuple(touching(seen) for seen in self.observations)

    @cached_property
    def observed(self) -> si.DimensionlessArray:
        """Observed values, shape (observations,)."""
        return np.array([seen.value for seen in self.observations])

    @cached_property
    def noise(self) -> si.DimensionlessArray:
        """Standard errors, shape (observations,)."""
        return np.array([seen.standard_error for seen in self.observations])

    def _covariance(self, scale: float) -> si.FloatArray:
        error = scale * BELIEVED[FRICTION]
        return error**2 * _likeness(self.where, self.where) + np.diag(self.noise**2)

    def logarithms(self, curves: si.DimensionlessArray) -> si.FloatArray:
        """The logarithm of the likelihood of every draw under every scale of `GRID`, shape (draws,
        scales); −∞ for a draw that has no friction somewhere."""
        from scipy.linalg import cho_factor, cho_solve

        off = self.observed - curves
        known = np.isfinite(off).all(axis=1)
        logarithms = np.full((len(curves), GRID.size), -math.inf)
        for k, scale in enumerate(GRID):
            factor = cho_factor(self._covariance(float(scale)), lower=True)
            solved = cho_solve(factor, off[known].T)
            determinant = 2 * float(np.sum(np.log(np.diag(factor[0]))))
            logarithms[known, k] = -(np.sum(off[known].T * solved, axis=0) + determinant) / 2
        return logarithms

    def errors(
        self,
        curves: si.DimensionlessArray,
        scales: si.DimensionlessArray,
        at: tuple[Touching, ...],
        seed: int,
    ) -> si.DimensionlessArray:
        """Draws of the law's error at other conditions, given what it was at those observed: for
        draws with their scales, shape (draws, conditions), correlated between the conditions. With
        one seed the first conditions are the same whatever follows them."""
        own, far = _likeness(at, at), _likeness(self.where, at)
        noise = np.random.default_rng(seed).normal(size=(len(at), len(curves))).T
        errors = np.zeros((len(curves), len(at)))
        for scale in np.unique(scales):
            rows = scales == scale
            error = (scale * BELIEVED[FRICTION]) ** 2
            gain = np.linalg.solve(self._covariance(float(scale)), error * far)
            left = error * (own - far.T @ gain)
            # A condition named twice has no error of its own: a hair keeps the factor.
            root = np.linalg.cholesky(left + 1e-9 * error * np.eye(len(at)))
            errors[rows] = (self.observed - curves[rows]) @ gain + noise[rows] @ root.T
        return errors

    def misfit(self, curves: si.DimensionlessArray) -> Misfit:
        """Judgement of how well the best of the draws explains what was observed, without a
        discrepancy."""
        off = (self.observed - curves) / self.noise
        squares = np.where(np.isfinite(off).all(axis=1), np.sum(off**2, axis=1), math.inf)
        at = int(np.argmin(squares))
        pairs = zip(self.observations, self.where, strict=True)
        names = [seen.in_words(where.said) for seen, where in pairs]
        return misfit_of(float(squares[at]), names, off[at])


def _likeness(a: tuple[Touching, ...], b: tuple[Touching, ...]) -> si.DimensionlessArray:
    """The correlation of the law's error between conditions, shape (a, b). A condition that is the
    display's own on one side only counts as another one."""
    # What is not told is NaN.
    mine = np.log(np.array(a, dtype=float).reshape(-1, 1, 3))
    other = np.log(np.array(b, dtype=float).reshape(1, -1, 3))
    apart = np.nan_to_num(np.abs(mine - other) / _ALIKE, nan=0.3)
    apart[np.isnan(mine) & np.isnan(other)] = 0.0
    return np.asarray(np.exp(-np.sum(apart, axis=2)))
