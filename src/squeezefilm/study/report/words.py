"""An analysed study in words: what to read first, and the main numbers, for page and terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from squeezefilm.core.kit.numbers import decimals
from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.design.tasks.task import JUDGED
from squeezefilm.study.identification.sensitivity import METHOD
from squeezefilm.study.tasks.findings import EQUALITY, PARTS, TaskAnalysis

if TYPE_CHECKING:
    from squeezefilm.study.identification.analysis import IdentificationAnalysis
    from squeezefilm.study.identification.condition_means import Course
    from squeezefilm.study.identification.power import PowerCurve
    from squeezefilm.study.identification.screening import Screening
    from squeezefilm.study.identification.sensitivity import OrderedSensitivity
    from squeezefilm.study.psychometric.estimate import Estimate
    from squeezefilm.study.tasks.analyze import StudyAnalysis
Rows = list[tuple[str, str, str]]
TextTable = tuple[tuple[str, ...], list[tuple[str, ...]]]
"""Head and rows of a table, as texts."""
_SURE = 0.05


def read_first(analysis: StudyAnalysis) -> list[str]:
    """Sentences for somebody with a minute."""
    people = f"{analysis.participants} {_people(analysis)}"
    said = [f"{people} answered {analysis.trials} main trials."]
    if isinstance(analysis, TaskAnalysis):
        said += _task_first(analysis)
    else:
        said += _identification_first(analysis)
    if analysis.screening is not None:
        said += _screening_first(analysis.screening)
    if analysis.course is not None:
        said += _course_first(analysis.course)
    if analysis.notes:
        count = len(analysis.notes)
        said.append(
            f"{count} {'remark stands' if count == 1 else 'remarks stand'} at the end: read "
            f"{'it' if count == 1 else 'them'} before quoting anything."
        )
    return said


def _people(analysis: StudyAnalysis) -> str:
    kind = "simulated participant" if "simulated" in analysis.origin else "participant"
    return kind if analysis.participants == 1 else f"{kind}s"


def _identification_first(analysis: IdentificationAnalysis) -> list[str]:
    interval, carried = analysis.main_number, analysis.information
    low, high = 100 * interval.low, 100 * interval.high
    chance = 100 * analysis.matrix.chance
    above = "above" if interval.low > analysis.matrix.chance else "not surely above"
    said = [
        f"{100 * analysis.proportion_correct:.3g} % of the answers are right ({low:.3g} to "
        f"{high:.3g} % at {100 * interval.level:g} %), which is {above} guessing ({chance:.3g} %).",
    ]
    if not math.isnan(carried.estimate):
        said.append(
            f"The answers carry {carried.estimate:.2g} of {carried.greatest:.3g} bit about the "
            "stimulus."
        )
    return said


def _task_first(analysis: TaskAnalysis) -> list[str]:
    strongest = [most_and_least(analysis)] if TASKS[analysis.task].ranks else []
    if analysis.pooled is None:
        return strongest or [f"No {analysis.measure} could be computed."]
    found = analysis.pooled
    if analysis.measure == "sensitivity d′":
        meaning = f"People tell the surfaces from the reference with d′ = {estimate_words(found)}."
    elif analysis.measure == "exponent":
        judged = JUDGED[analysis.judged].words
        what = "Strengths" if strongest else "Numbers"
        meaning = f"{what} grow with {judged} to the power of {estimate_words(found)}."
    elif analysis.measure == EQUALITY:
        meaning = (
            f"A typical person calls equal what differs from the reference in "
            f"{JUDGED[analysis.judged].words} by {estimate_words(found, *scale_of(analysis))}."
        )
    elif not analysis.functions:
        meaning = (
            f"A typical person's runs turn at {estimate_words(found, *scale_of(analysis))} of "
            f"{JUDGED[analysis.judged].words}: the {analysis.measure}."
        )
    else:
        meaning = (
            f"A typical person tells a difference of {estimate_words(found, *scale_of(analysis))} "
            f"in {JUDGED[analysis.judged].words} in 75 % of two intervals: the {analysis.measure}."
        )
    said = [*strongest, meaning]
    if analysis.spread is not None:
        spread = analysis.spread
        what = "exponents" if analysis.measure == "exponent" else "logarithms of it"
        said.append(
            f"People differ: their {what} spread by {spread.value:.2g} ({spread.low:.2g} to "
            f"{spread.high:.2g})."
        )
    return said


def most_and_least(analysis: TaskAnalysis) -> str:
    """Sentence on the strongest and the weakest surface of a task that orders them."""
    found = [(c.magnitude, c.name) for c in analysis.conditions if c.magnitude is not None]
    (least, weak), *_, (most, strong) = sorted(found, key=lambda one: one[0].value)
    return (
        f"Put first most often: {strong}, with a strength of {estimate_words(most)}; least often: "
        f"{weak}, with {estimate_words(least)}."
    )


def scale_of(analysis: TaskAnalysis) -> tuple[float, str]:
    """Factor and unit by which an analysis' measure is shown."""
    judged = JUDGED[analysis.judged]
    if analysis.measure in ("Weber fraction", EQUALITY):
        return 100.0, " %"
    return (judged.factor, judged.unit) if analysis.measure == "threshold" else (1.0, "")


def _screening_first(screening: Screening) -> list[str]:
    """Sentences on who does not do the task, and the main number without them."""
    said = [screening.said] if screening.said else []
    named = screening.named
    if not named:
        return said
    names = ", ".join(person.person for person in named)
    count = f"{len(named)} of {len(screening.people)} people"
    verbs = ("does", "is") if len(named) == 1 else ("do", "are")
    done = "left out" if screening.left_out else "kept, as the design's rule only marks"
    return [*said, f"{count} {verbs[0]} not do the task ({names}), and {verbs[1]} {done}."]


def screening_rows(screening: Screening, named: bool = False) -> TextTable:
    """Everybody, judged; or those only who do not do the task."""
    return ("Participant", "z", "Judged"), [
        (
            person.person,
            decimals(person.follows, 1),
            "; ".join(person.reasons) or "; ".join(("does the task", *person.doubts)),
        )
        for person in (screening.named if named else screening.people)
    ]


def result_rows(analysis: StudyAnalysis) -> Rows:
    """The main number with and without the people who do not do the task; none where all do."""
    screening = analysis.screening
    if screening is None or not screening.named:
        return []
    measure, scale, unit = "proportion correct", 100.0, " %"
    if isinstance(analysis, TaskAnalysis):
        measure, (scale, unit) = analysis.measure, scale_of(analysis)
    return [
        (f"{measure[:1].upper()}{measure[1:]}: {name}", *_value_and_interval(result, scale, unit))
        for name, result in screening.results.items()
    ]


def _value_and_interval(estimate: Estimate, scale: float, unit: str) -> tuple[str, str]:
    return f"{scale * estimate.value:.3g}{unit}", between(estimate, scale, unit)


def _course_first(course: Course) -> list[str]:
    said = []
    for drift in course.drift:
        if drift.p_value < _SURE:
            word = "rises" if drift.change > 0 else "falls"
            said.append(
                f"The {drift.quantity} {word} by {abs(drift.change):.2g} over the session "
                f"(p = {drift.p_value:.1g}): people learned, or tired."
            )
    if course.attention:
        missed = sum(not person.attended for person in course.attention)
        said.append(
            f"{missed} of {len(course.attention)} people missed more catch trials than one who "
            "attends."
            if missed
            else "Everybody's catch trials are those of people who attend."
        )
    return said


def estimate_words(estimate: Estimate, scale: float = 1.0, unit: str = "") -> str:
    """Words like "0.12 (0.1 to 0.15 at 95 %)"."""
    value = f"{scale * estimate.value:.3g}{unit}"
    if math.isnan(estimate.low):
        return f"{value} (no interval)"
    low, high = scale * estimate.low, scale * estimate.high
    return f"{value} ({low:.3g} to {high:.3g}{unit} at {100 * estimate.level:g} %)"


def key_rows(analysis: StudyAnalysis) -> Rows:
    """The main numbers: what, value, remark."""
    rows = [("Participants", f"{analysis.participants}", f"{analysis.trials} main trials")]
    if isinstance(analysis, TaskAnalysis):
        rows += _task_rows(analysis)
    else:
        rows += _identification_rows(analysis)
    return rows + result_rows(analysis) + course_rows(analysis.course)


def course_rows(course: Course | None) -> Rows:
    """Drift and attention, as `key_rows` has rows."""
    if course is None:
        return []
    rows = []
    for drift in course.drift:
        value = f"{drift.change:+.2g}"
        said = "one person: no interval"
        if not math.isnan(drift.low):
            said = f"{drift.low:+.2g} to {drift.high:+.2g}, p = {drift.p_value:.2g} (t over people)"
        rows.append((f"Drift of the {drift.quantity}", value, said))
    if course.attention:
        right = sum(person.right for person in course.attention)
        asked = sum(person.asked for person in course.attention)
        missed = [person.person for person in course.attention if not person.attended]
        rows.append(
            (
                "Catch trials right",
                f"{right} of {asked}",
                f"doubtful: {', '.join(missed) or 'nobody'}",
            )
        )
    return rows


def _task_rows(analysis: TaskAnalysis) -> Rows:
    (scale, unit), task = scale_of(analysis), TASKS[analysis.task]
    rows = []
    for name, found in (
        (analysis.measure.capitalize(), analysis.pooled),
        *analysis.more.items(),
    ):
        if found is None:
            continue
        s, u = (scale, unit) if name.lower() == analysis.measure.lower() else _scale_of(name)
        if task.ordered and task.model is not None and name == task.model.criterion:
            s, u = scale, unit
        rows.append((name[0].upper() + name[1:], *_value_and_interval(found, s, u)))
    if analysis.spread is not None:
        what = f"ln({analysis.measure})" if analysis.measure in PARTS else "the exponent"
        spread = _value_and_interval(analysis.spread, 1.0, "")
        rows.append((f"Spread of {what} over people", *spread))
    return rows


def _scale_of(name: str) -> tuple[float, str]:
    """Shares and differences in parts are shown in per cent, other numbers as they are."""
    parts = ("bias", "reversals", "false alarms", "difference just told")
    return (100.0, " %") if name.startswith(parts) else (1.0, "")


def between(interval: Estimate | None, scale: float = 1.0, unit: str = "") -> str:
    """Both ends, the method and the level; a dash for none."""
    if interval is None:
        return "–"
    ends = f"{scale * interval.low:.3g} to {scale * interval.high:.3g}{unit}"
    ends = "no interval" if math.isnan(interval.low) else ends
    return f"{ends} ({interval.method}, {100 * interval.level:g} %)"


def _identification_rows(analysis: IdentificationAnalysis) -> Rows:
    carried, fit = analysis.information, analysis.sensitivity
    rows = [
        *(
            ("Proportion correct", *_value_and_interval(interval, 100.0, " %"))
            for interval in analysis.intervals
        ),
        ("Guessing", f"{100 * analysis.matrix.chance:.3g} %", ""),
        (
            "p against unrelated answers",
            f"{analysis.permutation_p:.2g}",
            "permutation within participants, one-sided",
        ),
        (
            "Information transfer",
            f"{carried.estimate:.3g} bit of {carried.greatest:.3g}",
            f"{METHOD}; {between(carried.interval)}",
        ),
    ]
    if fit is not None:
        rows.append(("Total sensitivity Δ′", f"{fit.total:.3g}", model_fit(fit)))
        rows += [
            (
                f"d′ {stimulus} – {other}",
                f"{d:.2f}",
                f"{low:.2f} to {high:.2f} ({fit.interval_method}, {100 * fit.level:g} %)",
            )
            for stimulus, other, d, low, high in zip(
                analysis.matrix.stimuli[:-1],
                analysis.matrix.stimuli[1:],
                fit.d_prime,
                fit.low,
                fit.high,
                strict=True,
            )
        ]
    return rows


def people_needed(curve: PowerCurve, reach: str) -> str:
    """Words like "12 people reach 80 % power", or that the most who were tried do not."""
    if curve.needed is None:
        return f"{curve.participants[-1]} people do not {reach}"
    return f"{curve.needed} people {reach}"


def model_fit(fit: OrderedSensitivity) -> str:
    """How well the model of d′ along the stimuli describes the answers."""
    model = "equal-variance Thurstone model"
    if fit.corrected:
        return f"{model}, one trial per stimulus added (some never confused): d′ too low"
    p = "< 0.001" if fit.p_value < 0.001 else f"= {fit.p_value:.2g}"
    freedom = f"{fit.degrees_of_freedom} degrees of freedom"
    return f"{model}, G² = {fit.deviance:.1f} with {freedom} (p {p})"


def whose(origin: str) -> str:
    """Origin of answers: "simulated answers", "measured answers", "answers of people"."""
    is_noun = any(word in origin for word in ("people", "participants", "nobody"))
    return f"answers of {origin}" if is_noun else f"{origin} answers"
