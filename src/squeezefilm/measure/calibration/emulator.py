"""A fast stand-in for the solver around one display: a Gaussian process with a measured error.

Over priors of some per cent the logarithms of a plate's answers are nearly linear in the
logarithms of what the plate is made of; what is not (soft glue, a mode that meets another) is
interpolated with a Matérn covariance of its own length in every coordinate. The error is measured,
not believed: at solved points that the emulator was not shown. Source: Rasmussen and Williams,
Gaussian Processes for Machine Learning (2006), sections 2.7, 4.2 and 5.4.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

HELD_OUT = 12
"""Points that the emulator is not shown, from which its error is taken."""
_LENGTHS = (0.4, 60.0)
_NUGGETS = (1e-8, 0.3)
# Weakly, so that a length that the points say nothing of stays at some widths of the priors.
_USUAL_LENGTH, _TRUST = 4.0, 0.05


def least_points(parameters: int) -> int:
    """Number of solved points an emulator of so many parameters needs, those held out included."""
    return 4 * (parameters + 1) + HELD_OUT


@dataclass(frozen=True, eq=False)
class Emulator:
    """Answers (logarithms) over coordinates, by `emulator_of`.

    `errors` are root mean square differences of the logarithms (so relative errors) at points
    that it was not shown, shape (answers,). Valid within ±1 in every coordinate.
    """

    errors: si.DimensionlessArray
    _shown: si.FloatArray
    _trends: si.FloatArray
    _lengths: si.FloatArray
    _weights: si.FloatArray

    def __call__(self, coordinates: si.FloatArray) -> si.FloatArray:
        """Logarithms of the answers at points, shape (points, answers)."""
        x = np.asarray(coordinates, dtype=float)
        logarithms = _with_one(x) @ self._trends
        for k, lengths in enumerate(self._lengths):
            logarithms[:, k] += _matern(x / lengths, self._shown / lengths) @ self._weights[:, k]
        return np.asarray(logarithms)


def emulator_of(
    coordinates: si.FloatArray, logarithms: si.FloatArray, held_out: int = HELD_OUT
) -> Emulator:
    """The emulator of answers at solved points: `coordinates` (points, parameters), `logarithms`
    (points, answers). The last `held_out` points are not shown to it and give its error.

    Raises `InputError` for fewer points than `least_points` says.
    """
    x, y = np.asarray(coordinates, dtype=float), np.asarray(logarithms, dtype=float)
    if len(x) < least_points(x.shape[1]):
        raise InputError(
            f"{len(x)} solved plates are too few for an emulator of {x.shape[1]} parameters; "
            f"solve at least {least_points(x.shape[1])}, or calibrate fewer parameters"
        )
    shown = x[: len(x) - held_out]
    columns = [_fitted(shown, y[: len(shown), k]) for k in range(y.shape[1])]
    trends, lengths, weights = (np.stack([column[part] for column in columns]) for part in range(3))
    unjudged = Emulator(np.zeros(y.shape[1]), shown, trends.T, lengths, weights.T)
    off = unjudged(x[len(shown) :]) - y[len(shown) :]
    return replace(unjudged, errors=np.sqrt(np.mean(off**2, axis=0)))


def _with_one(x: si.FloatArray) -> si.FloatArray:
    return np.column_stack([np.ones(len(x)), x])


def _matern(a: si.FloatArray, b: si.FloatArray) -> si.FloatArray:
    """Matérn's covariance of order 5/2 between points, shape (points of a, points of b)."""
    squares = np.sum(a**2, axis=1)[:, None] + np.sum(b**2, axis=1)[None, :] - 2 * a @ b.T
    r = np.sqrt(5 * np.maximum(squares, 0.0))
    return np.asarray((1 + r + r**2 / 3) * np.exp(-r))


def _fitted(
    x: si.FloatArray, y: si.FloatArray
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    """Trend, lengths and weights of one answer, by the most likely lengths and nugget."""
    from scipy.linalg import cho_factor, cho_solve
    from scipy.optimize import Bounds, minimize

    count, d = x.shape
    trend = _with_one(x)
    if float(np.ptp(y)) < 1e-12:
        return np.r_[y[0], np.zeros(d)], np.full(d, _LENGTHS[1]), np.zeros(count)

    def at(logs: si.FloatArray) -> tuple[float, si.FloatArray, si.FloatArray]:
        scaled = x / np.exp(logs[:d])
        matrix = _matern(scaled, scaled) + np.exp(logs[d]) * np.eye(count)
        factor = cho_factor(matrix, lower=True)
        solved = cho_solve(factor, np.column_stack([trend, y]))
        line = np.linalg.solve(trend.T @ solved[:, :-1], trend.T @ solved[:, -1])
        weights = solved[:, -1] - solved[:, :-1] @ line
        variance = float((y - trend @ line) @ weights) / count
        held = _TRUST * float(np.sum((logs[:d] - np.log(_USUAL_LENGTH)) ** 2))
        determinant = float(np.sum(np.log(np.diag(factor[0]))))
        cost = count / 2 * float(np.log(max(variance, 1e-300))) + determinant + held
        return cost, np.asarray(line), np.asarray(weights)

    def cost(logs: si.FloatArray) -> float:
        return at(logs)[0]

    start: si.FloatArray = np.append(np.full(d, np.log(_USUAL_LENGTH)), np.log(1e-5))
    bounds = Bounds(*np.log([_LENGTHS] * d + [_NUGGETS]).T)
    best = minimize(cost, start, method="L-BFGS-B", bounds=bounds)
    _, line, weights = at(best.x)
    return line, np.exp(best.x[:d]), weights
