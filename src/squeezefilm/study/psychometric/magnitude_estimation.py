"""Magnitude estimation: Stevens' power law from numbers that people give to sensations.

Every person has a scale of numbers of their own. It is taken out by an intercept of their own in
the regression of ln number on ln intensity, or by modulus equalisation (Lane, Catania & Stevens
1961, 10.1121/1.1908600) before geometric means are formed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.study.psychometric.fit import Interval


@dataclass(frozen=True, slots=True, eq=False)
class PowerLaw:
    """number = modulus · intensityⁿ, with the exponent n of a population of people.

    Attributes:
        exponent: mean of the people's exponents.
        interval: of `exponent`, by Student's t.
        level: of the interval.
        participants: their names, shape (people,).
        exponents: one a participant, shape (people,).
        moduli: one a participant: the number at unit intensity by their own exponent.
        pooled_exponent: by least squares with one slope for all and an intercept for each.
        residual: standard deviation of ln number about the people's own lines.
        degrees_of_freedom: of t: people − 1, or trials − 2 of one person.
    """

    exponent: si.Dimensionless
    interval: Interval
    level: si.Dimensionless
    participants: tuple[str, ...]
    exponents: si.FloatArray
    moduli: si.FloatArray
    pooled_exponent: si.Dimensionless
    residual: si.Dimensionless
    degrees_of_freedom: int


class _Line(NamedTuple):
    """One person's ln number over ln intensity, by least squares: slope, value at ln intensity 0,
    and the sums of dx², of dx · dy and of what is left, squared."""

    slope: float
    start: float
    spread: float
    within: float
    squares: float


def _line(name: str, x: si.FloatArray, y: si.FloatArray) -> _Line:
    """The line of a person. Raises `InputError` where all intensities are the same."""
    dx, dy = x - x.mean(), y - y.mean()
    if np.unique(x).size < 2:
        raise InputError(
            f"participant '{name}' judged one intensity only; an exponent needs two or more"
        )
    spread, within = float(dx @ dx), float(dx @ dy)
    slope = within / spread
    start = float(y.mean() - slope * x.mean())
    return _Line(slope, start, spread, within, float(np.sum((dy - slope * dx) ** 2)))


def fit_power_law(
    intensity: ArrayLike,
    estimate: ArrayLike,
    participant: ArrayLike,
    *,
    level: si.Dimensionless = 0.95,
) -> PowerLaw:
    """Stevens' exponent from magnitude estimates, with an intercept and a slope for each person.

    The interval is that of the mean over people (for one person, of their line): people are the
    sample, trials of one person are not independent of each other. All people weigh the same.

    Args:
        intensity: of the stimuli, above 0, shape (trials,).
        estimate: the numbers given, above 0, shape (trials,).
        participant: who gave it, shape (trials,).
        level: of the interval.

    Raises:
        InputError: data of unlike shapes or not above 0, a participant with fewer than two
            different intensities, or one single participant with fewer than three trials.
    """
    x, y, who = _logarithms(intensity, estimate, participant)
    si.require("level", level, above=0.0, below=1.0)
    people = sorted(set(who))
    names = np.array(who)
    lines = [_line(name, x[names == name], y[names == name]) for name in people]
    freedom = x.size - 2 * len(people)
    exponents = np.array([one.slope for one in lines])
    squares = sum(one.squares for one in lines)
    residual = float(np.sqrt(squares / freedom)) if freedom > 0 else 0.0
    if len(people) > 1:
        degrees = len(people) - 1
        error = float(exponents.std(ddof=1)) / np.sqrt(len(people))
    else:
        degrees = freedom
        error = residual / np.sqrt(lines[0].spread)
        if degrees < 1:
            raise InputError("one participant with two trials has no interval; give three or more")
    mean = float(exponents.mean())
    reach = float(stdtrit(degrees, 0.5 + 0.5 * level)) * error
    return PowerLaw(
        exponent=mean,
        interval=(mean - reach, mean + reach),
        level=level,
        participants=tuple(people),
        exponents=exponents,
        moduli=np.exp(np.array([one.start for one in lines])),
        pooled_exponent=sum(one.within for one in lines) / sum(one.spread for one in lines),
        residual=residual,
        degrees_of_freedom=degrees,
    )


def equalised_estimates(estimate: ArrayLike, participant: ArrayLike) -> si.FloatArray:
    """Estimates with the modulus of every person made the same, shape (trials,).

    Each person's numbers are multiplied by what makes their geometric mean that of all people
    (each weighing the same). People must have judged the same intensities equally often.

    Raises:
        InputError: data of unlike shapes or not above 0.
    """
    _, y, who = _logarithms(np.ones_like(np.asarray(estimate, dtype=float)), estimate, participant)
    people = sorted(set(who))
    names = np.array(who)
    means = {name: float(y[names == name].mean()) for name in people}
    middle = float(np.mean([means[name] for name in people]))
    return np.asarray(np.exp(y - np.array([means[name] for name in who]) + middle))


def geometric_means(
    intensity: ArrayLike, estimate: ArrayLike
) -> tuple[si.FloatArray, si.FloatArray]:
    """Different intensities in rising order, and the geometric mean of the numbers given to each.

    Raises:
        InputError: data of unlike shapes or not above 0.
    """
    _, y, _ = _logarithms(intensity, estimate, np.zeros(np.shape(estimate), dtype=int))
    given = np.asarray(intensity, dtype=float)
    places, where = np.unique(given, return_inverse=True)
    return places, np.exp(np.bincount(where, y) / np.bincount(where))


def _logarithms(
    intensity: ArrayLike, estimate: ArrayLike, participant: ArrayLike
) -> tuple[si.FloatArray, si.FloatArray, list[str]]:
    given, numbers = np.asarray(intensity, dtype=float), np.asarray(estimate, dtype=float)
    who = np.asarray(participant)
    if given.ndim != 1 or not given.shape == numbers.shape == who.shape or given.size == 0:
        raise InputError(
            f"intensity, estimate and participant have the shapes {given.shape}, {numbers.shape} "
            f"and {who.shape}; all must be one-dimensional, of one length, with at least one row"
        )
    si.require("intensity", given, above=0.0)
    si.require("estimate", numbers, above=0.0)
    return np.log(given), np.log(numbers), [str(one) for one in who]
