"""Orders of trials for other programs: CSV as PsychoPy reads it, JSON as jsPsych does."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

from squeezefilm.core.errors import InputError
from squeezefilm.core.results import write_whole
from squeezefilm.study.design.plan import StudyPlan
from squeezefilm.study.design.trials import Trial
from squeezefilm.study.record.tables import (
    COLUMNS,
    SURFACES,
    Cell,
    Column,
    csv_text,
    surface_cells,
    trial_columns,
)

_OWN = (
    Column("reference_first", "Whether a series presents the reference first", kind="truth"),
    Column("alternatives", "Answers in the order in which they are offered, separated by |"),
    Column("pause_s", "Rest before the trial", "s", "number"),
)
_KNOWN = {column.name: column for column in (*COLUMNS, *_OWN)}
ORDER_COLUMNS = tuple(
    _KNOWN[name]
    for name in (
        *("participant_number", "trial", "display", "block", "phase"),
        *(name for name in _KNOWN if name.startswith(SURFACES)),
        *("adaptive_series", "reference_first", "alternatives", "answer"),
        *("pause_s", "seed"),
    )
)
"""Columns of an order file."""


def write_orders(plan: StudyPlan, folder: str | Path) -> list[Path]:
    """Write the order of every participant of a plan, `order-NUMBER.csv` and `.json`; the paths.

    The CSV is what PsychoPy's loops take as conditions; the JSON is a list of objects, jsPsych's
    `timeline_variables`. An adaptive series chooses its comparisons as it goes, so that its rows
    name no stimulus; one whose answer is "same" or "no" presents the reference alone. Raises
    `InputError` where the folder cannot be written to.
    """
    folder, written = Path(folder), []
    columns = [column for column in ORDER_COLUMNS if column in (*trial_columns(plan.design), *_OWN)]
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file; give a folder for the orders")
    for number, schedule in enumerate(plan.schedules):
        every = (_row(plan, number, trial) for trial in schedule)
        rows = [{column.name: row[column.name] for column in columns} for row in every]
        for suffix, text in (
            ("csv", csv_text(rows, columns)),
            ("json", json.dumps(rows, indent=1) + "\n"),
        ):
            path = folder / f"order-{number:03d}.{suffix}"
            write_whole(path, text)
            written.append(path)
    return written


def _row(plan: StudyPlan, number: int, trial: Trial) -> dict[str, Cell]:
    design = plan.design
    gratings = {alternative.name: alternative for alternative in design.alternatives}
    row: dict[str, Cell] = {
        "participant_number": number,
        "trial": trial.number,
        "display": trial.display,
        "block": trial.block,
        "phase": trial.phase,
        "adaptive_series": trial.adaptive,
        "reference_first": trial.reference_first if trial.adaptive else None,
        "alternatives": "|".join(trial.alternatives),
        "answer": trial.answer,
        "pause_s": trial.pause,
        "seed": trial.seed,
    }
    for prefix, name in itertools.zip_longest(SURFACES, trial.stimuli, fillvalue=""):
        felt = trial.phase == "familiarisation" and name in gratings
        surface = gratings[name] if felt else (design.stimulus(name) if name else None)
        row[prefix] = name
        row |= {f"{prefix}_{key}": value for key, value in surface_cells(surface).items()}
    return row
