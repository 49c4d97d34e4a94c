"""Jobs of seconds on a study's file: analysis, report, rehearsal. Each in a process of its own.

The study's thread records answers meanwhile, so these open the file themselves.
"""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.tasks.analyze import StudyAnalysis, analyze_study
from squeezefilm.study.tasks.findings import TaskAnalysis


def analysis_of(path: Path) -> dict[str, Any]:
    """The analysis of what was answered so far, by display: tables, numbers, figures."""
    from squeezefilm.core.kit.style import png
    from squeezefilm.study.report.page import study_figures
    from squeezefilm.study.report.words import key_rows, read_first

    with StudyStore.open(path) as store:
        answers = sum(participant["answered"] for participant in store.participants())
        analyses = analyze_study(store)
    return {
        "answers": answers,
        "displays": [
            {
                "display": display,
                "numbers": [list(row) for row in key_rows(analysis)],
                "first": read_first(analysis),
                "notes": list(analysis.notes),
                "methods": analysis.methods,
                **_tables(display, analysis),
                "figures": [
                    {"title": title, "png": base64.b64encode(png(figure)).decode()}
                    for key, (title, figure) in study_figures(analysis).items()
                    if key != "confusion"
                ],
            }
            for display, analysis in analyses.items()
        ],
    }


def _tables(display: str, analysis: StudyAnalysis) -> dict[str, Any]:
    """Answers by stimulus and by person, or confusions."""
    from squeezefilm.study.report.answer_tables import answer_parts

    if isinstance(analysis, TaskAnalysis):
        tables = [
            {"title": part.heading, "head": part.head, "rows": part.rows}
            for part in answer_parts(analysis)
        ]
        return {"tables": tables, "confusion": None}
    matrix = analysis.matrix
    confusion = {
        "display": display,
        "rows": list(matrix.answers),
        "columns": list(matrix.stimuli),
        "counts": matrix.counts.tolist(),
    }
    return {"tables": [], "confusion": confusion}


def rehearsed(path: Path, participants: int) -> dict[str, Any]:
    """Simulated participants do the study's file."""
    from squeezefilm.physics.perception.observer import load_observer
    from squeezefilm.study.conduct.rehearsal import rehearse

    with StudyStore.open(path) as store:
        people = rehearse(store, load_observer(), participants)
    return {"people": len(people)}


def report_of(path: Path) -> dict[str, Any]:
    """The analysis written as pages beside the study's file."""
    from squeezefilm.study.report.page import write_overview

    page = write_overview(analyze_study(path), path.with_suffix(".results"))
    return {"pages": [str(page.relative_to(path.parent.parent))]}
