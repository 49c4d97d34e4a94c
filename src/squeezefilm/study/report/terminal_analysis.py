"""An analysed study, and simulated participants, at the terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.terminal import heading, say, table
from squeezefilm.study.report.answer_tables import answer_parts, confusion_rows
from squeezefilm.study.report.page import evidence_rows, evidence_said, remarks
from squeezefilm.study.report.words import (
    key_rows,
    people_needed,
    read_first,
    screening_rows,
    whose,
)
from squeezefilm.study.tasks.findings import PARTS

if TYPE_CHECKING:
    from squeezefilm.study.identification.power import PowerCurve
    from squeezefilm.study.simulated.answers import SimulatedStudy
    from squeezefilm.study.simulated.planned_power import Planned, PlannedPower
    from squeezefilm.study.simulated.planned_precision import PlannedPrecision
    from squeezefilm.study.tasks.analyze import StudyAnalysis

_SHOWN_PEOPLE = 24
"""Most people of whom the terminal shows each; of more it shows the population only."""


def show_analyses(analyses: Mapping[str, StudyAnalysis]) -> None:
    """Print what to read first of each display, its answers and its main numbers."""
    for display, analysis in analyses.items():
        heading(f"{display}: {whose(analysis.origin)}")
        for sentence in read_first(analysis):
            say(sentence)
        for part in answer_parts(analysis):
            if part.heading != "People" or len(part.rows) <= _SHOWN_PEOPLE:
                table(part.head, part.rows, fixed=(0,))
        if analysis.screening is not None and analysis.screening.named:
            table(*screening_rows(analysis.screening, named=True), fixed=(0, 1))
        table(("", "", ""), key_rows(analysis), fixed=(0,))
        for note in analysis.notes:
            say(f"  {note}", style="dim")


def show_power(power: PlannedPower) -> None:
    """Print how many people tell two stimuli, or displays, apart, by simulation."""
    curve = power.curve
    where, sides, own = f" on {power.display}", "One-sided", "score"
    if not power.display:
        where, sides, own = f" by {power.design}", "Two-sided", f"difference of {power.measure}"
    heading(f"{power.first} against {power.second}{where}, SIMULATED")
    head = ("people", "studies that find it", "95 % bounds of the simulation")
    table(head, _by_size(curve), fixed=(0,))
    say(f"{people_needed(curve, f'reach {100 * curve.target:.0f} % power')}.")
    say(
        f"{sides} test over people at {curve.alpha:g}; the pool's own {own} is "
        f"{power.difference:.3g} (0 for nothing); {_rests_on(power, curve.studies)}"
    )


def show_precision(precision: PlannedPrecision) -> None:
    """Print how many people make an answer precise."""
    curve = precision.curve
    scale, unit = (100, " %") if precision.measure in PARTS else (1, "")
    wanted = f"± {scale * precision.precision:g}{unit}"
    heading(f"{precision.measure} of {precision.design} on {precision.display}, SIMULATED")
    head = ("people", f"studies within {wanted}", "95 % bounds", "intervals that hold the value")
    held = [f"{100 * share:.0f} %" for share in precision.held]
    rows = [(*row, share) for row, share in zip(_by_size(curve), held, strict=True)]
    table(head, rows, fixed=(0,))
    reach = f"give it in {100 * curve.target:.0f} % of the studies"
    say(f"{people_needed(curve, reach)}.")
    # Beyond what so many studies scatter.
    scatter = 2 * (0.95 * 0.05 / curve.studies) ** 0.5
    short = curve.participants[precision.held < 0.95 - scatter]
    if short.size:
        normal = "normal in the logarithm" if precision.measure in PARTS else "normal"
        say(
            f"With {', '.join(map(str, short))} people the interval holds the value less often "
            f"than the 95 % that it promises: it takes people's values to be {normal}, which those "
            "of these people are not."
        )
    say(f"The people's own value is {precision.truth:.3g}; {_rests_on(precision, curve.studies)}")


def _by_size(curve: PowerCurve) -> list[tuple[str, str, str]]:
    """Rows of people, share of the studies and its bounds."""
    return [
        (f"{size}", f"{100 * share:.0f} %", f"{100 * low:.0f} to {100 * high:.0f} %")
        for size, share, low, high in zip(
            curve.participants, curve.power, curve.low, curve.high, strict=True
        )
    ]


def _rests_on(planned: Planned, studies: int) -> str:
    return (
        f"{studies} studies a size, of simulated participants '{planned.observer}': what they "
        f"assume, this assumes. Finger: {printable(planned.finger)}."
    )


def show_simulated(study: SimulatedStudy) -> None:
    """Print each display's answers, or what their analysis says, and what is felt."""
    if not study.is_matching:
        show_analyses(study.analyses)
        say("SIMULATED: nobody answered. What that assumes stands below.")
    for index, name in enumerate(study.tables.design.displays):
        if not study.is_matching:
            heading(f"{name}: what is felt of each stimulus")
        else:
            heading(
                f"{name}, SIMULATED: {100 * study.proportion_correct(index):.1f} % right, "
                f"{study.participants} simulated participants, seed {study.seed}",
            )
            table(*confusion_rows(study.confusion(index)))
            say("Per cent of each column; rows are what was answered, columns simulated.")
        table(*evidence_rows(study.tables, index))
    say(f"Finger: {printable(study.tables.whose_finger)}.")
    say(evidence_said(study.tables))
    for said in remarks(study.tables.design):
        say(said)
