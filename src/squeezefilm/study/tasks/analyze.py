"""A study's answers analysed, display by display: what its task allows."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from scipy import stats
from scipy.stats import mstats

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.core.from_text import reads_text
from squeezefilm.study.design.study_design import NamedDesign, StudyDesign
from squeezefilm.study.identification.analysis import IdentificationAnalysis, analyze_identification
from squeezefilm.study.identification.condition_means import ConditionMean, condition_means
from squeezefilm.study.identification.course import course_of
from squeezefilm.study.identification.response_times import (
    ExGaussian,
    ResponseTimeSummary,
    fit_ex_gaussian,
    response_time_summary,
)
from squeezefilm.study.identification.screening import Screening, judged_people, rule_of
from squeezefilm.study.psychometric.estimate import Estimate
from squeezefilm.study.record.answers import Answers, recorded_answers
from squeezefilm.study.record.foreign import read_answers
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.tasks.asked_again import asked_again, require_rerun
from squeezefilm.study.tasks.by_difference import (
    MEASURE,
    difference_conditions,
    difference_numbers,
    false_alarms,
    on_grid_of_differences,
    unlike_conditions,
    unlike_persons,
)
from squeezefilm.study.tasks.findings import (
    ConditionFinding,
    PersonEstimate,
    PersonFunction,
    TaskAnalysis,
    of_population,
)
from squeezefilm.study.tasks.magnitude import exponents, magnitude_conditions, require_magnitudes
from squeezefilm.study.tasks.methods import methods_text
from squeezefilm.study.tasks.population import Population
from squeezefilm.study.tasks.two_interval import (
    PeopleOnGrid,
    adaptive_conditions,
    on_grid,
    two_interval_conditions,
    two_interval_numbers,
)

StudyAnalysis = IdentificationAnalysis | TaskAnalysis
Tell = Callable[[str], None]
Numbers = dict[str, Estimate]
_Analysis = TypeVar("_Analysis", IdentificationAnalysis, TaskAnalysis)
_POPULATION = "posterior, mixed model"


@reads_text
def analyze_study(
    store: StudyStore | str | Path,
    *,
    design: NamedDesign | None = None,
    columns: Mapping[str, str] | None = None,
    values: Mapping[str, str] | None = None,
    decimal_comma: bool = False,
    mixed: bool = False,
    resamples: int = 1000,
    reruns: int = 0,
    seed: int = 0,
    progress: Tell | None = None,
) -> dict[str, StudyAnalysis]:
    """The analysis of a study's answers, by display.

    `store` is the study, or the path of its file; with a `design` the path of a CSV that another
    program recorded of it, whose `columns`, `values` and `decimal_comma` are read as
    `read_answers` says. Main trials are
    analysed; practice and familiarisation are left out, catch trials say who attended. Results say
    whose answers they are. `mixed` adds statsmodels' mixed models to match-to-sample, whose stimuli
    must each have the grating of their own period among the answers; `resamples` are its
    bootstraps'. `reruns` (39 or more) adds thresholds of adaptive series in two intervals by so
    many simulated runs of them, `seed` is theirs too (`tasks.asked_again`).

    Raises:
        InputError: stimuli that have no right answer, no answer yet, or reruns of what has none.
        RecordError: the file is damaged.
    """
    how: dict[str, Any] = {"mixed": mixed, "resamples": resamples, "reruns": reruns, "seed": seed}
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
    mixed: bool = False,
    resamples: int = 1000,
    reruns: int = 0,
    level: si.Dimensionless = 0.95,
    seed: int = 0,
    progress: Tell | None = None,
) -> dict[str, StudyAnalysis]:
    """The same of answers in memory, like those of simulated participants, which `assumed` says
    what they rest on. Displays without a main trial are left out.

    Raises `InputError` for a task of match-to-sample without a right answer to each stimulus, and
    for `reruns` of a design without what could be run again.
    """
    require_rerun(answers.design, reruns)
    tell = progress or (lambda _: None)
    found: dict[str, StudyAnalysis] = {}
    for number, display in enumerate(answers.design.displays):
        main = answers.main(number)
        if not main.trials:
            continue
        how: dict[str, Any] = {"display": number, "name": f"{name}, {display}", "level": level}
        how |= {"seed": seed, "tell": tell}
        if answers.design.task == "match-to-sample":
            match = partial(_matches, **how, mixed=mixed, resamples=resamples)
            found[display] = _screened(answers, number, match)
            continue
        one = _screened(answers, number, partial(_judgements, **how, assumed=assumed))
        if reruns:
            persons = asked_again(main, one.persons, reruns, level, seed, tell)
            one = dataclasses.replace(one, persons=persons)
        found[display] = one
    return found


def _screened(
    answers: Answers, display: int, analysis: Callable[[Answers], _Analysis]
) -> _Analysis:
    """The analysis of everybody, or of those who do the task, as the design's rule says; with the
    main number of both."""
    everybody = analysis(answers)
    people, said = judged_people(answers, display)
    rule = rule_of(answers.design)
    results: dict[str, Estimate | None] = {"everybody": everybody.main_number}
    out = [one.person for one in people if one.reasons]
    chosen = everybody
    if out and len(out) < len(people):
        numbers = [answers.people.index(one) for one in out]
        without = analysis(answers.take(~np.isin(answers.participant, numbers)))
        results["without those named"] = without.main_number
        chosen = without if rule.action == "exclude" else everybody
    if isinstance(everybody, TaskAnalysis):
        results["robust, everybody"] = everybody.robust
    known = {name: one for name, one in results.items() if one is not None}
    screening = Screening(rule, people, known, said)
    methods = chosen.methods + screening.left_out_sentence
    return dataclasses.replace(chosen, screening=screening, methods=methods)


def stimuli_and_answers(design: StudyDesign) -> tuple[list[str], list[str]]:
    """Names of a match-to-sample design's stimuli and their right answers. Raises `InputError`
    where the answers are not each the right one to a stimulus."""
    stimuli = [one.name for one in design.stimuli]
    right = [design.answer_to(one) for one in design.stimuli]
    if sorted(right) != sorted(design.answers):
        raise InputError(
            "an identification needs one right answer for each stimulus and no other answers; "
            f"stimuli: {', '.join(stimuli)}; answers: {', '.join(design.answers)}"
        )
    return stimuli, right


def _matches(
    answers: Answers,
    display: int,
    name: str,
    mixed: bool,
    resamples: int,
    level: float,
    seed: int,
    tell: Tell,
) -> IdentificationAnalysis:
    design, main = answers.design, answers.main(display)
    stimuli, right = stimuli_and_answers(design)
    kind = np.array([stimuli.index(main.surfaces[k].name) for k in main.first])
    order = np.array([right.index(one) for one in design.answers])
    times = main.response_time
    found = analyze_identification(
        np.array(main.people)[main.participant],
        kind,
        order[main.choice],
        right,
        name=name,
        origin=answers.origin,
        response_time=times if np.isfinite(times).any() else None,
        exploration=main.exploration,
        mixed=mixed,
        level=level,
        resamples=resamples,
        seed=seed,
        progress=tell,
    )
    if not design.on_a_scale:
        found = dataclasses.replace(
            found,
            sensitivity=None,
            notes=(
                *found.notes,
                "d′ along the stimuli: they have no order; read the confusions and the choice "
                "model, which need none",
            ),
        )
    course = course_of(answers, display)
    return dataclasses.replace(found, course=course, methods=methods_text(answers, display))


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """What a task's own analysis gives."""

    measure: str
    persons: list[PersonEstimate]
    pooled: Estimate | None
    spread: Estimate | None
    conditions: tuple[ConditionFinding, ...]
    more: dict[str, Estimate]
    functions: dict[str, PersonFunction]
    notes: list[str]
    robust: Estimate | None = None


def _judgements(
    answers: Answers,
    display: int,
    name: str,
    assumed: tuple[str, ...],
    level: float,
    seed: int,
    tell: Tell,
) -> TaskAnalysis:
    design, main = answers.design, answers.main(display)
    own = {"two-interval": _two_interval, "magnitude-estimation": _magnitudes}
    found = own.get(design.task, _by_difference)(main, level, seed, tell)
    tell("response times and drift")
    condition, names = _conditions(main)
    course = course_of(answers, display)
    times, ex_gaussian = _times(main, condition, names, level, seed, found.notes)
    explored = _explored(main, condition, names, level)
    unbounded = [one.person for one in found.persons if one.unbounded]
    notes = [*found.notes]
    if unbounded:
        notes.append(
            f"the answers of {len(unbounded)} of {len(found.persons)} people do not bound their "
            f"{found.measure}: an end of its interval is where the prior ends, and more trials "
            "near the threshold are wanted"
        )
    here = design.judged_value(design.stimulus(design.reference)) if design.reference else math.nan
    return TaskAnalysis(
        name=name,
        origin=answers.origin,
        task=design.task,
        judged=design.judged,
        measure=found.measure,
        people=tuple(main.people[one] for one in np.unique(main.participant)),
        trials=main.trials,
        standard=here,
        persons=tuple(found.persons),
        pooled=found.pooled,
        spread=found.spread,
        conditions=found.conditions,
        more=found.more,
        functions=found.functions,
        is_adaptive=bool((main.series >= 0).any()),
        response_times=times,
        ex_gaussian=ex_gaussian,
        course=course,
        exploration=explored,
        assumed=assumed,
        notes=tuple(notes),
        methods=methods_text(answers, display),
        screening=None,
        robust=found.robust or _trimmed(found.persons, level),
        seed=seed,
    )


def _trimmed(persons: list[PersonEstimate], level: float) -> Estimate | None:
    """The mean of people's values without the fifth at either end, with Yuen's interval (1974,
    10.1093/biomet/61.1.165); None of fewer than five people."""
    values = np.sort([one.estimate.value for one in persons])
    cut = values.size // 5
    if not cut:
        return None
    kept = values.size - 2 * cut
    error = float(mstats.winsorize(values, (cut / values.size,) * 2).std(ddof=1))
    reach = float(stats.t.isf((1 - level) / 2, kept - 1)) * error * math.sqrt(values.size - 1)
    reach /= math.sqrt(kept * (kept - 1.0))
    mean = float(values[cut : values.size - cut].mean())
    return Estimate(mean, mean - reach, mean + reach, level, "trimmed by a fifth at either end")


def _of_fractions(
    people: PeopleOnGrid,
    level: float,
    conditions: tuple[ConditionFinding, ...],
    more: Numbers,
    criterion: bool = False,
) -> _Found:
    notes: list[str] = []
    persons = people.estimates(level)
    pooled, spread, robust = persons[0].estimate, None, None
    if len(persons) > 1:
        population = Population(people.likelihoods())
        pooled, spread = of_population(population.estimate(level), _POPULATION)
        low, middle, high = (math.exp(one) for one in population.robust(level))
        robust = Estimate(middle, low, high, level, "posterior, some do not do the task")
        # Answers at random go into a criterion where there is one.
        notes += [note for note in [population.lapse_note] if note and not criterion]
    else:
        notes.append(
            "one participant: the population's interval is theirs, and says nothing of others"
        )
    functions = people.functions(level)
    return _Found(
        "Weber fraction", persons, pooled, spread, conditions, more, functions, notes, robust
    )


def _two_interval(main: Answers, level: float, seed: int, tell: Tell) -> _Found:
    people = on_grid(main, tell)
    tell("mixed model over people")
    adaptive = bool((main.series >= 0).any())
    conditions = (
        adaptive_conditions(main, level) if adaptive else two_interval_conditions(main, level, seed)
    )
    return _of_fractions(people, level, conditions, two_interval_numbers(main, level))


def _by_difference(main: Answers, level: float, seed: int, tell: Tell) -> _Found:
    if not main.design.on_a_scale:
        return _unlike(main, level, seed, tell)
    tell(f"{main.design.task} model of each person")
    people = on_grid_of_differences(main)
    conditions = difference_conditions(main, level, seed)
    more = difference_numbers(main, people.bias, level)
    return _of_fractions(people, level, conditions, more, criterion=bool(more))


def _unlike(main: Answers, level: float, seed: int, tell: Tell) -> _Found:
    tell("sensitivity of each person")
    persons, pooled = unlike_persons(main, level, seed)
    conditions = unlike_conditions(main, level, seed)
    notes = [
        f"the surfaces have no {main.design.judged} to be told apart by, so that there is no Weber "
        "fraction: d′ is of whole surfaces"
    ]
    more = false_alarms(main, level)
    return _Found(MEASURE, persons, pooled, None, conditions, more, {}, notes)


def _magnitudes(main: Answers, level: float, _seed: int, tell: Tell) -> _Found:
    require_magnitudes(main)
    tell("power law of each person")
    persons, pooled, spread = exponents(main, level)
    conditions, notes = magnitude_conditions(main, level)
    lacking = np.unique(main.participant).size - len(persons)
    if lacking:
        notes.append(
            f"{lacking} {'person has' if lacking == 1 else 'people have'} no line of their own "
            "(fewer than 3 answers, or to one stimulus only) and no share in the exponent"
        )
    if len(persons) == 1:
        notes.append("one line: the interval is of it, and not of a population")
    return _Found("exponent", persons, pooled, spread, conditions, {}, {}, notes)


def _conditions(main: Answers) -> tuple[si.IntArray, tuple[str, ...]]:
    """What response times are told apart by: the comparison, the difference or the stimulus."""
    if (main.series >= 0).any():
        return main.series, tuple(one.name for one in main.design.adaptive)
    # By value, as they are read, and not in the order in which somebody met them first.
    order = np.argsort(main.values, kind="stable")
    place = np.argsort(order, kind="stable")
    names = tuple(main.surfaces[one].name for one in order)
    if main.design.compares:
        here = names.index(main.design.reference) if main.design.reference in names else -1
        shown = place[main.presented]
        # The one that is not the reference; several are the same one.
        other = np.where(shown != here, shown, -1).max(axis=0)
        alike = (shown == shown[0]).all(axis=0)
        return np.where(alike, len(names), other), (*names, "the same")
    return place[main.first], names


def _times(
    main: Answers,
    condition: si.IntArray,
    names: tuple[str, ...],
    level: float,
    seed: int,
    notes: list[str],
) -> tuple[tuple[ResponseTimeSummary, ...], ExGaussian | None]:
    # A time of 0 is what a clock of milliseconds makes of a slip of the hand.
    times = np.where(main.response_time > 0, main.response_time, np.nan)
    if not np.isfinite(times).any():
        return (), None
    person = np.unique(main.participant, return_inverse=True)[1]
    summaries = response_time_summary(person, condition, times, names, level)
    try:
        return summaries, fit_ex_gaussian(times, seed)
    except (InputError, ConvergenceError) as error:
        notes.append(f"ex-Gaussian: {error}")
        return summaries, None


def _explored(
    main: Answers, condition: si.IntArray, names: tuple[str, ...], level: float
) -> dict[str, tuple[ConditionMean, ...]]:
    person = np.unique(main.participant, return_inverse=True)[1]
    return {
        key: condition_means(person, condition, values, names, level)
        for key, values in main.exploration.items()
    }
