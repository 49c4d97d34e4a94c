"""`write_simulated`: answers, confusions, reasons and figures of simulated participants."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from squeezefilm.core.kit.folder import json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.page_style import (
    FigureOf,
    bullets,
    links,
    picture_sections,
    section,
    text_table,
)
from squeezefilm.study.record.tables import SURFACES, Column, columns_of, csv_text
from squeezefilm.study.report import observer_figures
from squeezefilm.study.report.pictures import pictures, png_files
from squeezefilm.study.report.words import confusion_rows
from squeezefilm.study.simulated.answers import SimulatedStudy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.study.design.study_design import StudyDesign

REMARK = (
    "The one checkable remark of Biet, Giraud and Lemaire-Semail (their tables are empty in the "
    "copy read) is of device 1: “Difference of the displayed sensation was clear except for the "
    "last case (0.4 mm).”"
)


def remarks(design: StudyDesign) -> tuple[str, ...]:
    """Sentences to be read beside the answers to a design: the paper's remark where
    real gratings are matched, else what the answers assume."""
    from squeezefilm.study.simulated.recalled import assumed

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
        *(column for column in columns_of(design) if column.name in _SHARED),
    ]


REASONS = ("Simulated", "Hz", "Bandwidth", "Kept", "Lag", "Contact", "Ripple", "d′", "Clearest")
LEGEND = (
    "Hz: frequency at which the texture passes the finger. Bandwidth: of the display's envelope "
    "(Hz). Kept: line of the friction rendered over that asked for; the wave's ripple is in it. "
    "Lag, Contact: over the period. Ripple: share of the friction's variation that the standing "
    "wave adds. d′: evidence at the period. Clearest: period of the strongest rhythm (mm). All are "
    "medians over finger classes."
)


FIGURES = (
    FigureOf(
        "percepts", "Evidence before noise", lambda one: observer_figures.percepts(one.tables)
    ),
)
"""The figure of simulated participants."""


def write_simulated(
    study: SimulatedStudy, folder: Path, progress: Callable[[str], None] | None = None
) -> Path:
    """Write simulated.json, trials.csv, a figure and a page; the path of index.html.

    The page has what to read first of each display, whose folder holds the full analysis, what the
    model sees, and of match-to-sample the confusions, also where nothing is right or wrong.
    Raises `InputError` for a folder that cannot be written to.
    """
    from squeezefilm.study.report.page import write_overview

    tell = progress or (lambda _: None)
    folder = require_folder(folder)
    tell("figures")
    figures = pictures(drawing, FIGURES, study)
    design = study.tables.design
    rows = [{"origin": "simulated", **row} for row in study.rows()]
    files = {
        **png_files(figures),
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
        + picture_sections(figures)
        + section("Files", f"<p>{links(['simulated.json', 'trials.csv'])}</p>")
    )
    page = write_overview(study.analyses, folder, tell, below, named=design.name)
    tell("writing the report")
    write_folder(folder, files)
    return page


def _seen(study: SimulatedStudy, index: int) -> str:
    """Section of a display: its answers in match-to-sample, and what the model sees."""
    heading = f"What the model sees on {escape(printable(study.tables.design.displays[index]))}"
    reasons = text_table(f"Reasons the model sees. {LEGEND}", REASONS, reason_rows(study, index))
    if study.matches is None:
        return section(heading, reasons)
    head, rows = confusion_rows(study.confusion(index))
    right = 100 * study.proportion_correct(index)
    caption = "Simulated answers, per cent of each column; in brackets trials"
    return section(f"{heading}: {right:.1f} % right", text_table(caption, head, rows) + reasons)


def drawing(study: SimulatedStudy, key: str) -> Figure:
    """The figure of simulated participants of that key."""
    return next(figure for figure in FIGURES if figure.key == key).draw(study)


def reason_rows(study: SimulatedStudy, index: int) -> list[list[str]]:
    """Rows of what the model sees of each stimulus on a display, as texts."""
    return [
        [
            name,
            *(
                f"{value:{form}}" if value == value else "–"
                for value, form in (
                    (why.texture_frequency, ".3g"),
                    (why.envelope_bandwidth, ".3g"),
                    (why.contrast_kept, ".2f"),
                    (why.lag_over_period, ".2f"),
                    (why.contact_over_period, ".1f"),
                    (why.ripple_share, ".2f"),
                    (why.d_prime, ".2f"),
                    (1e3 * why.clearest_period, ".3g"),
                )
            ),
        ]
        for name, why in study.tables.explain(index).items()
    ]


def load_drawing() -> None:
    """Load what drawing takes, in a program, before there is anything to draw."""
    import matplotlib.backends.backend_agg
    import matplotlib.figure  # noqa: F401

    from squeezefilm.study.report import page  # noqa: F401
