"""Intervals and goodness of fit of a psychometric function by parametric bootstrap.

The usual percentiles of refitted parameters cover too seldom: the estimates of width and lapse
rate are skewed and biased, and a lapse rate at its bound makes the simulated people better than
the real one. Simulating the deviance at the fit instead has the same second fault. What is done
here is to invert a test (the grid bootstrap of Hansen 1999, 10.1162/003465399558463): a value of a
parameter belongs to the interval if the deviance of holding it there is no larger than the
level's quantile of the deviances simulated with that very value as the truth, the other
parameters fitted under it. The interval does not depend on how a parameter is written.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from scipy.special import bdtr, chdtri

from squeezefilm.core import quantities as si
from squeezefilm.study.psychometric import kernel
from squeezefilm.study.psychometric.kernel import BoolArray

# How near to the end of an interval: for a given quantile of the deviance as a share of the
# prior's range, and from one simulated quantile to the next as a share of the distance from the
# best value; chance moves the quantile of 1000 deviances by more.
_NEAR = 1e-4
_CLOSE = 0.01
_MOST_ROUNDS = 4
# How many new experiments those weighed for another truth must be worth, as a share of a set.
_WORTH = 0.5


class Simulated(NamedTuple):
    """Simulated experiments: places, answers and trials in the first `used` columns of a row;
    shapes (replicates, places), `used` (replicates,)."""

    x: si.FloatArray
    k: si.FloatArray
    n: si.FloatArray
    used: si.IntArray


class Experiment(Protocol):
    """Does the experiment again, with simulated people of known θ.

    `dear` says that simulating takes longer than fitting: what was simulated at some truths is then
    weighed for others near by.
    """

    @property
    def dear(self) -> bool:
        """True where simulating takes longer than fitting."""
        ...

    def __call__(self, theta: si.FloatArray) -> Simulated:
        """Experiments with people of θ."""
        ...


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
    low: si.FloatArray
    high: si.FloatArray
    beta: si.FloatArray
    x: si.FloatArray
    k: si.FloatArray
    n: si.FloatArray

    def model(self, free: BoolArray | None = None) -> kernel.Model:
        """What is fitted, as the kernel takes it; with other parameters free, where given."""
        some = self.free if free is None else free
        return kernel.Model(self.code, some, self.low, self.high, self.beta)

    def maximum(
        self, start: si.FloatArray, free: BoolArray | None = None
    ) -> tuple[si.FloatArray, float]:
        """θ of the largest ln density near a start, and that ln density."""
        theta = start.copy()
        return theta, kernel.maximise(self.model(free), theta, self.x, self.k, self.n)


@dataclass(frozen=True, slots=True, eq=False)
class Bootstrap:
    """Answers simulated at a fit, and refitted.

    Attributes:
        best: θ of the fit, from which answers were simulated, shape (4,).
        estimates: θ of the refits, shape (replicates, 4).
        deviances: of the refits from the saturated model, shape (replicates,).
        shares: the random numbers, uniform in 0 to 1, shape (replicates, places).
    """

    best: si.FloatArray
    estimates: si.FloatArray
    deviances: si.DimensionlessArray
    shares: si.DimensionlessArray

    def goodness_of_fit(self, deviance: float) -> si.Dimensionless:
        """Probability of a deviance at least as large if the fitted function were the truth."""
        larger = int(np.count_nonzero(self.deviances >= deviance - 1e-9))
        return (1 + larger) / (1 + self.deviances.size)


def simulate_bootstrap(
    likelihood: PenalisedLikelihood, best: si.FloatArray, replicates: int, seed: int
) -> Bootstrap:
    """Simulate answers at the places and trials of the data and refit them.

    Where the places depended on the answers (a staircase, a Bayesian choice) they are kept as
    they were: the bootstrap is conditional on them.

    Raises:
        InputError: fewer than 39 replicates, which cannot tell a 95 % interval.
    """
    si.require("replicates", replicates, at_least=39)
    shares = np.random.default_rng(seed).random((replicates, likelihood.x.size))
    answers = _answers(likelihood, best, shares)
    estimates, deviances = np.empty((replicates, 4)), np.empty(replicates)
    model, places = likelihood.model(), (likelihood.x, likelihood.n)
    kernel.refit(model, best, *places, answers, estimates, deviances)
    return Bootstrap(best, estimates, deviances, shares)


@dataclass(frozen=True, slots=True, eq=False)
class SamePlaces:
    """The experiment at the places and trials of the data, whatever the answers; the same random
    numbers `shares` (replicates, places) for every truth."""

    likelihood: PenalisedLikelihood
    shares: si.DimensionlessArray
    dear: bool = False

    def __call__(self, theta: si.FloatArray) -> Simulated:
        """Answers of people of θ."""
        answers, (rows, places) = _answers(self.likelihood, theta, self.shares), self.shares.shape
        x, n = (np.tile(one, (rows, 1)) for one in (self.likelihood.x, self.likelihood.n))
        return Simulated(x, answers, n, np.full(rows, places))


def inverted_interval(
    likelihood: PenalisedLikelihood,
    best: si.FloatArray,
    experiments: Experiments,
    parameter: int,
    level: si.Dimensionless,
) -> tuple[float, float]:
    """The values of one θ that the test with simulated deviances does not refuse.

    `best` is the fit. An end that the data do not bound lies at the bound of the prior.
    """
    _, top = likelihood.maximum(best)
    ends = [
        _inverted_end(likelihood, best, experiments, top, parameter, level, float(bound))
        for bound in (likelihood.low[parameter], likelihood.high[parameter])
    ]
    return ends[0], ends[1]


class Experiments:
    """Simulated experiments, and what those of one truth say of another.

    Where they are dear all are kept and weighed: by their probability under the truth asked for
    over that under the mixture of truths they were simulated at (the balance heuristic of Veach
    and Guibas 1995). How stimuli were chosen after the answers cancels in that ratio.
    """

    def __init__(self, shape: int, again: Experiment) -> None:
        self._shape, self._again = shape, again
        self._truths: list[si.FloatArray] = []
        self._sets: list[Simulated] = []

    def at(self, theta: si.FloatArray) -> tuple[Simulated, si.FloatArray]:
        """Experiments with people of θ, and their weights."""
        if not self._again.dear:
            runs = self._again(theta)
            return runs, np.ones(runs.used.size)
        found = self._weighed(theta) if self._sets else None
        wanted = _WORTH * self._sets[0].used.size if self._sets else math.inf
        if found is None or found[1].sum() ** 2 < wanted * (found[1] @ found[1]):
            self._truths.append(theta.copy())
            self._sets.append(self._again(theta))
            found = self._weighed(theta)
        return found

    def _weighed(self, theta: si.FloatArray) -> tuple[Simulated, si.FloatArray]:
        joined = [np.concatenate(one) for one in zip(*self._sets, strict=True)]
        runs = Simulated(joined[0], joined[1], joined[2], joined[3].astype(np.int64))
        asked = kernel.log_likelihoods(self._shape, theta, *runs)
        mixed = np.array(
            [kernel.log_likelihoods(self._shape, truth, *runs) for truth in self._truths]
        )
        weights = 1.0 / np.mean(np.exp(mixed - asked), axis=0)
        some = weights > 1e-3 * weights.max()
        return Simulated(runs.x[some], runs.k[some], runs.n[some], runs.used[some]), weights[some]


def _answers(
    likelihood: PenalisedLikelihood, theta: si.FloatArray, shares: si.DimensionlessArray
) -> si.FloatArray:
    """Counts not exceeded with a probability `shares`, shape (replicates, places). The same shares
    give counts that rise with ψ, so that what is simulated at two values of a parameter differs by
    the parameter and not by chance."""
    answers = np.empty_like(shares)
    p = kernel.probabilities(likelihood.code, theta, likelihood.x)
    for place, trials in enumerate(likelihood.n):
        heights = bdtr(np.arange(trials + 1), int(trials), p[place])
        answers[:, place] = np.searchsorted(heights, shares[:, place])
    return answers


def _inverted_end(
    likelihood: PenalisedLikelihood,
    best: si.FloatArray,
    experiments: Experiments,
    top: float,
    parameter: int,
    level: float,
    bound: float,
) -> float:
    """Alternate the end that a quantile allows and the quantile simulated at that end."""
    allowed = float(chdtri(1, 1 - level))
    end, model = float("nan"), likelihood.model()
    for _ in range(_MOST_ROUNDS):
        before = end
        held = _end(likelihood, best, top, parameter, allowed, bound)
        end = float(held[parameter])
        if abs(end - before) <= _CLOSE * abs(end - float(best[parameter])):
            break
        runs, weights = experiments.at(held)
        drops = np.empty(runs.used.size)
        kernel.profile_drops(model, held, parameter, *runs, drops)
        allowed = _quantile(drops, weights, level)
    return end


def _quantile(drops: si.FloatArray, weights: si.FloatArray, level: float) -> float:
    """The least deviance that is no smaller than a share of the simulated ones; the data's own is
    counted as one more, so that chance in the simulated ones keeps the level."""
    order = np.argsort(drops)
    heights = np.cumsum(weights[order])
    # Its weight is that of the experiments that they are worth.
    one = float(weights @ weights) / heights[-1]
    rank = np.searchsorted(heights, level * (heights[-1] + one) - 1e-9)
    return float(drops[order[min(int(rank), drops.size - 1)]])


def _end(
    likelihood: PenalisedLikelihood,
    best: si.FloatArray,
    top: float,
    parameter: int,
    allowed: float,
    bound: float,
) -> si.FloatArray:
    """θ at the end of what a profile deviance allows, towards a bound or at it."""
    free = likelihood.free.copy()
    free[parameter] = False
    reach = float(likelihood.high[parameter] - likelihood.low[parameter])
    inside = best
    step = math.copysign(reach / 32, bound - float(best[parameter]))
    # March outwards, each fit starting from the one before, to the first value not allowed.
    while True:
        outside = float(inside[parameter]) + step
        if (outside - bound) * step >= 0:
            outside = bound
        theta = inside.copy()
        theta[parameter] = outside
        theta, value = likelihood.maximum(theta, free)
        if 2.0 * (top - value) > allowed:
            break
        inside = theta
        if outside == bound:
            return inside
    while abs(outside - inside[parameter]) > _NEAR * reach:
        middle = inside.copy()
        middle[parameter] = 0.5 * (float(inside[parameter]) + outside)
        theta, value = likelihood.maximum(middle, free)
        if 2.0 * (top - value) > allowed:
            outside = float(middle[parameter])
        else:
            inside = theta
    return inside
