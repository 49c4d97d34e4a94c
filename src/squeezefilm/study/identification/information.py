"""Information transfer of an identification, by several estimators, with where each fails.

The transfer is I = H(answer) − H(answer | stimulus) (Garner & Hake 1951, 10.1037/h0054482;
Miller & Nicely 1955), in bit. The share of each stimulus is what was presented, N_j/N: it is the
experimenter's choice and is not estimated. An estimator takes `counts` of shape (…, answers,
stimuli) and returns the shape (…). Nothing is cut off at 0: an estimate below 0 belongs to an
unbiased estimator, and cutting would bring the bias back.

No estimator is unbiased with few trials. What each does at 60 trials of 5 stimuli was measured on
matrices whose transfer is known (`REFERENCE_MATRICES`, and `even_errors` as the hard case); the
verdicts below are from there, and `estimator_bias` measures them again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import digamma, gammaln, ndtr, polygamma

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.confusion import whole_counts
from squeezefilm.study.identification.proportions import (
    Interval,
    recentred_interval,
    resampled_counts,
)

Bit = Annotated[float, si.Unit("bit")]

_LN2 = float(np.log(2.0))
# log β of the mixture of Dirichlet priors; 1e-4 to 1e3 spans certainty to near uniformity.
_CONCENTRATION = np.logspace(-4.0, 3.0, 80)
_BLOCK = 4096


def _x_log_x(x: si.FloatArray) -> si.FloatArray:
    return np.asarray(x * np.log(np.where(x > 0, x, 1.0)))


def plug_in(counts: ArrayLike) -> si.FloatArray:
    """The transfer of the observed shares: maximum likelihood. Biased up, by up to (r−1)(s−1)/(2N
    ln 2) and more."""
    n = whole_counts(counts).astype(float)
    total = n.sum(axis=(-2, -1))
    return np.asarray(
        (
            _x_log_x(n).sum(axis=(-2, -1))
            - _x_log_x(n.sum(axis=-1)).sum(axis=-1)
            - _x_log_x(n.sum(axis=-2)).sum(axis=-1)
            + _x_log_x(total)
        )
        / (total * _LN2)
    )


def miller_madow(counts: ArrayLike) -> si.FloatArray:
    """Plug-in less (K − R − S + 1)/(2N ln 2), K, R, S the cells, rows, columns with any trial
    (Miller 1955)."""
    n = whole_counts(counts)
    cells = (n > 0).sum(axis=(-2, -1))
    rows = (n.sum(axis=-1) > 0).sum(axis=-1)
    columns = (n.sum(axis=-2) > 0).sum(axis=-1)
    first = (cells - rows - columns + 1) / (2 * n.sum(axis=(-2, -1)) * _LN2)
    return np.asarray(plug_in(n) - first)


def jackknife(counts: ArrayLike) -> si.FloatArray:
    """The jackknife by columns: I + Σ_j (N_j−1)/N_j Σ_i n_ij (I − I without a trial of cell ij).

    Trials are left out within a stimulus and the stimuli's shares stay (a stratified jackknife;
    Quenouille 1956, 10.1093/biomet/43.3-4.353, by strata). NaN where a presented stimulus has a
    single trial.
    """
    n = whole_counts(counts)
    flat = n.reshape(-1, *n.shape[-2:])
    blocks = [_jackknife(flat[k : k + _BLOCK]) for k in range(0, flat.shape[0], _BLOCK)]
    return np.concatenate(blocks).reshape(n.shape[:-2])


def _jackknife(whole: si.IntArray) -> si.FloatArray:
    n = whole.astype(float)
    column = n.sum(axis=-2)
    share = column / column.sum(axis=-1, keepdims=True)
    divisor = np.where(column > 0, column, 1.0)
    within = np.log(divisor) - _x_log_x(n).sum(axis=-2) / divisor
    p = n / divisor[:, None, :]
    answer = (p * share[:, None, :]).sum(axis=-1)
    entropy = -_x_log_x(answer).sum(axis=-1)
    transfer = entropy - (share * within).sum(axis=-1)
    less = np.where(column > 1, column - 1, 1.0)
    # Without one trial of cell (i, j): the column's own entropy, then the answers'.
    changed = _x_log_x(n).sum(axis=-2)[:, None, :] - _x_log_x(n) + _x_log_x(np.maximum(n - 1, 0))
    within_less = np.log(less)[:, None, :] - changed / less[:, None, :]
    grown = p * (column / less)[:, None, :]
    moved = answer[:, :, None] + share[:, None, :] * (grown - p)
    removed = share / less
    others = -_x_log_x(moved).sum(axis=-2)
    own = _x_log_x(moved) - _x_log_x(np.maximum(moved - removed[:, None, :], 0.0))
    entropy_less = others[:, None, :] + own
    transfer_less = (
        entropy_less
        - (share * within).sum(axis=-1)[:, None, None]
        + share[:, None, :] * (within[:, None, :] - within_less)
    )
    weight = n * (less / divisor)[:, None, :]
    change = np.where(n > 0, transfer[:, None, None] - transfer_less, 0.0)
    estimate = transfer + (weight * change).sum(axis=(-2, -1))
    return np.asarray(np.where(np.any(column == 1, axis=-1), np.nan, estimate) / _LN2)


def nsb(counts: ArrayLike) -> si.FloatArray:
    """Nemenman, Shafee & Bialek's entropies (2002, arXiv physics/0108025), columns sharing one
    concentration.

    A mixture of Dirichlet priors over β, weighted so that entropy is a priori uniform. All columns
    are taken to have the same β (they are answered by the same people), the answers' own entropy
    has a β of its own.
    """
    n = whole_counts(counts)
    flat = n.reshape(-1, *n.shape[-2:])
    blocks = [_nsb(flat[k : k + _BLOCK // 8]) for k in range(0, flat.shape[0], _BLOCK // 8)]
    return np.concatenate(blocks).reshape(n.shape[:-2])


def _nsb(n: si.IntArray) -> si.FloatArray:
    column = n.sum(axis=-2)
    share = column / column.sum(axis=-1, keepdims=True)
    columns = np.swapaxes(n, -1, -2)
    answer = _mixed_entropy(n.sum(axis=-1)[:, None, :])[:, 0]
    return np.asarray((answer - (share * _mixed_entropy(columns)).sum(axis=-1)) / _LN2)


def _mixed_entropy(n: si.IntArray) -> si.FloatArray:
    """Posterior mean entropies of groups (…, groups, kinds) with a concentration in common."""
    kinds = n.shape[-1]
    beta = _CONCENTRATION
    total = n.sum(axis=-1)
    # Few counts are different: the gamma functions are worked out once for each.
    different, place = np.unique(n, return_inverse=True)
    place, each = place.reshape(n.shape), different[:, None] + beta
    gains = gammaln(each) - gammaln(beta)
    evidence = (
        gammaln(kinds * beta) - gammaln(total[..., None] + kinds * beta) + gains[place].sum(axis=-2)
    ).sum(axis=-2)
    flat = kinds * polygamma(1, kinds * beta + 1) - polygamma(1, beta + 1)
    weight = np.exp(evidence - evidence.max(axis=-1, keepdims=True)) * flat * beta
    weight /= weight.sum(axis=-1, keepdims=True)
    terms = each * digamma(each + 1)
    full = total[..., None] + kinds * beta
    entropy = digamma(full + 1) - terms[place].sum(axis=-2) / full
    return np.asarray((weight[..., None, :] * entropy).sum(axis=-1))


@dataclass(frozen=True, slots=True)
class InformationEstimator:
    """An estimator: its key, its name, what it computes of counts, and where it fails."""

    key: str
    name: str
    estimate: Callable[[ArrayLike], si.FloatArray]
    fails: str


RECOMMENDED = "jackknife"
"""The estimator to quote: at most 0.05 bit of bias on every reference matrix at 60 trials."""

ESTIMATORS: dict[str, InformationEstimator] = {
    item.key: item
    for item in (
        InformationEstimator(
            "plug-in",
            "plug-in (maximum likelihood)",
            plug_in,
            "too high everywhere with few trials: +0.23 bit for a guesser, still +0.07 near "
            "perfection, at 60 trials of 5 stimuli",
        ),
        InformationEstimator(
            "miller-madow",
            "Miller–Madow on observed cells",
            miller_madow,
            "+0.05 to +0.1 bit everywhere at 60 trials, +0.18 with a few even errors: rare cells "
            "not yet seen are not counted",
        ),
        InformationEstimator(
            "jackknife",
            "jackknife by stimulus",
            jackknife,
            "up to +0.09 bit where a few errors fall evenly on all answers (lapses, 90 to 95 % "
            "right), −0.04 bit for a guesser; has no value where a stimulus has a single trial",
        ),
        InformationEstimator(
            "nsb",
            "NSB, one concentration for all columns",
            nsb,
            "−0.04 to −0.07 bit for ordered stimuli confused with neighbours only (50 to 90 % "
            "right); at most +0.05 bit for guessers, lapses and even errors",
        ),
    )
}
"""Every estimator by its key."""


@dataclass(frozen=True, slots=True)
class TransferEstimate:
    """One estimator's value (bit), its interval over participants, and where it fails.

    `interval` is None with fewer than two participants, and where the estimator has no value for
    the matrix or for any resample.
    """

    key: str
    name: str
    estimate: Bit
    interval: Interval | None
    fails: str


@dataclass(frozen=True, slots=True)
class InformationTransfer:
    """The information that answers carry about stimuli, by every estimator.

    Attributes:
        estimates: one per estimator; the pooled matrix of all participants.
        recommended: key of the one to quote.
        greatest: entropy of the stimuli presented; log2 of their number if equally frequent.
        trials, participants, resamples: what it was made of.
    """

    estimates: tuple[TransferEstimate, ...]
    recommended: str
    greatest: Bit
    trials: int
    participants: int
    resamples: int

    @property
    def best(self) -> TransferEstimate:
        """The recommended estimator's."""
        return next(item for item in self.estimates if item.key == self.recommended)


def information_transfer(
    counts: ArrayLike,
    level: si.Dimensionless = 0.95,
    resamples: int = 1000,
    seed: int = 0,
) -> InformationTransfer:
    """Information transfer of the pooled matrix by every estimator, with participant intervals.

    The pooled matrix loses what differs between people: with the same stimuli for all, its
    transfer is at most the mean of theirs.

    Args:
        counts: every participant's matrix, shape (participants, answers, stimuli); or one matrix.
        level: of the intervals, between 0 and 1.
        resamples, seed: of the participant bootstrap.

    Raises:
        InputError: counts that are none, or without a trial.
    """
    whole = whole_counts(counts)
    whole = whole[None] if whole.ndim == 2 else whole
    if whole.ndim != 3 or whole.sum() == 0:
        raise InputError(
            f"counts of shape {whole.shape} hold no matrix with a trial; (participants, answers, "
            "stimuli) is wanted"
        )
    si.require("level", level, above=0.0, below=1.0)
    pooled = whole.sum(axis=0)
    people = int(np.count_nonzero(whole.sum(axis=(1, 2))))
    again = resampled_counts(whole, resamples, seed) if whole.shape[0] > 1 else None
    share = pooled.sum(axis=0) / pooled.sum()
    greatest = float(-(share[share > 0] * np.log2(share[share > 0])).sum())
    found = []
    for item in ESTIMATORS.values():
        value = float(item.estimate(pooled))
        interval = None
        if again is not None and np.isfinite(value):
            resampled = item.estimate(again)
            if np.isfinite(resampled).any():
                interval = recentred_interval(
                    value, resampled, whole.shape[0], level, 0.0, greatest
                )
        found.append(TransferEstimate(item.key, item.name, value, interval, item.fails))
    # The jackknife has no value where a stimulus came once; NSB has one for any counts.
    best = RECOMMENDED if np.isfinite(ESTIMATORS[RECOMMENDED].estimate(pooled)) else "nsb"
    made = 0 if again is None else resamples
    return InformationTransfer(tuple(found), best, greatest, int(pooled.sum()), people, made)


def ordered_observer(spacing: float, stimuli: int = 5) -> si.FloatArray:
    """Answer probabilities of an unbiased observer of ordered stimuli, shape (answers, stimuli).

    Stimulus j is felt as a normal deviate about j·`spacing` of unit spread, criteria lie midway
    (Thurstone's model with equal variances); `spacing` is d′ of neighbours, above 0.
    """
    si.require("spacing", spacing, above=0.0)
    place = spacing * np.arange(stimuli)
    criteria = np.concatenate([[-np.inf], 0.5 * (place[1:] + place[:-1]), [np.inf]])
    return np.asarray(np.diff(ndtr(criteria[:, None] - place[None, :]), axis=0))


def even_errors(proportion_correct: si.Dimensionless, stimuli: int = 5) -> si.FloatArray:
    """Answer probabilities of an observer whose errors fall evenly on all wrong answers."""
    si.require("proportion_correct", proportion_correct, at_least=0.0, at_most=1.0)
    wrong = (1 - proportion_correct) / (stimuli - 1)
    return np.full((stimuli, stimuli), wrong) + (proportion_correct - wrong) * np.eye(stimuli)


REFERENCE_MATRICES: dict[str, si.FloatArray] = {
    "guesser": even_errors(0.2),
    **{f"d′ = {spacing}": ordered_observer(float(spacing)) for spacing in (1, 2, 3, 4)},
}
"""Five matrices from guessing to near-perfect. The rule: a guesser, and unbiased observers of five
ordered stimuli one, two, three and four d′ apart; 20, 51, 75, 89 and 96 % right."""


def transfer_of(probabilities: si.FloatArray) -> Bit:
    """The exact transfer (bit) of answer probabilities, every stimulus presented equally often."""
    joint = np.asarray(probabilities, dtype=float) / probabilities.shape[1]
    answer = joint.sum(axis=1, keepdims=True)
    some = joint > 0
    ratio = np.divide(joint * joint.shape[1], answer, out=np.ones_like(joint), where=some)
    return float((joint * np.log2(np.where(some, ratio, 1.0))).sum())


@dataclass(frozen=True, slots=True)
class EstimatorError:
    """An estimator's error on one matrix: bias with its standard error, spread, and root mean
    square error (bit)."""

    key: str
    matrix: str
    transfer: Bit
    bias: Bit
    bias_error: Bit
    spread: Bit
    rms_error: Bit


def estimator_bias(
    matrices: dict[str, si.FloatArray] | None = None,
    trials: int = 60,
    runs: int = 2000,
    seed: int = 0,
    keys: tuple[str, ...] = tuple(ESTIMATORS),
) -> tuple[EstimatorError, ...]:
    """Errors of estimators on known matrices, by simulation with equal trials per stimulus.

    Args:
        matrices: name → answer probabilities, shape (answers, stimuli); the five if None.
        trials: of each run; a multiple of the number of stimuli.
        runs, seed: of the simulation.
        keys: which estimators.

    Raises:
        InputError: trials that do not spread evenly over the stimuli.
    """
    random = np.random.default_rng(seed)
    table = []
    for name, matrix in (REFERENCE_MATRICES if matrices is None else matrices).items():
        stimuli = matrix.shape[1]
        if trials % stimuli or trials < 1:
            raise InputError(
                f"{trials} trials do not spread evenly over {stimuli} stimuli; take a multiple"
            )
        counts = np.stack(
            [random.multinomial(trials // stimuli, p, size=runs) for p in matrix.T], axis=-1
        )
        true = transfer_of(matrix)
        for key in keys:
            error = ESTIMATORS[key].estimate(counts) - true
            spread = float(error.std(ddof=1))
            table.append(
                EstimatorError(
                    key,
                    name,
                    true,
                    float(error.mean()),
                    spread / np.sqrt(runs),
                    spread,
                    float(np.sqrt(np.mean(error**2))),
                )
            )
    return tuple(table)
