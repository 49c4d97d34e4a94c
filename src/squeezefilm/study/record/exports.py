"""Exports of a study, orders of trials, and the list of exports, so that a deletion reaches them.

The list lies beside the study (``study.exports/exports.json``), never in it: places on one
machine's disk are nobody else's business.

Psych-DS after the rules at https://psychds-docs.readthedocs.io: CSV files under ``data/``, named by
keywords, each with a sidecar of its own columns; ``dataset_description.json`` in JSON-LD with name,
description and every column in `variableMeasured`.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Literal, get_args

from squeezefilm import __version__
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import OWN_BYTES
from squeezefilm.core.regular_file import parsed_json, read_json, read_regular_text
from squeezefilm.core.results import write_whole
from squeezefilm.study.design.plan import StudyPlan
from squeezefilm.study.design.trials import Trial
from squeezefilm.study.record.erasure import erase_file, require_plain
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import (
    COLUMNS,
    SESSION_COLUMNS,
    SURFACES,
    Cell,
    Column,
    SurfaceCells,
    csv_text,
    session_table,
    surface_cells,
    surface_columns,
    trial_columns,
    trial_table,
)

Format = Literal["csv", "psych-ds"]
FORMATS: tuple[Format, ...] = get_args(Format)
LIST = "exports.json"
"""The list's name in the folder of exports."""
_MARK = ".squeezefilm-export.json"


def export_study(store: StudyStore, format: Format, folder: str | Path | None = None) -> Path:
    """Write all answers into a folder, and remember it. Returns the folder.

    Args:
        store: the study.
        format: "csv" (trials and sessions) or "psych-ds".
        folder: new, empty, or an earlier export, whose files are replaced; by default the
            format's own beside the study.

    Raises:
        InputError: an unknown format, a folder with other files in it (links are always
            somebody's own), or one that cannot be written to.
        RecordError: the study's file is damaged.
    """
    if format not in FORMATS:
        raise InputError(f"format '{format}' is not known; allowed: {', '.join(FORMATS)}")
    asked = Path(folder) if folder is not None else store.exports / format
    target = asked.resolve()
    store.require_whole()
    files = _FILES[format](store)
    _remove_export(target)
    # The mark comes first: a half-written export is known for one, and can be replaced.
    write_whole(target / _MARK, json.dumps({"format": format, "files": sorted(files)}, indent=2))
    for name, text in files.items():
        write_whole(target / name, text)
    _remember(store, format, target)
    return asked


def exported_folders(store: StudyStore) -> list[tuple[Format, Path]]:
    """Format and folder of every export that is still there."""
    listed = store.exports / LIST
    if not listed.is_file():
        return []
    try:
        rows = read_json(listed, OWN_BYTES, "a list of exports")
        folders = [(row["format"], Path(row["folder"])) for row in rows]
        if not {format for format, _ in folders} <= set(FORMATS):
            raise ValueError("a format that is not known")
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(
            f"{listed} cannot be read ({error!r}); remove it and export again, and delete old "
            "exports by hand"
        ) from error
    return [(format, folder) for format, folder in folders if (folder / _MARK).is_file()]


def export_again(store: StudyStore) -> int:
    """Make every export anew, its old files erased. Returns how many there are."""
    folders = exported_folders(store)
    for format, folder in folders:
        export_study(store, format, folder)
    return len(folders)


def own_files(folder: Path) -> set[Path]:
    """The files of an earlier export in a folder; none for a folder that is empty or not there.

    Raises `InputError` where there are others, which an export must not replace.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file; give a folder")
    mark = folder / _MARK
    # A link is never ours, whatever it leads to.
    present = {path for path in folder.rglob("*") if path.is_symlink() or not path.is_dir()}
    ours: set[Path] = set()
    if mark.is_file() and not mark.is_symlink():
        ours = {folder / name for name in _marked(mark)} | {mark}
        # A file that was being written when a program was killed.
        ours |= {p for p in present if any(p.name.startswith(f".{our.name}.") for our in ours)}
        ours = {path for path in ours if not path.is_symlink()}
    if others := sorted(str(path.relative_to(folder)) for path in present - ours):
        raise InputError(
            f"{folder} has files of its own ({', '.join(others[:3])}), which an export would "
            "replace; move them, or give a new or empty folder"
        )
    for path in present:
        require_plain(path)
    return present


def _marked(mark: Path) -> list[str]:
    """The names of the files that an export's mark lists.

    None for a mark of zeros: it was being erased, as the last of its files.
    """
    try:
        text = read_regular_text(mark, OWN_BYTES, "the mark of an export")
        if text.startswith("\0"):
            return []
        return [str(name) for name in parsed_json(text)["files"]]
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(
            f"{mark} cannot be read ({error!r:.100}); remove this export by hand, or give another "
            "folder"
        ) from error


def _remove_export(folder: Path) -> None:
    """Erase an earlier export. The mark goes last, so that an interrupted removal can be
    repeated. Raises what `own_files` raises."""
    mark = folder / _MARK
    for path in sorted(own_files(folder), key=lambda file: file == mark):
        erase_file(path)
    for path in sorted((p for p in folder.rglob("*") if p.is_dir()), reverse=True):
        path.rmdir()


def _remember(store: StudyStore, format: Format, folder: Path) -> None:
    known = {str(path): one for one, path in exported_folders(store)}
    known[str(folder)] = format
    listing = [{"format": one, "folder": path} for path, one in sorted(known.items())]
    write_whole(store.exports / LIST, json.dumps(listing, indent=2))


def _csv_files(store: StudyStore) -> dict[str, str]:
    name = store.design.name
    return {
        f"{name}_trials.csv": csv_text(trial_table(store), trial_columns(store.design)),
        f"{name}_sessions.csv": csv_text(session_table(store), SESSION_COLUMNS),
    }


_KINDS = {"text": "text", "number": "number", "whole": "whole number", "truth": "true or false"}


def psych_ds(store: StudyStore) -> dict[str, str]:
    """The files of a Psych-DS dataset: path within it → text."""
    design = store.design
    name = keyword(design.name)
    of_trials = trial_columns(design)
    columns = {column.name: column for column in (*of_trials, *SESSION_COLUMNS)}
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
        "README.md": readme(store),
        "CHANGES.md": f"Exported by squeezefilm {__version__}.\n",
        f"{trials}.csv": csv_text(trial_table(store), of_trials),
        f"{trials}.json": _json({"variableMeasured": _variables(of_trials)}),
        f"{sessions}.csv": csv_text(session_table(store), SESSION_COLUMNS),
        f"{sessions}.json": _json({"variableMeasured": _variables(SESSION_COLUMNS)}),
        "materials/design.toml": store.study["design"],
    }


def keyword(text: str) -> str:
    """A text as the value of a keyword in a file's name: letters and digits only."""
    return "".join(character for character in text if character.isascii() and character.isalnum())


def description(store: StudyStore) -> str:
    """A paragraph about the study, for a dataset's description."""
    design, study = store.design, store.study
    said = (
        f"{design.title or design.name}: {design.task} on {', '.join(design.displays)}, "
        f"{len(store.participants())} participants; design {study['design_sha256'][:12]}, seed "
        f"{study['seed']}, recorded with squeezefilm {study['squeezefilm_version']}."
    )
    return f"{said} {design.note}" if design.note else said


def readme(store: StudyStore) -> str:
    """The dataset's README."""
    design = store.design
    return (
        f"# {design.title or design.name}\n\n{description(store)}\n\nQuestion: "
        f"{design.spoken_question}\n\nThis is a Psych-DS dataset. One row is one answered trial; "
        "participants are random pseudonyms. Periods are whole spatial periods, groove plus "
        "ridge. A text cell that begins with an apostrophe was guarded against being taken for a "
        "formula: leave out that apostrophe.\n"
    )


def _variables(columns: Sequence[Column]) -> list[dict[str, str]]:
    variables = []
    for column in columns:
        said = f"{column.description} ({_KINDS[column.kind]})"
        variable = {"@type": "PropertyValue", "name": column.name, "description": said}
        if column.unit:
            variable["unitText"] = column.unit
        variables.append(variable)
    return variables


def _json(value: Any) -> str:
    return json.dumps(value, indent=2, ensure_ascii=False) + "\n"


_FILES: dict[Format, Callable[[StudyStore], dict[str, str]]] = {
    "csv": _csv_files,
    "psych-ds": psych_ds,
}


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
    folder, written, cells = Path(folder), [], functools.cache(surface_cells)
    columns = [column for column in ORDER_COLUMNS if column in (*trial_columns(plan.design), *_OWN)]
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder} is a file; give a folder for the orders")
    for number, schedule in enumerate(plan.schedules):
        every = (_row(plan, number, trial, cells) for trial in schedule)
        rows = [{column.name: row[column.name] for column in columns} for row in every]
        for suffix, text in (
            ("csv", csv_text(rows, columns)),
            ("json", json.dumps(rows, indent=1) + "\n"),
        ):
            path = folder / f"order-{number:03d}.{suffix}"
            write_whole(path, text)
            written.append(path)
    return written


def _row(plan: StudyPlan, number: int, trial: Trial, cells: SurfaceCells) -> dict[str, Cell]:
    row: dict[str, Cell] = {
        **trial.row(),
        "participant_number": number,
        "trial": trial.number,
        "adaptive_series": trial.adaptive,
        "reference_first": trial.reference_first if trial.adaptive else None,
        "alternatives": "|".join(trial.alternatives),
    }
    return row | surface_columns(plan.design, trial.stimuli, row, cells)
