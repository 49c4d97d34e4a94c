"""One participant out, without a byte left: database, logs, traces, exports, backups."""

from __future__ import annotations

import functools
import os
import shutil
import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError, RecordError, SqueezefilmError
from squeezefilm.study.conduct.run import StudyRun
from squeezefilm.study.conduct.sessions import SessionConditions, begin_session, end_session
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record import deletion
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


def test_nothing_is_deleted_while_another_program_has_the_file_open(tmp_path: Path) -> None:
    store, people = _study(tmp_path)
    idle = sqlite3.connect(store.path)
    idle.execute("SELECT count(*) FROM response").fetchall()
    with pytest.raises(RecordError, match="close every session"):
        delete_participant(store, people[0])
    assert len(store.participants()) == 3
    idle.close()
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


def test_a_persons_own_files_are_left_and_told(tmp_path: Path) -> None:
    store, people = _study(tmp_path)
    target = tmp_path / "precious.txt"
    target.write_text("precious")
    (store.traces / "notes.txt").write_text("mine")
    (store.traces / "folder").mkdir()
    (store.traces / "folder" / "more.csv").write_text("mine")
    (store.traces / "link.csv").symlink_to(target)
    done = delete_participant(store, people[1])
    assert _left(tmp_path, [people[1], SECRET]) == []
    assert [Path(one).relative_to(store.traces).as_posix() for one in done.left] == [
        "folder",
        "folder/more.csv",
        "link.csv",
        "notes.txt",
    ]
    assert {target.read_text(), (store.traces / "notes.txt").read_text()} == {"precious", "mine"}
    store.close()


def _link_in_place_of_a_trace(store: StudyStore, who: str) -> None:
    (name, *_), *_ = _traces(store, who)
    (store.traces / name).rename(store.traces.with_name("elsewhere.csv"))
    (store.traces / name).symlink_to(store.traces.with_name("elsewhere.csv"))


def _second_name_of_a_trace(store: StudyStore, who: str) -> None:
    (name, *_), *_ = _traces(store, who)
    os.link(store.traces / name, store.traces.with_name("elsewhere.csv"))


def _notes_about_somebody(store: StudyStore, who: str) -> None:
    (store.traces / "folder").mkdir()
    (store.traces / "folder" / "notes.txt").write_text(f"{who} was late")


def _linked_traces(store: StudyStore, who: str) -> None:
    store.traces.rename(store.traces.with_name("far away"))
    store.traces.symlink_to(store.traces.with_name("far away"))


def _linked_export(store: StudyStore, who: str) -> None:
    folder = export_study(store, "csv")
    (folder / "small_trials.csv").rename(store.traces.with_name("elsewhere.csv"))
    (folder / "small_trials.csv").symlink_to(store.traces.with_name("elsewhere.csv"))


def _linked_sittings(store: StudyStore, who: str) -> None:
    store.path.with_name("elsewhere.json").write_text("[]")
    store.path.with_name(FILE).symlink_to(store.path.with_name("elsewhere.json"))


def _open_elsewhere(store: StudyStore, who: str) -> None:
    _OPEN.append(sqlite3.connect(store.path))
    _OPEN[-1].execute("SELECT count(*) FROM response").fetchone()


_OPEN: list[sqlite3.Connection] = []


def _traces(store: StudyStore, who: str) -> list[list[str]]:
    import json

    rows = store.rows(
        "SELECT r.traces FROM response r JOIN trial t ON t.uuid = r.trial WHERE t.participant = ? "
        "AND r.traces != '[]' ORDER BY t.number",
        [who],
    )
    return [json.loads(row["traces"]) for row in rows]


@pytest.mark.skipif(os.name == "nt", reason="Windows has other links")
@pytest.mark.parametrize(
    ("obstacle", "says"),
    [
        (_link_in_place_of_a_trace, "is a link"),
        (_second_name_of_a_trace, "2 names of the same file"),
        (_notes_about_somebody, r"notes\.txt was not written by this program"),
        (_linked_traces, "is a link"),
        (_linked_export, "has files of its own"),
        (_linked_sittings, "is a link"),
        (_open_elsewhere, "is open in another program"),
    ],
)
def test_what_would_not_be_complete_is_refused_with_nothing_deleted(
    tmp_path: Path, obstacle: Callable[[StudyStore, str], None], says: str
) -> None:
    store, people = _study(tmp_path)
    obstacle(store, people[1])
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.[cj]s*") if path.is_file()}
    with pytest.raises(SqueezefilmError, match=says):
        delete_participant(store, people[1])
    assert {path: path.read_bytes() for path in before} == before
    assert len(store.participants()) == 3
    while _OPEN:
        _OPEN.pop().close()
    store.close()


def test_a_backup_that_was_never_finished_goes(tmp_path: Path) -> None:
    store, people = _study(tmp_path)
    whole = store.back_up()
    half = whole.with_name(f".{whole.name}.unfinished")
    half.write_text(people[1])
    half.with_name(f"{half.name}-journal").write_text(people[1])
    mine = store.backups / "foreign.sqlite"
    sqlite3.connect(mine).close()
    done = delete_participant(store, people[1])
    assert (done.backups, done.left) == (1, (str(mine),))
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
    assert (done.exports, done.backups, done.left) == (2, 1, ())
    assert _left(tmp_path, [people[1], SECRET]) == []
    monkeypatch.chdir(tmp_path.parent)
    assert store.enrol()
    store.close()


def test_notes_of_anything_random_that_is_theirs_are_found(tmp_path: Path) -> None:
    store, people = _study(tmp_path)
    notes = tmp_path / "study.sqlite.notes.txt"
    gone = people[1]
    theirs = [
        store.rows(query, [gone])[-1]["uuid"]
        for query in (
            "SELECT uuid FROM trial WHERE participant = ?",
            "SELECT uuid FROM session WHERE participant = ?",
            "SELECT v.uuid FROM verification v JOIN session s ON s.uuid = v.session "
            "WHERE s.participant = ?",
            "SELECT p.uuid FROM presentation p JOIN trial t ON t.uuid = p.trial "
            "WHERE t.participant = ?",
        )
    ]
    theirs += [gone, _traces(store, gone)[0][0]]
    for word in theirs:
        notes.write_text(f"at {word} the plate was loud")
        with pytest.raises(InputError, match=r"notes\.txt was not written .* belongs to"):
            delete_participant(store, gone)
    # Of somebody else they say nothing of this one.
    notes.write_text(people[0])
    assert delete_participant(store, gone).left == (str(notes),)
    store.close()


def test_what_is_left_after_a_deletion_is_told_with_its_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store, people = _study(tmp_path)
    late = store.path.with_name("study.sqlite.late")

    def slow(_: StudyStore) -> int:
        """Another program writes while exports are made anew."""
        late.write_bytes(b"x" * 5_000 + people[1].encode())
        return 0

    monkeypatch.setattr(deletion, "export_again", slow)
    with pytest.raises(RecordError, match=rf"traces are left in {late}; delete these files by"):
        delete_participant(store, people[1])
    late.unlink()
    assert not delete_participant(store, people[0]).left
    store.close()


def test_a_word_across_two_pieces_of_a_file_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(deletion, "_PIECE", 64)
    store, people = _study(tmp_path)
    notes = tmp_path / "study.sqlite.notes.txt"
    for before in (0, 48, 56, 63, 64, 100):
        notes.write_text("-" * before + people[1] + "-" * 70)
        with pytest.raises(InputError, match=r"notes\.txt was not written"):
            delete_participant(store, people[1])
    store.close()
