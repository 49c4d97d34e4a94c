"""`write_simulated`: answers and confusions of simulated participants, and what they feel."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit.folder import json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import M, printable, shown
from squeezefilm.core.kit.page_style import bullets, links, section, text_table
from squeezefilm.study.record.tables import SURFACES, Column, csv_text, trial_columns
from squeezefilm.study.report.answer_tables import confusion_rows
from squeezefilm.study.simulated.answers import SimulatedStudy
from squeezefilm.study.simulated.chain_tables import ChainTables

if TYPE_CHECKING:
    from squeezefilm.study.design.study_design import StudyDesign

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
    from squeezefilm.study.report.page import write_overview

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
    page = write_overview(study.analyses, folder, tell, below, named=design.name)
    tell("writing the report")
    write_folder(folder, files)
    return page


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


def evidence_rows(tables: ChainTables, index: int) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
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
