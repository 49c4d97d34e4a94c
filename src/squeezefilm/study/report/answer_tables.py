"""Tables of an analysed study's answers: of stimuli, people or confusions, for page, terminal and
lab."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import shown
from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.design.tasks.task import JUDGED
from squeezefilm.study.report.words import TextTable, estimate_words, scale_of
from squeezefilm.study.tasks.findings import TaskAnalysis

if TYPE_CHECKING:
    from squeezefilm.study.identification.confusion import ConfusionMatrix
    from squeezefilm.study.tasks.analyze import StudyAnalysis


def confusion_rows(matrix: ConfusionMatrix) -> TextTable:
    """Head and rows of a confusion matrix, as texts: shares of a column, with their trials."""
    rows = [
        (
            name,
            *(
                "–" if math.isnan(share) else f"{share:.0f} % ({count})"
                for share, count in zip(percent, counts, strict=True)
            ),
        )
        for name, percent, counts in zip(matrix.answers, matrix.percent, matrix.counts, strict=True)
    ]
    return ("Answered \\ presented", *matrix.stimuli), rows


@dataclass(frozen=True, slots=True)
class Part:
    """A table of an analysed study: of its page, at the terminal, in the lab."""

    heading: str
    caption: str
    head: tuple[str, ...]
    rows: list[tuple[str, ...]]


def answer_parts(analysis: StudyAnalysis) -> list[Part]:
    """Answers by stimulus and by person, or confusions."""
    if not isinstance(analysis, TaskAnalysis):
        caption = "Per cent of each column; in brackets trials"
        return [Part("Confusions", caption, *confusion_rows(analysis.matrix))]
    of_people = f"{analysis.measure[:1].upper()}{analysis.measure[1:]} of each person"
    people = Part("People", of_people, *person_rows(analysis))
    if not analysis.conditions:
        return [people]
    caption = "Answers by stimulus; intervals as the numbers say"
    return [Part("Stimuli", caption, condition_head(analysis), condition_rows(analysis)), people]


def condition_head(analysis: TaskAnalysis) -> tuple[str, ...]:
    """Head of `condition_rows`: what is counted depends on the task."""
    task = TASKS[analysis.task]
    if analysis.is_adaptive and analysis.conditions and analysis.conditions[0].share is None:
        return ("Runs", "Value", "Ended", "People", "Mean of their ends", "d′")
    counted = "Right" if analysis.is_adaptive and task.right_is_enough else task.counted
    return ("Stimulus", "Value", "Trials", "People", counted, "d′")


def condition_rows(analysis: TaskAnalysis) -> list[tuple[str, ...]]:
    """Each comparison or stimulus: its answers with their interval, and d′."""
    unit = si.Unit("1" if analysis.is_adaptive else JUDGED[analysis.judged].si_unit)
    rows: list[tuple[str, ...]] = []
    for condition in analysis.conditions:
        answers = condition.magnitude or condition.share
        scale, said = (1.0, "") if condition.magnitude is not None else (100.0, " %")
        if analysis.is_adaptive and condition.magnitude is not None:
            scale, said = scale_of(analysis)
        rows.append(
            (
                condition.name,
                "–" if math.isnan(condition.value) else shown(condition.value, unit, 3),
                f"{condition.trials}",
                f"{condition.participants}",
                "–" if answers is None else estimate_words(answers, scale, said),
                "–" if condition.d_prime is None else estimate_words(condition.d_prime),
            )
        )
    return rows


def person_rows(analysis: TaskAnalysis) -> TextTable:
    """Each person's Weber fraction, exponent or d′."""
    scale, unit = scale_of(analysis)
    return ("Participant", "Estimate", "Interval", "Trials", "Remark"), [
        (
            person.person,
            f"{scale * person.estimate.value:.3g}{unit}",
            f"{scale * person.estimate.low:.3g} to {scale * person.estimate.high:.3g}{unit}",
            f"{person.trials}",
            "not bounded by the answers alone" if person.unbounded else "",
        )
        for person in analysis.persons
    ]
