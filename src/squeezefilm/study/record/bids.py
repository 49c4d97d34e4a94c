"""A study as a BIDS dataset of behavioural data, without imaging.

After https://bids-specification.readthedocs.io (1.10), "Behavioral experiments (with no neural
recordings)": ``sub-*/beh/sub-*_task-*_beh.tsv``, one row per trial, with one sidecar for all at
the root, and likewise one row per sitting as the task "sittings".
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from squeezefilm import __version__
from squeezefilm.study.record.psych_ds import description, keyword, readme
from squeezefilm.study.record.session_table import SESSION_COLUMNS, session_table
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.trial_table import COLUMNS, Cell, Column, cell_text, trial_table

_MISSING = "n/a"
_NUMBER = Column("participant_number", "Which of the balanced orders they had, from 0")


def dataset(store: StudyStore) -> dict[str, str]:
    """The files of the dataset: path within it → text."""
    design = store.design
    task = keyword(design.task)
    rows = trial_table(store)
    columns = [
        Column("sitting_id", one.description) if one.name == "session_id" else one
        for one in COLUMNS
        if not one.name.startswith("participant_")
    ]
    people = {row["participant_id"]: row["participant_number"] for row in rows}
    listing: list[dict[str, Cell]] = [
        {"participant_id": f"sub-{one}", "participant_number": number}
        for one, number in people.items()
    ]
    files = {
        "dataset_description.json": _json(
            {
                "Name": design.title or design.name,
                "BIDSVersion": "1.10.0",
                "DatasetType": "raw",
                "GeneratedBy": [{"Name": "squeezefilm", "Version": __version__}],
            }
        ),
        "README": f"{readme(store, 'BIDS')}\n{description(store)}\n",
        "CHANGES": f"1.0.0 {store.study['created_utc'][:10]}\n  - Exported by squeezefilm.\n",
        "participants.tsv": _tsv(listing, [COLUMNS[0], _NUMBER]),
        "participants.json": _json(_described([_NUMBER])),
        f"task-{task}_beh.json": _json(
            {
                "TaskName": task,
                "TaskDescription": description(store),
                "Instructions": design.spoken_question,
                **_described(columns),
            }
        ),
    }
    sittings = session_table(store)
    files["task-sittings_beh.json"] = _json(
        {
            "TaskName": "sittings",
            "TaskDescription": "Conditions, airborne ultrasound and the device's state, by sitting",
            **_described(_SITTINGS),
        }
    )
    for one in people:
        mine = [row for row in rows if row["participant_id"] == one]
        files[f"sub-{one}/beh/sub-{one}_task-{task}_beh.tsv"] = _tsv(mine, columns)
        sat = [row for row in sittings if row["participant_id"] == one]
        files[f"sub-{one}/beh/sub-{one}_task-sittings_beh.tsv"] = _tsv(sat, _SITTINGS)
    return files


# BIDS keeps the name session_id for sessions of its own folders (ses-*).
_SITTINGS = [
    Column("sitting_id", one.description) if one.name == "session_id" else one
    for one in SESSION_COLUMNS
    if one.name != "participant_id"
]


def _described(columns: Sequence[Column]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for column in columns:
        found[column.name] = {"Description": column.description}
        if column.unit:
            found[column.name]["Units"] = column.unit
    return found


def _tsv(rows: Sequence[dict[str, Cell]], columns: Sequence[Column]) -> str:
    lines = ["\t".join(column.name for column in columns)]
    for row in rows:
        named = {**row, "sitting_id": row.get("session_id")}
        cells = [cell_text(named[column.name], _MISSING) for column in columns]
        # A tab or a line's end has no escape in TSV.
        lines.append("\t".join(" ".join(cell.split()) or _MISSING for cell in cells))
    return "\n".join(lines) + "\n"


def _json(value: Any) -> str:
    return json.dumps(value, indent=2, ensure_ascii=False) + "\n"
