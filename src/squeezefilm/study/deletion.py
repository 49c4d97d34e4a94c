"""Taking a participant out of a study without a trace.

Rows, traces, backups and exports that this program wrote are all gone through, and then searched,
byte by byte, for every identifier that belonged to the participant. What was copied elsewhere by
hand, a file system's snapshots and the spare blocks of a solid-state disk are out of reach.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from squeezefilm.errors import RecordError
from squeezefilm.study.exports import (
    erase_file,
    export_again,
    exported_folders,
    own_files,
)
from squeezefilm.study.store import StudyStore

_PIECE = 1 << 20


@dataclass(frozen=True)
class Deletion:
    """What was taken out. `searched` counts the files in which nothing was found afterwards."""

    enrolled: bool
    answers: int
    traces: int
    backups: int
    exports: int
    searched: int


def delete_participant(store: StudyStore, pseudonym: str) -> Deletion:
    """Take a participant out of the file, its traces, backups and exports, and verify it.

    Exports are made anew without them. May be repeated: a pseudonym that is not there (any more)
    is searched for all the same. Other stations' files must be gone through one by one, before
    they are merged again.

    Raises:
        InputError: an export's folder has files of other origin in it (nothing was deleted).
        RecordError: another program has the file open (nothing was deleted), or something is left,
            with the file it is in.
    """
    # First, while nothing is deleted yet: these fail if an export can't be made anew, or if
    # somebody else reads the file.
    for _, folder in exported_folders(store):
        own_files(folder)
    store.compact()
    identifiers = {pseudonym} | _identifiers(store, pseudonym)
    backups = []
    if store.backups.is_dir():
        backups = sorted(
            path for path in store.backups.iterdir() if path.suffix == store.path.suffix
        )
    for path in backups:
        with StudyStore.open(path) as backup:
            identifiers |= _identifiers(backup, pseudonym)
            remove_rows(backup, pseudonym)
            backup.compact()
    traces = _traces(store, pseudonym)
    enrolled, answers = remove_rows(store, pseudonym)
    store.compact()
    # Those of programs that were killed could be anybody's.
    for path in store.unreferenced_traces():
        erase_file(path)
    folders = export_again(store)
    searched = _require_gone(store, identifiers)
    return Deletion(enrolled, answers, len(traces), len(backups), folders, searched)


def _identifiers(store: StudyStore, pseudonym: str) -> set[str]:
    """Everything random that only this participant's rows hold."""
    found: set[str] = set()
    sessions = "SELECT uuid FROM session WHERE participant = ?"
    trials = "SELECT uuid FROM trial WHERE participant = ?"
    for query in (
        sessions,
        trials,
        f"SELECT uuid FROM verification WHERE session IN ({sessions})",
        f"SELECT uuid FROM presentation WHERE trial IN ({trials})",
    ):
        found |= {row["uuid"] for row in store.rows(query, [pseudonym])}
    return found | set(_traces(store, pseudonym))


def _traces(store: StudyStore, pseudonym: str) -> list[str]:
    import json

    found = store.rows(
        "SELECT r.traces FROM response r JOIN trial t ON t.uuid = r.trial WHERE t.participant = ?",
        [pseudonym],
    )
    return [name for row in found for name in json.loads(row["traces"])]


def remove_rows(store: StudyStore, pseudonym: str) -> tuple[bool, int]:
    """Delete a participant's rows, and nothing else. Whether they were enrolled, and how many
    answers went. Raises `RecordError` with nothing deleted."""
    sessions = "SELECT uuid FROM session WHERE participant = ?"
    trials = "SELECT uuid FROM trial WHERE participant = ?"
    with store.transaction() as write:
        gone = write.execute(f"DELETE FROM response WHERE trial IN ({trials})", [pseudonym])
        answers = gone.rowcount
        for statement in (
            f"DELETE FROM presentation WHERE trial IN ({trials})",
            f"DELETE FROM verification WHERE session IN ({sessions})",
            "DELETE FROM session WHERE participant = ?",
            "DELETE FROM trial WHERE participant = ?",
        ):
            write.execute(statement, [pseudonym])
        gone = write.execute("DELETE FROM participant WHERE uuid = ?", [pseudonym])
        return gone.rowcount > 0, answers


def _require_gone(store: StudyStore, identifiers: set[str]) -> int:
    """Search every file for every identifier. Raises `RecordError` naming where one is left."""
    wanted = [one.encode() for one in identifiers]
    count, left = 0, []
    for path in _files(store):
        count += path.is_file()
        if any(one in os.fsencode(path.name) for one in wanted) or _holds(path, wanted):
            left.append(str(path))
    if left:
        raise RecordError(
            f"the participant's rows are deleted, but traces are left in {', '.join(left)}; "
            "delete these files by hand, or repeat with every other program closed"
        )
    return count


def _files(store: StudyStore) -> Iterator[Path]:
    """Everything this program wrote: files, and the folders they are in."""
    yield from sorted(store.path.parent.glob(f"{store.path.name}*"))
    folders = (
        store.traces,
        store.backups,
        store.exports,
        *(folder for _, folder in exported_folders(store)),
    )
    for folder in folders:
        yield from sorted(folder.rglob("*"))


def _holds(path: Path, wanted: list[bytes]) -> bool:
    if not path.is_file():
        return False
    longest = max(len(one) for one in wanted)
    tail = b""
    with path.open("rb") as file:
        while piece := file.read(_PIECE):
            whole = tail + piece
            if any(one in whole for one in wanted):
                return True
            tail = whole[-longest:]
    return False
