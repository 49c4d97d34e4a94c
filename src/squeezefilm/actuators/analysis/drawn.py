"""Certainty of an actuator's answers, and its causes: all that nobody knows drawn together."""

from __future__ import annotations

import collections
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np
from scipy.stats import qmc, spearmanr

from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.distributions import Uniform
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.kit.numbers import shown
from squeezefilm.core.progress import CountProgress
from squeezefilm.physics.uncertainty.parameters import Parameter, value_at, with_values

COUNT, SEED = 64, 20081
LEVELS: tuple[float, float, float] = (0.05, 0.5, 0.95)
"""The ends and the middle of an interval, as quantiles of the draws."""

_Described = TypeVar("_Described")


class Usual(NamedTuple):
    """A range in shares of the nominal value, at most `most`, and why: taken for a value that the
    file gives no range of."""

    low: float
    high: float
    why: str
    most: float = float("inf")


@dataclass(frozen=True, eq=False)
class DrawnAnswers:
    """Answers of an actuator where what is uncertain is drawn, `count` times.

    `intervals` have the quantiles `LEVELS` of each answer, of the draws in which the actuator
    works; `refused` is in how many it does not, most often because of `reason`. `drawn` are the
    values and their ranges; `shares` say of each answer how much of its spread follows each of
    them: squares of Spearman's rank correlation, which some 0.05 of chance are in.
    """

    intervals: Mapping[str, tuple[float, float, float]]
    shares: Mapping[str, tuple[float, ...]]
    count: int
    refused: int
    reason: str
    seed: int
    drawn: tuple[Parameter, ...]


def drawn_answers(
    described: _Described,
    provenance: Mapping[str, Provenance],
    usual: Mapping[str, Usual],
    answers: Callable[[_Described], Mapping[str, float]],
    *,
    progress: CountProgress | None = None,
) -> DrawnAnswers:
    """The `answers` of a description with the values of `usual` (by dotted path) drawn: from the
    distribution that the file gives where it gives one, else evenly from the usual range.

    Scrambled Sobol' points of one seed: the same description has the same intervals, whose ends
    64 draws find to some 5 % of the probability. A draw that cannot work is counted and left out,
    so that the interval is of actuators that do. Where fewer than half work there is no interval.
    """
    drawn = tuple(_parameters(described, provenance, usual))
    points = qmc.Sobol(len(drawn), scramble=True, rng=SEED).random(COUNT)
    columns = [np.array(value.drawn(points[:, k])) for k, value in enumerate(drawn)]
    answered: list[Mapping[str, float]] = []
    worked: list[int] = []
    reasons: collections.Counter[str] = collections.Counter()
    for row in range(COUNT):
        values = {
            value.path: float(column[row]) for value, column in zip(drawn, columns, strict=True)
        }
        try:
            answered.append(answers(with_values(described, values)))
            worked.append(row)
        except SqueezefilmError as error:
            # Of one cause the numbers differ from draw to draw.
            reasons[str(error).split(":", 1)[0].split(" is ", 1)[0]] += 1
        if progress is not None:
            progress(row + 1, COUNT)
    intervals, shares = {}, {}
    if len(answered) > COUNT // 2:
        for name in answered[0]:
            values_of = np.array([answer[name] for answer in answered])
            low, middle, high = np.quantile(values_of, LEVELS).tolist()
            intervals[name] = (low, middle, high)
            shares[name] = tuple(_share(column[worked], values_of) for column in columns)
    reason = reasons.most_common(1)[0][0] if reasons else ""
    refused = COUNT - len(answered)
    return DrawnAnswers(intervals, shares, COUNT, refused, reason, SEED, drawn)


def with_interval(sampled: DrawnAnswers, value: float, name: str, unit: si.Unit) -> str:
    """A value (in its unit) and what lies between 5 and 95 % of the draws of the answer `name`."""
    interval = sampled.intervals.get(name)
    said = shown(value, unit, 3)
    if interval is None:
        return said
    return f"{said} ({shown(interval[0], unit, 2)} to {shown(interval[2], unit, 2)})"


def _share(drawn: si.FloatArray, answers: si.FloatArray) -> float:
    """The share of the answers' spread that follows one drawn value."""
    if np.ptp(answers) <= 1e-12 * np.max(np.abs(answers)):
        return 0.0
    return float(spearmanr(drawn, answers).statistic ** 2)


def _parameters(
    described: object, provenance: Mapping[str, Provenance], usual: Mapping[str, Usual]
) -> list[Parameter]:
    parameters = []
    for path, known in usual.items():
        nominal, unit = value_at(described, path)
        origin = provenance.get(path)
        given = None if origin is None else origin.distribution
        if given is not None and origin is not None:
            parameters.append(Parameter(path, nominal, unit, given, "given", origin.source))
        elif nominal:
            low, high = sorted((known.low * nominal, min(known.high * nominal, known.most)))
            spread = Uniform(low, high)
            parameters.append(Parameter(path, nominal, unit, spread, "assumed", known.why))
    return parameters
