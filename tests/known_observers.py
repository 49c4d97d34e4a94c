"""Answer probabilities whose information transfer is known."""

from __future__ import annotations

import numpy as np

from squeezefilm.study.identification.power import ordered_observer


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
