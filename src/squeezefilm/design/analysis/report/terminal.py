"""Terminal output of an analysis: the first screen, and the rest where asked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.terminal import bullets, heading, plain_console, table
from squeezefilm.design.analysis.report.decisions import sensitivity_rows, wanted_rows
from squeezefilm.design.analysis.report.first_screen import HEAD, first_screen
from squeezefilm.design.analysis.report.folds import folds

if TYPE_CHECKING:
    from rich.console import Console

    from squeezefilm.design.analysis.analysis import Analysis

SHOWN = ("ears",)
SHOWN_WITH_ALL = ("ears", "sensitivities", "other_models", "felt")
"""Parts of an analysis that are computed for the terminal."""


def show_analysis(analysis: Analysis, *, whole: bool = False, sensitivities: bool = False) -> None:
    """Print an analysis: its first screen; with `sensitivities` what each value does; `whole`: all
    of it, by question."""
    display, console, screen = analysis.display, plain_console(), first_screen(analysis)
    heading(console, f"{display.title} [{display.name}]")
    console.print(printable(screen.sentence))
    table(console, HEAD, screen.numbers, fixed=(0, 1))
    heading(console, "What could make it wrong")
    bullets(console, [("!", text, "yellow") for text in screen.doubts])
    heading(console, f"Next: {screen.next_step}")
    if analysis.wanted is not None:
        heading(console, "The friction that was asked for")
        table(console, ("", "", ""), wanted_rows(analysis.wanted), fixed=(0,))
    if whole:
        _show_folds(console, analysis)
        return
    if sensitivities:
        _show_sensitivities(console, analysis)
    console.print("\n--all prints everything else, by question")


def _show_folds(console: Console, analysis: Analysis) -> None:
    """Print every question with its tables and sentences."""
    for fold in folds(analysis):
        heading(console, fold.question)
        for each in fold.tables:
            if each.rows:
                console.print(printable(each.caption))
                head = ("", "", "") if each.head[0] == "Quantity" else each.head
                table(console, head, each.rows, fixed=(0,))
        bullets(console, [("–", text, "") for text in fold.said])


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
        f"A plate with one value changed is computed by {shifts.plate_model}; the drive follows "
        f"the resonance. --json has all {len(shifts.rows)} values."
    )
