"""Certainty of a friction: quasi-Monte-Carlo over parameters, laws and mechanisms, and which of
them matters."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import Interval, to_json, values_of
from squeezefilm.physics.chain.friction import where_known
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.draws import (
    Mixture,
    Outcome,
    Refusals,
    as_drawn,
    between_limits,
    mixture_of,
)
from squeezefilm.physics.uncertainty.free_amplitude import require_bent
from squeezefilm.physics.uncertainty.intervals import (
    LEVEL,
    MOST_REFUSED,
    GroupInfluence,
    Influence,
    ends,
    evaluate,
    followed,
    groups_of,
    hash_of_draws,
    influences_of,
    quantiles,
    require_samples,
)

SAMPLES, POINTS = 16, 8
"""Base samples where none are asked for, and how many points make the interval for each: chosen by
`tests/verification/test_uncertainty_coverage.py`."""


_WHICH = "which value matters, by draw"
_POINTS: Kept[si.FloatArray] = Kept("sobol-points", si.FloatArray)

# From fewer rows one cannot tell which inputs matter.
_FIRST_ROWS = 8


@dataclass(frozen=True, eq=False)
class UncertainFriction:
    """Relative friction µ′/µ with its interval: `nominal` as described, `interval` between the 5 %
    and 95 % quantiles of `samples` (µ′/µ) with their `amplitudes` (m), parameters, laws and
    mechanisms drawn at once, `draws` in number.

    `influences` are ranked, the most important to know better first; `groups` are what could be
    measured and what nobody knows. Draws that are `refused` (asperities pressed through) have no
    place in `samples` and count as outside of the interval, at both of its ends.
    `amplitude_interval` (m) and `power_interval` (W) are those of the same draws: None where the
    amplitude was given or the power is not known; `power` is that as described, see
    `draws.Outcome`.
    """

    nominal: si.Dimensionless
    median: si.Dimensionless
    interval: Interval
    level: si.Dimensionless
    samples: si.DimensionlessArray
    amplitudes: si.MetreArray
    draws: int
    influences: tuple[Influence, ...]
    groups: tuple[GroupInfluence, ...]
    refused: Refusals
    seed: int
    model: str
    amplitude_interval: Interval | None = None
    power: si.Watt | None = None
    power_interval: Interval | None = None

    @property
    def sentence(self) -> str:
        """The result as one says it: µ′/µ = 0.41 as described (0.28–0.55, median 0.40)."""
        low, high = self.interval
        return (
            f"µ′/µ = {self.nominal:.2f} as described ({low:.2f}–{high:.2f}, median "
            f"{self.median:.2f})"
        )

    @property
    def standing(self) -> str:
        """Words for where the value as described stands among the draws."""
        low, high = self.interval
        share = float(np.mean(self.samples < self.nominal))
        where = f"{si.percent(share)} of the draws lie below the value as described"
        if low <= self.nominal <= high:
            return where
        return f"{where}, which lies outside of the interval: the description is no typical draw"

    @si.checked_numbers
    def probability_below(self, relative_friction: si.Dimensionless) -> si.Dimensionless:
        """The share of the draws with µ′/µ at or below a value; a refused one is not below."""
        return float(np.count_nonzero(self.samples <= relative_friction) / self.draws)

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values, with units in the keys where there are any."""
        return {
            "relative_friction": self.nominal,
            "relative_friction_median": self.median,
            "relative_friction_interval": list(self.interval),
            "interval_level": self.level,
            "vibration_amplitude_interval_m": to_json(self.amplitude_interval),
            "power_W": self.power,
            "power_interval_W": to_json(self.power_interval),
            "evaluations": self.refused.evaluations,
            "refused": self.refused.count,
            "refused_why": dict(self.refused.reasons),
            "seed": self.seed,
            "groups": {
                group.knowledge: {
                    "first_order": group.alone,
                    "first_order_error": group.alone_error,
                    "total_order": group.total,
                    "total_order_error": group.error,
                }
                for group in self.groups
            },
            "measure_next": [
                {
                    "parameter": item.parameter.path,
                    **values_of(
                        item,
                        "parameter.knowledge first_order first_order_error parameter.source",
                    ),
                    "total_order": item.total,
                    "total_order_error": item.total_error,
                    "distribution": item.parameter.origin,
                    "range": list(item.parameter.spread),
                }
                for item in self.influences
            ],
        }


def uncertain_friction(
    display: Display,
    prediction: Prediction,
    *,
    samples: int = SAMPLES,
    seed: int = 1,
    progress: SayProgress | None = None,
) -> UncertainFriction:
    """A prediction's friction with all that is uncertain drawn at once.

    What is drawn, and with which weights, says `draws.Mixture`. The interval is that of 8 × samples
    Sobol' points (`samples` a power of two, 8 to 65 536). The influences are by Saltelli's design,
    in which a law is drawn by a uniform coordinate as a value is: at most samples × (inputs + 4)
    more, less for inputs that explain next to nothing in the first rows. Source: Saltelli et al.
    2010, 10.1016/j.cpc.2009.09.018.

    Raises `InputError` for `samples` that are no power of two, `OutOfRangeError` where more than
    2 % of the draws have no friction or the drive does not bend the plate.
    """
    require_samples(samples)
    require_bent(display, prediction)
    mixture = mixture_of(display, prediction)
    count = POINTS * samples
    tell = progress or (lambda _: None)
    drawn, kept, refused = _drawn(mixture, samples, seed, tell)
    if refused.share > MOST_REFUSED:
        raise OutOfRangeError(refusal_words(refused))
    friction = drawn.friction
    known = np.isfinite(friction)
    low, middle, high = (float(quantile) for quantile in quantiles(friction))
    driven = prediction.voltage is not None
    power = mixture.power(mixture.prediction.touch)
    return UncertainFriction(
        nominal=_nominal(mixture),
        median=middle,
        interval=Interval(low, high),
        level=LEVEL,
        samples=friction[known],
        amplitudes=drawn.amplitude[known],
        draws=count,
        influences=influences_of(mixture.inputs, kept),
        groups=groups_of(kept),
        refused=refused,
        seed=seed,
        model=f"{mixture.model}; laws and mechanisms by their assumed weights",
        amplitude_interval=_interval(drawn.amplitude) if driven else None,
        power=power,
        power_interval=None if power is None else _interval(drawn.power),
    )


def interval_or_reason(
    display: Display,
    prediction: Prediction,
    *,
    samples: int = SAMPLES,
    seed: int = 1,
    progress: SayProgress | None = None,
) -> tuple[UncertainFriction | None, str]:
    """`uncertain_friction`, or None with the reason why there is no interval (else ""). Raises
    `InputError` as it does."""
    if not samples:
        return None, "no samples were asked for"
    if prediction.touch.law is None:
        return None, "nothing vibrates, or the model shares no load"
    try:
        found = uncertain_friction(
            display, prediction, samples=samples, seed=seed, progress=progress
        )
    except OutOfRangeError as error:
        return None, str(error)
    return found, ""


def refusal_words(refused: Refusals) -> str:
    """Sentence on why there is no interval, and what to do."""
    return (
        f"{refused.sentence}. An interval of the other draws would leave these out in silence, so "
        f"above {si.percent(MOST_REFUSED)} there is none. The first one says: {refused.example}. "
        "Press less or vibrate less, give measured values with their narrower ranges, or ask for "
        'one law by evidence = "measured"'
    )


def _design(mixture: Mixture, samples: int, seed: int) -> si.FloatArray:
    """Points in the unit cube, shape (samples, inputs + 4, inputs): A, A with each column of B, B,
    then A with all columns of B that could be measured and B with those of A."""
    inputs = mixture.inputs
    both = _sobol(2 * len(inputs), samples, seed)
    a, b = both[:, : len(inputs)], both[:, len(inputs) :]
    measurable = np.array([input_.knowledge == "measurable" for input_ in inputs])
    taken = [
        np.zeros_like(measurable),
        *np.eye(len(inputs), dtype=bool),
        ~np.zeros_like(measurable),
    ]
    taken += [measurable, ~measurable]
    design = np.stack([np.where(columns, b, a) for columns in taken], axis=1)
    joint = mixture.display.joint
    if joint is None:
        return design
    return joint.moved(mixture.paths, design.reshape(-1, len(inputs))).reshape(design.shape)


def _drawn(
    mixture: Mixture, samples: int, seed: int, tell: SayProgress
) -> tuple[Outcome, si.FloatArray, Refusals]:
    """Outcome of the points of the interval; µ′/µ of the design, shape (samples, inputs + 4) less
    the rows with a refused draw, NaN where an input explained too little to be followed; and what
    was refused."""
    points, design = sobol_points(mixture, POINTS * samples, seed), _design(mixture, samples, seed)
    rows = np.full(design.shape[:2], np.nan)
    first, inputs = max(samples // 4, _FIRST_ROWS), design.shape[-1]
    at_once = np.concatenate([points, design[:first].reshape(-1, inputs)])
    drawn, refused = evaluate(mixture, at_once, tell)
    rows[:first] = drawn.friction[len(points) :].reshape(first, -1)
    columns = np.arange(design.shape[1])
    if samples > first:
        columns = followed(rows[:first])
        rest = design[first:, columns]
        more, refused_too = evaluate(mixture, rest.reshape(-1, inputs), tell, _WHICH)
        rows[first:, columns] = more.friction.reshape(rest.shape[:2])
        refused = refused.together_with(refused_too)
    whole = np.isfinite(rows[:, columns]).all(axis=1)
    whole[:first] = np.isfinite(rows[:first]).all(axis=1)
    return Outcome(*(values[: len(points)] for values in drawn)), rows[whole], refused


def sobol_points(mixture: Mixture, count: int, seed: int) -> si.FloatArray:
    """Scrambled Sobol' points of a mixture's unit cube, shape (count, inputs); `count` a power of
    two. Of a calibrated display what was calibrated is drawn from its table."""
    points = _sobol(len(mixture.inputs), count, seed)
    joint = mixture.display.joint
    return points if joint is None else joint.picked(mixture.paths, points)


def _interval(values: si.FloatArray) -> Interval | None:
    """Interval of both ends; None where refused draws leave no upper one."""
    low, _, high = ends(values)
    return Interval(low, high) if np.isfinite(high) else None


def _nominal(mixture: Mixture) -> float:
    """Relative friction µ′/µ as described; of a model that shares no load by the one that the draws
    are made with."""
    p = mixture.prediction
    if p.law.model == mixture.model:
        return float(p.relative_friction)
    return mixture.law(mixture.made({}, {})).at(p.vibration_amplitude)


@dataclass(frozen=True, eq=False)
class FrictionBand:
    """Relative friction µ′/µ over the vibration amplitude with everything but the amplitude
    uncertain.

    `low` and `high` are quantiles that hold `level` of the draws at each amplitude; NaN where more
    than 2 % of them are refused.
    """

    amplitude: si.MetreArray
    low: si.DimensionlessArray
    high: si.DimensionlessArray
    level: si.Dimensionless
    samples: int


def _sobol(dimensions: int, count: int, seed: int) -> si.DimensionlessArray:
    """Scrambled Sobol' points, shape (count, dimensions): kept on disk, since loading SciPy's
    statistics for them takes a quarter of a second."""

    def drawn() -> si.DimensionlessArray:
        from scipy.stats import qmc

        return np.asarray(qmc.Sobol(dimensions, rng=seed).random(count))

    return _POINTS.found(repr((dimensions, count, seed)), drawn)


_BANDS: Kept[si.DimensionlessArray] = Kept("draws-band", si.DimensionlessArray, large=True)


@as_drawn()
def friction_bands(
    display: Display,
    prediction: Prediction,
    amplitude: si.MetreArray,
    levels: Sequence[si.Dimensionless] = (LEVEL,),
    *,
    samples: int = 64,
    progress: Callable[[str, float], None] | None = None,
) -> tuple[FrictionBand, ...]:
    """The band of each level (1) in which µ′/µ lies at each amplitude (m, shape (n,)).

    Parameters, laws and mechanisms are drawn as in `uncertain_friction`, by `samples` Sobol' points
    (a power of two), the same for all levels; drive and actuator stand still, since the amplitude
    is the abscissa. `progress` is called with a text and a fraction. Raises `InputError` for
    amplitudes below 0.
    """
    mixture = Mixture(display, prediction, driven=False)
    points = sobol_points(mixture, samples, seed=1)
    make = functools.partial(_drawn_curves, mixture, points, amplitude, progress)
    rows = _BANDS.found(hash_of_draws(mixture, points, amplitude), make)
    known = np.isnan(rows).mean(axis=0) <= MOST_REFUSED
    bands = []
    for level in levels:
        edges = np.full((2, amplitude.size), np.nan)
        edges[:, known] = quantiles(rows[:, known], level)[[0, 2]]
        bands.append(FrictionBand(amplitude, edges[0], edges[1], level, samples))
    return tuple(bands)


def _drawn_curves(
    mixture: Mixture,
    points: si.DimensionlessArray,
    amplitude: si.MetreArray,
    progress: Callable[[str, float], None] | None,
) -> si.DimensionlessArray:
    """Relative friction µ′/µ of each draw at each amplitude, shape (draws, n); NaN where
    refused."""
    samples = len(points)
    rows = np.empty((samples, amplitude.size))
    for number, draw in enumerate(mixture.draws(points)):
        if progress is not None:
            progress(f"draw {number + 1} of {samples}", number / samples)
        friction = functools.partial(between_limits, mixture.law(draw), draw)
        rows[number] = where_known(friction, amplitude)
    return rows
