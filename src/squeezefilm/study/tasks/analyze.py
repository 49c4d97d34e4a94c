"""A study's answers analysed, display by display: what its task allows, and the methods section of
a paper on it, written out from what the study did, with its citations."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm import __version__
from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.study_design import NamedDesign, StudyDesign
from squeezefilm.study.design.tasks.task import JUDGED
from squeezefilm.study.identification.analysis import IdentificationAnalysis, analyze_identification
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
from squeezefilm.study.tasks.scales import require_magnitudes

_MATCHED = {"real gratings": "real gratings", "stimuli": "surfaces known from before"}
_ORDERS = {
    "williams": "in the order of a Williams square (Williams 1949, 10.1071/CH9490149)",
    "latin-square": "in the order of a Latin square",
    "shuffled": "in random order",
}
_UNLIKE = (
    "Surfaces had no amount in common to be compared by: each participant has a d′ over all pairs "
    "by the differencing model of Macmillan and Creelman (2005), and its mean has Student's "
    "interval over participants."
)
_PSI = "Kontsevich and Tyler 1999, 10.1016/S0042-6989(98)00285-5"
_QUEST_PLUS = "Watson 2017, 10.1167/17.3.10"


def methods_text(answers: Answers, display: int) -> str:
    """Methods section on a display's trials: participants, stimuli, task, orders, analysis.

    Written from the design and from the answers that there are: of what was not recorded nothing
    is said.
    """
    design, main = answers.design, answers.main(display)
    alike = design.task == "same-different"
    people = len(set(main.participant.tolist()))
    named = design.displays[display]
    who = "simulated participants" if "simulated" in answers.origin else "participants"
    parts = [
        f"{people} {who} took part on the display '{named}'.",
        _stimuli(design),
        design.described.presents.format(
            alternatives=len(design.answers),
            matched=_MATCHED[design.matched_with],
            reference=design.reference or "none",
            judged=JUDGED[design.judged].words,
        )
        + f" (“{design.spoken_question}”).",
        *_adaptive(design),
        _trials(design, answers, display),
        _UNLIKE
        if alike and not design.on_a_scale
        else design.described.analysed.format(judged=JUDGED[design.judged].words),
        f"Orders and analysis were made with squeezefilm {__version__} "
        f"(design SHA-256 {design.sha256[:12]}).",
    ]
    return " ".join(parts)


def _stimuli(design: StudyDesign) -> str:
    free = " They were explored freely over the face." if design.exploring == "free" else ""
    # Beside the reference of adaptive series they are for practice and familiarisation only.
    every = [
        stimulus
        for stimulus in design.stimuli
        if not design.adaptive or stimulus.name == design.reference
    ]
    simple = all(one.kind in ("square grating", "sine grating") for one in every)
    listed = []
    for stimulus in every:
        period, depth = si.format_quantity(stimulus.period, si.Unit("m")), _depth(stimulus)
        listed.append(f"{period} ({depth})" if simple else _surface(stimulus))
    shapes = " and ".join(sorted({stimulus.waveform for stimulus in every}))
    if design.adaptive:
        kind = f"a {shapes} grating of friction with the period" if simple else "the surface"
        return f"The reference was {kind} {', '.join(listed)}.{free}"
    if not simple:
        return f"Stimuli were surfaces of friction: {'; '.join(listed)}.{free}"
    return f"Stimuli were {shapes} gratings of friction with the periods {', '.join(listed)}.{free}"


def _depth(stimulus: Stimulus) -> str:
    return f"{100 * stimulus.friction_depth:.3g} % change of relative friction"


def _surface(one: Stimulus) -> str:
    """A shape, map or crossed grating by name, kind and periods."""
    lengths = [x for x in (one.period, one.second_period) if not math.isnan(x)]
    periods = " by ".join(si.format_quantity(x, si.Unit("m")) for x in lengths)
    said = [one.kind, *([periods] if lengths else []), *([] if one.texture else [_depth(one)])]
    return f"“{one.name}” ({', '.join(said)}; SHA-256 {one.surface_sha256[:12]})"


def _adaptive(design: StudyDesign) -> list[str]:
    said = []
    alike = design.task == "same-different"
    for series in design.adaptive:
        if series.method == "staircase":
            target = 100 * 0.5 ** (1 / series.down)
            how = (
                f"a staircase, {series.down} down and 1 up, that settles at {target:.1f} % correct "
                f"(Levitt 1971, 10.1121/1.1912375), from {100 * series.start:g} %"
            )
        elif series.in_runs:
            how = (
                f"{'adjustments' if series.method == 'adjustment' else 'the method of limits'}, in "
                f"runs of steps of {100 * series.step:g} %, that began alternately at either end"
            )
        else:
            by = _QUEST_PLUS if alike else _PSI
            how = f"a Bayesian choice of the most informative difference ({by})"
            how += "; every fourth went through all differences in turn" if alike else ""
        said.append(
            f"The series '{series.name}' of {series.count} trials chose the comparison by {how}, "
            f"within {100 * series.lowest:g} and {100 * series.highest:g} % of the reference"
            + ("; half of its trials presented the reference twice." if alike else ".")
        )
    if len(design.adaptive) > 1:
        said.append("The series were interleaved at random.")
    return said


def _trials(design: StudyDesign, answers: Answers, display: int) -> str:
    here = answers.take(answers.display == display)
    people = max(len(set(here.participant.tolist())), 1)
    counts = {phase: int((here.phase == phase).sum()) for phase in ("practice", "main", "catch")}
    said = f"There were {counts['main'] / people:.4g} trials a participant"
    extra = [
        f"{counts[phase] / people:.3g} {words}"
        for phase, words in (("practice", "of practice with feedback"), ("catch", "catch trials"))
        if counts[phase]
    ]
    said += f" beside {' and '.join(extra)}" if extra else ""
    order = "" if design.adaptive else f", {_ORDERS[design.order]}"
    blocks = f" in {design.blocks} blocks" if design.blocks > 1 else ""
    return f"{said}{blocks}{order}."


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
