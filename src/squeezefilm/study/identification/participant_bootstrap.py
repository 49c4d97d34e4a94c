"""The participant bootstrap: people are drawn with replacement, each with all their trials.

Trials of one person are not independent, so an interval over people must resample people
(the cluster bootstrap; Davison & Hinkley 1997, 10.1017/CBO9780511802843, section 3.8).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.study.identification.confusion import whole_counts


@dataclass(frozen=True, slots=True)
class Interval:
    """An interval: its bounds, its level, and how it was made."""

    low: float
    high: float
    level: si.Dimensionless
    method: str

    def __contains__(self, value: float) -> bool:
        return self.low <= value <= self.high


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
    people = whole.shape[0]
    cells = whole.reshape(people, -1).astype(float)
    random = np.random.default_rng(seed)
    pooled = np.empty((resamples, cells.shape[1]))
    # A block of weights at a time: 10 000 people times 2 000 resamples would be 160 MB.
    block = max(1, 2_000_000 // people)
    for first in range(0, resamples, block):
        last = min(first + block, resamples)
        weights = np.empty((last - first, people))
        for row in weights:
            row[:] = np.bincount(random.integers(people, size=people), minlength=people)
        pooled[first:last] = weights @ cells
    return np.asarray(np.rint(pooled).reshape(resamples, *whole.shape[1:]), dtype=np.int64)


def expansion(participants: int, level: float) -> float:
    """How many standard deviations of a bootstrap of n clusters an interval must reach:
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
) -> Interval:
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
    low, high = estimate + wide * (np.quantile(values, [tail, 1 - tail]) - values.mean())
    return Interval(
        float(np.clip(low, least, greatest)),
        float(np.clip(high, least, greatest)),
        level,
        "participant bootstrap, recentred",
    )
