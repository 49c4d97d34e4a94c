"""Models of tasks, of two answers and of many, with one parameter to three; and the choice of the
stimulus whose answer is expected to tell the most of them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from scipy.special import entr, ndtr

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.senses import D_PRIME_OF_75
from squeezefilm.study.adaptive.bayesian import information

Rates = Annotated[si.DimensionlessArray, si.AtLeast(0.0), si.Below(1.0)]
Positive = Annotated[si.FloatArray, si.Above(0.0)]
LAPSES: si.DimensionlessArray = np.array([0.005, 0.02, 0.05, 0.1])


@dataclass(frozen=True, eq=False)
class PlacementModel:
    """Chances of each answer, shape (answers, cells, stimuli), to stimuli under every combination
    (cell) of the parameters' values, the last running fastest. The first `interest` parameters are
    of interest; `prior` is of those that are not equally probable."""

    parameters: Mapping[str, si.FloatArray]
    stimuli: si.FloatArray
    answers: tuple[str, ...]
    chances: si.DimensionlessArray
    prior: Mapping[str, si.FloatArray]
    interest: int = 1

    @property
    def sizes(self) -> tuple[int, ...]:
        """Numbers of values of the parameters."""
        return tuple(len(values) for values in self.parameters.values())

    def first_weights(self) -> si.DimensionlessArray:
        """Probability of each cell before any answer, shape (cells,); sums to 1."""
        weights = np.ones(1)
        for name, values in self.parameters.items():
            own = np.asarray(self.prior.get(name, np.ones(len(values))), dtype=float)
            weights = np.multiply.outer(weights, own / own.sum()).ravel()
        return weights


class Placement:
    """A choice of stimuli as it runs: `next_stimulus`, then `update`, until `finished`."""

    def __init__(self, model: PlacementModel, trials: int) -> None:
        self.model, self.trials = model, trials
        self._weights, self._given = model.first_weights(), 0

    @property
    def finished(self) -> bool:
        """True where it has its trials."""
        return self._given >= self.trials

    @property
    def probability(self) -> si.DimensionlessArray:
        """Posterior probability of each cell, an axis for each parameter; sums to 1."""
        return self._weights.reshape(self.model.sizes)

    def expected_information(self) -> si.FloatArray:
        """Information of the next answer to each stimulus on what is of interest (nat)."""
        nuisance = math.prod(self.model.sizes[self.model.interest :])
        weights, chances = self._weights.reshape(-1, nuisance), self.model.chances
        if len(chances) == 2:
            return information(self._weights, np.ascontiguousarray(chances[0]), nuisance)
        share = weights.sum(axis=1, keepdims=True)
        cells = chances.reshape(len(chances), *weights.shape, -1)
        joint = np.einsum("gn,agns->ags", weights, cells)
        # A group that underflowed to 0 tells nothing.
        known = (share * entr(joint / np.where(share > 0, share, 1.0))).sum(axis=(0, 1))
        return np.asarray(entr(joint.sum(axis=1)).sum(axis=0) - known)

    def next_stimulus(self) -> int:
        """The number of the stimulus whose answer tells the most; of equals the first."""
        return int(np.argmax(self.expected_information()))

    def update(self, stimulus: int, answer: int) -> None:
        """Take in the answer to whatever stimulus was shown, both by number."""
        weights = self._weights * self.model.chances[answer, :, stimulus]
        self._weights = weights / weights.sum()
        self._given += 1


def _lapse_prior(lapses: si.DimensionlessArray) -> dict[str, si.FloatArray]:
    return {"lapse rate": (1.0 - lapses) ** 9}


def _grid(*values: si.FloatArray) -> tuple[si.FloatArray, ...]:
    """All combinations, each of shape (cells, 1), the last running fastest."""
    return tuple(one.reshape(-1, 1) for one in np.meshgrid(*values, indexing="ij"))


def _two(
    first: str, second: str, chance: si.FloatArray
) -> tuple[tuple[str, ...], si.DimensionlessArray]:
    return (first, second), np.stack([chance, 1.0 - chance])


def two_interval_model(
    differences: si.FloatArray,
    weber_fractions: Positive,
    biases: si.FloatArray | None = None,
    lapses: Rates = LAPSES,
) -> PlacementModel:
    """Two intervals, which has more: λ/2 + (1 − λ) Φ((Δ − b)/s), s of the Weber fraction.

    `differences` are of the logarithms of first and second; `biases` b likewise (none without
    them). Of interest is the Weber fraction.
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


def same_different_model(
    differences: Annotated[si.FloatArray, si.AtLeast(0.0)],
    weber_fractions: Positive,
    criteria: Positive,
    lapses: Rates = LAPSES,
) -> PlacementModel:
    """Same or different by the differencing model, as `tasks.thresholds` has it.

    `differences` are of the logarithms, 0 among them or the criterion is not told from the Weber
    fraction; `criteria` are in standard deviations of one percept. Of interest is the Weber
    fraction.
    """
    weber, limit, lapse = _grid(weber_fractions, criteria, lapses)
    z = differences * D_PRIME_OF_75 / np.log1p(weber)
    rise = ndtr((z - limit) / math.sqrt(2)) + ndtr((-z - limit) / math.sqrt(2))
    answers, chances = _two("different", "same", 0.5 * lapse + (1.0 - lapse) * rise)
    parameters = {"Weber fraction": weber_fractions, "criterion": criteria, "lapse rate": lapses}
    return PlacementModel(parameters, differences, answers, chances, _lapse_prior(lapses))


def match_to_sample_model(
    values: Positive, weber_fractions: Positive, lapses: Rates = LAPSES
) -> PlacementModel:
    """Match to sample: an observer of the logarithm with criteria midway between the samples.

    `values` rise, two or more; each is a stimulus and the right answer to it. Who lapses says any
    answer. Of interest is the Weber fraction.
    """
    weber, lapse = _grid(weber_fractions, lapses)
    places = np.log(values)
    limits = np.concatenate([[-np.inf], 0.5 * (places[1:] + places[:-1]), [np.inf]])
    z = (limits[:, None, None] - places) * D_PRIME_OF_75 / np.log1p(weber)
    chances = lapse / values.size + (1.0 - lapse) * np.diff(ndtr(z), axis=0)
    parameters = {"Weber fraction": weber_fractions, "lapse rate": lapses}
    answers = tuple(f"{one:g}" for one in values)
    return PlacementModel(parameters, values, answers, chances, _lapse_prior(lapses))


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
    standard deviation of the logarithm. Of interest is the exponent.
    """
    exponent, scale, noise = _grid(exponents, scales, noises)
    places = np.log(values) - np.log(values).mean()
    limits = np.concatenate([[-np.inf], np.log(edges), [np.inf]])[:, None, None]
    chances = np.diff(ndtr((limits - np.log(scale) - exponent * places) / noise), axis=0)
    names = ("", *(f"{one:g}" for one in edges), "")
    answers = tuple(f"{low} to {high}".strip() for low, high in itertools.pairwise(names))
    parameters = {"exponent": exponents, "scale": scales, "noise": noises}
    return PlacementModel(parameters, values, answers, chances, {})
