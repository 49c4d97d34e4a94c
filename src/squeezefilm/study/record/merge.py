"""Files of several stations into one: rows are known by their random identifiers.

Rows are only ever added, so merging is a union: what is there already is left, what is new is
added, and a row that both have with different content is a contradiction that stops the merge.
"""

from __future__ import annotations

import json
import os
import sqlite3
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from squeezefilm.core.errors import ContradictionError, InputError
from squeezefilm.core.results import write_whole
from squeezefilm.study.record.erasure import read_plain, require_own_folder
from squeezefilm.study.record.schema import TABLES
from squeezefilm.study.record.store import StudyStore, insert

_SHOWN = 5


@dataclass(frozen=True)
class Merge:
    """Outcome of a merge: rows added and rows that were there, by table; traces copied; and the
    participants' numbers that several have (their orders are the same, which costs balance)."""

    added: dict[str, int]
    present: dict[str, int]
    traces: int
    doubled_numbers: tuple[int, ...]


def open_or_begin(path: str | Path, other: str | Path) -> StudyStore:
    """The study's file at `path`; where there is none, a new one of the other's design and seed.

    Raises `InputError` or `RecordError` as `StudyStore.open` and `StudyStore.create` do.
    """
    if os.path.lexists(path):
        return StudyStore.open(path)
    with StudyStore.open(other) as theirs:
        stations = int(theirs.study["stations"])
        return StudyStore.create(path, theirs.design, int(theirs.study["seed"]), stations=stations)


def merge(store: StudyStore, other: str | Path) -> Merge:
    """Add another station's rows and traces to this file. Merging again changes nothing.

    Somebody who was deleted here but not there comes back: delete them in every file first.

    Raises:
        InputError: the same file, one of another study (another design or seed), or one with
            contents that this program does not write, such as a trace's name that leads elsewhere.
        ContradictionError: rows with the same identifier and different content, such as a
            participant who went on at two stations; nothing was merged.
        RecordError: nothing was merged; one of the files is damaged, or nothing could be written.
    """
    if Path(other).resolve() == store.path.resolve():
        raise InputError(f"{other} is this file itself; give another station's")
    with StudyStore.open(other) as theirs:
        ours, foreign = store.study, theirs.study
        # As this program reads them: a design has more to it than when an older one wrote it down.
        designs = store.design.sha256, theirs.design.sha256
        for what, here, there in (
            ("design", *designs),
            ("seed", ours["seed"], foreign["seed"]),
        ):
            if here != there:
                raise InputError(
                    f"{other} is of another study: its {what} is {there}, here it is {here}; "
                    "stations must be created from one design and one seed"
                )
        require_own_folder(store.traces)
        store.require_whole()
        theirs.require_whole()
        traces = _copy_traces(store, theirs)
        added: dict[str, int] = {}
        present: dict[str, int] = {}
        conflicts: list[str] = []
        with store.transaction() as write:
            for table in TABLES:
                added[table], present[table], wrong = _merge_table(write, store, theirs, table)
                conflicts += wrong
            if conflicts:
                more = len(conflicts) - _SHOWN
                raise ContradictionError(
                    f"{other} contradicts {store.path}, and nothing was merged: "
                    f"{'; '.join(conflicts[:_SHOWN])}{f'; and {more} more' if more > 0 else ''}. "
                    "Keep one of the two for these rows (delete the participant in the other file)"
                )
    numbers = Counter(row["number"] for row in store.rows("SELECT number FROM participant"))
    doubled = tuple(sorted(number for number, count in numbers.items() if count > 1))
    return Merge(added, present, traces, doubled)


def _merge_table(
    write: sqlite3.Connection, store: StudyStore, theirs: StudyStore, table: str
) -> tuple[int, int, list[str]]:
    """Rows of a table added, rows that were there, and what contradicts."""
    added, present, conflicts = 0, 0, []
    key = "trial" if table in ("response", "set_aside") else "uuid"
    known = {row[key]: row for row in store.rows(f"SELECT * FROM {table}")}
    for row in theirs.rows(f"SELECT * FROM {table}"):
        mine = known.get(row[key])
        if mine is None:
            try:
                insert(write, table, row)
            except sqlite3.IntegrityError as error:
                conflicts.append(f"{table} {row[key]}: {error}")
            else:
                added += 1
        elif mine != row:
            fields = ", ".join(name for name in row if row[name] != mine[name])
            conflicts.append(f"{table} {row[key]} differs in {fields}")
        else:
            present += 1
    return added, present, conflicts


def _copy_traces(store: StudyStore, theirs: StudyStore) -> int:
    """Copy traces we have not, before any row that names them. Names are random, so one name is
    one trace."""
    count = 0
    for row in theirs.rows("SELECT traces FROM response"):
        for name in json.loads(row["traces"]):
            source, target = theirs.traces / name, store.traces / name
            if os.path.lexists(target):
                continue
            if not os.path.lexists(source):
                raise InputError(
                    f"{theirs.path} names the trace {name}, which is not in {theirs.traces}; "
                    "bring the folder along"
                )
            write_whole(target, read_plain(source))
            count += 1
    return count
