"""`write_simulated`: answers, confusions, reasons and figures of simulated participants."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.folder import json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.page_style import (
    FigureOf,
    bullets,
    links,
    page,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.study.record.tables import Column, csv_text
from squeezefilm.study.report import observer_figures
from squeezefilm.study.report.pictures import Picture, pictures, png_files
from squeezefilm.study.report.words import confusion_rows
from squeezefilm.study.simulated.answers import SimulatedAnswers
from squeezefilm.study.simulated.participants import SimulatedStudy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.study.design.study_design import StudyDesign

REMARK = (
    "The one checkable remark of Biet, Giraud and Lemaire-Semail (their tables are empty in the "
    "copy read) is of device 1: “Difference of the displayed sensation was clear except for the "
    "last case (0.4 mm).”"
)


def remarks(design: StudyDesign) -> tuple[str, ...]:
    """What must be read beside the answers to a match-to-sample design: the paper's remark where
    real gratings are matched, else what the answers assume."""
    from squeezefilm.study.simulated.recalled import assumed

    return (REMARK,) if design.alternatives else assumed(design)


COLUMNS = (
    Column("origin", "Always simulated"),
    Column("participant", "Number of the simulated participant, from 0", kind="whole"),
    Column("finger_class", "Number of their finger class, from 0", kind="whole"),
    Column("trial", "Number among the trials asked, from 0", kind="whole"),
    Column("display", "Display that presented the stimulus"),
    Column("stimulus", "Name of the stimulus"),
    Column("choice", "Name of the grating or surface answered"),
    Column("felt", "Whether anything was felt", kind="truth"),
    Column("response_time_s", "Of a model with assumed numbers", "s", "number"),
)
ANSWER_COLUMNS = (
    *COLUMNS[:2],
    *COLUMNS[3:5],
    Column("phase", "practice, main or catch"),
    COLUMNS[5],
    Column("second_stimulus", "Name of the second stimulus, if there are several"),
    Column("third_stimulus", "Name of the third stimulus, if there are three"),
    Column("adaptive_series", "Series that chose the comparison, if any"),
    Column("intensity", "Of an adaptive comparison, in parts of the reference", "", "number"),
    Column("choice", "What was answered"),
    Column("estimate", "Number given", "", "number"),
    Column("correct", "1 where it was right, 0 where not", "", "number"),
    COLUMNS[8],
)
REASONS = (
    "Simulated",
    "Hz",
    "Bandwidth",
    "Kept",
    "Lag",
    "Contact",
    "Ripple",
    "d′",
    "Clearest",
)
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
    FigureOf("channels", "Channels", lambda one: observer_figures.channels(one.tables)),
)
"""The figures of simulated participants."""


def write_simulated(
    study: SimulatedStudy | SimulatedAnswers,
    folder: Path,
    progress: Callable[[str], None] | None = None,
) -> Path:
    """Write simulated.json, trials.csv, two figures and a page; the path of index.html.

    Of another task than match-to-sample the page is the one of its analysis, with each display's
    in a folder of its own.
    For each display whose gratings and stimuli pair up, its folder holds the full analysis.
    Raises `InputError` for a folder that cannot be written to.
    """
    tell = progress or (lambda _: None)
    folder = require_folder(folder)
    if isinstance(study, SimulatedAnswers):
        return _write_answers(study, folder, tell)
    summary = study.summary()
    tell("figures")
    figures = pictures(drawing, FIGURES, study)
    files = png_files(figures)
    analysed = _analyses(study, folder, tell)
    files["simulated.json"] = json_text(summary)
    files["trials.csv"] = csv_text(_rows(study), COLUMNS)
    files["index.html"] = _page(study, figures, analysed, summary["provenance"])
    tell("writing the report")
    write_folder(folder, files)
    return folder / "index.html"


def drawing(study: SimulatedStudy | SimulatedAnswers, key: str) -> Figure:
    """The figure of simulated participants of that key."""
    return next(figure for figure in FIGURES if figure.key == key).draw(study)


def _write_answers(study: SimulatedAnswers, folder: Path, tell: Callable[[str], None]) -> Path:
    from squeezefilm.study.report.page import write_overview

    tell("figures")
    figures = pictures(drawing, FIGURES, study)
    reasons = f"Reasons the model sees. {LEGEND}"
    more = "".join(
        section(
            f"What the model sees on {escape(printable(name))}",
            text_table(reasons, REASONS, reason_rows(study, index)),
        )
        for index, name in enumerate(study.tables.design.displays)
    )
    files = {
        **png_files(figures),
        "simulated.json": json_text(study.summary()),
        "trials.csv": csv_text(
            [{"origin": "simulated", **r} for r in study.rows()], ANSWER_COLUMNS
        ),
    }
    below = (
        f"<p>Finger: {escape(printable(study.tables.whose_finger))}.</p>"
        + more
        + picture_sections(figures)
        + section("Files", f"<p>{links(['simulated.json', 'trials.csv'])}</p>")
    )
    page = write_overview(study.analyses, folder, tell, below)
    write_folder(folder, files)
    return page


def _analyses(study: SimulatedStudy, folder: Path, tell: Callable[[str], None]) -> dict[str, str]:
    from squeezefilm.study.report.page import write_study
    from squeezefilm.study.simulated.answers import answers_of
    from squeezefilm.study.tasks.analyze import analyze_answers

    design = study.tables.design
    try:
        analyses = analyze_answers(answers_of(study), design.name, seed=study.seed, progress=tell)
    except InputError:
        # Gratings and stimuli do not pair up: nothing is right or wrong.
        return {}
    found = {}
    for name, analysis in analyses.items():
        page = write_study(analysis, folder / f"display-{design.displays.index(name) + 1}")
        found[name] = f"{page.parent.name}/{page.name}"
    return found


def _rows(study: SimulatedStudy) -> list[dict[str, Any]]:
    design = study.tables.design
    answers = design.answers
    stimuli = [stimulus.name for stimulus in design.stimuli]
    people, trials = study.choice.shape
    return [
        {
            "origin": study.origin,
            "participant": person,
            "finger_class": int(study.finger[person]),
            "trial": int(study.number[person, trial]),
            "display": design.displays[study.display[person, trial]],
            "stimulus": stimuli[study.stimulus[person, trial]],
            "choice": answers[study.choice[person, trial]],
            "felt": bool(study.felt[person, trial]),
            "response_time_s": float(study.response_time[person, trial]),
        }
        for person in range(people)
        for trial in range(trials)
    ]


def reason_rows(study: SimulatedStudy | SimulatedAnswers, index: int) -> list[list[str]]:
    """What the model sees of each stimulus on a display, as texts."""
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


def _page(
    study: SimulatedStudy,
    figures: dict[str, tuple[str, Picture]],
    analysed: dict[str, str],
    stamp: dict[str, Any],
) -> str:
    design = study.tables.design
    parts = []
    for index, name in enumerate(design.displays):
        head, rows = confusion_rows(study.confusion(index))
        right = 100 * study.proportion_correct(index)
        link = f'<p><a href="{analysed[name]}">Full analysis</a></p>' if name in analysed else ""
        answers = "Simulated answers, per cent of each column; in brackets trials"
        reasons = f"Reasons the model sees. {LEGEND}"
        parts.append(
            section(
                f"{escape(printable(name))}, simulated: {right:.1f} % right",
                text_table(answers, head, rows)
                + text_table(reasons, REASONS, reason_rows(study, index))
                + link,
            )
        )
    title = escape(printable(f"{design.name}: simulated participants"))
    return page(
        title,
        title,
        f"{study.participants} <b>simulated</b> participants, observer\n"
        f"{escape(printable(study.tables.observer.name))}, seed {study.seed},\n"
        f"finger: {escape(printable(study.tables.whose_finger))}; no person answered",
        section(
            "What can be compared" if design.alternatives else "What the simulated answers assume",
            bullets(remarks(design)),
        )
        + "".join(parts)
        + picture_sections(figures),
        f"{stamped(stamp, 'SHA-256 of design and observer')}.\n"
        f"{links(['simulated.json', 'trials.csv'])}.",
    )


def load_drawing() -> None:
    """Load what drawing takes, in a program, before there is anything to draw."""
    import matplotlib.backends.backend_agg
    import matplotlib.figure  # noqa: F401

    from squeezefilm.study.report import page  # noqa: F401
