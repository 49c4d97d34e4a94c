"""Confusion matrices of identification, and their share of right answers with intervals and tests.

Rows of a matrix are answers, columns are what was presented: the layout of Biet, Giraud &
Lemaire-Semail's tables, with a row for each real grating that a person may answer with, a column
for each simulated spatial period, percentages per column.

In the participant bootstrap people are drawn with replacement, each with all their trials: trials
of one person are not independent, so an interval over people must resample people (the cluster
bootstrap; Davison & Hinkley 1997, 10.1017/CBO9780511802843, section 3.8).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.psychometric.estimate import Estimate, holding


@dataclass(frozen=True, slots=True, eq=False)
class ConfusionMatrix:
    """Counts of each answer to each stimulus.

    Args:
        counts: trials, shape (answers, stimuli); whole numbers from 0 up.
        answers: what each row is called.
        stimuli: what each column is called.

    Raises:
        InputError: counts of another shape than the names, below 0, not whole, or all 0.
    """

    counts: si.IntArray
    answers: tuple[str, ...]
    stimuli: tuple[str, ...]

    def __post_init__(self) -> None:
        counts = whole_counts(self.counts)
        if counts.shape != (len(self.answers), len(self.stimuli)):
            raise InputError(
                f"counts of shape {counts.shape} do not fit {len(self.answers)} answers (rows) and "
                f"{len(self.stimuli)} stimuli (columns)"
            )
        if counts.sum() == 0:
            raise InputError("a confusion matrix needs at least one trial; it has 0")
        object.__setattr__(self, "counts", counts)

    @property
    def trials(self) -> int:
        """Trials in all."""
        return int(self.counts.sum())

    @property
    def trials_per_stimulus(self) -> si.IntArray:
        """Trials of each column, shape (stimuli,)."""
        return np.asarray(self.counts.sum(axis=0), dtype=np.int64)

    @property
    def proportions(self) -> si.DimensionlessArray:
        """Share of each column's answers, shape (answers, stimuli); NaN in an empty column."""
        totals, empty = self.counts.sum(axis=0), np.full(self.counts.shape, np.nan)
        return np.asarray(np.divide(self.counts, totals, out=empty, where=totals > 0))

    @property
    def percent(self) -> si.FloatArray:
        """The same in per cent, as the paper's tables have it."""
        return np.asarray(100.0 * self.proportions)

    @property
    def is_square(self) -> bool:
        """True where answer number i is the right one for stimulus number i."""
        return len(self.answers) == len(self.stimuli)

    @property
    def correct(self) -> int:
        """Trials on the diagonal. Raises `InputError` where rows and columns do not pair up."""
        if not self.is_square:
            raise InputError(
                f"{len(self.answers)} answers and {len(self.stimuli)} stimuli do not pair up: "
                "there is no right answer to count"
            )
        return int(np.trace(self.counts))

    @property
    def proportion_correct(self) -> float:
        """Share of all trials on the diagonal. Raises as `correct` does."""
        return self.correct / self.trials

    @property
    def chance(self) -> float:
        """Proportion correct of a person who guesses: 1/answers."""
        return 1.0 / len(self.answers)


def whole_counts(counts: ArrayLike) -> si.IntArray:
    """Counts as whole numbers. Raises `InputError` for negative, broken or not finite ones."""
    given = np.asarray(counts)
    if given.dtype.kind not in "iuf" or not np.all(np.isfinite(given)):
        raise InputError("counts must be whole numbers from 0 up; some are not numbers")
    whole = given.astype(np.int64)
    if np.any(whole != given) or np.any(whole < 0):
        raise InputError(
            f"counts must be whole numbers from 0 up; {given[(whole != given) | (whole < 0)][0]} "
            "is among them"
        )
    return whole


def one_per_trial(**columns: ArrayLike) -> tuple[NDArray[Any], ...]:
    """The columns as arrays of shape (trials,). Raises `InputError` where they are of others."""
    arrays = tuple(np.asarray(column) for column in columns.values())
    if arrays[0].ndim != 1 or len({array.shape for array in arrays}) > 1:
        *names, last = columns
        raise InputError(
            f"{', '.join(names)} and {last} must have one value a trial; their shapes are "
            f"{', '.join(str(array.shape) for array in arrays)}"
        )
    return arrays


def participant_counts(
    participant: ArrayLike, stimulus: ArrayLike, choice: ArrayLike, answers: int, stimuli: int
) -> tuple[NDArray[np.generic], si.IntArray]:
    """Every participant's own confusion matrix.

    Args:
        participant: who answered, shape (trials,); numbers or texts.
        stimulus: column number of what was presented, shape (trials,), 0 to stimuli − 1.
        choice: row number of what was answered, shape (trials,), 0 to answers − 1.
        answers, stimuli: how many there are.

    Returns:
        The participants in sorted order, shape (participants,), and counts of shape
        (participants, answers, stimuli).

    Raises:
        InputError: arrays of unequal length, no trial, or a number out of range.
    """
    columns = _index("stimulus", stimulus, stimuli)
    rows = _index("choice", choice, answers)
    who, columns, rows = one_per_trial(participant=participant, stimulus=columns, choice=rows)
    if who.size == 0:
        raise InputError("there is no trial to analyse; give at least one")
    names, person = np.unique(who, return_inverse=True)
    flat = (person * answers + rows) * stimuli + columns
    counts = np.bincount(flat, minlength=names.size * answers * stimuli)
    return names, counts.reshape(names.size, answers, stimuli).astype(np.int64)


def _index(name: str, values: ArrayLike, count: int) -> si.IntArray:
    given = np.asarray(values)
    if given.size and given.dtype.kind not in "iu":
        raise InputError(f"{name} must hold whole numbers from 0 to {count - 1}")
    if given.size and (given.min() < 0 or given.max() >= count):
        outside = given[(given < 0) | (given >= count)].ravel()[0]
        raise InputError(f"{name} = {outside} is out of range; it must be 0 to {count - 1}")
    return given.astype(np.int64)


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
    t = -float(special.stdtrit(participants - 1, (1 - level) / 2))
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
    wide = expansion(participants, level) / -float(special.ndtri(tail))
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
    from scipy import stats

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
    tail = float(special.ndtr(-expansion(whole.shape[0], level)))
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
    from scipy import stats

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
    return float(special.ndtr(-z))


def _square(counts: ArrayLike) -> si.IntArray:
    whole = whole_counts(counts)
    if whole.ndim != 3 or whole.shape[1] != whole.shape[2]:
        raise InputError(
            f"counts of shape {whole.shape} are no square matrices of participants; "
            "(participants, k, k) is wanted"
        )
    return whole
