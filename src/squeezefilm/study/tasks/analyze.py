"""A study's answers analysed, display by display: what its task allows."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.study.design.study_design import NamedDesign, StudyDesign
from squeezefilm.study.identification.analysis import (
    IdentificationAnalysis,
    analyze_identification,
)
from squeezefilm.study.identification.condition_means import (
    condition_means,
    course_of,
    response_time_summary,
)
from squeezefilm.study.identification.screening import Screening, judged_people, rule_of
from squeezefilm.study.record.answers import Answers, recorded_answers
from squeezefilm.study.record.foreign import read_answers
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.tasks.findings import TaskAnalysis
from squeezefilm.study.tasks.measures import comparisons, measured
from squeezefilm.study.tasks.methods import methods_text
from squeezefilm.study.tasks.scales import require_magnitudes

StudyAnalysis = IdentificationAnalysis | TaskAnalysis
Tell = Callable[[str], None]


@reads_text
def analyze_study(
    store: StudyStore | str | Path,
    *,
    design: NamedDesign | None = None,
    columns: Mapping[str, str] | None = None,
    values: Mapping[str, str] | None = None,
    decimal_comma: bool = False,
    resamples: int = 1000,
    seed: int = 0,
    progress: Tell | None = None,
) -> dict[str, StudyAnalysis]:
    """The analysis of a study's answers, by display.

    `store` is the study, or the path of its file; with a `design` the path of a CSV that another
    program recorded of it, whose `columns`, `values` and `decimal_comma` are read as
    `read_answers` says. Main trials are analysed; practice and familiarisation are left out, catch
    trials say who attended. Results say whose answers they are. Stimuli of
    match-to-sample must each have the grating of their own period among the answers; `resamples`
    are its bootstraps', `seed` is that of all resampling.

    Raises:
        InputError: stimuli that have no right answer, or no answer yet.
        RecordError: the file is damaged.
    """
    how: dict[str, Any] = {"resamples": resamples, "seed": seed}
    if design is not None and not isinstance(store, StudyStore):
        if design.task == "match-to-sample":
            stimuli_and_answers(design)
        answers, name = read_answers(store, design, columns, values, decimal_comma), design.name
    elif not isinstance(store, StudyStore):
        with StudyStore.open(store) as opened:
            return analyze_study(opened, **how, progress=progress)
    else:
        if store.design.task == "match-to-sample":
            stimuli_and_answers(store.design)
        store.require_whole()
        answers, name = recorded_answers(store), str(store.study["name"])
    if not (answers.phase == "main").any():
        where = store.path if isinstance(store, StudyStore) else store
        raise InputError(f"{where} has no answered main trial yet; run some first")
    return analyze_answers(answers, name, **how, progress=progress)


def analyze_answers(
    answers: Answers,
    name: str,
    *,
    assumed: tuple[str, ...] = (),
    resamples: int = 1000,
    level: si.Dimensionless = 0.95,
    seed: int = 0,
    progress: Tell | None = None,
) -> dict[str, StudyAnalysis]:
    """The same of answers in memory, like those of simulated participants, which `assumed` says
    what they rest on. Displays without a main trial are left out.

    Raises `InputError` for a task of match-to-sample without a right answer to each stimulus.
    """
    tell = progress or (lambda _: None)
    found: dict[str, StudyAnalysis] = {}
    for number, display in enumerate(answers.design.displays):
        if not answers.main(number).trials:
            continue
        how = _How(f"{name}, {display}", number, assumed, resamples, level, seed, tell)
        found[display] = _screened(answers, how)
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _How:
    """Settings of a display's analysis, see `analyze_answers`; `display` is its number."""

    name: str
    display: int
    assumed: tuple[str, ...]
    resamples: int
    level: float
    seed: int
    tell: Tell


def _screened(answers: Answers, how: _How) -> StudyAnalysis:
    """The analysis of everybody, or of those who do the task, as the design's rule says; with the
    main number of both."""
    analysis = _matches if answers.design.task == "match-to-sample" else _judgements
    if answers.design.task == "magnitude-estimation":
        require_magnitudes(answers.main(how.display))
    people, said = judged_people(answers, how.display)
    rule = rule_of(answers.design)
    out = [person.person for person in people if person.reasons]
    everybody = chosen = analysis(answers, how)
    results = {"everybody": everybody.main_number}
    if out and len(out) < len(people):
        numbers = [answers.people.index(name) for name in out]
        without = analysis(answers.take(~np.isin(answers.participant, numbers)), how)
        results["without those named"] = without.main_number
        if rule.action == "exclude":
            chosen = without
    if isinstance(everybody, TaskAnalysis):
        results["robust, everybody"] = everybody.robust
    known = {name: result for name, result in results.items() if result is not None}
    screening = Screening(rule, people, known, said)
    methods = chosen.methods + screening.left_out_sentence
    return dataclasses.replace(chosen, screening=screening, methods=methods)


def stimuli_and_answers(design: StudyDesign) -> tuple[list[str], list[str]]:
    """Names of a match-to-sample design's stimuli and their right answers. Raises `InputError`
    where the answers are not each the right one to a stimulus."""
    stimuli = [stimulus.name for stimulus in design.stimuli]
    right = [design.answer_to(stimulus) for stimulus in design.stimuli]
    if sorted(right) != sorted(design.answers):
        raise InputError(
            "an identification needs one right answer for each stimulus and no other answers; "
            f"stimuli: {', '.join(stimuli)}; answers: {', '.join(design.answers)}"
        )
    return stimuli, right


def _matches(answers: Answers, how: _How) -> IdentificationAnalysis:
    design, display, main = answers.design, how.display, answers.main(how.display)
    stimuli, right = stimuli_and_answers(design)
    order = np.array([right.index(answer) for answer in design.answers])
    found = analyze_identification(
        np.array(main.people)[main.participant],
        np.array([stimuli.index(main.surfaces[k].name) for k in main.presented[0]]),
        order[main.choice],
        right,
        name=how.name,
        origin=main.origin,
        response_time=main.response_time,
        exploration=main.exploration,
        level=how.level,
        resamples=how.resamples,
        seed=how.seed,
        progress=how.tell,
    )
    if not design.on_a_scale:
        found = dataclasses.replace(
            found,
            sensitivity=None,
            notes=(
                *found.notes,
                "d′ along the stimuli: they have no order; read the confusions, which need none",
            ),
        )
    return dataclasses.replace(
        found, course=course_of(answers, display), methods=methods_text(answers, display)
    )


def _judgements(answers: Answers, how: _How) -> TaskAnalysis:
    design, display, level, seed = answers.design, how.display, how.level, how.seed
    main = answers.main(display)
    found = measured(main, level, seed, how.tell)
    how.tell("response times and drift")
    condition, names = _conditions(main)
    person = np.unique(main.participant, return_inverse=True)[1]
    # A time of 0 is what a clock of milliseconds makes of a slip of the hand.
    times = np.where(main.response_time > 0, main.response_time, np.nan)
    unbounded = [person.person for person in found.persons if person.unbounded]
    notes = [*found.notes]
    if unbounded:
        notes.append(
            f"the answers of {len(unbounded)} of {len(found.persons)} people do not bound their "
            f"{found.measure}: an end of its interval is where the prior ends, and more trials "
            "near the threshold are wanted"
        )
    return TaskAnalysis(
        **vars(found) | {"notes": tuple(notes)},
        name=how.name,
        origin=answers.origin,
        task=design.task,
        judged=design.judged,
        people=tuple(main.people[person] for person in np.unique(main.participant)),
        trials=main.trials,
        standard=design.reference_value,
        is_adaptive=bool((main.series >= 0).any()),
        response_times=response_time_summary(person, condition, times, names, level),
        course=course_of(answers, display),
        exploration={
            key: condition_means(person, condition, values, names, level)
            for key, values in main.exploration.items()
        },
        assumed=how.assumed,
        methods=methods_text(answers, display),
        seed=seed,
    )


def _conditions(main: Answers) -> tuple[si.IntArray, tuple[str, ...]]:
    """Conditions of response times: the comparison, the difference, the stimulus, or what was put
    first."""
    if (main.series >= 0).any():
        return main.series, tuple(series.name for series in main.design.adaptive)
    # By value, as they are read, and not in the order in which somebody met them first.
    order = np.argsort(main.values, kind="stable")
    place = np.argsort(order, kind="stable")
    names = tuple(main.surfaces[surface].name for surface in order)
    if main.design.described.ranks:
        return place[main.in_order[0]], names
    if main.design.compares:
        other, _ = comparisons(main)
        return np.where(other < 0, len(names), place[other]), (*names, "the same")
    return place[main.presented[0]], names
