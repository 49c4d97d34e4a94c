"""Store of a study in one file: SQLite with a write-ahead log, in which what is acknowledged stays.

Every write is one transaction with ``synchronous=FULL``: when a call returns, its rows have been
handed to the disk and synced, and survive a crash of program or machine as far as the disk keeps
its word. A call that raises has written nothing. Traces of the finger lie beside the file in a
folder of the same name with ``.traces``; their names are random.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import secrets
import sqlite3
import uuid
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from squeezefilm import __version__
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.core.results import sync_folder, write_whole
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.design.trials import trials
from squeezefilm.study.record.database import (
    FAILURES,
    Database,
    claim,
    discard,
    require_study,
    same_folders,
)
from squeezefilm.study.record.erasure import require_own_folder, require_plain
from squeezefilm.study.record.schema import SCHEMA, UPGRADE_1, VERSION, is_trace, problems

_HIGHEST_SEED = 2**53
UNFINISHED = ".unfinished"
"""Ends the name of a backup that is being written."""
Row = Mapping[str, Any]


def utc_now() -> str:
    """The wall clock as text (UTC, milliseconds)."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


class StudyStore(Database):
    """A study's file, open. Make one with `create`, open it again with `open`; a context manager.

    Reads return plain rows; `StudyRun` and the functions of this room are what writes trials.
    """

    @classmethod
    def create(
        cls,
        path: str | Path,
        design: StudyDesign,
        seed: int,
        *,
        station: int = 0,
        stations: int = 1,
    ) -> StudyStore:
        """A new file for a design.

        Args:
            path: of the file, which must not exist.
            design: kept whole in the file.
            seed: of all orders; from 0 to 2⁵³.
            station, stations: where several stations gather data, which of how many this is; it
                numbers its participants station, station + stations, … so that orders stay
                balanced over all. Their files merge.

        Raises:
            InputError: a file that exists, or numbers outside their range.
            RecordError: a file that cannot be written.
        """
        path = Path(path)
        si.require("seed", seed, at_least=0, at_most=_HIGHEST_SEED)
        si.require("stations", stations, at_least=1, at_most=10_000)
        si.require("station", station, at_least=0, below=stations)
        if path.suffix in ("", ".traces", ".backups", ".exports"):
            raise InputError(f"{path}: give the file a suffix of its own, like study.sqlite")
        with contextlib.ExitStack() as undoing:
            # Nothing half-made stays, and nothing goes that somebody else put there.
            undoing.callback(discard, path, claim(path))
            if others := same_folders(path):
                raise InputError(
                    f"{others[0]} keeps its traces, backups and exports in the folders that {path} "
                    "would use; give a name that differs in more than the suffix"
                )
            store = undoing.enter_context(cls(path, new=True))
            store._fill(design, seed, station, stations)
            undoing.pop_all()
        return store

    def _fill(self, design: StudyDesign, seed: int, station: int, stations: int) -> None:
        from squeezefilm.core.config.schema import text_of

        row = {
            "uuid": str(uuid.uuid4()),
            "name": design.name,
            "design": text_of(design),
            "design_sha256": design.sha256,
            "seed": seed,
            "station": station,
            "stations": stations,
            "squeezefilm_version": __version__,
            "created_utc": utc_now(),
        }
        with self.transaction() as write:
            # Not executescript, which commits: the tables are there with their study, or not.
            for statement in SCHEMA.split(";"):
                if statement.strip():
                    write.execute(statement)
            insert(write, "study", row)

    @classmethod
    def open(cls, path: str | Path) -> StudyStore:
        """A study's file, opened to go on. What is no study's file is not changed.

        Raises:
            InputError: no study's file, one of another version, or one with contents that this
                program does not write.
            RecordError: it cannot be opened or read.
        """
        path = Path(path)
        require_study(path)
        store = cls(path)
        try:
            store._bring_up_to_date()
            for problem in problems(store.rows, lambda: store.design):
                raise InputError(
                    f"{path} is damaged or was not written by this program: {problem}. Nothing of "
                    f"it was used; open the last good backup (in {store.backups.name}), or mend "
                    "that row"
                )
        except BaseException:
            store.close()
            raise
        return store

    def _bring_up_to_date(self) -> None:
        """Give a file of version 1 the table that it lacks; nothing in it changes."""
        if self.rows("PRAGMA user_version")[0]["user_version"] != 1:
            return
        if self.rows("SELECT 1 FROM sqlite_schema WHERE name = 'set_aside'"):
            return
        with self.transaction() as write:
            write.execute(UPGRADE_1)
            write.execute(f"PRAGMA user_version = {VERSION}")

    def require_whole(self) -> None:
        """Refuse a damaged file: numbers of it are not to be trusted. Raises `RecordError`."""
        found = self.rows("PRAGMA integrity_check(3)")
        said = [str(row["integrity_check"]) for row in found]
        if said != ["ok"]:
            raise RecordError(
                f"{self.path} is damaged ({'; '.join(said)[:300]}), so that nothing of it is given "
                f"out. Copy it, and go on with the last good backup in {self.backups}; what else "
                "can be read of the copy, `sqlite3 COPY .recover` shows"
            )

    def __enter__(self) -> StudyStore:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def traces(self) -> Path:
        """The folder of the finger's traces."""
        return self.path.with_suffix(".traces")

    @property
    def backups(self) -> Path:
        """The folder of backups."""
        return self.path.with_suffix(".backups")

    @property
    def exports(self) -> Path:
        """The folder of exports, where no other is asked for, and of the list of those."""
        return self.path.with_suffix(".exports")

    @property
    def study(self) -> Row:
        """The row about the study itself."""
        return self.rows("SELECT * FROM study")[0]

    @functools.cached_property
    def design(self) -> StudyDesign:
        """The design the file was made with."""
        from squeezefilm.core import config

        return config.load_text(StudyDesign, self.study["design"], file=self.path)

    def rows(self, query: str, values: Iterable[Any] = ()) -> list[dict[str, Any]]:
        """Rows of a query, as dictionaries. Raises `RecordError` if the file cannot be read."""
        self.require_in_place()
        try:
            cursor = self.connection.execute(query, tuple(values))
            names = [column[0] for column in cursor.description]
            return [dict(zip(names, row, strict=True)) for row in cursor]
        except FAILURES as error:
            raise RecordError(f"{self.path} cannot be read: {error}") from error

    @contextlib.contextmanager
    def transaction(self) -> Iterator[sqlite3.Connection]:
        """Open a transaction: all of it is on the disk when it ends, or it raises and none is."""
        connection = self.connection
        try:
            connection.execute("BEGIN IMMEDIATE")
            self.require_in_place()
            yield connection
            connection.execute("COMMIT")
            # What was removed or replaced meanwhile holds this row no more.
            self.require_in_place()
        except FAILURES as error:
            _roll_back(connection)
            raise RecordError(
                f"{self.path} could not take the row: {error}; nothing was acknowledged. "
                "Make room on the disk (or close what locks the file) and go on: the same trial "
                "comes again"
            ) from error
        except BaseException:
            _roll_back(connection)
            raise

    def add(self, table: str, row: Row) -> None:
        """Add a row and sync it. Raises `RecordError`, with nothing written."""
        with self.transaction() as write:
            insert(write, table, row)

    def enrol(self, *, simulated: bool = False) -> str:
        """A new participant, with all trials planned. Returns the pseudonym, which is random; of
        somebody `simulated` it is `simulated_pseudonym`.

        The lowest free number of this station is taken, so that somebody deleted leaves no gap
        in the balance. Raises `RecordError`, with nobody enrolled.
        """
        design, study = self.design, self.study
        with self.transaction() as write:
            taken = {one[0] for one in write.execute("SELECT number FROM participant")}
            number = study["station"]
            while number in taken:
                number += study["stations"]
            pseudonym = self.simulated_pseudonym(number) if simulated else secrets.token_hex(8)
            row = {
                "uuid": pseudonym,
                "number": number,
                "squeezefilm_version": __version__,
                "enrolled_utc": utc_now(),
            }
            insert(write, "participant", row)
            for trial in trials(design, number, study["seed"]):
                planned = {"uuid": str(uuid.uuid4()), "participant": pseudonym, **trial.row()}
                insert(write, "trial", planned)
        return pseudonym

    def simulated_pseudonym(self, number: int) -> str:
        """The pseudonym of a simulated participant: of this file and their number, so that a
        rehearsal that was killed knows its own people again."""
        told = f"{self.study['uuid']} simulated {number}"
        return hashlib.sha256(told.encode()).hexdigest()[:16]

    def participants(self) -> list[dict[str, Any]]:
        """Everyone enrolled, by number: uuid, number, trials planned and answered, and set aside.

        What was set aside is asked again and counts neither as planned nor as answered."""
        return self.rows(
            "SELECT p.uuid, p.number, p.enrolled_utc, count(t.uuid) - count(a.trial) AS planned, "
            "sum(r.trial IS NOT NULL AND a.trial IS NULL) AS answered, count(a.trial) AS set_aside "
            "FROM participant p JOIN trial t ON t.participant = p.uuid "
            "LEFT JOIN response r ON r.trial = t.uuid LEFT JOIN set_aside a ON a.trial = t.uuid "
            "GROUP BY p.uuid ORDER BY p.number, p.uuid"
        )

    def require_participant(self, pseudonym: str) -> Row:
        """A participant's row. Raises `InputError` that lists those there are."""
        known = self.rows("SELECT * FROM participant")
        for row in known:
            if row["uuid"] == pseudonym:
                return row
        names = ", ".join(row["uuid"] for row in known) or "nobody yet"
        raise InputError(f"there is no participant '{pseudonym}'; enrolled: {names}")

    def save_trace(self, text: str) -> str:
        """Write a trace beside the study, synced, under a random name. Returns the name.

        A trace whose trial is never acknowledged is nobody's; `unreferenced_traces` finds it.
        Raises `RecordError` with nothing left behind.
        """
        name = f"{secrets.token_hex(16)}.csv"
        try:
            require_own_folder(self.traces)
            write_whole(self.traces / name, text)
        except InputError as error:
            raise RecordError(f"{error}; nothing was acknowledged") from error
        return name

    def unreferenced_traces(self) -> list[Path]:
        """Traces that this program wrote and no answer names: of programs that were killed.

        Raises `InputError` where one of them is a link, or has a second name.
        """
        if not self.traces.is_dir():
            return []
        rows = self.rows("SELECT traces FROM response")
        named = {name for row in rows for name in json.loads(row["traces"])}
        stray = sorted(
            path for path in self.traces.iterdir() if is_trace(path.name) and path.name not in named
        )
        for path in stray:
            require_plain(path)
        return stray

    def back_up(self) -> Path:
        """A copy of the file as it is now, in `backups`; there whole or not at all. Raises
        `RecordError`, also for a damaged file."""
        require_own_folder(self.backups)
        self.require_whole()
        stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%S%fZ")
        target = self.backups / f"{self.path.stem}-{stamp}-{secrets.token_hex(3)}{self.path.suffix}"
        unfinished = target.with_name(f".{target.name}{UNFINISHED}")
        try:
            target.parent.mkdir(exist_ok=True)
            self.copy_to(unfinished)
            unfinished.replace(target)
            sync_folder(target.parent)
        except (*FAILURES, OSError) as error:
            with contextlib.suppress(OSError):
                unfinished.unlink(missing_ok=True)
            raise RecordError(f"no backup could be written to {target}: {error}") from error
        return target


def insert(write: sqlite3.Connection, table: str, row: Row) -> None:
    """Add a row to one of this room's tables, in a transaction that is open."""
    columns, marks = ", ".join(row), ", ".join("?" * len(row))
    write.execute(f"INSERT INTO {table} ({columns}) VALUES ({marks})", tuple(row.values()))


def _roll_back(connection: sqlite3.Connection) -> None:
    # SQLite rolls back by itself after some errors (a full disk); then there is nothing to do.
    if connection.in_transaction:
        connection.execute("ROLLBACK")
