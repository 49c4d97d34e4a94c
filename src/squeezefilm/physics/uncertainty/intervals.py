"""Draws, kept on disk, and what they say: the ends of an interval, of which some may be refused and
some out of reach, and the share of the variance that each input explains, by Sobol' indices from
Saltelli's design.

Most inputs of a display explain next to nothing, which some rows of the design show: the others are
drawn for the rest alone.
"""

from __future__ import annotations

import dataclasses
import functools
import json
from dataclasses import dataclass
from hashlib import blake2b

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import to_json
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.draws import Input, Mixture, Outcome, Refusals, as_drawn
from squeezefilm.physics.uncertainty.parameters import Knowledge

LEVEL: si.Dimensionless = 0.9
MOST_REFUSED: si.Dimensionless = 0.02
"""Share of the draws: where more have no friction, an interval of the others would be a condition
that nobody asked for."""
# Stand for infinity, between which and a number one may go: what lies on the way is infinite too.
_BEYOND, _UNREACHED = 1e300, 1e200


def quantiles(
    friction: si.DimensionlessArray, level: si.Dimensionless = LEVEL, most: float = 1.0
) -> si.DimensionlessArray:
    """The lower end of the interval that holds `level`, the median and the upper end, of draws
    along the first axis.

    A refused draw (NaN) may be anything: it counts as 0 at the lower end and as `most` at the
    upper. Positions k/(n + 1), with which an interval of independent draws holds its level in the
    mean.
    """
    tails = (1 - level) / 2
    lost = np.isnan(friction)
    ends = [
        np.quantile(np.where(lost, fill, friction), at, axis=0, method="weibull")
        for fill, at in ((0.0, tails), (most, 1 - tails))
    ]
    return np.stack([ends[0], np.nanmedian(friction, axis=0), ends[1]])


def ends(values: si.FloatArray) -> tuple[float, float, float]:
    """Lower end, median, upper end as by `quantiles`, of values without an upper bound, shape (n,).

    Infinite ones are those that nothing reaches; a refused one (NaN) counts as 0 at the lower end
    and as infinite at the upper. An end that lies among the infinite is infinite.
    """
    if np.isnan(values).all():
        return 0.0, np.nan, np.inf
    found = quantiles(np.minimum(values, _BEYOND), most=_BEYOND)
    low, middle, high = np.where(found > _UNREACHED, np.inf, found).tolist()
    return low, middle, high


# An input whose share of the variance is below this, its doubt included, is followed no further.
_NEXT_TO_NOTHING = 0.02


@dataclass(frozen=True)
class Influence:
    """Share of the variance of µ′/µ that one input explains, alone and with all its company.

    First-order and total Sobol' indices with the half width of their 95 % confidence interval.
    """

    parameter: Input
    first_order: si.Dimensionless
    first_order_error: si.Dimensionless
    total: si.Dimensionless
    total_error: si.Dimensionless


@dataclass(frozen=True)
class GroupInfluence:
    """Share of the variance of µ′/µ that goes away if all of a group were known (`alone`), and how
    much would be left if all but the group were (`total`), each with the half width of its 95 %
    confidence interval: no member has more of either, but for these errors and its own."""

    knowledge: Knowledge
    alone: si.Dimensionless
    total: si.Dimensionless
    error: si.Dimensionless
    alone_error: si.Dimensionless


def influences_of(
    inputs: tuple[Input, ...], friction: si.DimensionlessArray
) -> tuple[Influence, ...]:
    """Influence of each input on the design's frictions, shape (samples, inputs + 4); the most
    important first. An input that was not `followed` to the end has NaN in the last rows."""
    a, b = friction[:, 0], friction[:, -3]
    scale = float(np.mean((a - b) ** 2)) or 1.0
    influences = []
    for k, item in enumerate(inputs):
        with_b = friction[:, k + 1]
        there = np.isfinite(with_b)
        of_a, of_b, with_b = a[there], b[there], with_b[there]
        whole = (of_a - of_b) ** 2
        total, total_error = _ratio((of_a - with_b) ** 2, whole, scale)
        first = _ratio(_shared((of_a, of_b), with_b), whole)
        influences.append(Influence(item, *first, total, total_error))
    return tuple(sorted(influences, key=lambda item: -item.total))


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
    """Influence on the design's frictions of what could be measured, and of what nobody knows.

    Its last two columns share with A, and with B, what nobody knows.
    """
    a, b, like_a, like_b = friction[:, [0, -3, -2, -1]].T
    whole = (a - b) ** 2 + (like_a - like_b) ** 2
    measurable = _ratio((a - like_a) ** 2 + (b - like_b) ** 2, whole)
    unknown = _ratio((b - like_a) ** 2 + (a - like_b) ** 2, whole)
    # Each way round, A for B.
    by_itself = [
        _ratio(_shared((a, b), of_a) + _shared((b, a), of_b), whole)
        for of_a, of_b in ((like_a, like_b), (like_b, like_a))
    ]
    return (
        GroupInfluence("measurable", by_itself[0][0], *measurable, by_itself[0][1]),
        GroupInfluence("unknown", by_itself[1][0], *unknown, by_itself[1][1]),
    )


def _shared(both: tuple[si.FloatArray, si.FloatArray], with_b: si.FloatArray) -> si.FloatArray:
    """Product of what A with some columns of B has in common with B, beyond what A has: its mean is
    twice the variance that these columns explain by themselves. Where they explain little its noise
    is little, which that of 1 less the share of the others is not (Saltelli's of 2010)."""
    a, b = both
    return 2 * (b - (np.mean(a) + np.mean(b)) / 2) * (with_b - a)


def _ratio(
    part: si.FloatArray, whole: si.FloatArray, scale: float | None = None
) -> tuple[float, float]:
    """A share of the variance, and the half width of its 95 % interval.

    The mean square of what differs where only some inputs do (Jansen), or what is `_shared`, over
    the mean square where all differ: as a ratio of the same rows, in which most of the noise
    cancels. `scale` is the mean of the whole where more rows of it are known. Jansen 1999,
    10.1016/S0010-4655(98)00154-4; Saltelli et al. 2010, 10.1016/j.cpc.2009.09.018.
    """
    scale = scale or float(np.mean(whole)) or 1.0
    share = float(np.mean(part)) / scale
    return share, 1.96 * float(np.std(part - share * whole)) / scale / len(part) ** 0.5


# So many messages take no time.
_TOLD = 20

# Whoever analyses a display again, with another texture or report, asks for the same draws again.
# Fewer are drawn again sooner than found.
_WORTH_KEEPING = 100


_KEPT: Kept[tuple[si.FloatArray, Refusals]] = Kept(
    "draws", tuple[si.FloatArray, Refusals], large=True
)


def evaluate(
    mixture: Mixture,
    points: si.DimensionlessArray,
    tell: SayProgress,
    what: str = "friction of draw",
) -> tuple[Outcome, Refusals]:
    """Outcome of draws at points of the unit cube, shape (n, inputs): arrays of shape (n,), NaN
    where refused; and what was refused. `tell` is told some twenty times."""
    outcomes = mixture.known(points)
    new = np.flatnonzero(np.isnan(outcomes[:, 0]))
    make = functools.partial(_drawn_now, mixture, points, new, tell, what)
    worth_keeping = new.size >= _WORTH_KEEPING
    made = _KEPT.found(hash_of_draws(mixture, points[new]), make) if worth_keeping else make()
    outcomes[new], refused = made
    mixture.learn(points[new], outcomes[new])
    return Outcome(*outcomes.T), dataclasses.replace(refused, evaluations=len(points))


def description_of(display: Display, prediction: Prediction, more: object = None) -> str:
    """All that follows from a display at a prediction's working point is kept under: both with
    every number in full, and whatever `more` it depends on."""
    sources = sorted(display.provenance.items())
    return json.dumps(to_json([display, sources, prediction.summary(), prediction.law.slip, more]))


def hash_of_draws(mixture: Mixture, points: si.DimensionlessArray, more: object = None) -> str:
    """A hash of all that draws at points of the unit cube, shape (n, inputs), come from: the
    display with its ranges, its prediction, and of these what the prediction's numbers do not say
    in full; and of what `more` is made of them."""
    p, law = mixture.prediction, mixture.prediction.law
    beside = (p.mode.modal_mass, p.held_amplitude, law.position, *law.ridge_swings)
    told = (mixture.model, mixture.inputs, beside, points, more)
    return blake2b(description_of(mixture.display, p, told).encode()).hexdigest()


@as_drawn()
def _drawn_now(
    mixture: Mixture,
    points: si.DimensionlessArray,
    new: si.IntArray,
    tell: SayProgress,
    what: str,
) -> tuple[si.FloatArray, Refusals]:
    """Outcome of the points numbered `new`, shape (n, 3), and what was refused."""
    outcomes, refused = np.full((new.size, 3), np.nan), Refusals(new.size)
    every = max(new.size // _TOLD, 1)
    draws = mixture.draws(points[new]) if new.size else iter(())
    for number, (point, draw) in enumerate(zip(points[new], draws, strict=True)):
        if number % every == 0:
            tell(f"{what} {number + 1} of {len(points)}")
        try:
            outcomes[number] = mixture.outcome(point, draw)
        except SqueezefilmError as error:
            refused.refuse(draw.heights, error)
    return outcomes, refused


def require_samples(samples: int) -> None:
    """Raise `InputError` for base samples that are no power of two from 8 to 65 536."""
    if samples < 8 or samples > 65536 or samples & (samples - 1):
        raise InputError(
            f"samples = {samples} cannot be used: take a power of two from 8 to 65536, like 128",
            quantity="samples",
        )
