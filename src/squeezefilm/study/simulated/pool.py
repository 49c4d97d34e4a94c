"""Simulated participants for power analysis: people drawn from a large pool, with their counts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.study.simulated.participants import SimulatedStudy


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedPeople:
    """Draws people with replacement from a simulated study's, for `power.power_curve`.

    The pool should be large against a study (some 10 000): then two people of one study are
    hardly ever the same.

    Args:
        counts: of the pool's people, shape (people, answers, stimuli).

    Raises:
        InputError: counts of another shape, or of fewer than two people.
    """

    counts: si.IntArray

    def __post_init__(self) -> None:
        if self.counts.ndim != 3 or self.counts.shape[0] < 2:
            raise InputError(
                f"counts of shape {self.counts.shape} cannot be drawn from: give (people, answers, "
                "stimuli) of at least two people"
            )

    @classmethod
    def of(cls, study: SimulatedStudy, display: int = 0) -> SimulatedPeople:
        """The people of a simulated study on one of its displays."""
        return cls(study.participant_counts(display))

    def __call__(self, participants: int, random: np.random.Generator) -> si.IntArray:
        """Counts of so many people, shape (participants, answers, stimuli)."""
        si.require("participants", participants, at_least=1)
        return self.counts[random.integers(0, self.counts.shape[0], participants)]
