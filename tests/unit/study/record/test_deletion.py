"""One participant out, without a byte left: database, logs, traces, exports, backups."""

from __future__ import annotations

import functools
import shutil
import sqlite3
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.study.conduct.run import StudyRun
from squeezefilm.study.conduct.sessions import SessionConditions, begin_session, end_session
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record.deletion import delete_participant
from squeezefilm.study.record.exports import export_study
from squeezefilm.study.record.sittings import FILE, Sittings
from squeezefilm.study.record.store import StudyStore

from ..scripted import LOUD, TRACE, Bench, Script, gratings

SECRET = "marker of one sitting"


def _study(folder: Path) -> tuple[StudyStore, list[str]]:
    """A copy of a study of three that is made once, beside the folders of all tests."""
    made = folder.resolve().parent / "three people"
    people = _made_once(made)
    shutil.copytree(made, folder, dirs_exist_ok=True)
    return StudyStore.open(folder / "study.sqlite"), people


@functools.cache
def _made_once(folder: Path) -> list[str]:
    folder.mkdir()
    store, people = _made(folder)
    store.close()
    return people


def _made(folder: Path) -> tuple[StudyStore, list[str]]:
    """Three people with traces; the second one's sitting and traces have a marker in them."""
    store = StudyStore.create(folder / "study.sqlite", gratings(4), 7)
    people = [store.enrol() for _ in range(3)]
    for place, who in enumerate(people):
        conditions = SessionConditions(consent=True, note=SECRET if place == 1 else "")
        device = Bench()
        if place == 1:
            device.trace = TRACE.replace("seed", SECRET)
        begun = begin_session(store, who, device, conditions, LOUD, acknowledged=True)
        conduct(StudyRun(store, begun), device, Script())
        end_session(store, begun, device)
    return store, people


def _left(folder: Path, words: list[str]) -> list[tuple[str, str]]:
    found = []
    for path in folder.rglob("*"):
        for word in words:
            inside = path.is_file() and word.encode() in path.read_bytes()
            if inside or word in path.name:
                found.append((word, path.name))
    return found


def test_no_byte_of_a_participant_is_left_anywhere(tmp_path: Path) -> None:
    # Never closed: some of it is in the log alone.
    store, people = _made(tmp_path)
    gone = people[1]
    for format in ("csv", "psych-ds"):
        export_study(store, format)  # type: ignore[arg-type]
    export_study(store, "csv", tmp_path / "elsewhere")
    store.back_up()
    # Rows in the database and in its write-ahead log.
    reader = sqlite3.connect(store.path)
    reader.execute("PRAGMA wal_checkpoint(PASSIVE)")
    reader.close()
    # A trace of a program that was killed before its answer was recorded.
    left_over = f"{'0f' * 16}.csv"
    (store.traces / left_over).write_text(SECRET)
    words = [gone, SECRET]
    for table, key in (("session", "participant"), ("trial", "participant")):
        rows = store.rows(f"SELECT uuid FROM {table} WHERE {key} = ?", [gone])
        words += [row["uuid"] for row in rows]
    words += [
        row["uuid"]
        for row in store.rows(
            "SELECT s.uuid FROM presentation s JOIN trial t ON t.uuid = s.trial "
            "WHERE t.participant = ?",
            [gone],
        )
    ]
    others = [
        store.rows(
            "SELECT r.* FROM response r JOIN trial t ON t.uuid = r.trial "
            "WHERE t.participant = ? ORDER BY t.number",
            [who],
        )
        for who in (people[0], people[2])
    ]
    places = {name for _, name in _left(tmp_path, words)}
    assert {"study.sqlite", "small_trials.csv", left_over} <= places
    assert any(name.endswith("-wal") for name in places)
    done = delete_participant(store, gone)
    assert done.enrolled
    assert done.answers == 15
    assert done.traces == 12
    assert (done.backups, done.exports) == (1, 3)
    assert _left(tmp_path, words) == []
    assert [one["uuid"] for one in store.participants()] == [people[0], people[2]]
    for who, before in zip((people[0], people[2]), others, strict=True):
        after = store.rows(
            "SELECT r.* FROM response r JOIN trial t ON t.uuid = r.trial "
            "WHERE t.participant = ? ORDER BY t.number",
            [who],
        )
        assert after == before
    assert people[0] in (tmp_path / "elsewhere" / "small_trials.csv").read_text()
    store.close()
    assert _left(tmp_path, words) == []


def test_the_search_finds_what_is_planted(tmp_path: Path) -> None:
    store, people = _study(tmp_path)
    store.backups.mkdir()
    planted = store.backups / "mail.txt"
    planted.write_bytes(b"x" * (1 << 20) + people[0][:8].encode() + people[0][8:].encode())
    with pytest.raises(RecordError, match=r"traces are left in .*mail\.txt; delete these files"):
        delete_participant(store, people[0])
    assert len(store.participants()) == 2
    planted.unlink()
    assert not delete_participant(store, people[0]).enrolled
    store.close()


def test_nothing_is_deleted_while_somebody_reads(tmp_path: Path) -> None:
    store, people = _study(tmp_path)
    reader = sqlite3.connect(store.path)
    reader.execute("BEGIN")
    reader.execute("SELECT count(*) FROM response").fetchone()
    store.enrol()
    with pytest.raises(RecordError, match="close every session"):
        delete_participant(store, people[0])
    assert len(store.participants()) == 4
    reader.close()
    assert delete_participant(store, people[0]).enrolled
    store.close()


def test_a_freed_number_is_given_again(tmp_path: Path) -> None:
    store, people = _study(tmp_path)
    delete_participant(store, people[1])
    store.enrol()
    assert [one["number"] for one in store.participants()] == [0, 1, 2]
    store.close()


def test_nothing_is_deleted_while_an_export_cannot_be_made_anew(tmp_path: Path) -> None:
    store, people = _study(tmp_path)
    folder = export_study(store, "csv")
    (folder / "mine.txt").write_text("mine")
    with pytest.raises(InputError, match=r"mine\.txt"):
        delete_participant(store, people[0])
    assert len(store.participants()) == 3
    (folder / "mine.txt").unlink()
    assert delete_participant(store, people[0]).exports == 1
    store.close()


def test_the_labs_sittings_go_too(tmp_path: Path) -> None:
    store, people = _study(tmp_path)
    sittings = Sittings(tmp_path / FILE)
    fields = {"study": "study", "device": "none", "consent_text": "c"}
    for who in people:
        sittings.new(participant=who, **fields)
    done = delete_participant(store, people[1])
    assert done.sittings == 1
    assert _left(tmp_path, [people[1], SECRET]) == []
    assert [one.participant for one in sittings.of_study("study")] == [people[0], people[2]]
    store.close()


def _traces(store: StudyStore, who: str) -> list[list[str]]:
    import json

    rows = store.rows(
        "SELECT r.traces FROM response r JOIN trial t ON t.uuid = r.trial WHERE t.participant = ? "
        "AND r.traces != '[]' ORDER BY t.number",
        [who],
    )
    return [json.loads(row["traces"]) for row in rows]


def test_a_backup_that_was_never_finished_goes(tmp_path: Path) -> None:
    store, people = _study(tmp_path)
    whole = store.back_up()
    half = whole.with_name(f".{whole.name}.unfinished")
    half.write_text(people[1])
    half.with_name(f"{half.name}-journal").write_text(people[1])
    mine = store.backups / "foreign.sqlite"
    sqlite3.connect(mine).close()
    done = delete_participant(store, people[1])
    assert done.backups == 1
    assert sorted(store.backups.iterdir()) == sorted([whole, mine])
    store.close()


@pytest.mark.parametrize("pseudonym", ["", "a", "../../x", "*", "0" * 15, "0" * 40, "Z" * 16])
def test_what_is_no_pseudonym_is_refused(tmp_path: Path, pseudonym: str) -> None:
    with (
        StudyStore.create(tmp_path / "study.sqlite", gratings(), 7) as store,
        pytest.raises(InputError, match="no participant's pseudonym"),
    ):
        delete_participant(store, pseudonym)


def test_a_relative_path_is_the_same_study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    store, people = _study(Path())
    for format in ("csv", "psych-ds"):
        export_study(store, format)  # type: ignore[arg-type]
    store.back_up()
    done = delete_participant(store, people[1])
    assert (done.exports, done.backups) == (2, 1)
    assert _left(tmp_path, [people[1], SECRET]) == []
    monkeypatch.chdir(tmp_path.parent)
    assert store.enrol()
    store.close()


def test_notes_of_anything_random_that_is_theirs_are_found(tmp_path: Path) -> None:
    queries = (
        "SELECT uuid FROM trial WHERE participant = ?",
        "SELECT uuid FROM session WHERE participant = ?",
        "SELECT v.uuid FROM verification v JOIN session s ON s.uuid = v.session "
        "WHERE s.participant = ?",
        "SELECT p.uuid FROM presentation p JOIN trial t ON t.uuid = p.trial "
        "WHERE t.participant = ?",
    )
    for place, query in enumerate(queries):
        (tmp_path / str(place)).mkdir()
        store, people = _study(tmp_path / str(place))
        notes = store.path.with_name("study.sqlite.notes.txt")
        word = store.rows(query, [people[1]])[-1]["uuid"]
        notes.write_text(f"at {word} the plate was loud")
        with pytest.raises(RecordError, match=r"traces are left in .*notes\.txt"):
            delete_participant(store, people[1])
        # Of somebody else they say nothing of this one.
        notes.write_text(people[0])
        assert not delete_participant(store, people[1]).enrolled
        store.close()
