"""Least squares of a complex curve, or of its size, with relative noise: values, intervals, and
what is left over; and what is demanded of a sweep of impedance, and read off it, before.

Every fit of an admittance goes through here, so that all weigh alike, estimate noise alike and say
alike whether their model is adequate.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import optimize

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.measure.fits.estimate import Adequacy, Estimate, adequacy_of, propagated
from squeezefilm.measure.fits.least_squares import remembering
from squeezefilm.measure.recordings.kinds import ImpedanceSweep

Model = Callable[[si.FloatArray], tuple[si.Array, si.Array]]
"""Model of parameters (p,): the curve (points,) and its derivatives (p, points)."""

_PASSES = 3
# A floor under relative noise must be told by this much (twice the logarithm of the likelihood).
_EVIDENCE = 10.0
_FLOORS_TRIED = 30


@dataclass(frozen=True)
class Prior:
    """Knowledge of the parameters beforehand: independent normal distributions; an infinite
    `spread` says nothing."""

    mean: si.FloatArray
    spread: si.FloatArray


@dataclass(frozen=True, eq=False)
class ComplexFit:
    """A fitted curve: `parameters` (p,), `covariance` (p, p), the weighted `residual` and the
    `weighted` data (points,).

    `spread` is the standard deviation of a component of the residual; `correlation` is by how much
    its smoothness multiplies variances (1 where it is as rough as noise); `left` is the residual
    as it was recorded, in the geometric mean, by which fits are compared; `floor` is the size of
    data below which noise falls no further, 0 where it was not told. `information` (p, p) is what
    the data say alone, without the prior.
    """

    parameters: si.FloatArray
    covariance: si.FloatArray
    information: si.FloatArray
    residual: si.Array
    weighted: si.Array
    spread: si.Dimensionless
    correlation: si.Dimensionless
    left: float
    floor: float
    degrees_of_freedom: int

    @property
    def numbers(self) -> int:
        """Number of real numbers that were fitted: two a point, one where it is a size."""
        return _numbers(self.residual)

    def estimate(self, value: Callable[[si.FloatArray], float], unit: str) -> Estimate:
        """Estimate of what `value` makes of the parameters: see `propagated`."""
        return propagated(value, self.parameters, self.covariance, self.degrees_of_freedom, unit)


def fit_complex(
    model: Model,
    start: si.FloatArray,
    data: si.Array,
    prior: Prior | None = None,
) -> ComplexFit:
    """Fit `model` to `data` (points,) from `start`; its size to data that are real.

    Every point's noise is the same share of |Y|, down to a floor where the residual tells of one
    (`noise_floor`). |Y| is taken from the model and not from the noisy data, since these would pull
    the fit down (the estimate solves its weighted equations, as in generalised linear models). The
    noise is estimated from the residual. Where
    neighbouring residuals are alike the model misses something: variances are then multiplied by
    the residual's correlation time. Real and imaginary part are taken as equally noisy and
    independent. Raises `InputError` for too few points, `ConvergenceError` where no minimum is
    found.
    """
    count, points = start.size, data.size
    if _numbers(data) < count + 8:
        least = (count + 9) // 2 if np.iscomplexobj(data) else count + 8
        raise InputError(
            f"{points} points are too few to fit {count} parameters; give at least {least}"
        )
    parameters = np.asarray(start, dtype=float)
    prior = prior or Prior(parameters, np.full(count, np.inf))
    model = remembering(model if np.iscomplexobj(data) else _sizes_of(model))
    weight, floor = 1 / np.abs(data), 0.0
    for number in range(_PASSES):
        parameters = _minimum(model, parameters, data, weight, prior)
        curve = model(parameters)[0]
        # Once, so that the weights settle; not at last, so that they are fitted with.
        if number == 0:
            floor = noise_floor(data - curve, np.abs(curve))
        weight = 1 / np.hypot(np.abs(curve), floor)
    curve, slopes = model(parameters)
    residual, rows = (data - curve) * weight, _stacked(slopes * weight)
    freedom = _numbers(data) - (count - int(np.isfinite(prior.spread).sum()))
    spread = float(np.sqrt(np.sum(_stacked(residual) ** 2) / freedom))
    correlation = correlation_time(residual)
    information = rows @ rows.T / (spread**2 * correlation)
    return ComplexFit(
        parameters=parameters,
        covariance=_inverse(information + np.diag(1 / prior.spread**2)),
        information=information,
        residual=residual,
        weighted=data * weight,
        spread=spread,
        correlation=correlation,
        left=spread * float(np.exp(-np.mean(np.log(weight)))),
        floor=floor,
        degrees_of_freedom=max(int(freedom / correlation), 3),
    )


def _inverse(information: si.FloatArray) -> si.FloatArray:
    """The inverse, of parameters of very different sizes."""
    size = np.sqrt(np.diag(information))
    size[size == 0] = 1.0
    scale = np.outer(size, size)
    return np.asarray(np.linalg.pinv(information / scale, hermitian=True) / scale)


def _numbers(values: si.Array) -> int:
    return values.size * (2 if np.iscomplexobj(values) else 1)


def _sizes_of(model: Model) -> Model:
    """The model of a curve's size."""

    def sizes(parameters: si.FloatArray) -> tuple[si.Array, si.Array]:
        curve, slopes = model(parameters)
        size = np.abs(curve)
        return size, np.real(np.conj(curve) * slopes) / size

    return sizes


def _stacked(values: si.Array) -> si.FloatArray:
    if not np.iscomplexobj(values):
        return np.asarray(values, dtype=float)
    return np.concatenate([values.real, values.imag], axis=-1)


def _minimum(
    model: Model,
    start: si.FloatArray,
    data: si.Array,
    weight: si.FloatArray,
    prior: Prior,
) -> si.FloatArray:
    # A standard deviation of the prior weighs as much as noise that is not known yet: the spread of
    # what is left, times the root of its correlation time.
    left = (data - model(start)[0]) * weight
    scale = np.sqrt(np.mean(_stacked(left) ** 2)) * np.sqrt(correlation_time(left))
    known = np.isfinite(prior.spread)

    def residual(p: si.FloatArray) -> si.FloatArray:
        rows = _stacked((model(p)[0] - data) * weight)
        return np.append(rows, scale * ((p - prior.mean) / prior.spread)[known])

    def slopes(p: si.FloatArray) -> si.FloatArray:
        rows = _stacked(model(p)[1] * weight).T
        return np.vstack([rows, scale * np.diag(1 / prior.spread)[known]])

    settled = optimize.least_squares(
        residual, start, slopes, method="lm", x_scale="jac", xtol=1e-10, ftol=1e-12, max_nfev=200
    )
    if not settled.success or not np.all(np.isfinite(settled.x)):
        raise ConvergenceError(
            "the fit found no minimum within 200 steps; give a sweep that holds the resonance and "
            "some of both sides of it",
            iterations=int(settled.nfev),
        )
    return np.asarray(settled.x)


def noise_floor(residual: si.Array, size: si.FloatArray) -> float:
    """The size (as that of `size`, (points,)) below which noise falls no further: 0 for noise that
    is the same share of every point's size, as far as the residual tells.

    Noise of standard deviation s √(size² + floor²), by the likelihood of second differences of the
    residual, in which what is smooth drops out. An instrument without ranges has a floor; one that
    chooses its range at every point has none.
    """
    second = residual[2:] - 2 * residual[1:-1] + residual[:-2]
    # Neighbouring differences share points: a third of their numbers is independent.
    share = _numbers(second) / (3 * second.size)
    rows = np.abs(second) ** 2
    if rows.size < 8 or not np.all(size > 0) or not rows.any():
        return 0.0

    def deviance(floor: float) -> float:
        square = size**2 + floor**2
        square = (square[2:] + 4 * square[1:-1] + square[:-2]) / 6
        return float(share * (np.sum(np.log(square)) + rows.size * np.log(np.mean(rows / square))))

    # A floor far above the largest size is noise of one size everywhere.
    floors = np.geomspace(3e-3 * np.mean(size), 10.0 * np.max(size), _FLOORS_TRIED)
    tried = [deviance(float(floor)) for floor in floors]
    best = int(np.argmin(tried))
    return float(floors[best]) if deviance(0.0) - tried[best] > _EVIDENCE else 0.0


def correlation_time(residual: si.Array) -> float:
    """1 + 2 Σ ρ over lags until ρ first falls to noise, or 1 where the first lag's is noise.

    The factor by which neighbours that err alike multiply the variance of a mean (Sokal 1997).
    """
    power = float(np.sum(np.abs(residual) ** 2))
    if power == 0 or residual.size < 8:
        return 1.0
    # The standard error of a correlation of white noise.
    chance = 1 / np.sqrt(_numbers(residual))
    total = 1.0
    for lag in range(1, residual.size // 3):
        rho = float(np.real(np.vdot(residual[:-lag], residual[lag:]))) / power
        if rho < (4.0 if lag == 1 else 1.0) * chance:
            break
        total += 2 * rho
    return total


def sweep_adequacy(fit: ComplexFit, frequency: si.HertzArray, model: str) -> Adequacy:
    """Judge whether a `model` ("The circuit of one branch") describes a sweep: see
    `adequacy_of`."""
    said = f"Below {fit.floor:.2g} S noise falls no further. " if fit.floor else ""
    return adequacy_of(
        fit.weighted,
        fit.residual,
        lambda i: f"at {si.format_quantity(frequency[i], si.Unit('Hz'), 4)}",
        model=model,
        said=said,
        remedy="Find out why: another mode, a drift of the analyser, a fixture that was not "
        "compensated, or a drive so strong that the ceramic is no longer linear.",
    )


_FEWEST_POINTS = 16


@dataclass(frozen=True)
class SweepPeaks:
    """Peaks that can be read off a sweep without any model: the largest conductance (S) and the
    largest resistance (Ω), the real parts of Y and of 1/Y, and the frequencies (Hz) of both."""

    conductance_frequency: si.Hertz
    conductance: si.Siemens
    resistance_frequency: si.Hertz
    resistance: si.Ohm


def require_passive(sweep: ImpedanceSweep) -> None:
    """Refuse what is no sweep of a passive, capacitive body. Raises `InputError`.

    Off resonance, here the tenth of the points at either end, a body is a capacitor: its
    admittance leads by nearly 90°. Resonances and noise leave a real part that is positive on
    average. A sweep without a recorded phase has nothing of this to look at.
    """
    y, f = sweep.admittance, sweep.frequency
    if y.ndim != 1 or f.shape != y.shape or y.size < _FEWEST_POINTS:
        raise InputError(
            f"the sweep has {y.size} points; a fit needs at least {_FEWEST_POINTS}, on both sides "
            "of a resonance",
            quantity="admittance",
        )
    if not (np.all(np.isfinite(y)) and np.all(np.isfinite(f)) and np.all(y != 0)):
        raise InputError(
            "the sweep has points that are not finite or have no admittance at all; leave them "
            "out, missing points do no harm",
            quantity="admittance",
        )
    if f[0] <= 0 or np.any(np.diff(f) <= 0):
        raise InputError(
            "the frequencies do not rise; sort the points and join those at one frequency",
            quantity="frequency",
        )
    if not sweep.phase_recorded:
        return
    unit = y / np.abs(y)
    rim = max(2, y.size // 10)
    ends = np.concatenate([unit[:rim], unit[-rim:]])
    lead = math.degrees(math.atan2(float(np.median(ends.imag)), float(np.median(ends.real))))
    if float(np.mean(unit.real)) < 0:
        raise InputError(
            f"the sweep gives out power: the real part of its admittance is negative at "
            f"{int(np.sum(y.real < 0))} of {y.size} points, and away from resonance the admittance "
            f"leads by {lead:.0f}° where a capacitor's leads by up to 90°. The phase was probably "
            "recorded with an offset of 180°; look at it, and if so write correct = "
            '"phase 180 deg" in the TOML beside the recording',
            quantity="admittance",
        )
    if lead < 0:
        raise InputError(
            f"away from resonance the admittance leads by {lead:.0f}°, as that of a coil; a "
            "ceramic is a capacitor there and leads by up to 90°. The phase was probably recorded "
            "with the wrong sign, or as that of the admittance; look at it, and if so write "
            'correct = "phase sign" in the TOML beside the recording',
            quantity="admittance",
        )


def sweep_peaks(sweep: ImpedanceSweep) -> SweepPeaks:
    """The largest conductance and resistance, by a parabola through the three highest points of
    the inverse of each, which is one near a resonance. Noise makes them too large by some of it.
    Raises `InputError` as `fit_impedance` does.
    """
    require_passive(sweep)
    at_series = _peak(sweep.frequency, sweep.admittance.real)
    at_parallel = _peak(sweep.frequency, (1 / sweep.admittance).real)
    return SweepPeaks(*at_series, *at_parallel)


def _peak(frequency: si.HertzArray, values: si.FloatArray) -> tuple[float, float]:
    top = int(np.argmax(values))
    near = slice(max(top - 1, 0), top + 2)
    if values[near].size < 3 or np.any(values[near] <= 0):
        return float(frequency[top]), float(values[top])
    x = frequency[near] - frequency[top]
    a, b, c = np.polyfit(x, 1 / values[near], 2)
    if a <= 0 or not x[0] <= -b / (2 * a) <= x[-1]:
        return float(frequency[top]), float(values[top])
    return float(frequency[top] - b / (2 * a)), float(1 / (c - b**2 / (4 * a)))
