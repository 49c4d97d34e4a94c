"""Estimators of information transfer (bit) from counts; each works on stacks of matrices.

The transfer is I = H(answer) − H(answer | stimulus) (Garner & Hake 1951, 10.1037/h0054482;
Miller & Nicely 1955). The share of each stimulus is what was presented, N_j/N: it is the
experimenter's choice and is not estimated. `counts` has the shape (…, answers, stimuli) and what
is returned the shape (…). Nothing is cut off at 0: an estimate below 0 belongs to an unbiased
estimator, and cutting would bring the bias back.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import digamma, gammaln, polygamma

from squeezefilm import quantities as si
from squeezefilm.study.identification.confusion import whole_counts

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


def first_order(counts: ArrayLike) -> si.FloatArray:
    """Plug-in less (r−1)(s−1)/(2N ln 2) with all cells, seen or not; too much for good observers.

    Only columns that were presented are counted.
    """
    n = whole_counts(counts)
    columns = (n.sum(axis=-2) > 0).sum(axis=-1)
    first = (n.shape[-2] - 1) * (columns - 1) / (2 * n.sum(axis=(-2, -1)) * _LN2)
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


def grassberger(counts: ArrayLike) -> si.FloatArray:
    """Grassberger's entropies (1988, 10.1016/0375-9601(88)90193-4) of answers and of each column:
    log N − Σ n G(n)/N, G(n) = ψ(n) + (−1)ⁿ/2 [ψ((n+1)/2) − ψ(n/2)]."""
    n = whole_counts(counts)
    column = n.sum(axis=-2)
    within = _grassberger_entropy(np.swapaxes(n, -1, -2))
    answer = _grassberger_entropy(n.sum(axis=-1))
    return np.asarray((answer - (within * column).sum(axis=-1) / column.sum(axis=-1)) / _LN2)


def _grassberger_entropy(n: si.IntArray) -> si.FloatArray:
    x = np.maximum(n, 1).astype(float)
    sign = np.where(n % 2 == 0, 0.5, -0.5)
    g = digamma(x) + sign * (digamma((x + 1) / 2) - digamma(x / 2))
    total = np.maximum(n.sum(axis=-1), 1)
    return np.asarray(np.log(total) - np.where(n > 0, n * g, 0.0).sum(axis=-1) / total)


def chao_shen(counts: ArrayLike) -> si.FloatArray:
    """Coverage-adjusted entropies (Chao & Shen 2003, 10.1023/A:1026096204727) of answers and of
    answers with stimuli; the stimuli's own entropy is known."""
    n = whole_counts(counts)
    column = n.sum(axis=-2)
    share = column / column.sum(axis=-1, keepdims=True)
    stimulus = -_x_log_x(share).sum(axis=-1)
    joint = _chao_shen_entropy(n.reshape(*n.shape[:-2], -1))
    return np.asarray((_chao_shen_entropy(n.sum(axis=-1)) + stimulus - joint) / _LN2)


def _chao_shen_entropy(n: si.IntArray) -> si.FloatArray:
    total = n.sum(axis=-1, keepdims=True)
    singles = (n == 1).sum(axis=-1, keepdims=True)
    # All trials single would make the coverage 0.
    coverage = 1 - np.where(singles == total, total - 1, singles) / total
    p = coverage * n / total
    seen = 1 - (1 - p) ** total
    return np.asarray(-(_x_log_x(p) / np.where(seen > 0, seen, 1.0)).sum(axis=-1))


def dirichlet(counts: ArrayLike, prior: float = 0.5) -> si.FloatArray:
    """Posterior means of entropies under Dirichlet priors (Wolpert & Wolf 1995,
    10.1103/PhysRevE.52.6841): columns with `prior` in every cell, answers with as much as all
    columns together."""
    n = whole_counts(counts)
    column = n.sum(axis=-2)
    presented = (column > 0).sum(axis=-1)[..., None]
    answer = _dirichlet_entropy(n.sum(axis=-1), prior * presented)
    within = _dirichlet_entropy(np.swapaxes(n, -1, -2), np.asarray(prior))
    return np.asarray((answer - (within * column).sum(axis=-1) / column.sum(axis=-1)) / _LN2)


def _dirichlet_entropy(n: si.IntArray, prior: si.FloatArray) -> si.FloatArray:
    a = n + prior
    total = a.sum(axis=-1)
    return np.asarray(digamma(total + 1) - (a * digamma(a + 1)).sum(axis=-1) / total)


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
