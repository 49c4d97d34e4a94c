"""Response times: log-normal summaries over participants, and the ex-Gaussian by likelihood."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import optimize, stats
from scipy.special import erfcx, log_ndtr

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.study.identification.condition_means import condition_means
from squeezefilm.study.identification.confusion import one_per_trial

_MOST_VALUES = 20_000


@dataclass(frozen=True, slots=True)
class ResponseTimeSummary:
    """Response times of one condition.

    Attributes:
        name: of the condition.
        trials, participants: that have one.
        geometric_mean: of participants' geometric means (s).
        low, high: its t interval over participants (s), at `level`; NaN with one participant.
        level: of the interval.
        spread: standard deviation of ln(time) within participants (1).
        median: of all trials (s).
    """

    name: str
    trials: int
    participants: int
    geometric_mean: si.Second
    low: si.Second
    high: si.Second
    level: si.Dimensionless
    spread: si.Dimensionless
    median: si.Second


def response_time_summary(
    participant: ArrayLike,
    condition: ArrayLike,
    response_time: ArrayLike,
    names: tuple[str, ...],
    level: si.Dimensionless = 0.95,
) -> tuple[ResponseTimeSummary, ...]:
    """Summaries by condition; times of a participant count as log-normal.

    Args:
        participant: numbers from 0 up, shape (trials,).
        condition: number of the condition, shape (trials,), 0 to len(names) − 1.
        response_time: in s, shape (trials,), above 0; NaN for a time not taken.
        names: of the conditions; those without a time are left out.
        level: of the intervals.

    Raises:
        InputError: times not above 0, arrays of unequal length, or a level not between 0 and 1.
    """
    person, kind = (np.asarray(one, dtype=np.int64) for one in (participant, condition))
    given = np.asarray(response_time, dtype=float)
    one_per_trial(participant=person, condition=kind, response_time=given)
    taken = ~np.isnan(given)
    si.require("response_time", given[taken], si.Unit("s"), above=0.0)
    si.require("level", level, above=0.0, below=1.0)
    found = []
    for column in np.unique(kind[taken]).tolist():
        here = taken & (kind == column)
        who, logs = person[here], np.log(given[here])
        (one,) = condition_means(who, np.zeros_like(who), logs, (names[column],), level)
        own = np.bincount(who, logs) / np.maximum(np.bincount(who), 1)
        freedom = one.trials - one.participants
        found.append(
            ResponseTimeSummary(
                one.name,
                one.trials,
                one.participants,
                float(np.exp(one.mean)),
                float(np.exp(one.low)),
                float(np.exp(one.high)),
                level,
                math.sqrt(((logs - own[who]) ** 2).sum() / freedom) if freedom else math.nan,
                float(np.median(given[here])),
            )
        )
    return tuple(found)


@dataclass(frozen=True, slots=True)
class ExGaussian:
    """A normal deviate plus an exponential one (Hohle 1965; Luce 1986).

    Attributes:
        mean, spread: μ and σ of the normal part (s).
        tail: mean of the exponential part τ (s); μ + τ is the mean time.
        log_likelihood: per value.
        values: how many times the fit used.
    """

    mean: si.Second
    spread: si.Second
    tail: si.Second
    log_likelihood: si.Dimensionless
    values: int


def fit_ex_gaussian(response_time: ArrayLike, seed: int = 0) -> ExGaussian:
    """Fit an ex-Gaussian by maximum likelihood.

    More than 20 000 times are thinned to that many by a draw without replacement: the estimates'
    errors are below 1 % of τ by then.

    Args:
        response_time: in s, above 0, any shape; NaN is left out.
        seed: of the draw.

    Raises:
        InputError: fewer than 10 times, times not above 0, or all equal.
        ConvergenceError: the optimiser found no maximum.
    """
    times = np.asarray(response_time, dtype=float).ravel()
    times = times[~np.isnan(times)]
    si.require("response_time", times, si.Unit("s"), above=0.0)
    if times.size < 10 or np.ptp(times) == 0.0:
        raise InputError(
            f"{times.size} response times (or equal ones) have no ex-Gaussian; give 10 that differ"
        )
    if times.size > _MOST_VALUES:
        times = np.random.default_rng(seed).choice(times, _MOST_VALUES, replace=False)
    centre, deviation = float(times.mean()), float(times.std())
    z = (times - centre) / deviation
    skew = float(np.clip(stats.skew(z), 0.05, 1.9))
    tail = (skew / 2) ** (1 / 3)
    start = np.array([-tail, 0.5 * np.log(1 - tail**2), np.log(tail)])

    def cost(values: si.FloatArray) -> float:
        return -float(_log_density(z, values[0], np.exp(values[1]), np.exp(values[2])).mean())

    # σ → 0 and τ → 0 are limits, not solutions: keep to a thousandth of the deviation.
    bounds = [(-8.0, 8.0), (np.log(1e-3), np.log(5.0)), (np.log(1e-3), np.log(5.0))]
    done = optimize.minimize(cost, start, method="L-BFGS-B", bounds=bounds)
    if not np.isfinite(done.fun):
        raise ConvergenceError(f"no ex-Gaussian fits the response times: {done.message}")
    mean, spread, tail = done.x[0], np.exp(done.x[1]), np.exp(done.x[2])
    return ExGaussian(
        centre + deviation * float(mean),
        deviation * float(spread),
        deviation * float(tail),
        -float(done.fun) - float(np.log(deviation)),
        times.size,
    )


def ex_gaussian_density(time: ArrayLike, fit: ExGaussian) -> si.FloatArray:
    """Density of a fitted ex-Gaussian (1/s) at times (s), the same shape."""
    t = np.asarray(time, dtype=float)
    return np.asarray(np.exp(_log_density(t, fit.mean, fit.spread, fit.tail)))


def _log_density(x: si.FloatArray, mean: float, spread: float, tail: float) -> si.FloatArray:
    """ln of (1/τ) exp(σ²/2τ² − (x−μ)/τ) Φ((x−μ)/σ − σ/τ), without overflow for small τ."""
    u = (x - mean) / spread
    v = u - spread / tail
    # exp(−u²/2) erfcx(−v/√2) is the same product where both factors would overflow.
    low = -0.5 * u**2 + np.log(0.5 * erfcx(-np.minimum(v, 0.0) / np.sqrt(2)))
    high = 0.5 * (spread / tail) ** 2 - (x - mean) / tail + log_ndtr(np.maximum(v, 0.0))
    return np.asarray(np.where(v < 0, low, high) - np.log(tail))
