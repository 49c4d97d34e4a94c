"""How much of the variance of µ′/µ each input explains: Sobol' indices from Saltelli's design.

Most inputs of a display explain next to nothing, which some rows of the design show: the others are
drawn for the rest alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.draws import Input
from squeezefilm.analysis.parameters import Knowledge

# An input whose share of the variance is below this, its doubt included, is followed no further.
_NEXT_TO_NOTHING = 0.02


@dataclass(frozen=True)
class Influence:
    """How much of the variance of µ′/µ one input explains, alone and with all its company.

    First-order and total Sobol' indices with the half width of their 95 % confidence interval.
    """

    parameter: Input
    first_order: si.Dimensionless
    first_order_error: si.Dimensionless
    total: si.Dimensionless
    total_error: si.Dimensionless


@dataclass(frozen=True)
class GroupInfluence:
    """How much of the variance of µ′/µ goes away if all of a group were known (`alone`), and how
    much would be left if all but the group were (`total`), with the half width of the latter's 95 %
    confidence interval."""

    knowledge: Knowledge
    alone: si.Dimensionless
    total: si.Dimensionless
    error: si.Dimensionless


def influences_of(
    inputs: tuple[Input, ...], friction: si.DimensionlessArray
) -> tuple[Influence, ...]:
    """What each input explains of the design's frictions, shape (samples, inputs + 4); the most
    important first. An input that was not `followed` to the end has NaN in the last rows."""
    a, b = friction[:, 0], friction[:, -3]
    scale = float(np.mean((a - b) ** 2)) or 1.0
    found = []
    for k, item in enumerate(inputs):
        with_b = friction[:, k + 1]
        there = np.isfinite(with_b)
        of_a, of_b, with_b = a[there], b[there], with_b[there]
        whole = (of_a - of_b) ** 2
        total, total_error = _ratio((of_a - with_b) ** 2, whole, scale)
        rest, rest_error = _ratio((of_b - with_b) ** 2, whole)
        found.append(Influence(item, 1 - rest, rest_error, total, total_error))
    return tuple(sorted(found, key=lambda item: -item.total))


def followed(friction: si.DimensionlessArray) -> si.IntArray:
    """The columns of the design, by number, that are worth drawing further after the frictions of
    its first rows, shape (rows, inputs + 4): all but those of inputs that explain next to nothing.
    Refused draws are NaN."""
    known = friction[np.isfinite(friction).all(axis=1)]
    every = np.arange(friction.shape[1])
    if not len(known):
        return every
    a, b = known[:, 0], known[:, -3]
    whole = (a - b) ** 2
    small = [
        k for k in every[1:-3] if sum(_ratio((a - known[:, k]) ** 2, whole)) < _NEXT_TO_NOTHING
    ]
    return np.setdiff1d(every, small)


def groups_of(friction: si.DimensionlessArray) -> tuple[GroupInfluence, ...]:
    """What could be measured, and what nobody knows, of the design's frictions.

    Its last two columns share with A, and with B, what nobody knows; alone is what the other group
    leaves.
    """
    a, b, like_a, like_b = friction[:, [0, -3, -2, -1]].T
    whole = (a - b) ** 2 + (like_a - like_b) ** 2
    measurable = _ratio((a - like_a) ** 2 + (b - like_b) ** 2, whole)
    unknown = _ratio((b - like_a) ** 2 + (a - like_b) ** 2, whole)
    return (
        GroupInfluence("measurable", 1 - unknown[0], *measurable),
        GroupInfluence("unknown", 1 - measurable[0], *unknown),
    )


def _ratio(
    part: si.FloatArray, whole: si.FloatArray, scale: float | None = None
) -> tuple[float, float]:
    """Jansen's estimator of a share of the variance, and the half width of its 95 % interval.

    Half the mean square of what differs where only some inputs do over that where all do: as a
    ratio of the same rows, in which most of the noise cancels. `scale` is the mean of the whole
    where more rows of it are known. Jansen 1999, 10.1016/S0010-4655(98)00154-4.
    """
    scale = scale or float(np.mean(whole)) or 1.0
    share = float(np.mean(part)) / scale
    return share, 1.96 * float(np.std(part - share * whole)) / scale / len(part) ** 0.5
