"""Information transfer of an identification, by several estimators, with where each fails.

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
from scipy.special import ndtr

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.study.identification import information_estimators as estimators
from squeezefilm.study.identification.confusion import whole_counts
from squeezefilm.study.identification.participant_bootstrap import (
    Interval,
    recentred_interval,
    resampled_counts,
)

Bit = Annotated[float, si.Unit("bit")]


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
            estimators.plug_in,
            "too high everywhere with few trials: +0.23 bit for a guesser, still +0.07 near "
            "perfection, at 60 trials of 5 stimuli",
        ),
        InformationEstimator(
            "first-order",
            "plug-in less (r−1)(s−1)/2N",
            estimators.first_order,
            "too low for all but guessers: it corrects for cells that are never used",
        ),
        InformationEstimator(
            "miller-madow",
            "Miller–Madow on observed cells",
            estimators.miller_madow,
            "+0.05 to +0.1 bit everywhere at 60 trials, +0.18 with a few even errors: rare cells "
            "not yet seen are not counted",
        ),
        InformationEstimator(
            "jackknife",
            "jackknife by stimulus",
            estimators.jackknife,
            "up to +0.09 bit where a few errors fall evenly on all answers (lapses, 90 to 95 % "
            "right), −0.04 bit for a guesser; has no value where a stimulus has a single trial",
        ),
        InformationEstimator(
            "grassberger",
            "Grassberger 1988",
            estimators.grassberger,
            "varies more than the jackknife; −0.05 bit for a guesser, up to +0.08 bit with a few "
            "even errors",
        ),
        InformationEstimator(
            "chao-shen",
            "Chao–Shen coverage",
            estimators.chao_shen,
            "−0.13 bit for a guesser, −0.1 bit for poor observers",
        ),
        InformationEstimator(
            "dirichlet",
            "Dirichlet posterior mean, prior 1/2",
            estimators.dirichlet,
            "far too low for good observers (−0.6 bit near perfection), where the prior spreads "
            "answers over cells never used; +0.28 bit for a guesser",
        ),
        InformationEstimator(
            "nsb",
            "NSB, one concentration for all columns",
            estimators.nsb,
            "−0.04 to −0.07 bit for ordered stimuli confused with neighbours only (50 to 90 % "
            "right); at most +0.05 bit for guessers, lapses and even errors",
        ),
    )
}
"""Every estimator by its key."""


@dataclass(frozen=True, slots=True)
class TransferEstimate:
    """One estimator's value (bit), its interval over participants, and where it fails.

    `interval` is None with fewer than two participants, and where the estimator has no value.
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
            interval = recentred_interval(
                value, item.estimate(again), whole.shape[0], level, 0.0, greatest
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
