"""Models of the tasks for `Placement`: of two answers and of many, with one parameter to three."""

from __future__ import annotations

import itertools
import math
from typing import Annotated

import numpy as np
from scipy.special import ndtr

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.senses import D_PRIME_OF_75
from squeezefilm.study.adaptive.placement import PlacementModel

Rates = Annotated[si.DimensionlessArray, si.AtLeast(0.0), si.Below(1.0)]
Positive = Annotated[si.FloatArray, si.Above(0.0)]
LAPSES: si.DimensionlessArray = np.array([0.005, 0.02, 0.05, 0.1])


def _lapse_prior(lapses: si.DimensionlessArray) -> dict[str, si.FloatArray]:
    return {"lapse rate": (1.0 - lapses) ** 9}


def _grid(*values: si.FloatArray) -> tuple[si.FloatArray, ...]:
    """All combinations, each of shape (cells, 1), the last running fastest."""
    return tuple(one.reshape(-1, 1) for one in np.meshgrid(*values, indexing="ij"))


def _two(
    first: str, second: str, chance: si.FloatArray
) -> tuple[tuple[str, ...], si.DimensionlessArray]:
    return (first, second), np.stack([chance, 1.0 - chance])


@si.checked_numbers
def two_interval_model(
    differences: si.FloatArray,
    weber_fractions: Positive,
    biases: si.FloatArray | None = None,
    lapses: Rates = LAPSES,
) -> PlacementModel:
    """Two intervals, which has more: λ/2 + (1 − λ) Φ((Δ − b)/s), s of the Weber fraction.

    `differences` are of the logarithms of first and second; `biases` b likewise (none without
    them). Of interest is the Weber fraction. Raises `InputError` as `PlacementModel` does.
    """
    bias = np.zeros(1) if biases is None else biases
    weber, b, lapse = _grid(weber_fractions, bias, lapses)
    rise = ndtr((differences - b) * D_PRIME_OF_75 / (math.sqrt(2) * np.log1p(weber)))
    answers, chances = _two("first", "second", 0.5 * lapse + (1.0 - lapse) * rise)
    parameters = {"Weber fraction": weber_fractions, "bias": bias, "lapse rate": lapses}
    return PlacementModel(parameters, differences, answers, chances, _lapse_prior(lapses))


def differencing_rate(d_prime: float, criterion: float) -> float:
    """Share of "different" to a difference, where that of the percepts decides (Macmillan and
    Creelman 2005, chapter 9); its false alarms are those of d′ = 0."""
    root = math.sqrt(2.0)
    return float(ndtr((d_prime - criterion) / root) + ndtr((-d_prime - criterion) / root))


@si.checked_numbers
def same_different_model(
    differences: Annotated[si.FloatArray, si.AtLeast(0.0)],
    weber_fractions: Positive,
    criteria: Positive,
    lapses: Rates = LAPSES,
) -> PlacementModel:
    """Same or different by the differencing model, as `tasks.on_grid` has it.

    `differences` are of the logarithms, 0 among them or the criterion is not told from the Weber
    fraction; `criteria` are in standard deviations of one percept. Of interest is the Weber
    fraction. Raises `InputError` where 0 is not among the differences, or as `PlacementModel` does.
    """
    if not np.any(differences == 0.0):
        raise InputError(
            "without a pair that is the same nobody can tell who is sharp from who says "
            "'different'; put 0 among the differences",
            quantity="differences",
        )
    weber, limit, lapse = _grid(weber_fractions, criteria, lapses)
    z = differences * D_PRIME_OF_75 / np.log1p(weber)
    rise = ndtr((z - limit) / math.sqrt(2)) + ndtr((-z - limit) / math.sqrt(2))
    answers, chances = _two("different", "same", 0.5 * lapse + (1.0 - lapse) * rise)
    parameters = {"Weber fraction": weber_fractions, "criterion": criteria, "lapse rate": lapses}
    return PlacementModel(parameters, differences, answers, chances, _lapse_prior(lapses))


@si.checked_numbers
def match_to_sample_model(
    values: Positive, weber_fractions: Positive, lapses: Rates = LAPSES
) -> PlacementModel:
    """Match to sample: an observer of the logarithm with criteria midway between the samples.

    `values` rise, two or more; each is a stimulus and the right answer to it. Who lapses says any
    answer. Of interest is the Weber fraction. Raises `InputError` for values that do not rise, or
    as `PlacementModel` does.
    """
    if np.any(np.diff(values) <= 0.0):
        raise InputError("values must rise; sort them, each only once", quantity="values")
    weber, lapse = _grid(weber_fractions, lapses)
    places = np.log(values)
    limits = np.concatenate([[-np.inf], 0.5 * (places[1:] + places[:-1]), [np.inf]])
    z = (limits[:, None, None] - places) * D_PRIME_OF_75 / np.log1p(weber)
    chances = lapse / values.size + (1.0 - lapse) * np.diff(ndtr(z), axis=0)
    parameters = {"Weber fraction": weber_fractions, "lapse rate": lapses}
    answers = tuple(f"{one:g}" for one in values)
    return PlacementModel(parameters, values, answers, chances, _lapse_prior(lapses))


@si.checked_numbers
def magnitude_model(
    values: Positive,
    exponents: si.FloatArray,
    scales: Positive,
    noises: Positive,
    edges: Positive,
) -> PlacementModel:
    """Magnitude estimation: ln number = ln scale + exponent · ln(value over the geometric mean of
    all) + noise.

    Numbers are told apart as far as `edges` do, rising: the number of an answer is
    ``np.searchsorted(edges, number)``. `scales` are numbers given to the mean, `noises` the
    standard deviation of the logarithm. Of interest is the exponent. Raises `InputError` for edges
    that do not rise, or as `PlacementModel` does.
    """
    if np.any(np.diff(edges) <= 0.0):
        raise InputError("edges must rise; sort them, each only once", quantity="edges")
    exponent, scale, noise = _grid(exponents, scales, noises)
    places = np.log(values) - np.log(values).mean()
    limits = np.concatenate([[-np.inf], np.log(edges), [np.inf]])[:, None, None]
    chances = np.diff(ndtr((limits - np.log(scale) - exponent * places) / noise), axis=0)
    names = ("", *(f"{one:g}" for one in edges), "")
    answers = tuple(f"{low} to {high}".strip() for low, high in itertools.pairwise(names))
    parameters = {"exponent": exponents, "scale": scales, "noise": noises}
    return PlacementModel(parameters, values, answers, chances, {})
