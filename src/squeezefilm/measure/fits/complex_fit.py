"""Least squares of a complex curve with relative noise: values, intervals, and what is left over.

Every fit of an admittance goes through here, so that all weigh alike, estimate noise alike and say
alike whether their model is adequate.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import optimize, stats

from squeezefilm import quantities as si
from squeezefilm.errors import ConvergenceError, InputError
from squeezefilm.measure.fits.estimate import Adequacy, Estimate

Model = Callable[[si.FloatArray], tuple[si.ComplexArray, si.ComplexArray]]
"""Of parameters (p,): the curve (points,) and its derivatives (p, points)."""

Weighing = Literal["relative", "absolute"]

LEVEL = 0.95
SMALL_MISFIT = 0.01
"""Misfit beyond noise, of |data| on average, up to which a model is called adequate: what bench
analysers and fixtures leave uncertain in the best of cases (assumed)."""

ROUGH_MISFIT = 0.03
"""Misfit up to which a model that is not adequate still gives its numbers roughly (assumed)."""

_LARGE_MISFIT_SOMEWHERE = 0.06
_PASSES = 3


@dataclass(frozen=True)
class Prior:
    """What is known beforehand of the parameters: independent normal distributions; an infinite
    `spread` says nothing."""

    mean: si.FloatArray
    spread: si.FloatArray


@dataclass(frozen=True, eq=False)
class ComplexFit:
    """A fitted curve: `parameters` (p,), `covariance` (p, p), the weighted `residual` (points,).

    `noise` is the standard deviation of a component of the residual that is left between
    neighbouring points, `spread` that of the whole residual; `correlation` is by how much the
    residual's smoothness multiplies variances (1 where it is as rough as noise).
    `information` (p, p) is what the data say alone, without the prior.
    """

    parameters: si.FloatArray
    covariance: si.FloatArray
    information: si.FloatArray
    residual: si.ComplexArray
    noise: si.Dimensionless
    spread: si.Dimensionless
    correlation: si.Dimensionless
    degrees_of_freedom: int

    def estimate(
        self, value: Callable[[si.FloatArray], float], unit: str, least: float = -np.inf
    ) -> Estimate:
        """What `value` makes of the parameters, with its 95 % interval to first order; `least`
        is what it cannot fall below."""
        best = value(self.parameters)
        slope = gradient(value, self.parameters, np.sqrt(np.diag(self.covariance)))
        error = math.sqrt(max(float(slope @ self.covariance @ slope), 0.0))
        reach = error * float(stats.t.ppf((1 + LEVEL) / 2, self.degrees_of_freedom))
        return Estimate(best, error, (max(best - reach, least), best + reach), unit, LEVEL)

    @property
    def misfit(self) -> si.Dimensionless:
        """The mean |residual| that noise does not explain."""
        return float(np.sqrt(np.pi / 2 * max(self.spread**2 - self.noise**2, 0.0)))


def gradient(
    value: Callable[[si.FloatArray], float], at: si.FloatArray, steps: si.FloatArray
) -> si.FloatArray:
    """Central differences of `value`, a hundredth of a standard error to either side."""
    slope = np.zeros(at.size)
    for k, step in enumerate(np.maximum(0.01 * steps, 1e-9 * np.abs(at) + 1e-15)):
        up, down = at.copy(), at.copy()
        up[k] += step
        down[k] -= step
        slope[k] = (value(up) - value(down)) / (2 * step)
    return slope


def fit_complex(
    model: Model,
    start: si.FloatArray,
    data: si.ComplexArray,
    *,
    weighing: Weighing = "relative",
    prior: Prior | None = None,
) -> ComplexFit:
    """Fit `model` to `data` (points,) from `start`.

    Relative: every point's noise is the same share of |Y|, which is taken from the model and not
    from the noisy data, since these would pull the fit down (the estimate solves its weighted
    equations, as in generalised linear models). Absolute: the same noise everywhere. The noise is
    estimated from the residual. Where neighbouring residuals are alike the model misses something:
    variances are then multiplied by the residual's correlation time. Real and imaginary part are
    taken as equally noisy and independent. Raises `InputError` for too few points,
    `ConvergenceError` where no minimum is found.
    """
    count, points = start.size, data.size
    if 2 * points < count + 8:
        raise InputError(
            f"{points} points are too few to fit {count} parameters; "
            f"give at least {(count + 9) // 2}"
        )
    parameters = np.asarray(start, dtype=float)
    weight = np.full(points, 1 / np.mean(np.abs(data)))
    if weighing == "relative":
        weight = 1 / np.abs(data)
    for _ in range(_PASSES if weighing == "relative" else 1):
        scale = _prior_scale(model, parameters, data, weight) if prior is not None else 1.0
        parameters = _minimum(model, parameters, data, weight, prior, scale)
        if weighing == "relative":
            weight = 1 / np.abs(model(parameters)[0])
    curve, slopes = model(parameters)
    return _fitted(parameters, (data - curve) * weight, slopes * weight, prior)


def _stacked(values: si.ComplexArray) -> si.FloatArray:
    return np.concatenate([values.real, values.imag], axis=-1)


def _prior_scale(
    model: Model, parameters: si.FloatArray, data: si.ComplexArray, weight: si.FloatArray
) -> float:
    """What a prior of one standard deviation counts beside residuals of which the noise is not yet
    known: their spread, times the root of their correlation time."""
    residual = (data - model(parameters)[0]) * weight
    spread = float(np.sqrt(np.mean(_stacked(residual) ** 2)))
    return spread * float(np.sqrt(correlation_time(residual)))


def _minimum(
    model: Model,
    start: si.FloatArray,
    data: si.ComplexArray,
    weight: si.FloatArray,
    prior: Prior | None,
    scale: float,
) -> si.FloatArray:
    known = None if prior is None else np.isfinite(prior.spread)

    def residual(p: si.FloatArray) -> si.FloatArray:
        rows = _stacked((model(p)[0] - data) * weight)
        if prior is not None:
            rows = np.append(rows, scale * ((p - prior.mean) / prior.spread)[known])
        return rows

    def slopes(p: si.FloatArray) -> si.FloatArray:
        rows = _stacked(model(p)[1] * weight).T
        if prior is not None:
            rows = np.vstack([rows, scale * np.diag(1 / prior.spread)[known]])
        return rows

    found = optimize.least_squares(
        residual, start, slopes, method="lm", x_scale="jac", xtol=1e-10, ftol=1e-12, max_nfev=200
    )
    if not found.success or not np.all(np.isfinite(found.x)):
        raise ConvergenceError(
            "the fit found no minimum within 200 steps; give a sweep that holds the resonance and "
            "some of both sides of it",
            iterations=int(found.nfev),
        )
    return np.asarray(found.x)


def _fitted(
    parameters: si.FloatArray,
    residual: si.ComplexArray,
    slopes: si.ComplexArray,
    prior: Prior | None,
) -> ComplexFit:
    rows = _stacked(slopes)
    told = 0 if prior is None else int(np.isfinite(prior.spread).sum())
    freedom = 2 * residual.size - (parameters.size - told)
    spread = float(np.sqrt(np.sum(_stacked(residual) ** 2) / freedom))
    correlation = correlation_time(residual)
    information = rows @ rows.T / (spread**2 * correlation)
    whole = information.copy()
    if prior is not None:
        whole += np.diag(1 / prior.spread**2)
    # Parameters of very different sizes: scaled before they are inverted.
    size = np.sqrt(np.diag(whole))
    size[size == 0] = 1.0
    covariance = np.linalg.pinv(whole / np.outer(size, size), hermitian=True)
    return ComplexFit(
        parameters=parameters,
        covariance=covariance / np.outer(size, size),
        information=information,
        residual=residual,
        noise=min(roughness(residual), spread),
        spread=spread,
        correlation=correlation,
        degrees_of_freedom=max(int(freedom / correlation), 3),
    )


def roughness(residual: si.ComplexArray) -> si.Dimensionless:
    """The standard deviation of a component that second differences of neighbours leave: what is
    smooth in a residual drops out. Median of squares, so that few outliers do not count."""
    if residual.size < 3:
        return 0.0
    second = residual[2:] - 2 * residual[1:-1] + residual[:-2]
    # White noise of standard deviation s has second differences of √6 s; |complex|² over s² has
    # a median of 2 ln 2.
    return float(np.sqrt(np.median(np.abs(second) ** 2) / 6 / (2 * np.log(2))))


def correlation_time(residual: si.ComplexArray) -> float:
    """1 + 2 Σ ρ over lags until ρ first falls to noise, or 1 where the first lag's is noise.

    The factor by which neighbours that err alike multiply the variance of a mean (Sokal 1997).
    """
    power = float(np.sum(np.abs(residual) ** 2))
    if power == 0 or residual.size < 8:
        return 1.0
    # Two components a point: the standard error of a correlation of white noise.
    chance = 1 / np.sqrt(2 * residual.size)
    total = 1.0
    for lag in range(1, residual.size // 3):
        rho = float(np.real(np.vdot(residual[:-lag], residual[lag:]))) / power
        if rho < (4.0 if lag == 1 else 1.0) * chance:
            break
        total += 2 * rho
    return total


def adequacy_of(fit: ComplexFit, frequency: si.HertzArray, what: str) -> Adequacy:
    """Whether `what` (a circuit, a bar) describes the sweep: mean |ΔY|/|Y| beside what noise alone
    would leave, and the frequency where it is worst."""
    size = np.abs(fit.residual)
    residual = float(np.mean(size))
    noise = float(fit.noise * np.sqrt(np.pi / 2))
    # The worst place of a smoothed residual: one outlier is no misfit.
    window = min(5, size.size)
    smooth = np.abs(np.convolve(fit.residual, np.ones(window) / window, mode="same"))
    worst = int(np.argmax(smooth))
    # Smoothing leaves noise too: what is above four of its standard deviations is no noise.
    beyond = float(smooth[worst]) - 4 * fit.noise / np.sqrt(window)
    adequate = fit.misfit <= SMALL_MISFIT and beyond <= _LARGE_MISFIT_SOMEWHERE
    where = f"at {frequency[worst] / 1e3:.5g} kHz, by {100 * float(smooth[worst]):.2g} %"
    left = (
        f"{what} lies {100 * residual:.2g} % from the data on average; noise alone would leave "
        f"{100 * noise:.2g} %."
    )
    if adequate and fit.correlation == 1.0:
        return Adequacy(True, residual, noise, where, f"{left} It describes the sweep.")
    if adequate:
        sentence = (
            f"{left} What is left is not noise, but small (most {where}): the intervals are "
            "widened for it."
        )
        return Adequacy(True, residual, noise, where, sentence)
    if fit.misfit <= ROUGH_MISFIT and beyond <= 2 * _LARGE_MISFIT_SOMEWHERE:
        sentence = (
            f"{left} It describes the sweep only roughly (it misses most {where}): its resonances "
            "can be used, the intervals are no bound."
        )
        return Adequacy(False, residual, noise, where, sentence)
    sentence = (
        f"{left} It does not describe the sweep: it misses most {where}. Do not use its numbers "
        "before you know why: another mode, a drift of the analyser, a fixture that was not "
        "compensated, or a drive so strong that the ceramic is no longer linear."
    )
    return Adequacy(False, residual, noise, where, sentence)
