"""What the experimenter's page is told of a study: its design, a sitting, the confusions so far."""

from __future__ import annotations

from typing import Any

from squeezefilm.study.conduct.again import COUNTED
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.record.sittings import Sitting
from squeezefilm.study.record.store import StudyStore


def confusion_counts(store: StudyStore) -> list[dict[str, Any]]:
    """Counts per display, rows answers and columns stimuli; main trials that count only.

    Empty for another task than match-to-sample. Raises `RecordError` if the file cannot be read.
    """
    design = store.design
    if design.task != "match-to-sample":
        return []
    rows, columns = list(design.answers), [stimulus.name for stimulus in design.stimuli]
    found = store.rows(
        "SELECT t.display, t.stimuli, r.choice, count(*) AS n FROM response r "
        "JOIN trial t ON t.uuid = r.trial WHERE t.phase = 'main' "
        f"AND {COUNTED} GROUP BY t.display, t.stimuli, r.choice"
    )
    tables = []
    for display in design.displays:
        counts = [[0] * len(columns) for _ in rows]
        for row in found:
            stimulus = row["stimuli"][2:-2]
            if row["display"] == display and row["choice"] in rows and stimulus in columns:
                counts[rows.index(row["choice"])][columns.index(stimulus)] += row["n"]
        tables.append({"display": display, "rows": rows, "columns": columns, "counts": counts})
    return tables


def described(design: StudyDesign) -> dict[str, Any]:
    """A design, as the page lists it."""
    return {
        "title": design.title,
        "task": design.task,
        "displays": list(design.displays),
        "stimuli": [one.name for one in design.stimuli],
        "answers": list(design.answers),
        "question": design.spoken_question,
        "note": design.note,
        "design": design.name,
    }


def shown_sitting(one: Sitting) -> dict[str, Any]:
    """A sitting, without what was consented to."""
    return {
        "id": one.id,
        "participant": one.participant,
        "device": one.device,
        "begun": one.session is not None,
    }
