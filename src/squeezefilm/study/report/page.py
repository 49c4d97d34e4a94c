"""`write_study`: numbers, figures and a page of a study's analysis on one display."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squeezefilm.core.kit.folder import json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.page_style import (
    FigureOf,
    as_html,
    bullets,
    drawn_figures,
    links,
    page,
    picture_files,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.study.report import figures as draw
from squeezefilm.study.report import task_figures
from squeezefilm.study.report.answer_tables import answer_parts
from squeezefilm.study.report.words import (
    SCREENING_HEAD,
    key_rows,
    read_first,
    screening_rows,
    whose,
)
from squeezefilm.study.tasks.findings import TaskAnalysis

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.study.tasks.analyze import StudyAnalysis


_TIMES = FigureOf(
    "times", "Response times", draw.response_times, has=lambda one: one.response_times
)
FIGURES = (
    FigureOf("confusion", "Confusion matrix", draw.confusion),
    FigureOf("sensitivity", "Sensitivity along the stimuli", draw.sensitivity),
    _TIMES,
)
"""The figures of an identification study."""

TASK_FIGURES = (
    FigureOf("answers", "What was answered", task_figures.answers),
    FigureOf("persons", "Each person", task_figures.persons, has=lambda one: one.persons),
    _TIMES,
)
"""The figures of two-interval, same-different and magnitude studies."""


def write_study(
    analysis: StudyAnalysis,
    folder: Path,
    *,
    progress: Callable[[str], None] | None = None,
) -> Path:
    """Write numbers, figures and the page of a study's display into `folder`; the path of
    index.html.

    All is made in memory before the first file is written.

    Raises:
        InputError: a folder that cannot be written to.
    """
    tell = progress or (lambda _: None)
    folder = require_folder(folder)
    tell("figures")
    figures = drawn_figures(_figures_of(analysis), analysis, "study-")
    files = picture_files(figures)
    summary = analysis.summary()
    files[_numbers_file(analysis)] = json_text(summary)
    files["index.html"] = study_page(analysis, figures, summary["provenance"])
    tell("writing the report")
    write_folder(folder, files)
    return folder / "index.html"


def write_overview(
    analyses: Mapping[str, StudyAnalysis],
    folder: Path,
    progress: Callable[[str], None] | None = None,
    more: str = "",
    named: str = "",
) -> Path:
    """Write a page per display, each in its own folder, and one to read first above them, with
    `more` sections (HTML) below; of simulated participants `named` is the study."""
    folder, places = require_folder(folder), _folders_of(analyses)
    for place, analysis in zip(places, analyses.values(), strict=True):
        write_study(analysis, folder / place, progress=progress)
    sections, name, origin = "", named, "simulated"
    for place, (display, analysis) in zip(places, analyses.items(), strict=True):
        name, origin = analysis.name.removesuffix(f", {display}"), analysis.origin
        link = f'<p><a href="{escape(place)}/index.html">All numbers and figures</a></p>'
        sections += section(escape(printable(display)), bullets(read_first(analysis)) + link)
    text = page(
        escape(printable(f"{name}: what to read first")),
        escape(printable(name)),
        f"<b>{escape(printable(whose(origin)))}</b>, analysed by squeezefilm",
        sections + more,
        "What to read first, by display.",
    )
    write_folder(folder, {"index.html": text})
    return folder / "index.html"


def _folders_of(displays: Iterable[str]) -> list[str]:
    """Names for displays' folders: of a file its name alone, numbered where two have the same."""
    names = [Path(display).name.removesuffix(".toml") for display in displays]
    return [
        name if names.count(name) == 1 else f"{name}-{number}"
        for number, name in enumerate(names, 1)
    ]


def study_figures(analysis: StudyAnalysis) -> dict[str, tuple[str, Figure]]:
    """The figures by key: heading and drawing. What was not measured has none."""
    return drawn_figures(_figures_of(analysis), analysis)


def _figures_of(analysis: StudyAnalysis) -> tuple[FigureOf, ...]:
    return TASK_FIGURES if isinstance(analysis, TaskAnalysis) else FIGURES


def _numbers_file(analysis: StudyAnalysis) -> str:
    return "analysis.json" if isinstance(analysis, TaskAnalysis) else "identification.json"


def study_page(
    analysis: StudyAnalysis,
    figures: Mapping[str, tuple[str, Figure]],
    provenance: dict[str, Any],
) -> str:
    """The page as text; `figures` lie beside it, by the names of their files."""
    title = escape(printable(analysis.name))
    head = ("Quantity", "Value", "Remark")
    numbers = text_table(whose(analysis.origin), head, key_rows(analysis))
    details = "".join(
        section(f"{part.heading} in numbers", text_table(part.caption, part.head, part.rows))
        for part in answer_parts(analysis)
    )
    if isinstance(analysis, TaskAnalysis) and analysis.assumed:
        details += section("What the simulated answers assume", bullets(analysis.assumed))
    sections = (
        section("Read first", bullets(read_first(analysis)))
        + section("Numbers", numbers)
        + picture_sections(figures)
        + details
        + _screening(analysis)
        + _worked(analysis)
        + section("What could not be computed, or needs care", bullets(analysis.notes, "Nothing."))
    )
    kind = "identification study" if not isinstance(analysis, TaskAnalysis) else analysis.task
    return page(
        f"{title}: {kind}",
        title,
        f"<b>{escape(printable(whose(analysis.origin)))}</b>, analysed by squeezefilm",
        sections,
        f"{stamped(provenance, 'SHA-256 of the answers')} ·\n"
        f"seed of the resampling {escape(str(provenance['seed']))}.\n"
        f"All numbers: {links([_numbers_file(analysis)])}.",
    )


def _screening(analysis: StudyAnalysis) -> str:
    """Section with everybody judged by the design's rule."""
    if analysis.screening is None:
        return ""
    caption = (
        "z is near a standard normal deviate for somebody who guesses, and below 0 for answers "
        "that are mixed up"
    )
    rows = screening_rows(analysis.screening)
    return section("Who does the task", text_table(caption, SCREENING_HEAD, rows))


def _worked(analysis: StudyAnalysis) -> str:
    """Section on exploration, and the methods section."""
    found = ""
    if head := _exploration_head(analysis):
        caption = "Means over people by stimulus; in brackets the t interval over people"
        found += section(
            "Exploration in numbers", text_table(caption, head, exploration_rows(analysis))
        )
    if analysis.methods:
        found += section("Methods, for a paper", f"<p>{as_html(analysis.methods)}</p>")
    return found


def _exploration_head(analysis: StudyAnalysis) -> tuple[str, ...]:
    """Head of `exploration_rows`; empty where no path was kept."""
    known = [key for key, rows in analysis.exploration.items() if rows]
    return ("Stimulus", *map(_key_words, known)) if known else ()


def exploration_rows(analysis: StudyAnalysis) -> list[tuple[str, ...]]:
    """Exploration of each stimulus: means over people with their intervals."""
    known = [rows for rows in analysis.exploration.values() if rows]
    names = list(dict.fromkeys(row.name for rows in known for row in rows))
    found = []
    for name in names:
        cells = []
        for rows in known:
            mine = [row for row in rows if row.name == name]
            if not mine:
                cells.append("–")
                continue
            first = mine[0]
            bounds = "" if math.isnan(first.low) else f" ({first.low:.3g} to {first.high:.3g})"
            cells.append(f"{first.mean:.3g}{bounds}")
        found.append((name, *cells))
    return found


def _key_words(key: str) -> str:
    """A key with its unit as a person reads it: mean_speed_m_per_s → mean speed (m/s)."""
    for unit in ("m/s", "mm/s", "m", "mm", "N", "s"):
        suffix = "_" + unit.replace("/", "_per_")
        if key.endswith(suffix):
            return f"{key.removesuffix(suffix).replace('_', ' ')} ({unit})"
    return key.replace("_", " ")
