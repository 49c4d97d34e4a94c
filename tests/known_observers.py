"""Observers whose answer probabilities are known, and people who vary about them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from squeezefilm.core.quantities import FloatArray, IntArray
from squeezefilm.study.identification.power import above_0, distinction_scores


def ordered_observer(spacing: float, stimuli: int = 5) -> FloatArray:
    """Answer probabilities of an unbiased observer of ordered stimuli, shape (answers, stimuli);
    `spacing` is d′ of neighbours (Thurstone's model with equal variances)."""
    place = spacing * np.arange(stimuli)
    criteria = np.concatenate([[-np.inf], 0.5 * (place[1:] + place[:-1]), [np.inf]])
    return np.asarray(np.diff(ndtr(criteria[:, None] - place[None, :]), axis=0))


@dataclass(frozen=True)
class DirichletParticipants:
    """People whose answer probabilities vary about a common matrix (Dirichlet-multinomial): a
    column's are Dirichlet with `concentration` times the common ones."""

    probabilities: FloatArray
    trials_per_stimulus: int
    concentration: float

    def __call__(self, participants: int, random: np.random.Generator) -> IntArray:
        answers, stimuli = self.probabilities.shape
        counts = np.zeros((participants, answers, stimuli), dtype=np.int64)
        for j, column in enumerate(self.probabilities.T):
            some = column > 0
            own = np.zeros((participants, answers))
            own[:, some] = random.dirichlet(self.concentration * column[some], participants)
            own /= own.sum(axis=1, keepdims=True)
            counts[:, :, j] = random.multinomial(self.trials_per_stimulus, own)
        return counts


def distinction(counts: IntArray, first: int, second: int) -> float:
    """p of the test over people that they tell two stimuli apart."""
    return above_0(distinction_scores(counts, first, second))


def even_errors(proportion_correct: float, stimuli: int = 5) -> np.ndarray:
    """Answer probabilities of an observer whose errors fall evenly on all wrong answers."""
    wrong = (1 - proportion_correct) / (stimuli - 1)
    return np.full((stimuli, stimuli), wrong) + (proportion_correct - wrong) * np.eye(stimuli)


REFERENCE_MATRICES: dict[str, np.ndarray] = {
    "guesser": even_errors(0.2),
    **{f"d′ = {spacing}": ordered_observer(float(spacing)) for spacing in (1, 2, 3, 4)},
}
"""Five matrices from guessing to near-perfect. The rule: a guesser, and unbiased observers of five
ordered stimuli one, two, three and four d′ apart; 20, 51, 75, 89 and 96 % right."""


def transfer_of(probabilities: np.ndarray) -> float:
    """The exact transfer (bit) of answer probabilities, every stimulus presented equally often."""
    joint = np.asarray(probabilities, dtype=float) / probabilities.shape[1]
    answer = joint.sum(axis=1, keepdims=True)
    some = joint > 0
    ratio = np.divide(joint * joint.shape[1], answer, out=np.ones_like(joint), where=some)
    return float((joint * np.log2(np.where(some, ratio, 1.0))).sum())
