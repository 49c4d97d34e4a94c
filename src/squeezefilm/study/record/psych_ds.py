"""A study as a Psych-DS dataset: CSV files under ``data/``, described in JSON-LD.

After the rules at https://psychds-docs.readthedocs.io: ``dataset_description.json`` with name,
description and every column in `variableMeasured`; data files named by keywords, each with a
sidecar of its own columns.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from squeezefilm import __version__
from squeezefilm.study.record.session_table import SESSION_COLUMNS, session_table
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.trial_table import COLUMNS, Column, csv_text, trial_table

_KINDS = {"text": "text", "number": "number", "whole": "whole number", "truth": "true or false"}


def dataset(store: StudyStore) -> dict[str, str]:
    """The files of the dataset: path within it → text."""
    design = store.design
    name = keyword(design.name)
    columns = {one.name: one for one in (*COLUMNS, *SESSION_COLUMNS)}
    about = {
        "@context": "https://schema.org",
        "@type": "Dataset",
        "name": design.title or design.name,
        "description": description(store),
        "keywords": ["tactile perception", "friction modulation", "psychophysics", design.task],
        "variableMeasured": _variables(list(columns.values())),
    }
    trials = f"data/study-{name}_task-{keyword(design.task)}_data"
    sessions = f"data/study-{name}_task-sessions_data"
    return {
        "dataset_description.json": _json(about),
        "README.md": readme(store, "Psych-DS"),
        "CHANGES.md": f"Exported by squeezefilm {__version__}.\n",
        f"{trials}.csv": csv_text(trial_table(store)),
        f"{trials}.json": _json({"variableMeasured": _variables(COLUMNS)}),
        f"{sessions}.csv": csv_text(session_table(store), SESSION_COLUMNS),
        f"{sessions}.json": _json({"variableMeasured": _variables(SESSION_COLUMNS)}),
        "materials/design.toml": store.study["design"],
    }


def keyword(text: str) -> str:
    """A text as the value of a keyword in a file's name: letters and digits only."""
    return "".join(one for one in text if one.isascii() and one.isalnum())


def description(store: StudyStore) -> str:
    """One paragraph about the study, for a dataset's description."""
    design, study = store.design, store.study
    said = (
        f"{design.title or design.name}: {design.task} on {', '.join(design.displays)}, "
        f"{len(store.participants())} participants; design {study['design_sha256'][:12]}, seed "
        f"{study['seed']}, recorded with squeezefilm {study['squeezefilm_version']}."
    )
    return f"{said} {design.note}" if design.note else said


def readme(store: StudyStore, standard: str) -> str:
    """The dataset's README."""
    design = store.design
    return (
        f"# {design.title or design.name}\n\n{description(store)}\n\nQuestion: "
        f"{design.spoken_question}\n\nThis is a {standard} dataset. One row is one answered trial; "
        "participants are random pseudonyms. Periods are whole spatial periods, groove plus "
        "ridge. A text cell that begins with an apostrophe was guarded against being taken for a "
        "formula: leave out that apostrophe.\n"
    )


def _variables(columns: Sequence[Column]) -> list[dict[str, str]]:
    found = []
    for column in columns:
        said = f"{column.description} ({_KINDS[column.kind]})"
        one = {"@type": "PropertyValue", "name": column.name, "description": said}
        if column.unit:
            one["unitText"] = column.unit
        found.append(one)
    return found


def _json(value: Any) -> str:
    return json.dumps(value, indent=2, ensure_ascii=False) + "\n"
