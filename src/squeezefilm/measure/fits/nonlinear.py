"""Least squares of numbers that all bend the curve, and what follows from fitted numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import Estimate

_MOST_STEPS = 60
_SETTLED = 1e-9
_STEP = 1e-5


def interval_around(
    value: float,
    standard_error: float,
    freedom: int,
    unit: str,
    level: si.Dimensionless = 0.95,
    *,
    logarithmic: bool = False,
) -> Estimate:
    """A value with Student's interval for its degrees of freedom; of the value's logarithm where
    `logarithmic`."""
    from scipy.special import stdtrit

    reach = float(stdtrit(max(freedom, 1), 0.5 + level / 2)) * standard_error
    low, high = value - reach, value + reach
    if logarithmic:
        with np.errstate(over="ignore"):
            value, low, high = (float(np.exp(one)) for one in (value, low, high))
        return Estimate(value, value * standard_error, (low, high), unit, level)
    return Estimate(value, standard_error, (low, high), unit, level)


def inverse_of(estimate: Estimate) -> Estimate:
    """One over an estimate (1), such as Q from a loss factor: its interval's ends change places.

    What is not above zero, an end of the interval or the value itself (noise can make a loss
    seem a gain), has an infinite inverse.
    """
    low, high = estimate.interval
    value, *ends = (
        1.0 / number if number > 0 else math.inf for number in (estimate.value, high, low)
    )
    error = value * estimate.standard_error / estimate.value if estimate.value > 0 else math.inf
    return Estimate(value, error, (ends[0], ends[1]), "1", estimate.level)


def propagated(
    of: Callable[[si.FloatArray], float],
    numbers: si.FloatArray,
    covariance: si.FloatArray,
    freedom: int,
    unit: str,
    *,
    positive: bool = False,
    level: si.Dimensionless = 0.95,
) -> Estimate:
    """A number that follows from fitted ones, with its interval by the delta method.

    `positive` numbers get theirs on a logarithmic scale, so that it never reaches zero. Holds where
    the number bends little within its own interval.
    """
    scale = np.sqrt(np.diag(covariance))

    def value(at: si.FloatArray) -> float:
        found = of(at)
        return float(np.log(found)) if positive else float(found)

    gradient = np.zeros(numbers.size)
    for i in np.flatnonzero(scale > 0):
        step = np.zeros(numbers.size)
        step[i] = scale[i] * _STEP
        gradient[i] = (value(numbers + step) - value(numbers - step)) / (2 * step[i])
    error = math.sqrt(max(float(gradient @ covariance @ gradient), 0.0))
    return interval_around(value(numbers), error, freedom, unit, level, logarithmic=positive)


@dataclass(frozen=True, eq=False)
class NonlinearFit:
    """Numbers (p,), what they leave, and their covariance for noise alike in every residual with
    `freedom` degrees of freedom."""

    numbers: si.FloatArray
    covariance: si.FloatArray
    residual: si.FloatArray
    freedom: int

    def with_widening(self, widening: float) -> NonlinearFit:
        """The same fit with standard errors multiplied by `widening`."""
        return replace(self, covariance=self.covariance * widening**2)

    def estimate(
        self,
        of: Callable[[si.FloatArray], float],
        unit: str,
        *,
        positive: bool = False,
        level: si.Dimensionless = 0.95,
    ) -> Estimate:
        """A number that follows from the fitted ones: see `propagated`."""
        return propagated(
            of, self.numbers, self.covariance, self.freedom, unit, positive=positive, level=level
        )


def fit_nonlinear(
    residual: Callable[[si.FloatArray], si.FloatArray], start: si.FloatArray, steps: si.FloatArray
) -> NonlinearFit:
    """The numbers (p,) that make the squares of `residual` (points,) least.

    Levenberg and Marquardt's damping, derivatives by differences of `steps` (p,). A residual that
    is not finite is walked around. Raises `InputError` where there are fewer residuals than
    numbers.
    """
    numbers, left = np.asarray(start, dtype=float), residual(start)
    freedom = left.size - numbers.size
    if freedom < 1:
        raise InputError(
            f"{left.size} numbers were recorded and {numbers.size} are to be fitted; record more"
        )
    least, damping = float(left @ left), 1e-3
    jacobian = _slopes(residual, numbers, steps)
    for _ in range(_MOST_STEPS):
        scale = _norms(jacobian)
        normal, toward = (jacobian / scale).T @ (jacobian / scale), (jacobian / scale).T @ left
        squares = np.inf
        while damping < 1e9:
            step = -np.linalg.solve(normal + damping * np.eye(numbers.size), toward) / scale
            with np.errstate(all="ignore"):
                other = residual(numbers + step)
                squares = float(other @ other)
            if squares <= least:
                break
            damping *= 10
        if not squares <= least:
            break
        gain, least = least - squares, squares
        numbers, left = numbers + step, other
        damping = max(damping / 10, 1e-9)
        jacobian = _slopes(residual, numbers, steps)
        if gain <= _SETTLED * least:
            break
    scale = _norms(jacobian)
    inverse = np.linalg.pinv(jacobian / scale)
    covariance = least / freedom * (inverse @ inverse.T) / np.outer(scale, scale)
    return NonlinearFit(numbers, covariance, left, freedom)


def _slopes(
    residual: Callable[[si.FloatArray], si.FloatArray], at: si.FloatArray, steps: si.FloatArray
) -> si.FloatArray:
    rows = []
    for i, size in enumerate(steps):
        step = np.zeros(at.size)
        step[i] = size
        rows.append((residual(at + step) - residual(at - step)) / (2 * size))
    return np.stack(rows, axis=1)


def _norms(jacobian: si.FloatArray) -> si.FloatArray:
    found = np.linalg.norm(jacobian, axis=0)
    found[found == 0] = 1.0
    return np.asarray(found)
