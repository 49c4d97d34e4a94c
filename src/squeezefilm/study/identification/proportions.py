"""Proportions with intervals, and tests of whether people did better than by guessing."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.study.identification.confusion import ConfusionMatrix, whole_counts
from squeezefilm.study.identification.participant_bootstrap import (
    Interval,
    expansion,
    resampled_counts,
)


def wilson_interval(successes: int, trials: int, level: si.Dimensionless = 0.95) -> Interval:
    """Wilson's score interval of a proportion (1927, 10.1080/01621459.1927.10502953).

    Raises `InputError` for counts that do not fit or a level not between 0 and 1.
    """
    return _by_scipy(successes, trials, level, "wilson", "Wilson")


def jeffreys_interval(successes: int, trials: int, level: si.Dimensionless = 0.95) -> Interval:
    """Equal-tailed posterior interval under Jeffreys' prior Beta(1/2, 1/2).

    At 0 or all successes the bound at the end is 0 or 1 (Brown, Cai & DasGupta 2001,
    10.1214/ss/1009213286). Raises as `wilson_interval`.
    """
    _check(successes, trials, level)
    posterior = stats.beta(successes + 0.5, trials - successes + 0.5)
    tail = (1 - level) / 2
    low = 0.0 if successes == 0 else float(posterior.ppf(tail))
    high = 1.0 if successes == trials else float(posterior.isf(tail))
    return Interval(low, high, level, "Jeffreys")


def clopper_pearson_interval(
    successes: int, trials: int, level: si.Dimensionless = 0.95
) -> Interval:
    """The exact interval (Clopper & Pearson 1934, 10.1093/biomet/26.4.404): never too short.

    Raises as `wilson_interval`.
    """
    return _by_scipy(successes, trials, level, "exact", "Clopper–Pearson")


def participant_interval(
    counts: ArrayLike, level: si.Dimensionless = 0.95, resamples: int = 2000, seed: int = 0
) -> Interval:
    """Percentile interval of the proportion correct over resampled participants.

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
    low, high = np.quantile(right, [tail, 1 - tail])
    return Interval(float(low), float(high), level, "participant bootstrap")


def chance_test(matrix: ConfusionMatrix) -> si.Dimensionless:
    """Probability of so many right answers or more from guessing (exact binomial, one-sided).

    It treats trials as independent, which holds under guessing. Raises `InputError` where rows and
    columns do not pair up.
    """
    return float(stats.binom.sf(matrix.correct - 1, matrix.trials, matrix.chance))


def permutation_test(
    counts: ArrayLike, permutations: int = 2000, seed: int = 0
) -> si.Dimensionless:
    """Probability of so many right answers if answers had nothing to do with what was presented.

    Answers are shuffled over the trials of each participant, so preferences for an answer, which
    the binomial test takes for skill or its lack, stay as they are. One-sided; the data count as
    one of the permutations (Phipson & Smyth 2010, 10.2202/1544-6115.1585). From 201 participants
    on the normal limit is taken, with the exact mean and variance, instead of shuffles.

    Args:
        counts: every participant's square matrix, shape (participants, k, k).
        permutations, seed: how many shuffles, and of which draws.

    Raises:
        InputError: matrices that are not square, or fewer than one permutation.
    """
    whole = _square(counts)
    if permutations < 1:
        raise InputError(f"permutations = {permutations} cannot be used; it must be at least 1")
    observed = int(np.trace(whole, axis1=1, axis2=2).sum())
    answers, presented = whole.sum(axis=2), whole.sum(axis=1)
    if whole.shape[0] > 200:
        # A sum over many people is normal, and its mean and variance are known exactly.
        return _normal_permutation(answers, presented, observed)
    random = np.random.default_rng(seed)
    found = np.zeros(permutations, dtype=np.int64)
    for rows, columns in zip(answers, presented, strict=True):
        left = np.broadcast_to(rows, (permutations, rows.size)).copy()
        for column, drawn in enumerate(columns):
            taken = _draw(random, left, int(drawn))
            found += taken[:, column]
            left -= taken
    return float((1 + np.count_nonzero(found >= observed)) / (1 + permutations))


def _draw(random: np.random.Generator, left: si.IntArray, drawn: int) -> si.IntArray:
    """One multivariate hypergeometric draw from each row of `left`."""
    taken = np.zeros_like(left)
    wanted = np.full(left.shape[0], drawn)
    others = left.sum(axis=1)
    for row in range(left.shape[1]):
        others = others - left[:, row]
        taken[:, row] = random.hypergeometric(left[:, row], others, wanted)
        wanted = wanted - taken[:, row]
    return taken


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


def _by_scipy(
    successes: int, trials: int, level: float, method: Literal["exact", "wilson"], name: str
) -> Interval:
    _check(successes, trials, level)
    found = stats.binomtest(successes, trials).proportion_ci(level, method)
    return Interval(float(found.low), float(found.high), level, name)


def _square(counts: ArrayLike) -> si.IntArray:
    whole = whole_counts(counts)
    if whole.ndim != 3 or whole.shape[1] != whole.shape[2]:
        raise InputError(
            f"counts of shape {whole.shape} are no square matrices of participants; "
            "(participants, k, k) is wanted"
        )
    return whole


def _check(successes: int, trials: int, level: float) -> None:
    si.require("level", level, above=0.0, below=1.0)
    if not 0 <= successes <= trials or trials < 1:
        raise InputError(
            f"{successes} successes of {trials} trials cannot be; successes must lie between 0 and "
            "the trials, of which at least 1 is wanted"
        )
