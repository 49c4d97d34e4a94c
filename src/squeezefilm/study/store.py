"""One file per study: SQLite with a write-ahead log, in which what is acknowledged stays.

Every write is one transaction with ``synchronous=FULL``: when a call returns, its rows have been
handed to the disk and synced, and survive a crash of program or machine as far as the disk keeps
its word. A call that raises has written nothing. Traces of the finger lie beside the file in a
folder of the same name with ``.traces``; their names are random.
"""

from __future__ import annotations

import contextlib
import json
import secrets
import sqlite3
import uuid
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from squeezefilm import __version__
from squeezefilm.errors import InputError, RecordError
from squeezefilm.quantities import require
from squeezefilm.results import write_whole
from squeezefilm.study.design import StudyDesign
from squeezefilm.study.schema import APPLICATION_ID, SCHEMA, VERSION
from squeezefilm.study.trials import Trial, trials

_HIGHEST_SEED = 2**53
_PATIENCE = 5000
"""How long a write waits for another program's (ms)."""
Row = Mapping[str, Any]


def utc_now() -> str:
    """The wall clock as text (UTC, milliseconds)."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


class StudyStore:
    """A study's file, open. Make one with `create`, open it again with `open`; a context manager.

    Reads return plain rows; `StudyRun` and the functions of this room are what writes trials.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path = path
        self._connection = connection
        self._design: StudyDesign | None = None

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
        from squeezefilm.config.write import text_of

        path = Path(path)
        require("seed", seed, at_least=0, at_most=_HIGHEST_SEED)
        require("stations", stations, at_least=1, at_most=10_000)
        require("station", station, at_least=0, below=stations)
        if path.suffix in ("", ".traces", ".backups", ".exports"):
            raise InputError(f"{path}: give the file a suffix of its own, like study.sqlite")
        if path.exists():
            raise InputError(f"{path} exists; open it to go on, or give another name")
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            store = cls(path, _connect(path))
            with store.transaction() as write:
                # Not executescript, which commits: the tables are there with their study, or not.
                for statement in SCHEMA.split(";"):
                    if statement.strip():
                        write.execute(statement)
                write.execute(f"PRAGMA application_id = {APPLICATION_ID}")
                write.execute(f"PRAGMA user_version = {VERSION}")
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
                insert(write, "study", row)
        except BaseException:
            # Nothing half-made stays: there was no file before.
            for part in ("", "-wal", "-shm"):
                path.with_name(path.name + part).unlink(missing_ok=True)
            raise
        return store

    @classmethod
    def open(cls, path: str | Path) -> StudyStore:
        """A study's file, opened to go on.

        Raises `InputError` for what is no study's file or one of another version.
        """
        path = Path(path)
        if not path.is_file():
            raise InputError(f"{path} does not exist; plan a study and create its file first")
        connection = _connect(path)
        try:
            kind = connection.execute("PRAGMA application_id").fetchone()[0]
            version = connection.execute("PRAGMA user_version").fetchone()[0]
        except sqlite3.DatabaseError as error:
            connection.close()
            raise InputError(f"{path} is no study's file: {error}") from error
        if kind != APPLICATION_ID:
            connection.close()
            raise InputError(f"{path} is no study's file; give one that `study run` made")
        if version != VERSION:
            connection.close()
            raise InputError(
                f"{path} has tables of version {version}; this program reads version {VERSION}; "
                "use the version of squeezefilm that made it"
            )
        return cls(path, connection)

    def close(self) -> None:
        """Close the file; its write-ahead log is folded in where nobody else has it open."""
        self._connection.close()

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

    @property
    def design(self) -> StudyDesign:
        """The design the file was made with."""
        if self._design is None:
            from squeezefilm import config

            self._design = config.load_text(StudyDesign, self.study["design"], file=self.path)
        return self._design

    def rows(self, query: str, values: Iterable[Any] = ()) -> list[dict[str, Any]]:
        """What a query finds, as dictionaries. Raises `RecordError` if the file cannot be read."""
        try:
            cursor = self._connection.execute(query, tuple(values))
            names = [one[0] for one in cursor.description]
            return [dict(zip(names, row, strict=True)) for row in cursor]
        except sqlite3.Error as error:
            raise RecordError(f"{self.path} cannot be read: {error}") from error

    @contextlib.contextmanager
    def transaction(self) -> Iterator[sqlite3.Connection]:
        """One transaction: all of it is on the disk when it ends, or nothing is and it raises."""
        connection = self._connection
        try:
            connection.execute("BEGIN IMMEDIATE")
            yield connection
            connection.execute("COMMIT")
        except sqlite3.Error as error:
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

    def enrol(self) -> str:
        """A new participant: a random pseudonym, with all trials planned. Returns the pseudonym.

        The lowest free number of this station is taken, so that somebody deleted leaves no gap
        in the balance. Raises `RecordError`, with nobody enrolled.
        """
        design, study = self.design, self.study
        pseudonym = secrets.token_hex(8)
        with self.transaction() as write:
            taken = {one[0] for one in write.execute("SELECT number FROM participant")}
            number = study["station"]
            while number in taken:
                number += study["stations"]
            row = {
                "uuid": pseudonym,
                "number": number,
                "squeezefilm_version": __version__,
                "enrolled_utc": utc_now(),
            }
            insert(write, "participant", row)
            for trial in trials(design, number, study["seed"]):
                insert(write, "trial", _planned(trial, pseudonym))
        return pseudonym

    def participants(self) -> list[dict[str, Any]]:
        """Everyone enrolled, by number: uuid, number, trials planned and answered."""
        return self.rows(
            "SELECT p.uuid, p.number, p.enrolled_utc, count(t.uuid) AS planned, "
            "count(r.trial) AS answered FROM participant p JOIN trial t ON t.participant = p.uuid "
            "LEFT JOIN response r ON r.trial = t.uuid GROUP BY p.uuid ORDER BY p.number, p.uuid"
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
            write_whole(self.traces / name, text)
        except InputError as error:
            raise RecordError(f"{error}; nothing was acknowledged") from error
        return name

    def unreferenced_traces(self) -> list[Path]:
        """Files among the traces that no answer names, from programs that were killed."""
        if not self.traces.is_dir():
            return []
        found = self.rows("SELECT traces FROM response")
        named = {name for row in found for name in json.loads(row["traces"])}
        return sorted(path for path in self.traces.iterdir() if path.name not in named)

    def compact(self) -> None:
        """Rewrite the file without anything deleted, and empty its write-ahead log.

        Raises `RecordError` while another program reads or writes it.
        """
        try:
            self._connection.execute("PRAGMA busy_timeout = 500")
            self._empty_log()
            self._connection.execute("VACUUM")
            self._empty_log()
        except sqlite3.Error as error:
            raise RecordError(f"{self.path} could not be compacted: {error}") from error
        finally:
            self._connection.execute(f"PRAGMA busy_timeout = {_PATIENCE}")

    def _empty_log(self) -> None:
        if self._connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()[0]:
            raise RecordError(
                f"{self.path} is open in another program; close every session, then try again"
            )

    def back_up(self) -> Path:
        """A copy of the file as it is now, in `backups`. Raises `RecordError`."""
        stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%S%fZ")
        target = self.backups / f"{self.path.stem}-{stamp}{self.path.suffix}"
        try:
            target.parent.mkdir(exist_ok=True)
            with contextlib.closing(sqlite3.connect(target)) as copy:
                self._connection.backup(copy)
        except (sqlite3.Error, OSError) as error:
            target.unlink(missing_ok=True)
            raise RecordError(f"no backup could be written to {target}: {error}") from error
        return target


def insert(write: sqlite3.Connection, table: str, row: Row) -> None:
    """Add a row to one of this room's tables, in a transaction that is open."""
    columns, marks = ", ".join(row), ", ".join("?" * len(row))
    write.execute(f"INSERT INTO {table} ({columns}) VALUES ({marks})", tuple(row.values()))


def _planned(trial: Trial, participant: str) -> Row:
    return {
        "uuid": str(uuid.uuid4()),
        "participant": participant,
        "number": trial.number,
        "display": trial.display,
        "block": trial.block,
        "phase": trial.phase,
        "stimuli": json.dumps(trial.stimuli),
        "alternatives": json.dumps(trial.alternatives),
        "answer": trial.answer,
        "adaptive": trial.adaptive,
        "reference_first": int(trial.reference_first),
        "pause_s": trial.pause,
        "seed": trial.seed,
    }


def _connect(path: Path) -> sqlite3.Connection:
    if sqlite3.sqlite_version_info < (3, 37):
        raise RecordError(
            f"this Python has SQLite {sqlite3.sqlite_version}; a study needs 3.37 or later, for "
            "tables that check the types of what is written"
        )
    try:
        connection = sqlite3.connect(path, isolation_level=None, timeout=_PATIENCE / 1000)
    except sqlite3.Error as error:
        raise RecordError(f"{path} cannot be opened: {error}; is the folder writable?") from error
    try:
        mode = connection.execute("PRAGMA journal_mode = WAL").fetchone()[0]
        if mode != "wal":
            raise RecordError(
                f"{path} lies where no write-ahead log can be kept (journal_mode is {mode}); put "
                "it on a local disk"
            )
        connection.execute("PRAGMA synchronous = FULL")
        connection.execute("PRAGMA fullfsync = ON")
        connection.execute("PRAGMA foreign_keys = ON")
        connection.execute("PRAGMA secure_delete = ON")
        # Journals of statements and sorting stay in memory: no copy of a row in a stray file.
        connection.execute("PRAGMA temp_store = MEMORY")
    except sqlite3.DatabaseError as error:
        connection.close()
        if "not a database" in str(error):
            raise InputError(f"{path} is no study's file: {error}") from error
        raise RecordError(f"{path} cannot be opened: {error}") from error
    except RecordError:
        connection.close()
        raise
    return connection


def _roll_back(connection: sqlite3.Connection) -> None:
    # SQLite rolls back by itself after some errors (a full disk); then there is nothing to do.
    if connection.in_transaction:
        connection.execute("ROLLBACK")
