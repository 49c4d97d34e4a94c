"""One participant out, without a byte left: database, logs, traces, exports, backups."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest

from squeezefilm.errors import InputError, RecordError
from squeezefilm.study.conduct import conduct
from squeezefilm.study.deletion import delete_participant
from squeezefilm.study.exports import export_study
from squeezefilm.study.run import StudyRun
from squeezefilm.study.session_conditions import SessionConditions
from squeezefilm.study.sessions import begin_session, end_session
from squeezefilm.study.store import StudyStore

from .scripted import TRACE, Bench, Script, gratings
from .test_sessions import LOUD

SECRET = "marker of one sitting"


def _study(tmp_path: Path) -> tuple[StudyStore, list[str]]:
    """Three people with traces; the second one's sitting and traces have a marker in them."""
    store = StudyStore.create(tmp_path / "study.sqlite", gratings(4), 7)
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
    store, people = _study(tmp_path)
    gone = people[1]
    for format in ("csv", "psych-ds", "bids"):
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
    assert {"study.sqlite", "small_trials.csv", "participants.tsv", left_over} <= places
    assert any(name.endswith("-wal") for name in places)
    done = delete_participant(store, gone)
    assert done.enrolled
    assert done.answers == 15
    assert done.traces == 12
    assert (done.backups, done.exports) == (1, 4)
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
    with pytest.raises(InputError, match=r"nothing was deleted: .*mail\.txt"):
        delete_participant(store, people[0])
    assert len(store.participants()) == 3
    planted.unlink()
    done = delete_participant(store, people[0])
    assert done.enrolled
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
