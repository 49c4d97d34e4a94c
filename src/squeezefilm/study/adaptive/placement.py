"""The next stimulus of any task: the one whose answer is expected to tell the most.

QUEST+ (Watson 2017, 10.1167/17.3.10): a model says how probable each of several answers to each
stimulus is under each value of its parameters; answers weigh the values, and the stimulus is chosen
whose answer is expected to lower the entropy of what is of interest the most. `BayesianAdaptive` is
the same for psychometric functions.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.errors import InputError


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class PlacementModel:
    """Chances of the answers to each stimulus under each value of the parameters.

    Args:
        parameters: values of each parameter on a grid, by name; cells are their combinations, the
            last parameter running fastest.
        stimuli: what there is to choose from, two or more, in the model's unit.
        answers: names of the answers, two or more.
        chances: probability of each answer, shape (answers, cells, stimuli), 1 in the sum of all.
        prior: probability of each value of the parameters that are not equally probable, by name.
        interest: how many parameters, from the first on, are of interest; the rest are integrated
            out before the entropy is taken. At least 1.

    Raises:
        InputError: shapes that do not fit, probabilities that do not sum to 1, or stimuli between
            which no answer tells anything.
    """

    parameters: Mapping[str, si.FloatArray]
    stimuli: si.FloatArray
    answers: tuple[str, ...]
    chances: Annotated[si.FloatArray, si.AtLeast(0.0), si.AtMost(1.0)]
    prior: Mapping[str, si.FloatArray]
    interest: Annotated[int, si.AtLeast(1)] = 1

    def __post_init__(self) -> None:
        shape = len(self.answers), math.prod(self.sizes), len(self.stimuli)
        if self.chances.shape != shape or shape[0] < 2 or shape[2] < 2:
            raise InputError(
                f"chances have the shape {self.chances.shape}; these answers, parameters and "
                f"stimuli want {shape}, with two or more answers and stimuli",
                quantity="chances",
            )
        if not np.allclose(self.chances.sum(axis=0), 1.0):
            raise InputError("the probabilities of all answers must sum to 1", quantity="chances")
        for name, weights in self.prior.items():
            wanted = np.shape(self.parameters.get(name, ()))
            if np.shape(weights) != wanted or not np.sum(weights) > 0 or np.min(weights) < 0:
                raise InputError(
                    f"the prior of '{name}' must be a probability for each of its values, and "
                    f"'{name}' one of: {', '.join(self.parameters)}",
                    quantity="prior",
                )
        if self.interest > len(self.parameters):
            raise InputError(
                f"interest = {self.interest} of {len(self.parameters)} parameters",
                quantity="interest",
            )
        if np.allclose(self.chances, self.chances[:, :1]):
            raise InputError(
                "every value of the parameters answers alike at all stimuli, so that no answer "
                "tells anything; take other stimuli, or a wider grid",
                quantity="stimuli",
            )

    @property
    def sizes(self) -> tuple[int, ...]:
        """Numbers of values of the parameters."""
        return tuple(len(values) for values in self.parameters.values())

    @property
    def nuisance(self) -> int:
        """Number of cells in a row that differ by what is integrated out."""
        return math.prod(self.sizes[self.interest :])

    def first_weights(self) -> si.DimensionlessArray:
        """Probability of each cell before any answer, shape (cells,); sums to 1."""
        weights = np.ones(1)
        for name, values in self.parameters.items():
            own = np.asarray(self.prior.get(name, np.ones(len(values))), dtype=float)
            weights = np.multiply.outer(weights, own / own.sum()).ravel()
        return weights


class Placement:
    """A choice of stimuli as it runs: `next_stimulus`, then `update`, until `finished`.

    Nothing in it is random: the answers are all its state, and playing them again (`update`)
    gives the placement that was interrupted.
    """

    def __init__(self, model: PlacementModel, trials: int) -> None:
        si.require("trials", trials, at_least=1)
        self.model, self.trials = model, trials
        self._chances = np.ascontiguousarray(model.chances[:-1])
        self._weights = model.first_weights()
        self._given: list[tuple[int, int]] = []

    @property
    def given(self) -> tuple[tuple[int, int], ...]:
        """Numbers of the stimuli and answers so far."""
        return tuple(self._given)

    @property
    def finished(self) -> bool:
        """True where it has its trials."""
        return len(self._given) >= self.trials

    @property
    def probability(self) -> si.DimensionlessArray:
        """Posterior probability of each cell, an axis for each parameter; sums to 1."""
        return self._weights.reshape(self.model.sizes).copy()

    def marginal(self, parameter: str) -> si.DimensionlessArray:
        """Posterior probability of each value of a parameter. Raises `InputError` for a name that
        is none."""
        names = list(self.model.parameters)
        si.require_one_of("parameter", parameter, names)
        rest = tuple(at for at, name in enumerate(names) if name != parameter)
        return np.asarray(self.probability.sum(axis=rest))

    def estimate(self, parameter: str) -> tuple[float, float]:
        """Posterior mean and standard deviation of a parameter; for intervals use the task's own
        analysis. Raises `InputError` for a name that is none."""
        weights, values = self.marginal(parameter), self.model.parameters[parameter]
        mean = float(weights @ values)
        return mean, math.sqrt(float(weights @ (values - mean) ** 2))

    def expected_information(self) -> si.FloatArray:
        """Mutual information of the next answer and what is of interest (nat), shape (stimuli,)."""
        told = np.empty(len(self.model.stimuli))
        information(self._weights, self._chances, self.model.nuisance, told)
        return told

    def next_stimulus(self) -> int:
        """The number of the stimulus whose answer tells the most; of equals the first.

        Raises `InputError` where all trials have been made.
        """
        self._require_room()
        return int(np.argmax(self.expected_information()))

    def update(self, stimulus: int, answer: int) -> None:
        """Take in the answer to whatever stimulus was shown, both by number.

        Raises `InputError` for numbers of none, an answer that is impossible under every value of
        the parameters, or where all trials have been made.
        """
        self._require_room()
        answers, _, stimuli = self.model.chances.shape
        if not (0 <= answer < answers and 0 <= stimulus < stimuli):
            raise InputError(
                f"stimulus {stimulus}, answer {answer}: there are stimuli 0 to {stimuli - 1} and "
                f"answers 0 to {answers - 1}"
            )
        weights = self._weights * self.model.chances[answer, :, stimulus]
        total = float(weights.sum())
        if not total > 0.0:
            raise InputError(
                f"the answer '{self.model.answers[answer]}' to stimulus {stimulus} is impossible "
                "under every value of the parameters; widen their grid",
                quantity="answer",
            )
        self._weights = weights / total
        self._given.append((stimulus, answer))

    def _require_room(self) -> None:
        if self.finished:
            raise InputError(f"all {self.trials} trials have been made; start another")


@compiled(error_model="numpy")
def _term(p: float) -> float:
    """−p ln p."""
    return -p * math.log(p) if p > 0.0 else 0.0


@compiled(error_model="numpy")
def information(
    weights: si.FloatArray, chances: si.FloatArray, nuisance: int, told: si.FloatArray
) -> None:
    """Mutual information (nat) of the next answer and what is of interest, of every stimulus.

    `weights` (cells,) sum to 1; `chances` (answers − 1, cells, stimuli) are the probabilities of
    all answers but the last. Of every `nuisance` cells in a row only the sum is of interest. Fills
    `told` (stimuli,).
    """
    answers, cells, stimuli = chances.shape
    total = np.zeros((answers, stimuli))
    joint = np.empty((answers, stimuli))
    told[:] = 0.0
    for first in range(0, cells, nuisance):
        share = 0.0
        for cell in range(first, first + nuisance):
            share += weights[cell]
        if share <= 0.0:
            continue
        joint[:] = 0.0
        for answer in range(answers):
            here = joint[answer]
            for cell in range(first, first + nuisance):
                weight, chance = weights[cell], chances[answer, cell]
                for at in range(stimuli):
                    here[at] += weight * chance[at]
        for at in range(stimuli):
            rest, known = share, 0.0
            for answer in range(answers):
                rest -= joint[answer, at]
                total[answer, at] += joint[answer, at]
                known += _term(joint[answer, at] / share)
            told[at] -= share * (known + _term(rest / share))
    for at in range(stimuli):
        rest, guessed = 1.0, 0.0
        for answer in range(answers):
            p = total[answer, at]
            rest -= p
            guessed += _term(p)
        told[at] += guessed + _term(rest)
