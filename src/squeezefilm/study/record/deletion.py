"""Taking a participant out of a study without a trace.

All that this program wrote is gone through: rows, traces, backups, exports, the lab's sittings. It
is then searched, byte by byte, for every identifier that belonged to the participant. Whatever
could keep this from being complete is looked for first, and refused with nothing deleted. Files
that this program did not write are a person's own: they are searched, told, and left. What was
copied elsewhere by hand, a file system's snapshots and the spare blocks of a solid-state disk are
out of reach.
"""

from __future__ import annotations

import glob
import json
import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.core.hard_limits import TRACE_BYTES
from squeezefilm.core.regular_file import opened
from squeezefilm.study.record.database import is_study, require_alone, same_folders
from squeezefilm.study.record.erasure import erase_file, require_plain
from squeezefilm.study.record.exports import LIST, export_again, exported_folders, own_files
from squeezefilm.study.record.schema import is_trace, require_identifier
from squeezefilm.study.record.sittings import FILE, Sittings
from squeezefilm.study.record.store import UNFINISHED, StudyStore

_PIECE = 1 << 20
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
    """Counts of what was taken out. `searched` are the files in which nothing was found afterwards;
    `left` are files and folders of other origin among them, which are as they were."""

    enrolled: bool
    answers: int
    traces: int
    backups: int
    exports: int
    sittings: int
    searched: int
    left: tuple[str, ...]


def delete_participant(store: StudyStore, pseudonym: str) -> Deletion:
    """Take a participant out of the file, its traces, backups, exports and sittings; verify it.

    Exports are made anew without them. May be repeated: a pseudonym that is not there (any more)
    is searched for all the same. Other stations' files must be gone through one by one, before
    they are merged again.

    Raises:
        InputError: what is no pseudonym; or nothing was deleted, since the deletion would not be
            complete: an export's folder or a file of other origin holds the participant, a file
            to be erased is a link, another study keeps its traces in the same folder.
        RecordError: another program has the file open (nothing was deleted); or the disk refused
            on the way, or something is left, with the file it is in: repeat it.
    """
    require_identifier(pseudonym)
    sittings = Sittings(store.path.with_name(FILE))
    # First, while nothing is deleted yet, all that could fail on the way.
    backups, erased, identifiers = _surveyed(store, sittings, pseudonym)
    left = _own(store)
    if held := _found_in(left, identifiers):
        raise InputError(
            f"nothing was deleted: {', '.join(held)} was not written by this program and holds "
            f"what belongs to {pseudonym}; take it out of there, or move the file away, then repeat"
        )
    store.compact()
    for path in backups:
        with StudyStore.open(path) as backup:
            remove_rows(backup, pseudonym)
            backup.compact()
    traces = _traces(store, pseudonym)
    enrolled, answers = remove_rows(store, pseudonym)
    store.compact()
    # Those of programs that were killed could be anybody's.
    for path in (*store.unreferenced_traces(), *erased):
        erase_file(path)
    sat = sittings.forget(pseudonym)
    folders = export_again(store)
    searched = _require_gone(store, sittings, identifiers)
    return Deletion(
        enrolled,
        answers,
        len(traces),
        len(backups),
        folders,
        sat,
        searched,
        tuple(str(path) for path in left),
    )


def _surveyed(
    store: StudyStore, sittings: Sittings, pseudonym: str
) -> tuple[list[Path], list[Path], set[str]]:
    """The backups to go through, the unfinished ones to erase, and what to search for.

    Raises what keeps a deletion from being complete.
    """
    if others := same_folders(store.path):
        raise InputError(
            f"nothing was deleted: {others[0]} keeps its traces in the same folder as {store.path},"
            f" {store.traces.name}; move one of the studies to another folder, with its traces"
        )
    for _, folder in exported_folders(store):
        own_files(folder)
    sittings.require_erasable()
    with store.closed_meanwhile():
        require_alone(store.path)
    store.require_whole()
    backups, unfinished = _backup_files(store)
    identifiers = {pseudonym} | _identifiers(store, pseudonym)
    for path in backups:
        with StudyStore.open(path) as backup:
            identifiers |= _identifiers(backup, pseudonym)
    traces = [store.traces / name for name in _traces(store, pseudonym)]
    for path in (*unfinished, *store.unreferenced_traces(), *traces):
        if os.path.lexists(path):
            require_plain(path)
    for folder in {path.parent for path in (*backups, *traces)}:
        if folder.is_dir() and not os.access(folder, os.W_OK | os.X_OK):
            raise InputError(f"nothing was deleted: {folder} cannot be written to; allow it first")
    return backups, unfinished, identifiers


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


def _require_gone(store: StudyStore, sittings: Sittings, identifiers: set[str]) -> int:
    """Search every file for every identifier. Raises `RecordError` naming where one is left."""
    # Closing a file that SQLite has open would drop SQLite's locks on it.
    with store.closed_meanwhile():
        beside = store.path.parent.glob(f"{glob.escape(store.path.name)}*")
        every = _placed({sittings.file, *beside, *_in_folders(_folders(store))})
        if left := _found_in(every, identifiers):
            raise RecordError(
                f"the participant's rows are deleted, but traces are left in {', '.join(left)}; "
                "delete these files by hand, or repeat with every other program closed"
            )
    return sum(path.is_file() for path in every)


def _own(store: StudyStore) -> list[Path]:
    """Files among a study's that were not written by this program, sorted."""
    exports = exported_folders(store)
    backups = {path for some in _backup_files(store) for path in some}
    ours = backups | {store.exports / LIST, *(folder for _, folder in exports)}
    ours |= {path for _, folder in exports for path in folder.rglob("*")}
    ours |= {store.path.with_name(f"{store.path.name}{part}") for part in ("", "-wal", "-shm")}
    ours |= {path for path in _in_folders([store.traces]) if is_trace(path.name)}
    beside = store.path.parent.glob(f"{glob.escape(store.path.name)}*")
    return sorted(_placed({*beside, *_in_folders(_folders(store))}) - _placed(ours))


def _folders(store: StudyStore) -> list[Path]:
    exports = [folder for _, folder in exported_folders(store)]
    return [store.traces, store.backups, store.exports, *exports]


def _in_folders(folders: Iterable[Path]) -> Iterator[Path]:
    for folder in folders:
        yield from folder.rglob("*")


def _placed(paths: Iterable[Path]) -> set[Path]:
    """Paths by which the same file is the same, however it was asked for; links stay links."""
    return {path.parent.resolve() / path.name for path in paths}


def _found_in(paths: Iterable[Path], identifiers: set[str]) -> list[str]:
    """Files whose name or content has one of the identifiers in it; links lead out of here."""
    wanted = [identifier.encode() for identifier in identifiers]
    return sorted(
        str(path)
        for path in paths
        if any(identifier in os.fsencode(path.name) for identifier in wanted)
        or (path.is_file() and not path.is_symlink() and _holds(path, wanted))
    )


def _holds(path: Path, wanted: list[bytes]) -> bool:
    longest = max(len(identifier) for identifier in wanted)
    tail = b""
    try:
        with (
            opened(path, TRACE_BYTES, "a file to search") as handle,
            os.fdopen(handle, "rb", closefd=False) as file,
        ):
            while piece := file.read(_PIECE):
                whole = tail + piece
                if any(identifier in whole for identifier in wanted):
                    return True
                tail = whole[-longest:]
    except OSError as error:
        raise RecordError(f"{path} cannot be searched: {error.strerror}") from error
    return False


def _backup_files(store: StudyStore) -> tuple[list[Path], list[Path]]:
    """Backups, and what is left of those that were never finished."""
    if not store.backups.is_dir():
        return [], []
    every, (stem, suffix) = sorted(store.backups.iterdir()), (store.path.stem, store.path.suffix)
    name = re.compile(rf"\.{re.escape(stem)}-\w+-\w+{re.escape(suffix + UNFINISHED)}(-journal)?")
    whole = [path for path in every if path.suffix == suffix and is_study(path)]
    return whole, [path for path in every if name.fullmatch(path.name)]
