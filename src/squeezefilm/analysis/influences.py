"""How much of the variance of µ′/µ each input explains: Sobol' indices from Saltelli's design."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.draws import Input
from squeezefilm.analysis.parameters import Knowledge


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
    important first."""
    a, b = friction[:, 0], friction[:, -3]
    whole = (a - b) ** 2
    found = []
    for k, item in enumerate(inputs):
        with_b = friction[:, k + 1]
        total, total_error = _ratio((a - with_b) ** 2, whole)
        rest, rest_error = _ratio((b - with_b) ** 2, whole)
        found.append(Influence(item, 1 - rest, rest_error, total, total_error))
    return tuple(sorted(found, key=lambda item: -item.total))


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


def _ratio(part: si.FloatArray, whole: si.FloatArray) -> tuple[float, float]:
    """Jansen's estimator of a share of the variance, and the half width of its 95 % interval.

    Half the mean square of what differs where only some inputs do over that where all do: as a
    ratio of the same rows, in which most of the noise cancels. Jansen 1999,
    10.1016/S0010-4655(98)00154-4.
    """
    scale = float(np.mean(whole)) or 1.0
    share = float(np.mean(part)) / scale
    return share, 1.96 * float(np.std(part - share * whole)) / scale / len(part) ** 0.5
