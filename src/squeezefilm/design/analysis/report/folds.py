"""Details behind the first screen, ordered by question: for the page and, with --all, for the
terminal. A number of the first screen is not said again."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

from squeezefilm.core.kit.numbers import Row
from squeezefilm.design.analysis.report.decisions import (
    interval_rows,
    sensitivity_rows,
    wanted_rows,
)
from squeezefilm.design.analysis.report.first_screen import doubted, first_screen
from squeezefilm.design.analysis.report.model_rows import (
    MISSED_HEADING,
    group_words,
    influence_rows,
    missed_directions,
    models,
    theory_rows,
    weight_rows,
)
from squeezefilm.design.analysis.report.point_rows import (
    display_values,
    electronics_rows,
    place_rows,
)
from squeezefilm.design.analysis.report.rows import (
    electrical_rows,
    more_rows,
    rival_rows,
    sound_rows_at_ear,
    surface_rows,
    texture_rows,
    unsaid_warnings,
    vibration_rows,
    with_measured,
    working_point,
)
from squeezefilm.design.plate.report.heat_and_sound import heat_rows

if TYPE_CHECKING:
    from squeezefilm.design.analysis.analysis import Analysis

NUMBERS = ("Quantity", "Value", "Remark")
_INFLUENCES = ("Drawn", "From", "Share of the variance", "Whose")
# Of what could be measured: as many rows as one decides from.
_NEXT = 5
# Rows of assumed values that a page shows.
_ASSUMED = 20


class Table(NamedTuple):
    """A table of plain texts: caption, heads of its columns, rows."""

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]


class Fold(NamedTuple):
    """A question with what answers it: the keys of its figures, its tables, its sentences."""

    question: str
    figures: tuple[str, ...]
    tables: list[Table]
    said: list[str]


def folds(analysis: Analysis) -> list[Fold]:
    """The questions that an analysis answers beyond its first screen."""
    return [fold for fold in _folds(analysis) if fold.figures or fold.tables or fold.said]


def _folds(analysis: Analysis) -> Iterator[Fold]:
    p, whole, unsure = analysis.prediction, analysis.whole, analysis.uncertainty
    said = {row[0] for row in first_screen(analysis).numbers}

    def new(rows: Iterable[Row]) -> list[Row]:
        return [row for row in rows if row[0] not in said]

    driving = with_measured(vibration_rows(p), analysis.measured, p.voltage)
    driving += wanted_rows(analysis.wanted)
    if p.voltage is not None:
        load = analysis.drive_electronics
        driving += electronics_rows(load) if whole else electrical_rows(load)
    at = f"A{working_point(p)[1:]}"
    yield Fold("Can I drive it?", ("response",), [Table(at, NUMBERS, new(driving))], [])
    if p.voltage:
        hot = heat_rows(p.heat) if whole else heat_rows(p.heat)[:4]
        rows = [*new(hot), *sound_rows_at_ear(analysis.ears)]
        yield Fold("Does it get hot or loud?", (), [Table("Driven for long", NUMBERS, rows)], [])
    felt = texture_rows(analysis)
    yield Fold("What can a finger feel?", (), [Table("Gratings", NUMBERS, felt)], [])
    yield _how_sure(analysis, new(friction_rows(analysis)))
    if analysis.has_sensitivities and (shifts := analysis.sensitivities) is not None:
        caption = f"From the 5 % to the 95 % end of each range; plates by {shifts.plate_model}"
        head = ("Value", "From, to", "Frequency", "Amplitude", "µ′/µ", "Range")
        table = Table(caption, head, sensitivity_rows(shifts))
        yield Fold("What does each value do?", (), [table], [])
    yield _origin(analysis)
    if whole:
        tables = [
            Table("Beside the first screen", NUMBERS, new(more_rows(analysis))),
            Table(
                "The same plate by other theories, without a finger", _THEORY, theories(analysis)
            ),
        ]
        if unsure is not None:
            weights = weight_rows(unsure)
            tables += [Table("Laws that are drawn", ("What", "Which", "Weight", "Why"), weights)]
            tables += [Table("Intervals", NUMBERS, interval_rows(unsure))]
        missed = [MISSED_HEADING.format(p.model), *missed_directions(p.model, why=True)]
        yield Fold("What do other models say?", (), tables, missed)


_THEORY = ("Model", "Resonance", "Half wavelength", "Amplitude")


def theories(analysis: Analysis) -> list[tuple[str, str, str, str]]:
    """Rows of other theories of the plate; none where there is no other."""
    return theory_rows(analysis) if analysis.other_models else []


def friction_rows(analysis: Analysis) -> list[Row]:
    """Rows of the finger's place and of what it touches; of a whole analysis rival models, too."""
    p, whole = analysis.prediction, analysis.whole
    place = place_rows(p, analysis.active_area)
    rivals = rival_rows(analysis) if whole else []
    return [*(place if whole else place[:1]), *surface_rows(analysis), *rivals]


def _how_sure(analysis: Analysis, rows: list[Row]) -> Fold:
    """Section on what the friction depends on, what could be measured, what is doubtful."""
    unsure, whole, short = analysis.uncertainty, analysis.whole, doubted(analysis)
    tables = [Table("Where and on what", NUMBERS, rows)]
    if unsure is not None:
        tables += [
            Table(group_words(group), _INFLUENCES, influence_rows(unsure, group.knowledge, most))
            for group in unsure.groups
            if whole or group.knowledge == "measurable"
            for most in (len(unsure.influences) if whole else _NEXT,)
        ]
    findings = [
        finding.text
        for finding in analysis.findings
        if whole or (finding.about != "friction" and finding.text not in short)
    ]
    if whole and analysis.model_form is not None:
        findings.append(analysis.model_form.text)
    if unsure is not None and unsure.refused.count:
        findings.append(f"{unsure.refused.sentence}.")
    return Fold("How sure is it?", (), tables, [*findings, *unsaid_warnings(analysis)])


def _origin(analysis: Analysis) -> Fold:
    """The models, and the values of the description: those assumed, or with all of an analysis
    every one."""
    every, whole = display_values(analysis.display), analysis.whole
    values = every if whole else [value for value in every if value.evidence == "assumed"]
    shown, caption = values, "Every value of the description"
    if not whole:
        shown = values[:_ASSUMED]
        caption = f"{len(shown)} of the {len(values)} values that are assumed; --all has all"
    marks = {"assumed": "⚠ assumed" if whole else "assumed", "": "not stated"}
    rows = [
        (value.path, value.text, value.source or "–", marks.get(value.evidence, value.evidence))
        for value in shown
    ]
    head = ("Key", "Value", "Source", "Evidence")
    tables = [Table(caption, head, rows)] if rows else []
    made = Table("What made the numbers", ("Link of the chain", "Model"), models(analysis))
    return Fold("Where do the values come from?", (), [made, *tables], [])
