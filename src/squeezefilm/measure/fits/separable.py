"""Least squares of curves that are linear in most of their numbers, and bent by a few.

A resonance, a wave along a line and a decay in time are sums of columns with unknown weights; only
frequency, wave number or loss bend the columns. The weights are eliminated at every step
(variable projection, Golub and Pereyra 1973, 10.1137/0710036, in Kaufman's form), so that a fit
needs starting values of the few bending numbers only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import Estimate
from squeezefilm.measure.fits.misfit import correlation_factor
from squeezefilm.measure.fits.nonlinear import propagated

Columns = Callable[[si.FloatArray], tuple[si.Array, si.Array]]
"""From the bending numbers (p,) to the columns (points, m) and their derivatives (p, points, m)."""

_MOST_STEPS = 60
_SETTLED = 1e-10


@dataclass(frozen=True, eq=False)
class SeparableFit:
    """Bending numbers `shape` (p,), `weights` (m,) of the columns, and what they leave.

    `covariance` is that of `shape`, then the weights' real and (where they are complex) imaginary
    parts, of independent noise alike in every real number of the data, with `freedom` degrees of
    freedom; `widening` multiplies every standard error, above 1 where neighbouring residuals are
    alike, so that the data say less than they are many. `covariance` has it in.
    """

    shape: si.FloatArray
    weights: si.Array
    covariance: si.FloatArray
    residual: si.Array
    model: si.Array
    freedom: int
    widening: float

    @property
    def numbers(self) -> si.FloatArray:
        """All fitted numbers in the order of `covariance`."""
        parts = [self.shape, self.weights.real]
        return np.concatenate([*parts, self.weights.imag] if self._complex else parts)

    @property
    def _complex(self) -> bool:
        return bool(self.covariance.shape[0] > self.shape.size + self.weights.size)

    def with_widening(self, widening: float) -> SeparableFit:
        """The same fit with standard errors `widening` times those of independent noise."""
        scale = (widening / self.widening) ** 2
        return replace(self, covariance=self.covariance * scale, widening=widening)

    def split(self, numbers: si.FloatArray) -> tuple[si.FloatArray, si.Array]:
        """Shape and weights out of all numbers in one row."""
        p, m = self.shape.size, self.weights.size
        real = numbers[p : p + m]
        return numbers[:p], real + 1j * numbers[p + m :] if self._complex else real

    def estimate(
        self,
        of: Callable[[si.FloatArray, si.Array], float],
        unit: str,
        *,
        positive: bool = False,
        level: si.Dimensionless = 0.95,
    ) -> Estimate:
        """A number that follows from shape and weights: see `propagated`."""
        return propagated(
            lambda numbers: of(*self.split(numbers)),
            self.numbers,
            self.covariance,
            self.freedom,
            unit,
            positive=positive,
            level=level,
        )


def fit_separable(
    columns: Columns,
    data: si.Array,
    start: si.FloatArray,
    *,
    real_weights: bool = False,
    reach: float | si.FloatArray = np.inf,
) -> SeparableFit:
    """Shape and weights that describe `data` (points,) best in the sense of least squares.

    Complex data get complex weights unless `real_weights`. The shape stays within `reach` of its
    start. Raises `InputError` where there are fewer data than numbers.
    """
    both = np.iscomplexobj(data)

    def stacked(part: si.Array) -> si.FloatArray:
        if not both:
            return np.asarray(part, dtype=float)
        rows = np.concatenate([part.real, part.imag], axis=-2)
        if real_weights:
            return rows
        other = np.concatenate([-part.imag, part.real], axis=-2)
        return np.concatenate([rows, other], axis=-1)

    def at(shape: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
        found, bent = columns(shape)
        return stacked(found), stacked(bent)

    wanted = np.concatenate([data.real, data.imag]) if both else np.asarray(data, dtype=float)
    shape, weights, matrix, bent = _settled(at, wanted, np.asarray(start, dtype=float), reach)
    jacobian = np.concatenate([(bent @ weights).T, matrix], axis=1)
    freedom = wanted.size - jacobian.shape[1]
    if freedom < 1:
        raise InputError(
            f"{wanted.size} numbers were recorded and {jacobian.shape[1]} are to be fitted; record "
            "more points, or fit fewer modes"
        )
    model = matrix @ weights
    left = wanted - model
    size = np.linalg.norm(jacobian, axis=0)
    size[size == 0] = 1.0
    inverse = np.linalg.pinv(jacobian / size)
    covariance = float(left @ left) / freedom * (inverse @ inverse.T) / np.outer(size, size)
    n = data.size
    residual = left[:n] + 1j * left[n:] if both else left
    fitted = model[:n] + 1j * model[n:] if both else model
    m = weights.size // 2 if both and not real_weights else weights.size
    own = weights[:m] + 1j * weights[m:] if m < weights.size else weights
    widening = correlation_factor(residual)
    return SeparableFit(shape, own, covariance * widening**2, residual, fitted, freedom, widening)


def _settled(
    at: Callable[[si.FloatArray], tuple[si.FloatArray, si.FloatArray]],
    wanted: si.FloatArray,
    start: si.FloatArray,
    reach: float | si.FloatArray,
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray, si.FloatArray]:
    """Shape, weights, matrix and its derivatives where the squares are least, by Levenberg and
    Marquardt's damping."""
    shape = start
    matrix, bent = at(shape)
    weights, left, basis = _projected(matrix, wanted)
    least, damping = float(left @ left), 1e-3
    for _ in range(_MOST_STEPS if shape.size else 0):
        slopes = (bent @ weights).T
        slopes = slopes - basis @ (basis.T @ slopes)
        size = np.linalg.norm(slopes, axis=0)
        size[size == 0] = 1.0
        normal, toward = (slopes / size).T @ (slopes / size), (slopes / size).T @ left
        moved = False
        while damping < 1e12:
            step = np.linalg.solve(normal + damping * np.eye(shape.size), toward) / size
            if np.all(np.abs(shape + step - start) <= reach):
                other, other_bent = at(shape + step)
                new_weights, new_left, new_basis = _projected(other, wanted)
                squares = float(new_left @ new_left)
                if squares <= least:
                    moved = True
                    break
            damping *= 10
        if not moved:
            break
        gain, least = least - squares, squares
        shape, matrix, bent = shape + step, other, other_bent
        weights, left, basis = new_weights, new_left, new_basis
        damping = max(damping / 10, 1e-12)
        if gain <= _SETTLED * least:
            break
    return shape, weights, matrix, bent


def _projected(
    matrix: si.FloatArray, wanted: si.FloatArray
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    """The best weights of columns, what they leave, and an orthonormal basis of the columns."""
    size = np.linalg.norm(matrix, axis=0)
    size[size == 0] = 1.0
    basis, triangle = np.linalg.qr(matrix / size)
    share = basis.T @ wanted
    diagonal = np.abs(np.diag(triangle))
    if diagonal.min() > 1e-12:
        weights = np.linalg.solve(triangle, share)
    else:
        weights = np.linalg.lstsq(triangle, share, rcond=None)[0]
    return weights / size, wanted - basis @ share, basis
