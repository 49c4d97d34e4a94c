"""Intervals and goodness of fit of a psychometric function by parametric bootstrap.

The usual percentiles of refitted parameters cover too seldom: the estimates of width and lapse
rate are skewed and biased, and where the lapse rate is at its bound they pile up there. What is
simulated here is therefore the deviance instead: how far ln density falls when one parameter is
held at its true value. An interval holds the values whose profile deviance is no larger than the
level's quantile of the simulated ones. It does not depend on how a parameter is written.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from squeezefilm.quantities import Dimensionless, DimensionlessArray, FloatArray, require
from squeezefilm.study import psychometric_kernel as kernel
from squeezefilm.study.psychometric_kernel import BoolArray

# How near to the end of an interval, as a share of the prior's range.
_NEAR = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class PenalisedLikelihood:
    """The data and the prior of one fit, as the kernel takes them; θ as the kernel's.

    Attributes:
        code: of the shape.
        free: which of the four parameters are fitted.
        low, high: bounds of θ, shape (4,).
        beta: exponents of the Beta priors of lapse and guess rate, shape (4,).
        x, k, n: places on the axis, answers, trials, shape (places,).
    """

    code: int
    free: BoolArray
    low: FloatArray
    high: FloatArray
    beta: FloatArray
    x: FloatArray
    k: FloatArray
    n: FloatArray

    def maximum(self, start: FloatArray, free: BoolArray | None = None) -> tuple[FloatArray, float]:
        """θ of the largest ln density near a start, and that ln density."""
        theta = start.copy()
        value = kernel.maximise(
            self.code,
            theta,
            self.free if free is None else free,
            self.low,
            self.high,
            self.beta,
            self.x,
            self.k,
            self.n,
        )
        return theta, value


@dataclass(frozen=True, slots=True, eq=False)
class Bootstrap:
    """A parametric bootstrap of a fit.

    Attributes:
        best: θ of the fit, from which answers were simulated, shape (4,).
        estimates: θ of the refits, shape (replicates, 4).
        drops: twice the fall of ln density with one parameter held at `best`,
            shape (replicates, 4).
        deviances: of the refits from the saturated model, shape (replicates,).
    """

    best: FloatArray
    estimates: FloatArray
    drops: FloatArray
    deviances: DimensionlessArray

    def percentiles(self, parameter: int, level: Dimensionless) -> tuple[float, float]:
        """The plain percentile interval of θ; it covers less than its level in small samples."""
        tail = 0.5 * (1.0 - level)
        low, high = np.quantile(self.estimates[:, parameter], [tail, 1.0 - tail])
        return float(low), float(high)

    def goodness_of_fit(self, deviance: float) -> Dimensionless:
        """Probability of a deviance at least as large if the fitted function were the truth."""
        larger = int(np.count_nonzero(self.deviances >= deviance - 1e-9))
        return (1 + larger) / (1 + self.deviances.size)


def simulate_bootstrap(
    likelihood: PenalisedLikelihood, best: FloatArray, replicates: int, seed: int
) -> Bootstrap:
    """Simulate answers at the places and trials of the data and refit them.

    Where the places depended on the answers (a staircase, a Bayesian choice) they are kept as
    they were: the bootstrap is conditional on them.

    Raises:
        InputError: fewer than 39 replicates, which cannot tell a 95 % interval.
    """
    require("replicates", replicates, at_least=39)
    random = np.random.default_rng(seed)
    truth = kernel.probabilities(likelihood.code, best, likelihood.x)
    answers = random.binomial(
        likelihood.n.astype(np.int64), truth, size=(replicates, truth.size)
    ).astype(float)
    estimates, drops = np.empty((replicates, 4)), np.empty((replicates, 4))
    deviances = np.empty(replicates)
    kernel.bootstrap(
        likelihood.code,
        best,
        likelihood.free,
        likelihood.low,
        likelihood.high,
        likelihood.beta,
        likelihood.x,
        likelihood.n,
        answers,
        estimates,
        drops,
        deviances,
    )
    return Bootstrap(best, estimates, drops, deviances)


def calibrated_interval(
    likelihood: PenalisedLikelihood, bootstrap: Bootstrap, parameter: int, level: Dimensionless
) -> tuple[float, float]:
    """The values of one θ whose profile deviance is within the bootstrap's quantile of it.

    An end that the data do not bound lies at the prior's bound.
    """
    drops = np.sort(bootstrap.drops[:, parameter])
    rank = math.ceil(level * (drops.size + 1)) - 1
    allowed = float(drops[min(rank, drops.size - 1)])
    _, top = likelihood.maximum(bootstrap.best)
    ends = [
        _end(likelihood, bootstrap.best, top, parameter, allowed, float(bound))
        for bound in (likelihood.low[parameter], likelihood.high[parameter])
    ]
    return ends[0], ends[1]


def _end(
    likelihood: PenalisedLikelihood,
    best: FloatArray,
    top: float,
    parameter: int,
    allowed: float,
    bound: float,
) -> float:
    free = likelihood.free.copy()
    free[parameter] = False
    centre = float(best[parameter])
    reach = float(likelihood.high[parameter] - likelihood.low[parameter])
    inside, start = centre, best
    step = math.copysign(reach / 32, bound - centre)
    outside = centre
    # March outwards, each fit starting from the one before, to the first value not allowed.
    while True:
        outside = inside + step
        if (outside - bound) * step >= 0:
            outside = bound
        theta = start.copy()
        theta[parameter] = outside
        theta, value = likelihood.maximum(theta, free)
        if 2.0 * (top - value) > allowed:
            break
        inside, start = outside, theta
        if outside == bound:
            return bound
    while abs(outside - inside) > _NEAR * reach:
        middle = 0.5 * (inside + outside)
        theta = start.copy()
        theta[parameter] = middle
        theta, value = likelihood.maximum(theta, free)
        if 2.0 * (top - value) > allowed:
            outside = middle
        else:
            inside, start = middle, theta
    return 0.5 * (inside + outside)
