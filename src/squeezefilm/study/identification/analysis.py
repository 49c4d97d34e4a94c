"""`analyze_identification`: everything a table of identification trials says, in one result."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squeezefilm.core import quantities as si
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import Result, stamp, to_json, values_of
from squeezefilm.study.identification.condition_means import (
    ConditionMean,
    Course,
    ResponseTimeSummary,
    condition_means,
    response_time_summary,
)
from squeezefilm.study.identification.confusion import (
    ConfusionMatrix,
    participant_counts,
    participant_interval,
    permutation_test,
    proportion_interval,
)
from squeezefilm.study.identification.screening import Screening
from squeezefilm.study.identification.sensitivity import (
    METHOD,
    InformationTransfer,
    OrderedSensitivity,
    information_transfer,
    ordered_sensitivity,
)
from squeezefilm.study.psychometric.estimate import Estimate


@dataclass(frozen=True, slots=True)
class StimulusCorrect:
    """Correct answers to a stimulus, and their share with Wilson's interval over trials."""

    stimulus: str
    trials: int
    correct: int
    proportion_correct: si.Dimensionless
    low: si.Dimensionless
    high: si.Dimensionless


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class DisplayAnalysis(Result):
    """What analyses of all tasks have, on one display.

    Attributes:
        name: of the study and the display.
        origin: whose answers these are, e.g. "simulated" or "measured"; every figure repeats it.
        response_times: by condition; empty without times.
        exploration: quantity (with unit in its key) → means by condition.
        notes: what could not be computed, or needs care, and why.
        seed: of all resampling.
        course: response times, drift and attention; None of trials without a design.
        methods: the methods section of a paper; empty likewise.
        screening: who does the task, by the design's rule; None likewise.
    """

    name: str
    origin: str
    response_times: tuple[ResponseTimeSummary, ...]
    exploration: Mapping[str, tuple[ConditionMean, ...]]
    notes: tuple[str, ...]
    seed: int
    course: Course | None = None
    methods: str = ""
    screening: Screening | None = None


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class IdentificationAnalysis(DisplayAnalysis):
    """Analysis of an identification study.

    Attributes:
        matrix: all trials, rows answers, columns stimuli.
        counts: every participant's, shape (participants, k, k).
        intervals: of the proportion correct: Wilson's (trials taken as independent), and by
            participant bootstrap where there are two people or more.
        by_stimulus: proportion correct of each stimulus.
        participant_correct: proportion correct of each participant, shape (participants,).
        permutation_p: test against answers unrelated to stimuli, preferences kept.
        information: transfer of the answers, with its interval over participants.
        sensitivity: d′ of stimuli in the order of the labels; None where it has none.
    """

    matrix: ConfusionMatrix
    counts: si.IntArray
    intervals: tuple[Estimate, ...]
    by_stimulus: tuple[StimulusCorrect, ...]
    participant_correct: si.DimensionlessArray
    permutation_p: si.Dimensionless
    information: InformationTransfer
    sensitivity: OrderedSensitivity | None
    _shown: ClassVar[str] = "name origin participants proportion_correct"

    @property
    def participants(self) -> int:
        """Number of people who answered."""
        return int(self.counts.shape[0])

    @property
    def trials(self) -> int:
        """Number of main trials."""
        return int(self.matrix.trials)

    @property
    def proportion_correct(self) -> si.Dimensionless:
        """Share of right answers of all trials."""
        return self.matrix.proportion_correct

    @property
    def main_number(self) -> Estimate:
        """The share of right answers with the interval to quote: over participants, or Wilson's
        where there is one."""
        return self.intervals[-1]

    def summary(self) -> dict[str, Any]:
        """All numbers as plain JSON values, units in the keys; `confusion` in the paper's layout:
        rows are answers (gratings), columns what was presented (simulated periods)."""
        matrix = self.matrix
        person = self.participant_correct
        values = {
            **values_of(
                self,
                "name origin participants matrix.trials matrix.answers matrix.stimuli "
                "proportion_correct matrix.chance permutation_p information sensitivity "
                "response_times exploration course methods screening notes",
            ),
            "confusion": matrix.counts,
            "confusion_percent": matrix.percent,
            "proportion_correct_intervals": self.intervals,
            "proportion_correct_by_stimulus": self.by_stimulus,
            "participant_proportion_correct": {
                "mean": person.mean(),
                "standard_deviation": person.std(ddof=1) if person.size > 1 else None,
                "least": person.min(),
                "greatest": person.max(),
            },
            "information_transfer_bit": self.information.estimate,
            "information_transfer_estimator": METHOD,
            "provenance": stamp(
                {"name": self.name, "origin": self.origin, "counts": self.counts}, self.seed
            ),
        }
        plain: dict[str, Any] = to_json(values)
        return plain

    def _table(self) -> Any:
        """The confusions: one row a pair of stimulus and answer."""
        counts = self.matrix.counts
        return [
            {"stimulus": stimulus, "answer": answer, "count": int(counts[row, column])}
            for column, stimulus in enumerate(self.matrix.stimuli)
            for row, answer in enumerate(self.matrix.answers)
        ]


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class IdentificationRequest:
    """Arguments of `analyze_identification`."""

    participant: ArrayLike
    stimulus: ArrayLike
    choice: ArrayLike
    labels: Sequence[str]
    _: KW_ONLY
    name: str = "identification"
    origin: str = "not stated"
    response_time: ArrayLike | None = None
    exploration: Mapping[str, ArrayLike] | None = None
    level: si.Dimensionless = 0.95
    resamples: int = 1000
    seed: int = 0
    progress: Callable[[str], None] | None = None


@called_with(IdentificationRequest)
def analyze_identification(asked: IdentificationRequest) -> IdentificationAnalysis:
    """Analyse identification trials, one row a trial; leave out practice and catch trials before.

    Args:
        participant: who answered, shape (trials,); numbers or texts.
        stimulus, choice: numbers of what was presented and answered, 0 to len(labels) − 1.
        labels: of the stimuli and of their right answers, in the stimuli's order (d′ is along it).
        name, origin: of the study, and whose answers these are.
        response_time: in s, shape (trials,); NaN where none was taken.
        exploration: quantity with its unit, e.g. "mean_speed_m_per_s" → values by trial.
        level: of all intervals, between 0 and 1.
        resamples: of people in bootstraps, and shuffles in the permutation test.
        seed: of all resampling.
        progress: called with what is being computed.

    Raises:
        InputError: fewer than two labels, arrays that do not fit, or no trial. What the data are
            too few for is None in the result, with the reason in `notes`.
    """
    tell = asked.progress or (lambda _: None)
    tell("counting")
    names, level, resamples, seed = tuple(asked.labels), asked.level, asked.resamples, asked.seed
    k = len(names)
    if k < 2:
        raise InputError(f"{k} labels cannot be confused; at least 2 are wanted")
    _, counts = participant_counts(asked.participant, asked.stimulus, asked.choice, k, k)
    matrix = ConfusionMatrix(counts.sum(axis=0), names, names)
    notes: list[str] = []
    tell("intervals and tests")
    intervals = _intervals(counts, matrix, asked, notes)
    tell("information transfer")
    information = information_transfer(counts, level, resamples, seed)
    tell("d′")
    sensitivity = _sensitivity(counts, asked, notes)
    tell("response times and exploration")
    person = np.unique(np.asarray(asked.participant), return_inverse=True)[1]
    kind = np.asarray(asked.stimulus, dtype=np.int64)
    times: tuple[ResponseTimeSummary, ...] = ()
    if asked.response_time is not None:
        times = response_time_summary(person, kind, asked.response_time, names, level)
    explored = {
        key: condition_means(person, kind, values, names, level)
        for key, values in (asked.exploration or {}).items()
    }
    return IdentificationAnalysis(
        name=asked.name,
        origin=asked.origin,
        matrix=matrix,
        counts=counts,
        intervals=intervals,
        by_stimulus=_by_stimulus(matrix, level),
        participant_correct=np.trace(counts, axis1=1, axis2=2) / counts.sum(axis=(1, 2)),
        permutation_p=permutation_test(counts, resamples, seed),
        information=information,
        sensitivity=sensitivity,
        response_times=times,
        exploration=explored,
        notes=tuple(notes),
        seed=seed,
    )


def _intervals(
    counts: si.IntArray, matrix: ConfusionMatrix, asked: IdentificationRequest, notes: list[str]
) -> tuple[Estimate, ...]:
    """The proportion correct over trials, and over people where there are two."""
    level = asked.level
    intervals = [proportion_interval(matrix.correct, matrix.trials, level)]
    if counts.shape[0] > 1:
        intervals.append(participant_interval(counts, level, asked.resamples, asked.seed))
    else:
        notes.append("intervals over people: there is one participant; those shown are over trials")
    return tuple(intervals)


def _by_stimulus(matrix: ConfusionMatrix, level: float) -> tuple[StimulusCorrect, ...]:
    rows = []
    for j, name in enumerate(matrix.stimuli):
        right, trials = int(matrix.counts[j, j]), int(matrix.trials_per_stimulus[j])
        if trials == 0:
            continue
        bounds = proportion_interval(right, trials, level)
        rows.append(StimulusCorrect(name, trials, right, right / trials, bounds.low, bounds.high))
    return tuple(rows)


def _sensitivity(
    counts: si.IntArray, asked: IdentificationRequest, notes: list[str]
) -> OrderedSensitivity | None:
    try:
        found = ordered_sensitivity(counts, asked.level, asked.resamples, asked.seed)
    except InputError as error:
        notes.append(f"d′: {error}")
        return None
    if found.corrected:
        notes.append(
            "d′: some stimuli were never confused, or an answer never given; one trial per "
            "stimulus was added, spread over the answers, and d′ is too low"
        )
    return found
