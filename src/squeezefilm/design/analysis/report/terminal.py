"""What the command line prints of an analysis: one screen to decide from, the rest where asked."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from squeezefilm.core.kit.terminal import bullets, heading, plain_console, table
from squeezefilm.design.analysis.report.decisions import (
    felt_rows,
    interval_rows,
    sensitivity_rows,
    wanted_rows,
)
from squeezefilm.design.analysis.report.model_rows import models, show_missed, theory_rows
from squeezefilm.design.analysis.report.point_rows import electronics_rows
from squeezefilm.design.analysis.report.rows import (
    Rows,
    decision_rows,
    more_rows,
    unsaid_warnings,
    working_point,
)

if TYPE_CHECKING:
    from rich.console import Console

    from squeezefilm.core.kit.numbers import Row
    from squeezefilm.design.analysis.analyze import Analysis
    from squeezefilm.design.analysis.verdict import Finding
    from squeezefilm.design.analysis.wanted import Wanted

_KINDS = {"good": "good ", "limit": "limit", "doubt": "doubt"}
_STYLES = {"good": "green", "limit": "cyan", "doubt": "yellow"}

SHOWN = ("ears", "felt")
SHOWN_WITH_ALL = ("ears", "sensitivities", "other_models", "felt")
"""What of an analysis is computed for the terminal."""

# Letters of a warning where it is not asked for in full: three lines of a terminal.
_SHORT = 210


def show_analysis(analysis: Analysis, *, whole: bool = False, sensitivities: bool = False) -> None:
    """Print an analysis: verdict, warnings and key numbers; with `sensitivities` what each value
    does; `whole`: all warnings in full, that table, and then what other models say."""
    display, console = analysis.display, plain_console()
    heading(console, f"{display.title} [{display.name}]")
    _findings(console, analysis.findings)
    warned = unsaid_warnings(analysis)
    cut = [text if whole else shortened(text) for text in warned]
    if cut:
        heading(console, "Warnings")
        bullets(console, [("!", text, "yellow") for text in cut])
    heading(console, f"Key numbers {working_point(analysis.prediction)}")
    groups = decision_rows(analysis)
    rows = [row for group in groups for row in (group.rows if whole else _short(group))]
    table(console, ("", "", ""), rows, fixed=(0, 1))
    _show_wanted(console, analysis.wanted)
    if whole:
        _show_certainty(console, analysis)
        _show_sensitivities(console, analysis)
        _show_electronics(console, analysis)
        _show_models(console, analysis)
        return
    if sensitivities:
        _show_sensitivities(console, analysis)
    more = "intervals, sensitivities, models and heat"
    if cut != warned:
        more = f"the warnings in full, {more}"
    console.print(f"\n--all prints {more}")


def _short(group: Rows) -> Iterator[Row]:
    """Rows without what the verdict says already, each with the first part of its remark."""
    for row in group.rows:
        if row not in group.said:
            label, value, remark = row
            yield label, value, re.split("; |, | \\(", remark)[0]


def shortened(text: str) -> str:
    """A text up to the end of its first statement, and of those after it that three lines hold."""
    kept, *more = re.split(r"(?<=[.!?]) (?=[A-Z])|(?<=;) ", text)
    for statement in more:
        if len(kept) + len(statement) >= _SHORT:
            break
        kept += f" {statement}"
    return kept.removesuffix(";")


def _findings(console: Console, findings: tuple[Finding, ...]) -> None:
    bullets(console, [(_KINDS[item.kind], item.text, _STYLES[item.kind]) for item in findings])


def _show_wanted(console: Console, wanted: Wanted | None) -> None:
    """What a friction that was asked for takes."""
    if wanted is not None:
        heading(console, "The friction that was asked for")
        table(console, ("", "", ""), wanted_rows(wanted), fixed=(0,))


def _show_certainty(console: Console, analysis: Analysis) -> None:
    """Print the intervals of what one decides from."""
    if rows := interval_rows(analysis.uncertainty) + felt_rows(analysis.felt):
        heading(console, "How sure it is")
        table(console, ("", "", ""), rows, fixed=(0,))
    if analysis.model_form is not None:
        _findings(console, (analysis.model_form,))


def _show_sensitivities(console: Console, analysis: Analysis) -> None:
    """Print what each value does to frequency, amplitude and friction."""
    shifts = analysis.sensitivities
    heading(console, "What each value does, from the 5 % to the 95 % end of its range")
    if shifts is None:
        console.print("Nothing vibrates here, so that no value changes anything.")
        return
    head = ("value", "from, to", "frequency", "amplitude", "µ′/µ", "range")
    table(console, head, sensitivity_rows(shifts), fixed=(0,))
    console.print(
        f"µ′/µ is {shifts.relative_friction:.2f} as described. A plate with one value changed is "
        f"computed by {shifts.plate_model}; the drive follows the resonance. --json has all "
        f"{len(shifts.rows)} values."
    )


def _show_electronics(console: Console, analysis: Analysis) -> None:
    """Print which amplifiers can drive the display."""
    if analysis.prediction.voltage is not None:
        heading(console, "Drive electronics")
        table(console, ("", "", ""), electronics_rows(analysis.drive_electronics), fixed=(0,))


def _show_models(console: Console, analysis: Analysis) -> None:
    """What made the numbers, and what other models and theories say."""
    heading(console, "More numbers")
    table(console, ("", "", ""), more_rows(analysis), fixed=(0, 1))
    heading(console, "Models")
    table(console, ("", ""), models(analysis), fixed=(0,))
    show_missed(console, analysis.prediction.model)
    if analysis.other_models:
        heading(console, "The same plate by other theories, without a finger")
        others = [(model, at, amplitude) for model, at, _, amplitude in theory_rows(analysis)]
        table(console, ("model", "resonance", "amplitude"), others)
