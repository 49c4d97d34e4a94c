"""Taking a participant out of a study without a trace.

All that this program wrote is gone through: rows, traces, backups, exports, the lab's sittings. It
is then searched, with what else lies among it, for every identifier that belonged to the
participant. What was copied elsewhere by hand, a file system's snapshots and the free blocks of a
disk are out of reach.
"""

from __future__ import annotations

import glob
import json
import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.core.hard_limits import TRACE_BYTES
from squeezefilm.core.regular_file import read_regular
from squeezefilm.study.record.database import is_study, same_folders
from squeezefilm.study.record.exports import export_again, exported_folders, own_files
from squeezefilm.study.record.schema import require_identifier
from squeezefilm.study.record.sittings import FILE, Sittings
from squeezefilm.study.record.store import UNFINISHED, StudyStore

_TRIALS = "trial IN (SELECT uuid FROM trial WHERE participant = ?)"
_OF = {
    "set_aside": _TRIALS,
    "response": _TRIALS,
    "presentation": _TRIALS,
    "verification": "session IN (SELECT uuid FROM session WHERE participant = ?)",
    "session": "participant = ?",
    "trial": "participant = ?",
    "participant": "uuid = ?",
}
"""Conditions on a participant's rows in each table; each before those it refers to."""


@dataclass(frozen=True)
class Deletion:
    """Counts of what was taken out. `searched` are the files in which nothing was found
    afterwards."""

    enrolled: bool
    answers: int
    traces: int
    backups: int
    exports: int
    sittings: int
    searched: int


def delete_participant(store: StudyStore, pseudonym: str) -> Deletion:
    """Take a participant out of the file, its traces, backups, exports and sittings; verify it.

    Exports are made anew without them. May be repeated: a pseudonym that is not there (any more)
    is searched for all the same. Other stations' files must be gone through one by one, before
    they are merged again.

    Raises:
        InputError: what is no pseudonym; or nothing was deleted, since an export cannot be made
            anew, or another study keeps its traces in the same folder.
        RecordError: another program reads the file (nothing was deleted); or the disk refused on
            the way, or something is left, with the file it is in: repeat it.
    """
    require_identifier(pseudonym)
    if others := same_folders(store.path):
        raise InputError(
            f"nothing was deleted: {others[0]} keeps its traces in the same folder as {store.path},"
            f" {store.traces.name}; move one of the studies to another folder, with its traces"
        )
    for _, folder in exported_folders(store):
        own_files(folder)
    store.require_whole()
    store.compact()
    backups, unfinished = _backup_files(store)
    traces = _traces(store, pseudonym)
    identifiers = {pseudonym} | _identifiers(store, pseudonym)
    for path in backups:
        with StudyStore.open(path) as backup:
            identifiers |= _identifiers(backup, pseudonym)
            remove_rows(backup, pseudonym)
            backup.compact()
    enrolled, answers = remove_rows(store, pseudonym)
    store.compact()
    # Those of programs that were killed could be anybody's.
    _remove([*store.unreferenced_traces(), *unfinished])
    sat = Sittings(store.path.with_name(FILE)).forget(pseudonym)
    folders = export_again(store)
    searched = _require_gone(store, identifiers)
    return Deletion(enrolled, answers, len(traces), len(backups), folders, sat, searched)


def _remove(paths: Iterable[Path]) -> None:
    for path in paths:
        try:
            path.unlink()
        except OSError as error:
            raise RecordError(f"{path} cannot be removed: {error.strerror}; repeat it") from error


def _identifiers(store: StudyStore, pseudonym: str) -> set[str]:
    """Everything random that only this participant's rows hold."""
    identifiers = set(_traces(store, pseudonym))
    for table in ("presentation", "verification", "session", "trial"):
        rows = store.rows(f"SELECT uuid FROM {table} WHERE {_OF[table]}", [pseudonym])
        identifiers |= {row["uuid"] for row in rows}
    return identifiers


def _traces(store: StudyStore, pseudonym: str) -> list[str]:
    found = store.rows(
        "SELECT r.traces FROM response r JOIN trial t ON t.uuid = r.trial WHERE t.participant = ?",
        [pseudonym],
    )
    return [name for row in found for name in json.loads(row["traces"])]


def remove_rows(store: StudyStore, pseudonym: str) -> tuple[bool, int]:
    """Delete a participant's rows, and nothing else. Whether they were enrolled, and how many
    answers went. Raises `RecordError` with nothing deleted."""
    with store.transaction() as write:
        gone = {
            table: write.execute(f"DELETE FROM {table} WHERE {of}", [pseudonym]).rowcount
            for table, of in _OF.items()
        }
    return gone["participant"] > 0, gone["response"]


def _require_gone(store: StudyStore, identifiers: set[str]) -> int:
    """Search every file for every identifier. Raises `RecordError` naming where one is left."""
    exports = [folder for _, folder in exported_folders(store)]
    beside = store.path.parent.glob(f"{glob.escape(store.path.name)}*")
    every = {store.path.with_name(FILE), *beside}
    for folder in (store.traces, store.backups, store.exports, *exports):
        every |= set(folder.rglob("*"))
    wanted = [identifier.encode() for identifier in identifiers]
    with store.closed_meanwhile():
        if left := sorted(str(path) for path in every if _holds(path, wanted)):
            raise RecordError(
                f"the participant's rows are deleted, but traces are left in {', '.join(left)}; "
                "delete these files by hand, or repeat with every other program closed"
            )
    return sum(path.is_file() for path in every)


def _holds(path: Path, wanted: list[bytes]) -> bool:
    """True for a file whose name or content has one of the words in it; links lead out of here."""
    if any(word in os.fsencode(path.name) for word in wanted):
        return True
    if path.is_symlink() or not path.is_file():
        return False
    content = read_regular(path, TRACE_BYTES, "a file to search")
    return any(word in content for word in wanted)


def _backup_files(store: StudyStore) -> tuple[list[Path], list[Path]]:
    """Backups, and what is left of those that were never finished."""
    if not store.backups.is_dir():
        return [], []
    every, (stem, suffix) = sorted(store.backups.iterdir()), (store.path.stem, store.path.suffix)
    name = re.compile(rf"\.{re.escape(stem)}-\w+-\w+{re.escape(suffix + UNFINISHED)}(-journal)?")
    whole = [path for path in every if path.suffix == suffix and is_study(path)]
    return whole, [path for path in every if name.fullmatch(path.name)]
