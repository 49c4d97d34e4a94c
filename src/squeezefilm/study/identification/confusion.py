"""Confusion matrices of identification: rows are answers, columns are what was presented.

This is the layout of Biet, Giraud & Lemaire-Semail's tables: a row for each real grating that a
person may answer with, a column for each simulated spatial period, percentages per column.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError


@dataclass(frozen=True, slots=True, eq=False)
class ConfusionMatrix:
    """Counts of each answer to each stimulus.

    Args:
        counts: trials, shape (answers, stimuli); whole numbers from 0 up.
        answers: what each row is called.
        stimuli: what each column is called.

    Raises:
        InputError: counts of another shape than the names, below 0, not whole, or all 0.
    """

    counts: si.IntArray
    answers: tuple[str, ...]
    stimuli: tuple[str, ...]

    def __post_init__(self) -> None:
        counts = whole_counts(self.counts)
        if counts.shape != (len(self.answers), len(self.stimuli)):
            raise InputError(
                f"counts of shape {counts.shape} do not fit {len(self.answers)} answers (rows) and "
                f"{len(self.stimuli)} stimuli (columns)"
            )
        if counts.sum() == 0:
            raise InputError("a confusion matrix needs at least one trial; it has 0")
        object.__setattr__(self, "counts", counts)

    @property
    def trials(self) -> int:
        """Trials in all."""
        return int(self.counts.sum())

    @property
    def trials_per_stimulus(self) -> si.IntArray:
        """Trials of each column, shape (stimuli,)."""
        return np.asarray(self.counts.sum(axis=0), dtype=np.int64)

    @property
    def proportions(self) -> si.DimensionlessArray:
        """Share of each column's answers, shape (answers, stimuli); NaN in an empty column."""
        totals, empty = self.counts.sum(axis=0), np.full(self.counts.shape, np.nan)
        return np.asarray(np.divide(self.counts, totals, out=empty, where=totals > 0))

    @property
    def percent(self) -> si.FloatArray:
        """The same in per cent, as the paper's tables have it."""
        return np.asarray(100.0 * self.proportions)

    @property
    def is_square(self) -> bool:
        """True where answer number i is the right one for stimulus number i."""
        return len(self.answers) == len(self.stimuli)

    @property
    def correct(self) -> int:
        """Trials on the diagonal. Raises `InputError` where rows and columns do not pair up."""
        if not self.is_square:
            raise InputError(
                f"{len(self.answers)} answers and {len(self.stimuli)} stimuli do not pair up: "
                "there is no right answer to count"
            )
        return int(np.trace(self.counts))

    @property
    def proportion_correct(self) -> float:
        """Share of all trials on the diagonal. Raises as `correct` does."""
        return self.correct / self.trials

    @property
    def chance(self) -> float:
        """Proportion correct of a person who guesses: 1/answers."""
        return 1.0 / len(self.answers)


def whole_counts(counts: ArrayLike) -> si.IntArray:
    """Counts as whole numbers. Raises `InputError` for negative, broken or not finite ones."""
    given = np.asarray(counts)
    if given.dtype.kind not in "iuf" or not np.all(np.isfinite(given)):
        raise InputError("counts must be whole numbers from 0 up; some are not numbers")
    whole = given.astype(np.int64)
    if np.any(whole != given) or np.any(whole < 0):
        raise InputError(
            f"counts must be whole numbers from 0 up; {given[(whole != given) | (whole < 0)][0]} "
            "is among them"
        )
    return whole


def one_per_trial(**columns: ArrayLike) -> tuple[NDArray[Any], ...]:
    """The columns as arrays of shape (trials,). Raises `InputError` where they are of others."""
    arrays = tuple(np.asarray(column) for column in columns.values())
    if arrays[0].ndim != 1 or len({array.shape for array in arrays}) > 1:
        *names, last = columns
        raise InputError(
            f"{', '.join(names)} and {last} must have one value a trial; their shapes are "
            f"{', '.join(str(array.shape) for array in arrays)}"
        )
    return arrays


def participant_counts(
    participant: ArrayLike, stimulus: ArrayLike, choice: ArrayLike, answers: int, stimuli: int
) -> tuple[NDArray[np.generic], si.IntArray]:
    """Every participant's own confusion matrix.

    Args:
        participant: who answered, shape (trials,); numbers or texts.
        stimulus: column number of what was presented, shape (trials,), 0 to stimuli − 1.
        choice: row number of what was answered, shape (trials,), 0 to answers − 1.
        answers, stimuli: how many there are.

    Returns:
        The participants in sorted order, shape (participants,), and counts of shape
        (participants, answers, stimuli).

    Raises:
        InputError: arrays of unequal length, no trial, or a number out of range.
    """
    columns = _index("stimulus", stimulus, stimuli)
    rows = _index("choice", choice, answers)
    who, columns, rows = one_per_trial(participant=participant, stimulus=columns, choice=rows)
    if who.size == 0:
        raise InputError("there is no trial to analyse; give at least one")
    names, person = np.unique(who, return_inverse=True)
    flat = (person * answers + rows) * stimuli + columns
    counts = np.bincount(flat, minlength=names.size * answers * stimuli)
    return names, counts.reshape(names.size, answers, stimuli).astype(np.int64)


def _index(name: str, values: ArrayLike, count: int) -> si.IntArray:
    given = np.asarray(values)
    if given.size and given.dtype.kind not in "iu":
        raise InputError(f"{name} must hold whole numbers from 0 to {count - 1}")
    if given.size and (given.min() < 0 or given.max() >= count):
        outside = given[(given < 0) | (given >= count)].ravel()[0]
        raise InputError(f"{name} = {outside} is out of range; it must be 0 to {count - 1}")
    return given.astype(np.int64)
