"""Proportions of right answers with intervals, and tests of whether people did better than by
guessing.

In the participant bootstrap people are drawn with replacement, each with all their trials: trials
of one person are not independent, so an interval over people must resample people (the cluster
bootstrap; Davison & Hinkley 1997, 10.1017/CBO9780511802843, section 3.8).
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.confusion import whole_counts
from squeezefilm.study.psychometric.estimate import Estimate, holding


def resampled_counts(counts: ArrayLike, resamples: int, seed: int) -> si.IntArray:
    """Pooled matrices of resampled participants, shape (resamples, answers, stimuli).

    Args:
        counts: every participant's matrix, shape (participants, answers, stimuli).
        resamples: how many times participants are drawn; at least 1.
        seed: of the draws.

    Raises:
        InputError: fewer than two participants (people cannot be resampled from one), or fewer
            than one resample.
    """
    whole = whole_counts(counts)
    if whole.ndim != 3 or whole.shape[0] < 2:
        raise InputError(
            f"counts of shape {whole.shape} hold fewer than 2 participants; an interval over "
            "people needs at least 2"
        )
    si.require("resamples", resamples, at_least=1)
    people, random = whole.shape[0], np.random.default_rng(seed)
    cells = whole.reshape(people, -1).astype(float)
    pooled = np.empty((resamples, cells.shape[1]))
    for resample in pooled:
        often = np.bincount(random.integers(people, size=people), minlength=people)
        resample[:] = often @ cells
    return np.asarray(np.rint(pooled).reshape(resamples, *whole.shape[1:]), dtype=np.int64)


def expansion(participants: int, level: float) -> float:
    """Number of standard deviations of a bootstrap of n clusters an interval must reach:
    √(n/(n−1)) t_{n−1}, instead of the normal quantile (Hesterberg 2015,
    10.1080/00031305.2015.1089789, "expanded percentile interval")."""
    t = float(stats.t.isf((1 - level) / 2, participants - 1))
    return t * math.sqrt(participants / (participants - 1))


def recentred_interval(
    estimate: float,
    resampled: si.FloatArray,
    participants: int,
    level: float = 0.95,
    least: float = -np.inf,
    greatest: float = np.inf,
) -> Estimate:
    """The spread of a bootstrap laid around the estimate, not around the bootstrap's own mean.

    Resampling repeats people, and statistics with a bias that grows as data thin out (information
    transfer, d′) have it twice in the resamples; their mean is therefore taken away. The spread is
    widened for few people, see `expansion`.

    Raises:
        InputError: a level not between 0 and 1, or no finite resample.
    """
    si.require("level", level, above=0.0, below=1.0)
    values = resampled[np.isfinite(resampled)]
    if values.size == 0:
        raise InputError("no resample gave a finite value; there is no interval")
    tail = (1 - level) / 2
    wide = expansion(participants, level) / float(stats.norm.isf(tail))
    ends = estimate + wide * (np.quantile(values, [tail, 1 - tail]) - values.mean())
    # An unbiased estimate may lie beyond what can be, and all resamples to one side of their mean.
    low, high = np.clip(ends, least, greatest)
    return holding(estimate, low, high, level, "participant bootstrap, recentred")


Method = Literal["Wilson", "Jeffreys", "Clopper–Pearson"]


@si.checked_numbers
def proportion_interval(
    successes: Annotated[int, si.AtLeast(0), si.AtMost("trials")],
    trials: Annotated[int, si.AtLeast(1)],
    level: Annotated[si.Dimensionless, si.Above(0.0), si.Below(1.0)] = 0.95,
    method: Method = "Wilson",
) -> Estimate:
    """A proportion with an interval; trials are taken as independent.

    Wilson's score interval (1927, 10.1080/01621459.1927.10502953); the equal-tailed posterior
    under Jeffreys' prior Beta(1/2, 1/2), whose bound at 0 or all successes is 0 or 1 (Brown, Cai &
    DasGupta 2001, 10.1214/ss/1009213286); or the exact one of Clopper & Pearson (1934,
    10.1093/biomet/26.4.404), which is never too short.

    Raises:
        InputError: another method, counts that do not fit, or a level not between 0 and 1.
    """
    share = successes / trials
    if method != "Jeffreys":
        exact = method == "Clopper–Pearson"
        interval = stats.binomtest(successes, trials).proportion_ci(
            level, "exact" if exact else "wilson"
        )
        return Estimate(share, float(interval.low), float(interval.high), level, method)
    posterior = stats.beta(successes + 0.5, trials - successes + 0.5)
    tail = (1 - level) / 2
    low = 0.0 if successes == 0 else float(posterior.ppf(tail))
    high = 1.0 if successes == trials else float(posterior.isf(tail))
    return holding(share, low, high, level, method)


def participant_interval(
    counts: ArrayLike, level: si.Dimensionless = 0.95, resamples: int = 2000, seed: int = 0
) -> Estimate:
    """The proportion correct with its percentile interval over resampled participants.

    The percentiles lie further out than the level says, for few people (`expansion`).

    Args:
        counts: every participant's square matrix, shape (participants, k, k).
        level: of the interval.
        resamples, seed: of the bootstrap.

    Raises:
        InputError: fewer than two participants, or matrices that are not square.
    """
    si.require("level", level, above=0.0, below=1.0)
    whole = _square(counts)
    pooled = resampled_counts(whole, resamples, seed)
    right = np.trace(pooled, axis1=1, axis2=2) / pooled.sum(axis=(1, 2))
    tail = float(stats.norm.sf(expansion(whole.shape[0], level)))
    correct = float(np.trace(whole.sum(axis=0)) / whole.sum())
    low, high = np.quantile(right, [tail, 1 - tail])
    return holding(correct, low, high, level, "participant bootstrap")


def permutation_test(
    counts: ArrayLike, permutations: int = 2000, seed: int = 0
) -> si.Dimensionless:
    """Probability of so many right answers if answers had nothing to do with what was presented.

    Answers are shuffled over the trials of each participant, so preferences for an answer, which
    a binomial test takes for skill or its lack, stay as they are. One-sided; the data count as
    one of the permutations (Phipson & Smyth 2010, 10.2202/1544-6115.1585). From 201 participants
    on the normal limit is taken, with the exact mean and variance, instead of shuffles.

    Args:
        counts: every participant's square matrix, shape (participants, k, k).
        permutations, seed: how many shuffles, and of which draws.

    Raises:
        InputError: matrices that are not square, or fewer than one permutation.
    """
    whole = _square(counts)
    si.require("permutations", permutations, at_least=1)
    observed = int(np.trace(whole, axis1=1, axis2=2).sum())
    answers, presented = whole.sum(axis=2), whole.sum(axis=1)
    if whole.shape[0] > 200:
        # A sum over many people is normal, and its mean and variance are known exactly.
        return _normal_permutation(answers, presented, observed)
    random = np.random.default_rng(seed)
    totals = np.zeros(permutations, dtype=np.int64)
    for rows, columns in zip(answers, presented, strict=True):
        shuffled = stats.random_table(rows, columns)
        totals += np.trace(shuffled.rvs(permutations, random_state=random), axis1=1, axis2=2)
    return float((1 + np.count_nonzero(totals >= observed)) / (1 + permutations))


def _normal_permutation(answers: si.IntArray, presented: si.IntArray, observed: int) -> float:
    trials = presented.sum(axis=1).astype(float)
    both = (answers * presented).astype(float)
    mean = both.sum(axis=1) / np.maximum(trials, 1.0)
    # A linear statistic of a random pairing of n trials (Hoeffding 1951); a single trial has one.
    n = np.maximum(trials, 2.0)
    total, crossed = both.sum(axis=1), (both * (answers + presented)).sum(axis=1)
    variance = (total - crossed / n + (total / n) ** 2) / (n - 1)
    spread = math.sqrt(float(variance[trials > 1].sum()))
    if spread == 0.0:
        return 1.0
    z = (observed - 0.5 - float(mean.sum())) / spread
    return float(stats.norm.sf(z))


def _square(counts: ArrayLike) -> si.IntArray:
    whole = whole_counts(counts)
    if whole.ndim != 3 or whole.shape[1] != whole.shape[2]:
        raise InputError(
            f"counts of shape {whole.shape} are no square matrices of participants; "
            "(participants, k, k) is wanted"
        )
    return whole
