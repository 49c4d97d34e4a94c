"""Response times: log-normal summaries over participants, and the ex-Gaussian by likelihood."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import optimize, stats
from scipy.special import erfcx, log_ndtr

from squeezefilm import quantities as si
from squeezefilm.errors import ConvergenceError, InputError

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
    si.require("level", level, above=0.0, below=1.0)
    person, kind, times = _three(participant, condition, response_time)
    people = int(person.max()) + 1 if person.size else 0
    logs = np.log(times)
    group = person * len(names) + kind
    size = people * len(names)
    count = np.bincount(group, minlength=size).reshape(people, len(names))
    total = np.bincount(group, logs, size).reshape(people, len(names))
    square = np.bincount(group, logs**2, size).reshape(people, len(names))
    found = []
    for column, name in enumerate(names):
        n, some = count[:, column], count[:, column] > 0
        if not np.any(some):
            continue
        means = total[some, column] / n[some]
        inner = np.maximum(square[some, column] - n[some] * means**2, 0.0).sum()
        freedom = int(n[some].sum() - some.sum())
        centre, half = float(means.mean()), float("nan")
        if means.size > 1:
            t = float(stats.t.isf((1 - level) / 2, means.size - 1))
            half = t * float(means.std(ddof=1)) / np.sqrt(means.size)
        found.append(
            ResponseTimeSummary(
                name,
                int(n.sum()),
                int(some.sum()),
                float(np.exp(centre)),
                float(np.exp(centre - half)),
                float(np.exp(centre + half)),
                level,
                float(np.sqrt(inner / freedom)) if freedom else float("nan"),
                float(np.median(times[kind == column])),
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


def _three(
    a: ArrayLike, b: ArrayLike, c: ArrayLike
) -> tuple[si.IntArray, si.IntArray, si.FloatArray]:
    person = np.asarray(a, dtype=np.int64)
    kind, times = np.asarray(b, dtype=np.int64), np.asarray(c, dtype=float)
    if not person.ndim == 1 or not person.shape == kind.shape == times.shape:
        raise InputError(
            "participant, condition and response_time must have one value a trial; their shapes "
            f"are {person.shape}, {kind.shape} and {times.shape}"
        )
    taken = ~np.isnan(times)
    si.require("response_time", times[taken], si.Unit("s"), above=0.0)
    return person[taken], kind[taken], times[taken]
