"""Details behind the first screen, ordered by question: for the page and, with --all, for the
terminal. A number of the first screen is not said again."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import (
    HZ,
    NUMBERS,
    PER_VOLT,
    SPEED,
    M,
    N,
    Row,
    S,
    V,
    printable,
    shown,
    span,
)
from squeezefilm.design.analysis.report.first_screen import doubted, first_screen
from squeezefilm.design.analysis.report.rows import (
    MISSED_HEADING,
    OUT_OF_REACH,
    display_values,
    electronics_rows,
    felt_rows,
    group_words,
    influence_rows,
    interval_rows,
    missed_directions,
    models,
    place_rows,
    reduction_row,
    sensitivity_rows,
    theory_rows,
    wanted_rows,
    weight_rows,
)
from squeezefilm.design.plate.report.terminal import heat_rows
from squeezefilm.physics.chain.pad_place import place_words

if TYPE_CHECKING:
    from squeezefilm.design.analysis.analysis import Analysis, MeasuredBeside
    from squeezefilm.design.analysis.ears import EarExposure
    from squeezefilm.physics.chain.prediction import Prediction


def working_point(p: Prediction) -> str:
    """Words for the point at which the key numbers are."""
    driven = shown(p.vibration_amplitude, M, 3) if p.voltage is None else shown(p.voltage, V)
    return (
        f"at {driven} and {shown(p.frequency, HZ)}, finger of {shown(p.normal_force, N)} at "
        f"{shown(p.speed, SPEED)} on {printable(p.surface.name)}"
    )


def vibration_rows(p: Prediction) -> list[Row]:
    """Resonance and drive, and the amplitude with and without the finger."""
    mode, free = p.mode, p.touch.free_amplitude
    # The resonance is defined to many digits only: an off-resonance drive is worth a remark.
    off = abs(p.frequency / mode.resonance_frequency - 1) > 1e-6
    at = f"{shown(p.frequency, HZ)}, {'beside the' if off else 'the'} resonance"
    per_volt = shown(mode.amplitude_per_volt, PER_VOLT)
    place = p.law.place
    of = "at antinodes" if place is None else f"at {place.antinode_said}"
    drive, made = ("Drive", "none", f"amplitude given, at {at}"), f"zero-to-peak, {of}"
    if p.voltage is not None:
        drive = ("Drive", shown(p.voltage, V), f"peak, at {at}")
        made = f"{per_volt} × {shown(p.voltage, V)}, {of}"
        if off:
            made = f"{of}; at the resonance {per_volt}"
    kept = f"the finger leaves {100 * p.touch.kept:.3g} %"
    if p.touch.mode is None:
        kept = "the finger is taken to change nothing: no modal mass is known"
    held, under_finger = shown(p.vibration_amplitude, M, 3), list[Row]()
    # A finger at the antinode has that amplitude: no number is printed twice.
    if place is not None and shown(p.amplitude_at_place, M, 3) != held:
        where = f"r.m.s. over its contact, at {place_words(p.place)}"
        under_finger = [("Amplitude under the finger", shown(p.amplitude_under_pad, M, 3), where)]
    solved = mode.label
    if mode.frequency_error is not None:
        solved += f", solved to ± {shown(mode.frequency_error, HZ, 2)}"
    return [
        ("Resonance frequency", shown(mode.resonance_frequency, HZ), solved),
        drive,
        ("Amplitude, free", shown(free, M, 3), made),
        ("Peak amplitude, finger on", held, f"{of}; {kept}"),
        *under_finger,
    ]


def with_measured(
    rows: Iterable[Row], beside: Iterable[MeasuredBeside], voltage: si.Volt | None
) -> list[Row]:
    """Rows whose remarks begin with what was measured of their quantity on the real display, and by
    how much the computed number differs; of an amplitude at another voltage (V) that is said."""
    said = dict[str, str]()
    for measured in beside:
        more = "+" if measured.difference > 0 else "−"
        text = f"{more}{si.percent(abs(measured.difference))} on measured "
        text += shown(measured.measured, si.Unit(measured.unit), 3)
        if measured.voltage not in (None, voltage):
            text += f" at {shown(measured.voltage, V)}"
        said[measured.quantity] = f"{text} ({printable(measured.source) or 'source not stated'})"
    return [
        (label, value, "; ".join(part for part in (said.get(label), remark) if part))
        for label, value, remark in rows
    ]


def surface_rows(analysis: Analysis) -> list[Row]:
    """Rows of what is touched, and of what the paper's criterion takes."""
    p = analysis.prediction
    finger = f"{shown(p.normal_force, N)} at {shown(p.speed, SPEED)}"
    name = printable(p.surface.name)
    reached = shown(analysis.own_curve.amplitude_for_criterion, M, 3, OUT_OF_REACH)
    return [
        ("Surface roughness", shown(p.surface.roughness, M), f"{name}; finger {finger}"),
        ("Amplitude for µ′/µ = 0.7", reached, "under the finger"),
    ]


def rival_rows(analysis: Analysis) -> list[Row]:
    """Rows of the range of rival models, beside the interval's width, which leaves them out."""
    rivals, unsure = analysis.rivals.values(), analysis.uncertainty
    if unsure is None or not rivals:
        return []
    low, high = unsure.interval
    said = f"interval {high - low:.2f} wide, without them"
    return [("Rival models give µ′/µ", span(min(rivals), max(rivals)), said)]


def texture_rows(analysis: Analysis) -> list[Row]:
    """Rows of how fast the amplitude can follow, and of the gratings which that lets through."""
    tau, table = analysis.envelope_time_constant, analysis.fidelity
    band = f"a bandwidth of {shown(analysis.envelope_bandwidth, HZ, 3)}"
    rows = [("Envelope time constant", shown(tau, S, 3), band)]
    speed = analysis.prediction.speed
    if table is not None:
        rows.append(_grating(analysis, int(np.argmin(np.abs(table.speeds - speed)))))
    return [*rows, *felt_rows(analysis.felt, speed)]


def _grating(analysis: Analysis, at: int) -> Row:
    """The finest grating at one of the table's speeds."""
    table = analysis.fidelity
    assert table is not None, "nothing is rendered"
    left = f"{si.percent(table.fundamental)} of its wave"
    return (
        f"Finest grating at {shown(float(table.speeds[at]), SPEED)}",
        shown(float(table.finest_period[at]), M, 3),
        f"{si.percent(table.kept)} of its swing, {left} kept",
    )


def sound_rows_at_ear(ears: EarExposure | None) -> list[Row]:
    """The level at an ear, beside the guidance."""
    if ears is None:
        said = "no face was solved here; squeezefilm plate solves plates, discs and stators"
        return [("Sound", "not known", said)]
    levels = " and ".join(f"{ear_limit.guidance.level_dB:.0f} dB" for ear_limit in ears.limits)
    limit = f"guidance {levels}" if levels else "no guidance"
    range_of = f"{ears.low_dB:.0f} to {ears.high_dB:.0f} dB, loudest direction; {limit}"
    return [(f"Sound at {ears.distance:g} m", f"{ears.level_dB:.0f} dB", range_of)]


def more_rows(analysis: Analysis) -> list[Row]:
    """Rows of what the key numbers are made of and what follows from them: for an appendix."""
    p = analysis.prediction
    floats = shown(analysis.own_curve.zero_friction_amplitude, M, 3, OUT_OF_REACH)
    rows = [
        ("Quality factor", f"{p.mode.quality_factor:.4g}", ""),
        ("Half wavelength", shown(p.mode.half_wavelength, M), ""),
        ("Squeeze number", f"{p.squeeze_number:.4g}", ""),
        ("Mean pressure", f"{p.mean_pressure:.4f}", "over ambient, contact and period"),
        reduction_row(p),
        ("Amplitude for no friction", floats, "the finger floats"),
    ]
    if analysis.fidelity is not None:
        rows += [_grating(analysis, at) for at in range(len(analysis.fidelity.speeds))]
    rows += heat_rows(p.heat)[2:] if p.voltage else []
    return with_measured(rows, analysis.measured, p.voltage)


def unsaid_warnings(analysis: Analysis) -> list[str]:
    """The warnings that the verdict does not already say word for word."""
    said = {finding.text for finding in analysis.verdict}
    return [text for text in analysis.prediction.warnings if text not in said]


_INFLUENCES = ("Drawn", "From", "Share of the variance", "Whose")
# Of what could be measured: as many rows as one decides from.
_NEXT = 5
# Rows of assumed values that a page shows.
_ASSUMED = 20


class FoldTable(NamedTuple):
    """A table of plain texts: caption, heads of its columns, rows."""

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]


class Fold(NamedTuple):
    """A question with what answers it: the keys of its figures, its tables, its sentences."""

    question: str
    figures: tuple[str, ...]
    tables: list[FoldTable]
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
        driving += electronics_rows(analysis.drive_electronics)
    at = f"A{working_point(p)[1:]}"
    yield Fold("Can I drive it?", ("response",), [FoldTable(at, NUMBERS, new(driving))], [])
    if p.voltage:
        hot = heat_rows(p.heat) if whole else heat_rows(p.heat)[:4]
        rows = [*new(hot), *sound_rows_at_ear(analysis.ears)]
        yield Fold(
            "Does it get hot or loud?", (), [FoldTable("Driven for long", NUMBERS, rows)], []
        )
    felt = texture_rows(analysis)
    yield Fold("What can a finger feel?", (), [FoldTable("Gratings", NUMBERS, felt)], [])
    yield _how_sure(analysis, new(friction_rows(analysis)))
    if analysis.has_sensitivities and (shifts := analysis.sensitivities) is not None:
        caption = f"From the 5 % to the 95 % end of each range; plates by {shifts.plate_model}"
        head = ("Value", "From, to", "Frequency", "Amplitude", "µ′/µ", "Range")
        table = FoldTable(caption, head, sensitivity_rows(shifts))
        yield Fold("What does each value do?", (), [table], [])
    yield _origin(analysis)
    if whole:
        beside = theory_rows(analysis) if analysis.other_models else []
        tables = [
            FoldTable("Beside the first screen", NUMBERS, new(more_rows(analysis))),
            FoldTable("The same plate by other theories, without a finger", _THEORY, beside),
        ]
        if unsure is not None:
            weights = weight_rows(unsure)
            tables += [
                FoldTable("Laws that are drawn", ("What", "Which", "Weight", "Why"), weights)
            ]
            tables += [FoldTable("Intervals", NUMBERS, interval_rows(unsure))]
        missed = [MISSED_HEADING.format(p.model), *missed_directions(p.model, why=True)]
        yield Fold("What do other models say?", (), tables, missed)


_THEORY = ("Model", "Resonance", "Half wavelength", "Amplitude")


def friction_rows(analysis: Analysis) -> list[Row]:
    """Rows of the finger's place and of what it touches; of a whole analysis rival models, too."""
    p, whole = analysis.prediction, analysis.whole
    place = place_rows(p, analysis.active_area)
    rivals = rival_rows(analysis) if whole else []
    return [*(place if whole else place[:1]), *surface_rows(analysis), *rivals]


def _how_sure(analysis: Analysis, rows: list[Row]) -> Fold:
    """Section on what the friction depends on, what could be measured, what is doubtful."""
    unsure, whole, short = analysis.uncertainty, analysis.whole, doubted(analysis)
    tables = [FoldTable("Where and on what", NUMBERS, rows)]
    if unsure is not None:
        tables += [
            FoldTable(
                group_words(group), _INFLUENCES, influence_rows(unsure, group.knowledge, most)
            )
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
    tables = [FoldTable(caption, head, rows)] if rows else []
    made = FoldTable("What made the numbers", ("Link of the chain", "Model"), models(analysis))
    return Fold("Where do the values come from?", (), [made, *tables], [])
