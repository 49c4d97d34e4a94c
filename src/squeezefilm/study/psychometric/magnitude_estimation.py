"""Magnitude estimation: Stevens' power law from numbers that people give to sensations.

Every person has a scale of numbers of their own. It is taken out by an intercept of their own in
the regression of ln number on ln intensity, or by modulus equalisation (Lane, Catania & Stevens
1961, 10.1121/1.1908600) before geometric means are formed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
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
    x, y, people, who = _logarithms(intensity, estimate, participant)
    si.require("level", level, above=0.0, below=1.0)
    for number, name in enumerate(people):
        if np.unique(x[who == number]).size < 2:
            raise InputError(
                f"participant '{name}' judged one intensity only; an exponent needs two or more"
            )
    # Least squares of everyone's own line: sums of dx² and of dx·dy about their means.
    middle_x, middle_y = _means(who, x), _means(who, y)
    dx, dy = x - middle_x[who], y - middle_y[who]
    spread, within = np.bincount(who, dx * dx), np.bincount(who, dx * dy)
    exponents = within / spread
    freedom = x.size - 2 * len(people)
    squares = float(np.sum((dy - exponents[who] * dx) ** 2))
    residual = float(np.sqrt(squares / freedom)) if freedom > 0 else 0.0
    if len(people) > 1:
        degrees = len(people) - 1
        error = float(exponents.std(ddof=1)) / np.sqrt(len(people))
    else:
        degrees = freedom
        error = residual / np.sqrt(spread[0])
        if degrees < 1:
            raise InputError("one participant with two trials has no interval; give three or more")
    mean = float(exponents.mean())
    reach = float(stdtrit(degrees, 0.5 + 0.5 * level)) * error
    return PowerLaw(
        exponent=mean,
        interval=(mean - reach, mean + reach),
        level=level,
        participants=people,
        exponents=exponents,
        moduli=np.exp(middle_y - exponents * middle_x),
        pooled_exponent=float(within.sum() / spread.sum()),
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
    given = np.ones_like(np.asarray(estimate, dtype=float))
    _, y, _, who = _logarithms(given, estimate, participant)
    means = _means(who, y)
    return np.asarray(np.exp(y - means[who] + means.mean()))


def geometric_means(
    intensity: ArrayLike, estimate: ArrayLike
) -> tuple[si.FloatArray, si.FloatArray]:
    """Different intensities in rising order, and the geometric mean of the numbers given to each.

    Raises:
        InputError: data of unlike shapes or not above 0.
    """
    _, y, _, _ = _logarithms(intensity, estimate, np.zeros(np.shape(estimate), dtype=int))
    given = np.asarray(intensity, dtype=float)
    places, where = np.unique(given, return_inverse=True)
    return places, np.exp(_means(where, y))


def _means(group: si.IntArray, values: si.FloatArray) -> si.FloatArray:
    return np.asarray(np.bincount(group, values) / np.bincount(group))


def _logarithms(
    intensity: ArrayLike, estimate: ArrayLike, participant: ArrayLike
) -> tuple[si.FloatArray, si.FloatArray, tuple[str, ...], si.IntArray]:
    """ln of intensities and estimates, the participants' names in order, and whose each row is."""
    given, numbers = np.asarray(intensity, dtype=float), np.asarray(estimate, dtype=float)
    who = np.asarray(participant)
    if given.ndim != 1 or not given.shape == numbers.shape == who.shape or given.size == 0:
        raise InputError(
            f"intensity, estimate and participant have the shapes {given.shape}, {numbers.shape} "
            f"and {who.shape}; all must be one-dimensional, of one length, with at least one row"
        )
    si.require("intensity", given, above=0.0)
    si.require("estimate", numbers, above=0.0)
    names, whose = np.unique([str(one) for one in who], return_inverse=True)
    return np.log(given), np.log(numbers), tuple(names.tolist()), whose
