"""An analysis in the terminal, and as result.json and report.html, which needs no other file.

Both begin with the first screen; the rest follows by question."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from html import escape
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
    from squeezefilm.design.analysis.analysis import Analysis

# What stands beside an analysis for comparison, each computed by itself.
_BESIDE = ("ears", "band", "friction_curves", "response", "felt")
SHOWN = ("ears",)
SHOWN_WITH_ALL = ("ears", "sensitivities", "other_models", "felt")
"""Parts of an analysis that are computed for the terminal."""


def write_analysis(
    analysis: Analysis,
    folder: Path,
    progress: Callable[[str], None] | None = None,
) -> Path:
    """Write result.json and report.html into `folder`; the path of the page.

    Raises `InputError` where the folder cannot be written to.
    """
    folder, tell = require_folder(folder), progress or (lambda _: None)
    asked = ("sensitivities",) if analysis.has_sensitivities else ()
    more = ("other_models",) if analysis.whole else ()
    analysis.compute((*_BESIDE, *asked, *more), tell)
    summary = analysis.summary()
    tell("figures")
    drawn = _figures(analysis)
    tell("writing the report")
    data = json_text(result_data(analysis, summary))
    files = {"result.json": data, "report.html": report_page(analysis, summary, drawn)}
    return write_folder(folder, files)


def _figures(analysis: Analysis) -> dict[str, str]:
    """The figures by key, each in its section."""
    return {item.key: figure_section(item, drawing(analysis, item)) for item in FIGURES}


def result_data(analysis: Analysis, summary: dict[str, Any]) -> dict[str, Any]:
    """The content of result.json: the summary, the curves behind the figures, the display."""
    return {
        **summary,
        "curves": {
            "response": analysis.response,
            "friction": analysis.friction_curves,
            "band": analysis.band,
            "fidelity": analysis.fidelity,
            "active_area": None if analysis.active_area is None else analysis.active_area.area,
        },
        "display_description": analysis.display,
    }


def report_page(
    analysis: Analysis,
    summary: dict[str, Any] | None = None,
    drawn: Mapping[str, str] | None = None,
) -> str:
    """The report as the text of one self-contained HTML page: the first screen, then a fold for
    each question. `drawn` are its figures by key, where they are there already."""
    summary, ready = summary or analysis.summary(), drawn or _figures(analysis)
    display = analysis.display
    title, name = as_html(display.title), as_html(display.name)
    stamp = summary["provenance"]
    seed = "no random numbers" if stamp["seed"] is None else f"seed {escape(str(stamp['seed']))}"
    parts = [
        in_short(analysis, ready),
        *(_fold(each, ready) for each in folds(analysis)),
    ]
    more = "" if analysis.whole else " <code>--all</code> adds every value and other models."
    return page(
        f"{name}: squeezefilm report",
        title,
        f"<code>{name}</code>, analysed by squeezefilm",
        "".join(parts),
        f"{stamped(stamp, 'description SHA-256')} ·\n{seed}.\n"
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


def show_analysis(analysis: Analysis, *, whole: bool = False, sensitivities: bool = False) -> None:
    """Print an analysis: its first screen; with `sensitivities` what each value does; `whole`: all
    of it, by question."""
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
    if whole:
        _show_folds(analysis)
        return
    if sensitivities:
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
