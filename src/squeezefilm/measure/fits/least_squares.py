"""Least squares of curves that a few numbers bend, and of those that are linear in all others.

A resonance, a wave along a line and a decay in time are sums of columns with unknown weights; only
frequency, wave number or loss bend the columns. The weights are eliminated at every step
(variable projection, Golub and Pereyra 1973, 10.1137/0710036, in Kaufman's form), so that a fit
needs starting values of the few bending numbers only. Steps are those of SciPy's trust region.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from scipy import optimize

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import Estimate, correlation_factor, propagated

Columns = Callable[[si.FloatArray], tuple[si.Array, si.Array]]
"""Function from bending numbers (p,) to columns (points, m) and derivatives (p, points, m)."""

_Answer = TypeVar("_Answer")
_MOST_STEPS = 200
_SETTLED = 1e-11


def remembering(
    function: Callable[[si.FloatArray], _Answer],
) -> Callable[[si.FloatArray], _Answer]:
    """The same function, which keeps its last answer: a fit asks for residual and derivatives one
    after the other."""
    last: dict[bytes, _Answer] = {}

    def remembered(at: si.FloatArray) -> _Answer:
        key = at.tobytes()
        if key not in last:
            last.clear()
            last[key] = function(at)
        return last[key]

    return remembered


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
    ) -> Estimate:
        """A number that follows from shape and weights: see `propagated`."""
        return propagated(
            lambda numbers: of(*self.split(numbers)),
            self.numbers,
            self.covariance,
            self.freedom,
            unit,
            positive=positive,
        )

    def angle(self, of: Callable[[si.FloatArray, si.Array], complex]) -> Estimate:
        """The angle (rad) of a complex number that follows from shape and weights, with an interval
        that is not cut at ±π."""
        own = complex(of(self.shape, self.weights))
        turned = self.estimate(
            lambda shape, weights: float(np.angle(of(shape, weights) * own.conjugate())), "rad"
        )
        angle = float(np.angle(own))
        low, high = turned.interval
        return replace(turned, value=angle, interval=(angle + low, angle + high))


def linear_fit(matrix: si.Array, data: si.Array) -> SeparableFit:
    """`fit_separable` of columns (points, m) that nothing bends."""
    bent = np.empty((0, *matrix.shape))
    return fit_separable(lambda _: (matrix, bent), data, np.empty(0))


def fit_separable(
    columns: Columns,
    data: si.Array,
    start: si.FloatArray,
    *,
    reach: float | si.FloatArray = np.inf,
) -> SeparableFit:
    """Shape and weights that describe `data` (points,) best in the sense of least squares.

    Complex data get complex weights. The shape stays within `reach` of its
    start. Raises `InputError` where there are fewer data than numbers.
    """
    both = np.iscomplexobj(data)
    wanted = np.concatenate([data.real, data.imag]) if both else np.asarray(data, dtype=float)

    def stacked(part: si.Array) -> si.FloatArray:
        if not both:
            return np.asarray(part, dtype=float)
        rows = np.concatenate([part.real, part.imag], axis=-2)
        other = np.concatenate([-part.imag, part.real], axis=-2)
        return np.concatenate([rows, other], axis=-1)

    def projected(shape: si.FloatArray) -> tuple[si.FloatArray, ...]:
        matrix, bent = (stacked(part) for part in columns(shape))
        weights, left, basis = _projected(matrix, wanted)
        return left, (bent @ weights).T, basis, matrix, weights

    at = remembering(projected)

    def slopes(shape: si.FloatArray) -> si.FloatArray:
        _, bent, basis, *_ = at(shape)
        return np.asarray(basis @ (basis.T @ bent) - bent)

    shape = np.asarray(start, dtype=float)
    if shape.size:
        shape = _least(lambda shape: at(shape)[0], slopes, shape, reach)
    left, bent, _, matrix, weights = at(shape)
    jacobian = np.concatenate([bent, matrix], axis=1)
    freedom = wanted.size - jacobian.shape[1]
    if freedom < 1:
        raise InputError(
            f"{wanted.size} numbers were recorded and {jacobian.shape[1]} are to be fitted; record "
            "more points, or fit fewer modes"
        )
    model = matrix @ weights
    covariance = float(left @ left) / freedom * _inverse_square(jacobian)
    n = data.size
    residual = left[:n] + 1j * left[n:] if both else left
    fitted = model[:n] + 1j * model[n:] if both else model
    m = weights.size // 2 if both else weights.size
    own = weights[:m] + 1j * weights[m:] if m < weights.size else weights
    widening = correlation_factor(residual)
    return SeparableFit(shape, own, covariance * widening**2, residual, fitted, freedom, widening)


def _projected(
    matrix: si.FloatArray, wanted: si.FloatArray
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    """The best weights of columns, what they leave, and an orthonormal basis of the columns."""
    size = _norms(matrix)
    basis, triangle = np.linalg.qr(matrix / size)
    share = basis.T @ wanted
    diagonal = np.abs(np.diag(triangle))
    if diagonal.min() > 1e-12:
        weights = np.linalg.solve(triangle, share)
    else:
        weights = np.linalg.lstsq(triangle, share, rcond=None)[0]
    return weights / size, wanted - basis @ share, basis


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
        self, of: Callable[[si.FloatArray], float], unit: str, *, positive: bool = False
    ) -> Estimate:
        """A number that follows from the fitted ones: see `propagated`."""
        return propagated(of, self.numbers, self.covariance, self.freedom, unit, positive=positive)


def fit_nonlinear(
    residual: Callable[[si.FloatArray], si.FloatArray], start: si.FloatArray, steps: si.FloatArray
) -> NonlinearFit:
    """The numbers (p,) that make the squares of `residual` (points,) least.

    Derivatives are central differences of `steps` (p,), more residuals than numbers are presumed.
    A residual that is not finite is walked around.
    """
    numbers = np.asarray(start, dtype=float)

    def slopes(at: si.FloatArray) -> si.FloatArray:
        moved = np.diag(steps)
        rows = [residual(at + step) - residual(at - step) for step in moved]
        return np.stack(rows, axis=1) / (2 * steps)

    numbers = _least(residual, slopes, numbers, np.inf)
    left = residual(numbers)
    freedom = left.size - numbers.size
    covariance = float(left @ left) / freedom * _inverse_square(slopes(numbers))
    return NonlinearFit(numbers, covariance, left, freedom)


def _least(
    residual: Callable[[si.FloatArray], si.FloatArray],
    slopes: Callable[[si.FloatArray], si.FloatArray],
    start: si.FloatArray,
    reach: float | si.FloatArray,
) -> si.FloatArray:
    """The numbers within `reach` of their start at which the squares of a residual are least.

    Raises `ArithmeticError` where SciPy meets an infinity, which a fit tells as it does its own.
    """
    try:
        with np.errstate(all="ignore"):
            settled = optimize.least_squares(
                residual,
                start,
                slopes,
                bounds=(start - reach, start + reach),
                x_scale="jac",
                ftol=_SETTLED,
                xtol=_SETTLED,
                gtol=None,
                max_nfev=_MOST_STEPS,
            )
    except InputError:
        raise
    except ValueError as error:
        raise ArithmeticError(f"its squares cannot be made least: {error}") from error
    return np.asarray(settled.x)


def _inverse_square(jacobian: si.FloatArray) -> si.FloatArray:
    """(JᵀJ)⁻¹, of columns of very different sizes."""
    size = _norms(jacobian)
    inverse = np.linalg.pinv(jacobian / size)
    return np.asarray(inverse @ inverse.T / np.outer(size, size))


def _norms(matrix: si.FloatArray) -> si.FloatArray:
    size = np.linalg.norm(matrix, axis=0)
    size[size == 0] = 1.0
    return np.asarray(size)
