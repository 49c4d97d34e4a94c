"""A study's file: made by one, changed by nobody else's look, and gone when it is gone."""

from __future__ import annotations

import contextlib
import os
import shutil
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.study.conduct.run import Response, StudyRun
from squeezefilm.study.conduct.study_device import NoDevice
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record import database as database_module
from squeezefilm.study.record import store as store_module
from squeezefilm.study.record.database import (
    Database,
    claim,
    discard,
    identity_of,
    is_study,
    require_alone,
    require_study,
    same_folders,
)
from squeezefilm.study.record.deletion import delete_participant
from squeezefilm.study.record.exports import export_study
from squeezefilm.study.record.merge import merge
from squeezefilm.study.record.schema import APPLICATION_ID, VERSION
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.tasks.analyze import analyze_study

from ..scripted import Script, gratings, run_through, session

VERSION_1 = Path(__file__).with_name("version_1.sql")


def _begun(path: Path) -> tuple[StudyStore, StudyRun]:
    store = StudyStore.create(path, gratings(), 7)
    run = session(store, store.enrol())
    _answer(run)
    return store, run


def _answer(run: StudyRun) -> int:
    shown = run.next_trial()
    assert shown is not None
    choice = shown.trial.alternatives[0] if shown.trial.asks else ""
    return run.respond(shown.token, Response(choice=choice)).number


def test_who_comes_second_removes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "study.sqlite"
    seeds: list[int] = []
    filled = StudyStore._fill

    def beaten(store: StudyStore, design: object, seed: int, *more: int) -> None:
        """The other program is here just as fast: it creates while this one does."""
        if not seeds:
            seeds.append(seed)
            with pytest.raises(InputError, match="exists"):
                StudyStore.create(path, gratings(), 8)
        filled(store, design, seed, *more)  # type: ignore[arg-type]

    monkeypatch.setattr(StudyStore, "_fill", beaten)
    StudyStore.create(path, gratings(), 7).close()
    with StudyStore.open(path) as store:
        assert store.study["seed"] == 7


def test_a_creation_that_fails_leaves_what_another_put_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "study.sqlite"

    def replaced(store: StudyStore, *_: object) -> None:
        path.unlink()
        path.write_text("somebody's")
        raise RecordError("no room")

    with monkeypatch.context() as patched:
        patched.setattr(StudyStore, "_fill", replaced)
        with pytest.raises(RecordError, match="no room"):
            StudyStore.create(path, gratings(), 7)
    assert path.read_text() == "somebody's"

    def full(*_: object) -> None:
        raise RecordError("no room")

    monkeypatch.setattr(StudyStore, "_fill", full)
    with pytest.raises(RecordError, match="no room"):
        StudyStore.create(tmp_path / "other.sqlite", gratings(), 7)
    assert [one.name for one in tmp_path.iterdir() if one.name.startswith("other")] == []


RACE = """
import os, sys, time
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.study.record.store import StudyStore
sys.path.insert(0, sys.argv[1])
from scripted_design import design
seed, folder = int(sys.argv[2]), sys.argv[3]
open(f"{folder}/ready{seed}", "w").close()
for number in range(25):
    while not os.path.exists(f"{folder}/go{number}"):
        pass
    try:
        StudyStore.create(f"{folder}/{number}.sqlite", design, seed).close()
        print(number, seed, flush=True)
    except SqueezefilmError:
        pass
    open(f"{folder}/done{number}-{seed}", "w").close()
"""


@pytest.mark.nightly
def test_of_four_programs_that_create_one_file_one_has_it(tmp_path: Path) -> None:
    import time

    (tmp_path / "scripted_design.py").write_text(
        "from squeezefilm.study.design.study_design import load_design\n"
        "design = load_design('biet2008-gratings')"
    )
    racers = [
        subprocess.Popen(
            [sys.executable, "-c", RACE, str(tmp_path), str(seed), str(tmp_path)],
            stdout=subprocess.PIPE,
            text=True,
        )
        for seed in range(4)
    ]

    def wait(names: list[str]) -> None:
        while not all((tmp_path / name).exists() for name in names):
            assert all(one.poll() is None for one in racers) or "24" in names[0]
            time.sleep(0.01)

    wait([f"ready{seed}" for seed in range(4)])
    for number in range(25):
        (tmp_path / f"go{number}").touch()
        wait([f"done{number}-{seed}" for seed in range(4)])
    told = [
        tuple(map(int, line.split()))
        for one in racers
        for line in one.communicate()[0].splitlines()
    ]
    assert sorted(number for number, _ in told) == list(range(25))
    for number, seed in told:
        with StudyStore.open(tmp_path / f"{number}.sqlite") as store:
            assert store.study["seed"] == seed


def test_a_log_that_was_left_behind_is_not_taken_for_ours(tmp_path: Path) -> None:
    (tmp_path / "study.sqlite-wal").write_bytes(b"of a file that was removed")
    with pytest.raises(InputError, match=r"study\.sqlite-wal lies there"):
        StudyStore.create(tmp_path / "study.sqlite", gratings(), 7)
    assert [one.name for one in tmp_path.iterdir()] == ["study.sqlite-wal"]


def test_two_studies_do_not_share_their_folders(tmp_path: Path) -> None:
    StudyStore.create(tmp_path / "study.sqlite", gratings(), 7).close()
    with pytest.raises(InputError, match="differs in more than the suffix"):
        StudyStore.create(tmp_path / "study.db", gratings(), 7)
    assert not (tmp_path / "study.db").exists()
    # What an earlier version let happen.
    shutil.copy(tmp_path / "study.sqlite", tmp_path / "study.db")
    with (
        StudyStore.open(tmp_path / "study.db") as store,
        pytest.raises(InputError, match="keeps its traces in the same folder"),
    ):
        delete_participant(store, store.enrol())


def _removed(path: Path) -> None:
    for part in tuple(path.parent.glob(f"{path.name}*")):
        part.unlink()


def _replaced(path: Path) -> None:
    shutil.copy(path, path.with_name("copy"))
    path.with_name("copy").replace(path)


def _moved(path: Path) -> None:
    path.rename(path.with_name("moved.sqlite"))


def _without_log(path: Path) -> None:
    path.with_name(f"{path.name}-wal").unlink()


def _without_index(path: Path) -> None:
    path.with_name(f"{path.name}-shm").unlink()


@pytest.mark.parametrize("change", [_removed, _replaced, _moved, _without_log, _without_index])
def test_nothing_is_acknowledged_into_a_file_that_is_not_there(
    tmp_path: Path, change: Callable[[Path], None]
) -> None:
    store, run = _begun(tmp_path / "study.sqlite")
    shown = run.next_trial()
    assert shown is not None
    change(store.path)
    for attempt in (
        lambda: run.respond(shown.token, Response()),
        run.next_trial,
        store.enrol,
        store.back_up,
        lambda: run.state,
        store.compact,
    ):
        with pytest.raises(
            RecordError, match=r"was removed or replaced while study\.sqlite was open"
        ):
            attempt()
    store.close()


def test_what_goes_while_it_is_written_is_not_acknowledged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store, _ = _begun(tmp_path / "study.sqlite")
    insert = store_module.insert

    def inserted(write: sqlite3.Connection, table: str, row: object) -> None:
        insert(write, table, row)  # type: ignore[arg-type]
        if table == "trial":
            _removed(store.path)

    monkeypatch.setattr(store_module, "insert", inserted)
    with pytest.raises(RecordError, match="nothing is acknowledged any more"):
        store.enrol()
    store.close()


def test_a_deletion_keeps_the_locks_that_keep_others_from_removing_the_log(tmp_path: Path) -> None:
    store, run = _begun(tmp_path / "study.sqlite")
    delete_participant(store, store.enrol())
    other = (
        f"import sqlite3; c = sqlite3.connect({str(store.path)!r}); "
        "print(c.execute('SELECT count(*) FROM response').fetchone()[0]); c.close()"
    )
    for answers in (1, 2):
        # Whoever closes last folds in and removes the log; it must not take itself for the last.
        done = subprocess.run(
            [sys.executable, "-c", other], capture_output=True, text=True, check=True
        )
        assert done.stdout == f"{answers}\n"
        if answers == 1:
            _answer(run)
    store.close()


@pytest.mark.parametrize("mode", ["delete", "wal", "wal, of a program that was killed"])
def test_a_foreign_database_is_not_changed(tmp_path: Path, mode: str) -> None:
    path = tmp_path / "foreign.sqlite"
    connection = sqlite3.connect(path)
    connection.execute(f"PRAGMA journal_mode = {mode.partition(',')[0]}")
    connection.execute("CREATE TABLE t (x)")
    if "killed" in mode:
        (tmp_path / "killed").mkdir()
        for part in (path, tmp_path / "foreign.sqlite-wal"):
            shutil.copy(part, tmp_path / "killed")
        path = tmp_path / "killed" / path.name

    def contents() -> dict[str, bytes]:
        beside = path.parent.glob(f"{path.name}*")
        return {one.name: one.read_bytes() for one in beside if not one.name.endswith("-shm")}

    before = contents()
    with pytest.raises(InputError, match="no study's file"):
        StudyStore.open(path)
    assert contents() == before
    connection.close()


def test_an_empty_file_stays_empty_and_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    empty, pipe = tmp_path / "empty.sqlite", tmp_path / "pipe.sqlite"
    empty.touch()
    with pytest.raises(InputError, match="is empty"):
        StudyStore.open(empty)
    assert [(one.name, one.stat().st_size) for one in tmp_path.iterdir()] == [("empty.sqlite", 0)]
    if hasattr(os, "mkfifo"):
        os.mkfifo(pipe)
        with pytest.raises(InputError, match="it is a pipe"):
            StudyStore.open(pipe)


def test_a_study_of_which_all_is_in_the_log_opens(tmp_path: Path) -> None:
    store, _ = _begun(tmp_path / "study.sqlite")
    # As a kill -9 leaves it: log and all, copied while it is open.
    (tmp_path / "killed").mkdir()
    for part in tmp_path.glob("study.sqlite*"):
        if not part.name.endswith("-shm"):
            shutil.copy(part, tmp_path / "killed")
    store.close()
    with StudyStore.open(tmp_path / "killed" / "study.sqlite") as found:
        assert found.participants()[0]["answered"] == 1


def test_a_damaged_file_is_given_to_nobody(tmp_path: Path) -> None:
    path = tmp_path / "study.sqlite"
    run_through(path, gratings(1)).close()
    run_through(tmp_path / "other.sqlite", gratings(1), people=1).close()
    connection = sqlite3.connect(path, isolation_level=None)
    connection.execute("PRAGMA writable_schema = ON")
    # An index of another column than its rows: every query still answers, some of them wrongly.
    connection.execute(
        "UPDATE sqlite_schema SET sql = 'CREATE INDEX presentation_of ON presentation (session)' "
        "WHERE name = 'presentation_of'"
    )
    connection.close()
    with StudyStore.open(path) as store, StudyStore.open(tmp_path / "other.sqlite") as whole:
        for give in (
            lambda: export_study(store, "csv"),
            lambda: analyze_study(store),
            lambda: merge(whole, path),
            lambda: merge(store, tmp_path / "other.sqlite"),
            store.back_up,
            lambda: delete_participant(store, store.participants()[0]["uuid"]),
        ):
            with pytest.raises(RecordError, match=r"is damaged \(.*missing from index.*backups"):
                give()
        assert len(store.participants()) == 2
        assert not store.exports.exists()


def test_a_file_of_version_1_opens_goes_on_and_exports(tmp_path: Path) -> None:
    path = tmp_path / "study.sqlite"
    connection = sqlite3.connect(path)
    # Dumped from a file that the first version of this room wrote.
    connection.executescript(VERSION_1.read_text(encoding="utf-8"))
    connection.close()
    with StudyStore.open(path) as store:
        (who,) = store.participants()
        assert (who["uuid"], who["planned"], who["answered"]) == ("52a95791154444a6", 6, 3)
        before = store.rows("SELECT * FROM response ORDER BY trial")
        assert conduct(session(store, who["uuid"]), NoDevice(), Script()) == 3
        after = store.rows("SELECT * FROM response ORDER BY trial")
        assert [row for row in after if row in before] == before
        export_study(store, "psych-ds")


class Connection:
    """SQLite, of which one statement fails or answers otherwise."""

    def __init__(self, place: object, fails: str, by: object, **how: object) -> None:
        self._inner = sqlite3.connect(place, **how)  # type: ignore[call-overload]
        self._fails, self._by = fails, by
        self.closed = False

    def execute(self, statement: str, *more: object) -> object:
        """As it is, but for the one."""
        if self._fails not in statement:
            return self._inner.execute(statement, *more)
        if isinstance(self._by, Exception):
            raise self._by
        # Another answer, of the same shape.
        return self._inner.execute(f"SELECT {self._by}")

    def close(self) -> None:
        """Keep that it was."""
        self.closed = True
        self._inner.close()


def _failing(monkeypatch: pytest.MonkeyPatch, statement: str, by: object) -> list[Connection]:
    made: list[Connection] = []

    class Module:
        """`sqlite3`, of which only `connect` is another."""

        Error, sqlite_version = sqlite3.Error, sqlite3.sqlite_version
        sqlite_version_info = sqlite3.sqlite_version_info

        @staticmethod
        def connect(place: object, **how: object) -> Connection:
            made.append(Connection(place, statement, by, **how))
            return made[-1]

    monkeypatch.setattr(database_module, "sqlite3", Module)
    return made


FULL = sqlite3.OperationalError("database or disk is full")


@pytest.mark.parametrize(
    ("statement", "by", "kind", "says"),
    [
        ("count(*) FROM sqlite_schema", FULL, RecordError, "cannot be opened: database or disk is"),
        ("journal_mode", "'delete'", RecordError, r"\(journal_mode is delete\); put it on a local"),
        ("foreign_keys", FULL, RecordError, "cannot be opened: database or disk is full"),
        ("synchronous", sqlite3.DatabaseError("file is not a database"), InputError,
         "is no study's file: file is not a database"),
    ],
)  # fmt: skip
def test_a_database_that_cannot_be_opened_is_closed_again(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    statement: str,
    by: object,
    kind: type[BaseException],
    says: str,
) -> None:
    path = tmp_path / "study.sqlite"
    StudyStore.create(path, gratings(), 7).close()
    made = _failing(monkeypatch, statement, by)
    with pytest.raises(kind, match=says):
        Database(path)
    assert [one.closed for one in made] == [True]


def test_a_folder_that_keeps_nothing_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "study.sqlite"
    StudyStore.create(path, gratings(), 7).close()

    def refused(*_: object, **__: object) -> None:
        raise sqlite3.OperationalError("unable to open database file")

    with monkeypatch.context() as patched:
        patched.setattr(database_module.sqlite3, "connect", refused)
        with pytest.raises(RecordError, match=r"unable to open .*; is the folder writable\?"):
            Database(path)
    with monkeypatch.context() as patched:
        patched.setattr(database_module.sqlite3, "sqlite_version_info", (3, 36, 9))
        with pytest.raises(RecordError, match=r"a study needs 3\.37 or later"):
            Database(path)
    with monkeypatch.context() as patched:
        patched.setattr(database_module.sqlite3, "sqlite_version_info", (3, 37))
        Database(path).close()


def test_a_file_that_was_replaced_while_it_was_opened_is_not_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "study.sqlite"
    StudyStore.create(path, gratings(), 7).close()
    connect = database_module._connect

    def slow(path: Path, new: bool) -> sqlite3.Connection:
        made = connect(path, new)
        _replaced(path)
        return made

    monkeypatch.setattr(database_module, "_connect", slow)
    with pytest.raises(RecordError, match="was replaced while it was being opened; open it again"):
        Database(path)


def test_a_person_who_stops_an_opening_leaves_nothing_open(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "study.sqlite"
    StudyStore.create(path, gratings(), 7).close()
    made = _failing(monkeypatch, "nothing that is asked", 0)
    looks: list[Path] = []

    def look(at: Path) -> tuple[int, int] | None:
        looks.append(at)
        if len(looks) > 1:
            raise KeyboardInterrupt
        return identity_of(at)

    monkeypatch.setattr(database_module, "identity_of", look)
    with pytest.raises(KeyboardInterrupt):
        Database(path)
    assert [one.closed for one in made] == [True]


def test_what_is_no_study_is_told_from_one_of_another_version(tmp_path: Path) -> None:
    path = tmp_path / "study.sqlite"
    StudyStore.create(path, gratings(), 7).close()
    require_study(path)
    assert is_study(path)
    for mark, value, says, still in (
        ("application_id", APPLICATION_ID + 1, "no study's file; give one that `study run`", False),
        ("application_id", 0, "no study's file; give one that `study run`", False),
        ("user_version", VERSION + 1, f"version {VERSION + 1}; this program reads version", True),
        ("user_version", VERSION - 2, f"version {VERSION - 2}; this program reads version", True),
    ):
        other = tmp_path / "other.sqlite"
        shutil.copy(path, other)
        connection = sqlite3.connect(other)
        connection.execute(f"PRAGMA {mark} = {value}")
        connection.close()
        for look in (require_study, Database):
            with pytest.raises(InputError, match=says):
                look(other)
        assert is_study(other) is still
    text = tmp_path / "text.sqlite"
    text.write_text("no database, however long it goes on " * 50)
    with pytest.raises(InputError, match="is no study's file: file is not a database"):
        require_study(text)
    # With a log beside it the log is asked too.
    text.with_name("text.sqlite-wal").write_bytes(b"nor a log")
    with pytest.raises(InputError, match="is no study's file"):
        require_study(text)
    for none in (text, tmp_path, tmp_path / "none.sqlite"):
        assert not is_study(none)
    for none, says in (
        (tmp_path, "it is a directory"),
        (tmp_path / "none.sqlite", "does not exist; plan a study"),
    ):
        with pytest.raises(InputError, match=says):
            require_study(none)
    # A name that no file can have.
    with pytest.raises(InputError):
        require_study(Path("a\x00b.sqlite"))


def test_a_file_is_claimed_once_and_discarded_by_who_claimed_it(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "study.sqlite"
    claimed = claim(path)
    assert claimed == identity_of(path) == (path.stat().st_dev, path.stat().st_ino)
    assert path.read_bytes() == b""
    with pytest.raises(InputError, match="exists; open it to go on"):
        claim(path)
    with pytest.raises(RecordError, match=r"cannot be made: .*; choose another"):
        claim(path / "under" / "a-file.sqlite")
    with pytest.raises(RecordError, match=r"cannot be made: .*; choose another"):
        claim(path / "a-file.sqlite")  # the folder is a file
    log = path.with_name("study.sqlite-wal")
    log.touch()
    discard(path, (claimed[0], claimed[1] + 1))
    assert path.exists()
    assert log.exists()
    discard(path, claimed)
    assert list(path.parent.iterdir()) == []
    # Nothing is there any more, and nothing is made of that.
    discard(path, claimed)
    assert identity_of(path) is None


def test_who_is_not_alone_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "study.sqlite"
    StudyStore.create(path, gratings(), 7).close()
    require_alone(path)
    connect = sqlite3.connect
    # Nobody else will end meanwhile: do not wait half a second for them.
    monkeypatch.setattr(
        database_module.sqlite3, "connect", lambda *at, **how: connect(*at, **{**how, "timeout": 0})
    )
    with contextlib.closing(connect(path, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        with pytest.raises(RecordError, match=r"open in another program \(database is locked\)"):
            require_alone(path)
    require_alone(path)


def test_a_file_that_another_reads_is_not_compacted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "study.sqlite"
    StudyStore.create(path, gratings(), 7).close()
    database = Database(path)
    waits = "PRAGMA busy_timeout"
    before = database.connection.execute(waits).fetchone()[0]
    assert before == 5000
    database.compact()
    made = database.connection
    for statement, by, says in (
        ("wal_checkpoint", 1, "is open in another program; close every session"),
        ("VACUUM", FULL, "could not be compacted: database or disk is full"),
    ):
        failing = Connection(path, statement, by, isolation_level=None)
        database.connection = failing  # type: ignore[assignment]
        with pytest.raises(RecordError, match=says):
            database.compact()
        # It waits as long as ever for what comes next.
        assert failing.execute(waits).fetchone()[0] == before  # type: ignore[attr-defined]
        failing.close()
    database.connection = made
    database.compact()
    assert made.execute(waits).fetchone()[0] == before
    database.close()


def test_studies_of_one_name_share_their_folders_and_nothing_else_does(tmp_path: Path) -> None:
    path = tmp_path / "study[1].sqlite"
    StudyStore.create(path, gratings(), 7).close()
    assert same_folders(path) == []
    shutil.copy(path, tmp_path / "study[1].db")
    shutil.copy(path, tmp_path / "study[1].a.db")
    shutil.copy(path, tmp_path / "study1.db")
    (tmp_path / "study[1].txt").write_text("notes")
    assert same_folders(path) == [tmp_path / "study[1].db"]
    shutil.copy(path, tmp_path / "study[1].aaa")
    assert same_folders(path) == [tmp_path / "study[1].aaa", tmp_path / "study[1].db"]


def test_what_is_written_is_kept_by_all_that_sqlite_offers(tmp_path: Path) -> None:
    path = tmp_path / "study.sqlite"
    StudyStore.create(path, gratings(), 7).close()
    database = Database(path)
    found = {
        one: database.connection.execute(f"PRAGMA {one}").fetchone()[0]
        for one in ("synchronous", "fullfsync", "foreign_keys", "secure_delete", "trusted_schema",
                    "cell_size_check", "temp_store", "journal_mode")
    }  # fmt: skip
    # FULL is 2, and 2 of temp_store is memory.
    assert found == {
        "synchronous": 2, "fullfsync": 1, "foreign_keys": 1, "secure_delete": 1,
        "trusted_schema": 0, "cell_size_check": 1, "temp_store": 2, "journal_mode": "wal",
    }  # fmt: skip
    database.copy_to(tmp_path / "copy.sqlite")
    require_study(tmp_path / "copy.sqlite")
    database.close()


def test_what_fails_within_a_transaction_leaves_the_file_as_it_was(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as store:
        before = store.rows("SELECT COUNT(*) AS number FROM sqlite_master")

        def fail() -> None:
            with store.transaction() as write:
                write.execute("CREATE TABLE begun (number INTEGER)")
                raise ValueError("no row")

        with pytest.raises(ValueError, match="no row"):
            fail()
        with store.transaction():  # the next one begins
            pass
        assert store.rows("SELECT COUNT(*) AS number FROM sqlite_master") == before
