"""Which one experiment would tell the laws of height, and the shear elements, best apart.

For a grid of forces, speeds and amplitudes each law predicts µ′/µ, with what else is uncertain
drawn anew but the same under every law. What counts is how far two laws lie apart over what a
measurement of µ′/µ leaves open: d = |difference of means| / √(mean variance + noise²). Whoever
then takes the law that lies nearer is right with probability Φ(d/2) (equal normal spreads).

A *ratio* is the same finger at two conditions: what is uncertain of it cancels in part.
"""

from __future__ import annotations

import dataclasses
import itertools
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.draws import Mixture, as_drawn
from squeezefilm.analysis.intervals import MOST_REFUSED
from squeezefilm.analysis.model_choices import HEIGHT_LAW, SHEAR, Choice
from squeezefilm.analysis.parameters import SKIN_COMPLIANCE
from squeezefilm.analysis.uncertainty import sobol_points
from squeezefilm.chain.friction import FrictionLaw
from squeezefilm.chain.prediction import Prediction
from squeezefilm.contact.sharing.pad import Limit
from squeezefilm.display import Display
from squeezefilm.errors import InputError, SqueezefilmError
from squeezefilm.progress import SayProgress

NOISE: si.Dimensionless = 0.05
"""Of one measured µ′/µ, relative, with many strokes averaged: assumed."""

FORCES: si.NewtonArray = np.array([0.1, 0.3, 1.0, 3.0])
SPEEDS: si.MetrePerSecondArray = np.array([0.01, 0.03, 0.1, 0.3])
AMPLITUDES: si.MetreArray = np.array([0.5e-6, 1e-6, 2e-6, 3e-6])
DRAWS = 16
_LIMITS: tuple[Limit, Limit] = ("own", "one-gap")


@dataclass(frozen=True)
class Condition:
    """What is set in an experiment: force (N), speed of sliding (m/s) and amplitude (m)."""

    normal_force: si.Newton
    speed: si.MetrePerSecond
    amplitude: si.Metre


@dataclass(frozen=True)
class BestExperiment:
    """Of two laws: where one measurement tells them best apart, and where a ratio of two does.

    `means` are µ′/µ by either law there (geometric means over the draws); `of` is the choice that
    the two are options of.
    """

    pair: tuple[str, str]
    of: str
    condition: Condition
    means: tuple[si.Dimensionless, si.Dimensionless]
    discriminability: si.Dimensionless
    ratio: tuple[Condition, Condition]
    ratio_means: tuple[si.Dimensionless, si.Dimensionless]
    ratio_discriminability: si.Dimensionless

    @property
    def right(self) -> si.Dimensionless:
        """The probability that one measurement chooses the right one of the two."""
        return _right(self.discriminability)

    @property
    def ratio_right(self) -> si.Dimensionless:
        """The same of the ratio."""
        return _right(self.ratio_discriminability)


@dataclass(frozen=True)
class Overall:
    """One condition for all options of a choice (`of`): `least` is the probability of choosing the
    right one of the two that are told worst there."""

    of: str
    condition: Condition
    least: si.Dimensionless


@dataclass(frozen=True, eq=False)
class ToldApart:
    """How well each pair of laws is told apart at each condition.

    `discriminability` has the shape (pairs, forces, speeds, amplitudes), NaN where more than 2 %
    of the draws are refused; `best` is in the order of the pairs. `overall` is, of the laws of
    heights and of the shear elements, the one condition at which the pair told worst is told best.
    """

    forces: si.NewtonArray
    speeds: si.MetrePerSecondArray
    amplitudes: si.MetreArray
    pairs: tuple[tuple[str, str], ...]
    discriminability: si.DimensionlessArray
    best: tuple[BestExperiment, ...]
    overall: tuple[Overall, ...]
    noise: si.Dimensionless
    draws: int

    def summary(self) -> dict[str, Any]:
        """The numbers for ``--json``, with units in the keys."""
        return {
            "forces_N": self.forces.tolist(),
            "speeds_m_per_s": self.speeds.tolist(),
            "amplitudes_m": self.amplitudes.tolist(),
            "noise": self.noise,
            "draws": self.draws,
            "discriminability": [
                {"pair": list(pair), "d": [[list(map(_number, c)) for c in b] for b in a]}
                for pair, a in zip(self.pairs, self.discriminability, strict=True)
            ],
            "best": [
                {
                    "pair": list(one.pair),
                    "of": one.of,
                    "condition": _keyed(one.condition),
                    "relative_friction": list(one.means),
                    "discriminability": one.discriminability,
                    "probability_right": one.right,
                    "ratio": [_keyed(at) for at in one.ratio],
                    "ratio_of_frictions": list(one.ratio_means),
                    "ratio_discriminability": one.ratio_discriminability,
                    "ratio_probability_right": one.ratio_right,
                }
                for one in self.best
            ],
            "best_for_all": [
                {"of": one.of, **_keyed(one.condition), "least_probability_right": one.least}
                for one in self.overall
            ],
        }


def tell_apart(
    display: Display,
    prediction: Prediction,
    *,
    seed: int = 1,
    draws: int = DRAWS,
    progress: SayProgress | None = None,
) -> ToldApart:
    """Which force, speed and amplitude tell the laws of a display's friction best apart.

    At the prediction's frequency and surface. Parameters, moisture and slip law are drawn (`draws`
    Sobol' points, a power of two) and the same under each of the nine pairs of a law of heights
    with a shear element; where one of the two is told apart, the other is drawn by its weight.
    Force, speed and amplitude are set, and known. Raises `InputError` where the description or the
    model leaves nothing to tell apart, or nothing can be asked at any condition.
    """
    tell = progress or (lambda _: None)
    mixture = Mixture(display, prediction, driven=False)
    choices = {one.path: one for one in mixture.inputs if isinstance(one, Choice)}
    if HEIGHT_LAW not in choices or SHEAR not in choices:
        raise InputError(
            "there is nothing to tell apart: the description or the model asked for has settled "
            "the law of heights or the shear element; ask without a model by name"
        )
    heights, shears = choices[HEIGHT_LAW], choices[SHEAR]
    found = _frictions(mixture, sobol_points(mixture, draws, seed), heights, shears, tell)
    # Refused under one law is refused under all: they are compared at the same draws.
    lost = np.isnan(found).any(axis=(0, 1)).mean(axis=0) > MOST_REFUSED
    if lost.all():
        raise InputError("nowhere on the grid can the laws be asked; take a smaller amplitude")
    weights = [np.array([one.weight for one in side.options]) for side in (heights, shears)]
    by_height, by_shear = found, np.swapaxes(found, 0, 1)
    pairs: list[tuple[str, str]] = []
    tables: list[si.DimensionlessArray] = []
    best: list[BestExperiment] = []
    overall: list[Overall] = []
    for side, values, other in (
        (heights, by_height, weights[1]),
        (shears, by_shear, weights[0]),
    ):
        for i, j in itertools.combinations(range(len(side.options)), 2):
            pair = side.options[i].name, side.options[j].name
            d = _discriminability(values[i], values[j], other / other.sum())
            d[lost] = np.nan
            pairs.append(pair)
            tables.append(d)
            best.append(_best(pair, side.path, (values[i], values[j]), other / other.sum(), d))
        least = np.min(tables[-len(side.options) * (len(side.options) - 1) // 2 :], axis=0)
        at = int(np.nanargmax(least))
        overall.append(Overall(side.path, _condition(at), _right(float(least.ravel()[at]))))
    return ToldApart(
        FORCES,
        SPEEDS,
        AMPLITUDES,
        tuple(pairs),
        np.array(tables),
        tuple(best),
        tuple(overall),
        NOISE,
        draws,
    )


@as_drawn()
def _frictions(
    mixture: Mixture,
    points: si.DimensionlessArray,
    heights: Choice,
    shears: Choice,
    tell: SayProgress,
) -> si.DimensionlessArray:
    """µ′/µ, shape (heights, shears, draws, forces, speeds, amplitudes); NaN where refused."""
    names = [[one.name for one in side.options] for side in (heights, shears)]
    form = (*map(len, names), len(points), FORCES.size, SPEEDS.size, AMPLITUDES.size)
    found = np.full(form, np.nan)
    for k, (values, chosen) in enumerate(mixture.values(points)):
        tell(f"laws under draw {k + 1} of {len(points)}")
        for (i, height), (j, shear) in itertools.product(*map(enumerate, names)):
            draw = mixture.made(values, {**chosen, HEIGHT_LAW: height, SHEAR: shear})
            law = mixture.law(draw)
            for f, force in enumerate(FORCES):
                at = dataclasses.replace(law, normal_force=float(force))
                found[i, j, k, f] = _over_grid(at, values.get(SKIN_COMPLIANCE, 1.0))
    return found


def _over_grid(law: FrictionLaw, compliance: si.Dimensionless) -> si.DimensionlessArray:
    """µ′/µ over speeds and amplitudes of a pad as soft as `compliance` has it; NaN from the
    amplitude on that is refused."""
    rows = np.full((SPEEDS.size, AMPLITUDES.size), np.nan)
    # Where all that touches slips, speed makes no difference.
    speeds = SPEEDS[:1] if law.finger.tangential_stiffness == "rigid" else SPEEDS
    for count in range(AMPLITUDES.size, 0, -1):
        try:
            own, tied = (law.over_speeds(AMPLITUDES[:count], speeds, limit) for limit in _LIMITS)
        except SqueezefilmError:
            continue
        rows[:, :count] = compliance * own + (1 - compliance) * tied
        break
    return rows


def _moments(
    values: si.DimensionlessArray, weights: si.DimensionlessArray
) -> tuple[si.DimensionlessArray, si.DimensionlessArray]:
    """Mean and variance over draws and, by their weights, over the other choice; `values` of shape
    (other choice, draws, …)."""
    mean = np.tensordot(weights, np.nanmean(values, axis=1), 1)
    square = np.tensordot(weights, np.nanmean(values**2, axis=1), 1)
    return mean, np.maximum(square - mean**2, 0.0)


def _discriminability(
    one: si.DimensionlessArray, other: si.DimensionlessArray, weights: si.DimensionlessArray
) -> si.DimensionlessArray:
    """d of two laws at every condition, shape (forces, speeds, amplitudes)."""
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # means of what was refused throughout
        (a, spread_a), (b, spread_b) = (_moments(values, weights) for values in (one, other))
    noise = NOISE**2 * (a**2 + b**2) / 2
    return np.asarray(np.abs(a - b) / np.sqrt((spread_a + spread_b) / 2 + noise))


def _best(
    pair: tuple[str, str],
    of: str,
    values: tuple[si.DimensionlessArray, si.DimensionlessArray],
    weights: si.DimensionlessArray,
    d: si.DimensionlessArray,
) -> BestExperiment:
    """The best condition of a pair, and its best ratio of two conditions."""
    known = np.flatnonzero(np.isfinite(d))
    place = int(np.argmax(d.ravel()[known]))
    at = int(known[place])
    logs = [np.log(one.reshape(*one.shape[:2], -1)[..., known]) for one in values]
    means = [float(np.exp(_moments(one, weights)[0][place])) for one in logs]
    first, second = np.triu_indices(known.size, 1)
    (a, spread_a), (b, spread_b) = (
        _moments(one[..., first] - one[..., second], weights) for one in logs
    )
    apart = np.abs(a - b) / np.sqrt((spread_a + spread_b) / 2 + 2 * NOISE**2)
    ratio = int(np.argmax(apart))
    return BestExperiment(
        pair,
        of,
        _condition(at),
        (means[0], means[1]),
        float(d.ravel()[at]),
        (_condition(int(known[first[ratio]])), _condition(int(known[second[ratio]]))),
        (float(np.exp(a[ratio])), float(np.exp(b[ratio]))),
        float(apart[ratio]),
    )


def _condition(at: int) -> Condition:
    """A condition of the grid by its place."""
    f, s, a = np.unravel_index(at, (FORCES.size, SPEEDS.size, AMPLITUDES.size))
    return Condition(float(FORCES[f]), float(SPEEDS[s]), float(AMPLITUDES[a]))


def _keyed(at: Condition) -> dict[str, float]:
    return {
        "normal_force_N": at.normal_force,
        "speed_m_per_s": at.speed,
        "vibration_amplitude_m": at.amplitude,
    }


def _number(value: float) -> float | None:
    return None if np.isnan(value) else float(value)


def _right(d: si.Dimensionless) -> si.Dimensionless:
    """Φ(d/2)."""
    from scipy.special import ndtr

    return float(ndtr(d / 2))
