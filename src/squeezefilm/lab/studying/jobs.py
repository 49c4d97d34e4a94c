"""What takes seconds of a study's file: analysis, report, rehearsal. Each in a process of its own.

The study's thread records answers meanwhile, so these open the file themselves.
"""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

from squeezefilm.study.identification.recorded import analyze_study
from squeezefilm.study.record.store import StudyStore


def analysis_of(path: Path) -> dict[str, Any]:
    """The analysis of what was answered so far, by display: tables, numbers, figures."""
    from squeezefilm.report.kit.style import png
    from squeezefilm.report.study.page import key_rows, study_figures

    with StudyStore.open(path) as store:
        answers = sum(one["answered"] for one in store.participants())
        found = analyze_study(store)
    return {
        "answers": answers,
        "displays": [
            {
                "display": display,
                "numbers": [list(row) for row in key_rows(one)],
                "notes": list(one.notes),
                "confusion": {
                    "display": display,
                    "rows": list(one.matrix.answers),
                    "columns": list(one.matrix.stimuli),
                    "counts": one.matrix.counts.tolist(),
                },
                "figures": [
                    {"title": title, "png": base64.b64encode(png(figure)).decode()}
                    for key, (title, figure) in study_figures(one).items()
                    if key != "confusion"
                ],
            }
            for display, one in found.items()
        ],
    }


def rehearsed(path: Path, participants: int) -> dict[str, Any]:
    """Simulated participants do the study's file."""
    from squeezefilm.perception.observer import load_observer
    from squeezefilm.study.conduct.rehearsal import rehearse

    with StudyStore.open(path) as store:
        people = rehearse(store, load_observer(), participants)
    return {"people": len(people)}


def report_of(path: Path) -> dict[str, Any]:
    """The analysis written as pages beside the study's file."""
    from squeezefilm.report.study.page import write_study

    with StudyStore.open(path) as store:
        found = analyze_study(store)
    folder = path.with_suffix(".results")
    pages = [write_study(one, folder / display) for display, one in found.items()]
    return {"pages": [str(page.relative_to(path.parent.parent)) for page in pages]}
