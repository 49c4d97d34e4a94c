"""Pages of a study: of its analysis on a display, of all displays, of simulated participants."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core.kit.folder import json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import M, printable, shown
from squeezefilm.core.kit.page_style import (
    FigureOf,
    Pictures,
    as_html,
    bullets,
    drawn_figures,
    links,
    page,
    picture_files,
    picture_sections,
    rows_section,
    section,
    stamped,
    text_table,
)
from squeezefilm.study.record.tables import SURFACES, Column, csv_text, trial_columns
from squeezefilm.study.report import figures as draw
from squeezefilm.study.report import task_figures
from squeezefilm.study.report.answer_tables import answer_parts, confusion_rows
from squeezefilm.study.report.words import (
    TextTable,
    key_rows,
    read_first,
    screening_rows,
    whose,
)
from squeezefilm.study.tasks.findings import TaskAnalysis

if TYPE_CHECKING:
    from squeezefilm.study.design.study_design import StudyDesign
    from squeezefilm.study.simulated.answers import SimulatedStudy
    from squeezefilm.study.simulated.chain_tables import ChainTables
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
    return write_folder(folder, files)


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
    sections, name, origin = "", named, "simulated"
    for place, (display, analysis) in zip(places, analyses.items(), strict=True):
        write_study(analysis, folder / place, progress=progress)
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
    return write_folder(folder, {"index.html": text})


def _folders_of(displays: Iterable[str]) -> list[str]:
    """Names for displays' folders: of a file its name alone, numbered where two have the same."""
    names = [Path(display).name.removesuffix(".toml") for display in displays]
    return [
        name if names.count(name) == 1 else f"{name}-{number}"
        for number, name in enumerate(names, 1)
    ]


def study_figures(analysis: StudyAnalysis) -> Pictures:
    """The figures by key: heading and drawing. What was not measured has none."""
    return drawn_figures(_figures_of(analysis), analysis)


def _figures_of(analysis: StudyAnalysis) -> tuple[FigureOf, ...]:
    return TASK_FIGURES if isinstance(analysis, TaskAnalysis) else FIGURES


def _numbers_file(analysis: StudyAnalysis) -> str:
    return "analysis.json" if isinstance(analysis, TaskAnalysis) else "identification.json"


def study_page(
    analysis: StudyAnalysis,
    figures: Pictures,
    provenance: dict[str, Any],
) -> str:
    """The page as text; `figures` lie beside it, by the names of their files."""
    title = escape(printable(analysis.name))
    details = "".join(
        section(f"{part.heading} in numbers", text_table(part.caption, part.head, part.rows))
        for part in answer_parts(analysis)
    )
    if isinstance(analysis, TaskAnalysis) and analysis.assumed:
        details += section("What the simulated answers assume", bullets(analysis.assumed))
    sections = (
        section("Read first", bullets(read_first(analysis)))
        + rows_section("Numbers", whose(analysis.origin), key_rows(analysis))
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
    return section("Who does the task", text_table(caption, *screening_rows(analysis.screening)))


def _worked(analysis: StudyAnalysis) -> str:
    """Section on exploration, and the methods section."""
    found = ""
    if any(analysis.exploration.values()):
        caption = "Means over people by stimulus; in brackets the t interval over people"
        table = text_table(caption, *exploration_rows(analysis))
        found += section("Exploration in numbers", table)
    if analysis.methods:
        found += section("Methods, for a paper", f"<p>{as_html(analysis.methods)}</p>")
    return found


def exploration_rows(analysis: StudyAnalysis) -> TextTable:
    """Head and rows of the exploration of each stimulus: means over people with their intervals."""
    known = {key: rows for key, rows in analysis.exploration.items() if rows}
    names = dict.fromkeys(row.name for rows in known.values() for row in rows)
    found = []
    for name in names:
        cells = []
        for rows in known.values():
            row = next((row for row in rows if row.name == name), None)
            if row is None:
                cells.append("–")
                continue
            bounds = "" if math.isnan(row.low) else f" ({row.low:.3g} to {row.high:.3g})"
            cells.append(f"{row.mean:.3g}{bounds}")
        found.append((name, *cells))
    return ("Stimulus", *map(_key_words, known)), found


def _key_words(key: str) -> str:
    """A key with its unit as a person reads it: mean_speed_m_per_s → mean speed (m/s)."""
    for unit in ("m/s", "mm/s", "m", "mm", "N", "s"):
        suffix = "_" + unit.replace("/", "_per_")
        if key.endswith(suffix):
            return f"{key.removesuffix(suffix).replace('_', ' ')} ({unit})"
    return key.replace("_", " ")


REMARK = (
    "The one checkable remark of Biet, Giraud and Lemaire-Semail (their tables are empty in the "
    "copy read) is of device 1: “Difference of the displayed sensation was clear except for the "
    "last case (0.4 mm).”"
)


def remarks(design: StudyDesign) -> tuple[str, ...]:
    """Sentences to be read beside the answers to a design: the paper's remark where
    real gratings are matched, else what the answers assume."""
    from squeezefilm.study.simulated.chain_tables import assumed

    return (REMARK,) if design.alternatives else assumed(design)


_SHARED = (
    *("trial", "display", "phase", *SURFACES, "adaptive_series", "intensity", "choice", "estimate"),
    *("correct", "response_time_s"),
)


def simulated_columns(design: StudyDesign) -> list[Column]:
    """Columns of trials.csv: those of recorded trials that a simulated participant has too."""
    return [
        Column("origin", "Always simulated"),
        Column("participant", "Number of the simulated participant, from 0", kind="whole"),
        *(column for column in trial_columns(design) if column.name in _SHARED),
    ]


def write_simulated(
    study: SimulatedStudy, folder: Path, progress: Callable[[str], None] | None = None
) -> Path:
    """Write simulated.json, trials.csv and a page; the path of index.html.

    The page has what to read first of each display, whose folder holds the full analysis, what is
    felt of each stimulus, and of match-to-sample the confusions, also where nothing is right or
    wrong.
    Raises `InputError` for a folder that cannot be written to.
    """
    tell = progress or (lambda _: None)
    folder = require_folder(folder)
    design = study.tables.design
    rows = [{"origin": "simulated", **row} for row in study.rows()]
    files: dict[str, str | bytes] = {
        "simulated.json": json_text(study.summary()),
        "trials.csv": csv_text(rows, simulated_columns(design)),
    }
    about = "What can be compared" if design.alternatives else "What the simulated answers assume"
    below = (
        f"<p>{study.participants} <b>simulated</b> participants, observer "
        f"{escape(printable(study.tables.observer.name))}, seed {study.seed}, finger: "
        f"{escape(printable(study.tables.whose_finger))}; no person answered.</p>"
        + section(about, bullets(remarks(design)))
        + "".join(_seen(study, index) for index in range(len(design.displays)))
        + section("Files", f"<p>{links(['simulated.json', 'trials.csv'])}</p>")
    )
    written = write_overview(study.analyses, folder, tell, below, named=design.name)
    tell("writing the report")
    write_folder(folder, files)
    return written


def _seen(study: SimulatedStudy, index: int) -> str:
    """Section of a display: its answers in match-to-sample, and what is felt."""
    tables = study.tables
    heading = f"What is felt on {escape(printable(tables.design.displays[index]))}"
    felt = text_table(evidence_said(tables), *evidence_rows(tables, index))
    if not study.is_matching:
        return section(heading, felt)
    right = 100 * study.proportion_correct(index)
    caption = "Simulated answers, per cent of each column; in brackets trials"
    matched = text_table(caption, *confusion_rows(study.confusion(index)))
    return section(f"{heading}: {right:.1f} % right", matched + felt)


def evidence_said(tables: ChainTables) -> str:
    """Sentence on what `evidence_rows` has."""
    return (
        "Evidence (d′) of the clearest rhythm before noise, and its spatial period: medians over "
        f"finger classes. Below d′ = {tables.observer.detection_criterion:.3g} nothing is felt."
    )


def evidence_rows(tables: ChainTables, index: int) -> TextTable:
    """Head and rows of what is felt of each stimulus on a display: evidence and spatial period of
    its clearest rhythm; along x and along y where surfaces are explored freely."""
    felt = tables.virtual.d_prime[index, ..., 0], tables.virtual.period[index, ..., 0]
    evidence, period = (np.median(values, axis=0) for values in felt)
    ways = ("",) if evidence.shape[1] == 1 else (" along x", " along y")
    head = ("Stimulus", *(f"{what}{way}" for way in ways for what in ("d′", "Clearest rhythm")))
    rows = []
    for stimulus, strengths, periods in zip(tables.design.stimuli, evidence, period, strict=True):
        cells = [stimulus.name]
        for strength, length in zip(strengths, periods, strict=True):
            cells += [f"{strength:.2f}", shown(length, M, 3)] if strength > 0 else ["0", "–"]
        rows.append(tuple(cells))
    return head, rows
