"""The biased choice model: answers from similarities of stimuli and biases of answers.

    p(answer i | stimulus j) = b_i η_ij / Σ_m b_m η_mj,   η_ij = η_ji, η_ii = 1, Σ b = 1

(Shepard 1957, 10.1007/BF02288967; Luce 1963). With as many answers as stimuli its expected counts
are those of a quasi-symmetric table, a_i c_j s_ij, so that maximum likelihood is found by fitting
margins and sums of mirrored cells in turn (Smith 1982, Perception & Psychophysics 31:183;
Caussinus 1965). Distances are Shepard's −ln η (1987, 10.1126/science.3629243).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.study.identification.confusion import (
    column_proportions,
    goodness_of_fit,
    whole_counts,
)

_MOST_ROUNDS = 20_000
_TOLERANCE = 1e-10


@dataclass(frozen=True, slots=True, eq=False)
class ChoiceModel:
    """Similarities and biases that describe a confusion matrix best.

    Attributes:
        similarity: η, shape (k, k), symmetric with ones on the diagonal; may exceed 1 where a
            wrong answer is more frequent than the right one.
        bias: b, shape (k,), sums to 1.
        distance: −ln η, shape (k, k); infinite where two stimuli were never confused.
        pseudo_trials: added to each column, spread evenly over the answers, before the fit.
        deviance, degrees_of_freedom, p_value: G² against the saturated model; a small p says that
            confusions are not symmetric beyond bias. Rough where cells hold fewer than some 5
            trials; NaN where trials were added.
        log_likelihood: of the fit, without the multinomial constant.
        rounds: of the iteration.
    """

    similarity: si.DimensionlessArray
    bias: si.DimensionlessArray
    distance: si.DimensionlessArray
    pseudo_trials: si.Dimensionless
    deviance: si.Dimensionless
    degrees_of_freedom: int
    p_value: si.Dimensionless
    log_likelihood: si.Dimensionless
    rounds: int

    @property
    def probabilities(self) -> si.FloatArray:
        """Answer probabilities of the model, shape (answers, stimuli)."""
        return choice_probabilities(self.similarity, self.bias)


def choice_probabilities(similarity: ArrayLike, bias: ArrayLike) -> si.FloatArray:
    """Answer probabilities, shape (answers, stimuli), of similarities and biases."""
    strength = np.asarray(bias, dtype=float)[:, None] * np.asarray(similarity, dtype=float)
    return np.asarray(strength / strength.sum(axis=0, keepdims=True))


def choice_model(counts: ArrayLike, pseudo_trials: si.Dimensionless = 0.0) -> ChoiceModel:
    """Fit the choice model by maximum likelihood.

    Args:
        counts: trials, shape (k, k), rows answers, columns stimuli.
        pseudo_trials: added to each column, spread evenly over answers; with 1 all distances are
            finite.

    Raises:
        InputError: counts that are not square, a stimulus without trials, a stimulus never
            answered rightly (its similarities are not defined; add pseudo-trials), or
            pseudo-trials below 0.
        ConvergenceError: no fixed point within 20 000 rounds.
    """
    whole = whole_counts(counts)
    if whole.ndim != 2 or whole.shape[0] != whole.shape[1]:
        raise InputError(f"counts of shape {whole.shape} are not square; (k, k) is wanted")
    si.require("pseudo_trials", pseudo_trials, at_least=0.0)
    k = whole.shape[0]
    n = whole + pseudo_trials / k
    if np.any(n.sum(axis=0) == 0):
        raise InputError("the choice model needs trials of every stimulus; leave out the others")
    if np.any(np.diag(n) == 0):
        raise InputError(
            f"stimulus {int(np.flatnonzero(np.diag(n) == 0)[0])} was never answered rightly, so "
            "its similarities are not defined; pass pseudo_trials=1"
        )
    fitted, rounds = _quasi_symmetric(n)
    diagonal = np.diag(fitted)
    similarity = np.sqrt(fitted * fitted.T / np.outer(diagonal, diagonal))
    p = column_proportions(fitted)
    freedom = (k - 1) * (k - 2) // 2
    deviance, p_value, likelihood = goodness_of_fit(n, p, freedom, judged=pseudo_trials == 0)
    with np.errstate(divide="ignore"):
        distance = np.where(np.eye(k) > 0, 0.0, -np.log(similarity))
    return ChoiceModel(
        similarity,
        _bias(fitted),
        distance,
        float(pseudo_trials),
        deviance,
        freedom,
        p_value,
        likelihood,
        rounds,
    )


def _bias(fitted: si.FloatArray) -> si.FloatArray:
    """Biases of a quasi-symmetric table: of answers that are linked by confusions."""
    p = column_proportions(fitted)
    k = p.shape[0]
    linked = (p > 0) & (p.T > 0) & ~np.eye(k, dtype=bool)
    # Answers without a common confusion have no bias against each other; least squares of the
    # smallest length then gives those groups the same geometric mean.
    i, j = np.nonzero(np.triu(linked))
    if not i.size:
        return np.full(k, 1.0 / k)
    rows = np.eye(k)[i] - np.eye(k)[j]
    values = 0.5 * np.log(p[i, j] * p[i, i] / (p[j, i] * p[j, j]))
    logs = np.linalg.lstsq(rows, values, rcond=None)[0]
    bias = np.exp(logs - logs.max())
    return np.asarray(bias / bias.sum())


def _quasi_symmetric(n: si.FloatArray) -> tuple[si.FloatArray, int]:
    """Expected counts with the margins and the sums of mirrored cells of `n`."""
    m = np.where(n + n.T > 0, 1.0, 0.0)
    mirrored = n + n.T
    for rounds in range(1, _MOST_ROUNDS + 1):
        before = m
        m = m * _ratio(n.sum(axis=1), m.sum(axis=1))[:, None]
        m = m * _ratio(n.sum(axis=0), m.sum(axis=0))[None, :]
        m = m * _ratio(mirrored, m + m.T)
        if np.abs(m - before).max() <= _TOLERANCE * n.sum():
            return m, rounds
    raise ConvergenceError(
        f"the choice model found no fixed point in {_MOST_ROUNDS} rounds; pass pseudo_trials=1",
        partial=m,
        residual=float(np.abs(m - before).max()),
        iterations=_MOST_ROUNDS,
    )


def _ratio(wanted: si.FloatArray, have: si.FloatArray) -> si.FloatArray:
    return np.divide(wanted, have, out=np.zeros_like(have), where=have > 0)
