"""An analysis in the terminal, and as result.json and report.html, which needs no other file.

Both begin with the first screen; the rest follows by question."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squeezefilm.core.kit import terminal
from squeezefilm.core.kit.folder import json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.page_style import (
    as_html,
    bullets,
    figure_section,
    folded,
    page,
    section,
    stamped,
    text_table,
)
from squeezefilm.design.analysis.report.figures import FIGURES, drawing
from squeezefilm.design.analysis.report.first_screen import HEAD, first_screen
from squeezefilm.design.analysis.report.folds import Fold, folds
from squeezefilm.design.analysis.report.rows import sensitivity_rows, wanted_rows

if TYPE_CHECKING:
    from squeezefilm.core.progress import SayProgress
    from squeezefilm.design.analysis.analysis import Analysis

# What stands beside an analysis for comparison, each computed by itself.
_BESIDE = ("ears", "band", "friction_curves", "response", "felt")


def write_analysis(
    analysis: Analysis,
    folder: Path,
    progress: SayProgress | None = None,
) -> Path:
    """Write result.json and report.html into `folder`; the path of the page.

    Raises `InputError` where the folder cannot be written to.
    """
    folder, tell = require_folder(folder), progress or (lambda _: None)
    analysis.compute((*_BESIDE, *_asked_for(analysis)), tell)
    summary, area = analysis.summary(), analysis.active_area
    # The summary, the curves behind the figures, the display.
    data = {
        **summary,
        "curves": {
            "response": analysis.response,
            "friction": analysis.friction_curves,
            "band": analysis.band,
            "fidelity": analysis.fidelity,
            "active_area": None if area is None else area.area,
        },
        "display_description": analysis.display,
    }
    tell("figures")
    drawn = _figures(analysis)
    tell("writing the report")
    files = {
        "result.json": json_text(data),
        "report.html": report_page(analysis, summary["provenance"], drawn),
    }
    return write_folder(folder, files)


def _asked_for(analysis: Analysis) -> tuple[str, ...]:
    """Parts that page and terminal have of an analysis where they were asked for."""
    shifts = ("sensitivities",) if analysis.has_sensitivities else ()
    return (*shifts, "other_models") if analysis.whole else shifts


def _figures(analysis: Analysis) -> dict[str, str]:
    """The figures by key, each in its section."""
    return {item.key: figure_section(item, drawing(analysis, item)) for item in FIGURES}


def report_page(analysis: Analysis, stamp: dict[str, Any], drawn: Mapping[str, str]) -> str:
    """The report as the text of one self-contained HTML page: the first screen, then a fold for
    each question. `stamp` says how it came about, `drawn` are its figures by key."""
    display = analysis.display
    title, name = as_html(display.title), as_html(display.name)
    parts = [in_short(analysis, drawn), *(_fold(each, drawn) for each in folds(analysis))]
    more = "" if analysis.whole else " <code>--all</code> adds every value and other models."
    return page(
        f"{name}: squeezefilm report",
        title,
        f"<code>{name}</code>, analysed by squeezefilm",
        "".join(parts),
        f"{stamped(stamp, 'description SHA-256')} ·\nno random numbers.\n"
        f"Numbers and curves: <code>result.json</code> beside this page.{more}",
        images="data:",
    )


def in_short(analysis: Analysis, drawn: Mapping[str, str] | None = None) -> str:
    """First screen of an analysis as HTML, with its picture where that is `drawn`."""
    screen = first_screen(analysis)
    picture = "" if drawn is None else drawn["friction"]
    numbers = text_table("In numbers", HEAD, screen.numbers)
    body = (
        f"<p>{as_html(screen.sentence)}</p>\n{picture}{numbers}\n"
        f"<h3>What could make it wrong</h3>\n{bullets(screen.doubts)}\n"
        f"<p><strong>Next:</strong> {as_html(screen.next_step)}</p>"
    )
    return section("In short", body)


def _fold(fold: Fold, drawn: Mapping[str, str]) -> str:
    """A question with what answers it, folded."""
    body = [drawn[key] for key in fold.figures]
    body += [text_table(each.caption, each.head, each.rows) for each in fold.tables if each.rows]
    if fold.said:
        body.append(bullets(fold.said))
    return folded(fold.question, "\n".join(body))


def compute_shown(analysis: Analysis, tell: SayProgress) -> None:
    """Compute the parts of an analysis that `show_analysis` prints; `tell` is told each."""
    felt = ("felt",) if analysis.whole else ()
    analysis.compute(("ears", *_asked_for(analysis), *felt), tell)


def show_analysis(analysis: Analysis) -> None:
    """Print an analysis: its first screen; where it was asked for what each value does; all of a
    whole one, by question."""
    display, screen = analysis.display, first_screen(analysis)
    terminal.heading(f"{display.title} [{display.name}]")
    terminal.say(printable(screen.sentence))
    terminal.table(HEAD, screen.numbers, fixed=(0, 1))
    terminal.heading("What could make it wrong")
    terminal.bullets([("!", text, "yellow") for text in screen.doubts])
    terminal.heading(f"Next: {screen.next_step}")
    if analysis.wanted is not None:
        terminal.heading("The friction that was asked for")
        terminal.table(("", "", ""), wanted_rows(analysis.wanted), fixed=(0,))
    if analysis.whole:
        _show_folds(analysis)
        return
    if analysis.has_sensitivities:
        _show_sensitivities(analysis)
    terminal.say("\n--all prints everything else, by question")


def _show_folds(analysis: Analysis) -> None:
    """Print every question with its tables and sentences."""
    for fold in folds(analysis):
        terminal.heading(fold.question)
        for each in fold.tables:
            if each.rows:
                terminal.say(printable(each.caption))
                head = ("", "", "") if each.head[0] == "Quantity" else each.head
                terminal.table(head, each.rows, fixed=(0,))
        terminal.bullets([("–", text, "") for text in fold.said])


def _show_sensitivities(analysis: Analysis) -> None:
    """Print what each value does to frequency, amplitude and friction."""
    shifts = analysis.sensitivities
    terminal.heading("What each value does, from the 5 % to the 95 % end of its range")
    if shifts is None:
        terminal.say("Nothing vibrates here, so that no value changes anything.")
        return
    head = ("value", "from, to", "frequency", "amplitude", "µ′/µ", "range")
    terminal.table(head, sensitivity_rows(shifts), fixed=(0,))
    terminal.say(
        f"A plate with one value changed is computed by {shifts.plate_model}; the drive follows "
        f"the resonance. --json has all {len(shifts.rows)} values."
    )
