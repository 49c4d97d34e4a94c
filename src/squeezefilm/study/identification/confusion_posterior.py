"""What the data say of every cell of a confusion matrix: Dirichlet posteriors by column."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.study.identification.confusion import ConfusionMatrix
from squeezefilm.study.identification.participant_bootstrap import Interval


@dataclass(frozen=True, slots=True, eq=False)
class ConfusionPosterior:
    """Posterior of the answer probabilities; arrays of shape (answers, stimuli).

    Trials are taken as independent draws of one person or of people who are alike: where people
    differ the intervals are too short, and the participant bootstrap is the one to quote.

    Attributes:
        matrix: the data.
        prior: Dirichlet parameter of every cell (1).
        level: of the intervals.
        mean: posterior means.
        low, high: bounds of equal-tailed intervals of single cells.
        proportion_correct: interval of the mean of the diagonal, every stimulus counting the same;
            None where rows and columns do not pair up.
    """

    matrix: ConfusionMatrix
    prior: si.Dimensionless
    level: si.Dimensionless
    mean: si.DimensionlessArray
    low: si.DimensionlessArray
    high: si.DimensionlessArray
    proportion_correct: Interval | None


def confusion_posterior(
    matrix: ConfusionMatrix,
    prior: si.Dimensionless | None = None,
    level: si.Dimensionless = 0.95,
    samples: int = 20_000,
    seed: int = 0,
) -> ConfusionPosterior:
    """The posterior of a confusion matrix with independent Dirichlet columns.

    A cell's marginal is Beta(n_ij + a, N_j − n_ij + (k − 1) a), in closed form. The proportion
    correct is a mean of Beta variables and is sampled.

    Args:
        matrix: the data.
        prior: Dirichlet parameter a of every cell; 1/answers if None (Perks' prior, which weighs
            as much as one trial per column whatever the number of answers); above 0.
        level: of the intervals.
        samples, seed: of the proportion correct.

    Raises:
        InputError: a prior not above 0, a level not between 0 and 1, fewer than 100 samples.
    """
    answers = len(matrix.answers)
    a = 1.0 / answers if prior is None else float(prior)
    si.require("prior", a, above=0.0)
    si.require("level", level, above=0.0, below=1.0)
    if samples < 100:
        raise InputError(f"samples = {samples} cannot be used; it must be at least 100")
    ones = matrix.counts + a
    others = ones.sum(axis=0) - ones
    tail = (1 - level) / 2
    marginal = stats.beta(ones, others)
    correct = None
    if matrix.is_square:
        random = np.random.default_rng(seed)
        diagonal = random.beta(np.diag(ones), np.diag(others), size=(samples, answers))
        low, high = np.quantile(diagonal.mean(axis=1), [tail, 1 - tail])
        correct = Interval(float(low), float(high), level, f"Dirichlet posterior, prior {a:g}")
    return ConfusionPosterior(
        matrix,
        a,
        level,
        ones / ones.sum(axis=0),
        np.asarray(marginal.ppf(tail)),
        np.asarray(marginal.isf(tail)),
        correct,
    )
