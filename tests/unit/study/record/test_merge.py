"""Files of stations into one: a union, again and again the same, and contradictions refused."""

from __future__ import annotations

import shutil
import sqlite3
from pathlib import Path

import pytest

from squeezefilm.core.errors import ContradictionError, InputError, RecordError
from squeezefilm.study.conduct.study_device import NoDevice
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record.merge import merge, open_or_begin
from squeezefilm.study.record.schema import TABLES
from squeezefilm.study.record.store import StudyStore

from ..scripted import Bench, Script, gratings, session, staircase


def _station(path: Path, station: int, people: int = 2) -> StudyStore:
    store = StudyStore.create(path, gratings(), 7, station=station, stations=3)
    for _ in range(people):
        conduct(session(store, store.enrol()), Bench(), Script())
    return store


def _contents(store: StudyStore) -> dict[str, list[tuple[object, ...]]]:
    return {
        table: sorted(
            tuple(map(repr, row.values())) for row in store.rows(f"SELECT * FROM {table}")
        )
        for table in TABLES
    }


def test_stations_merge_in_any_order_and_again(tmp_path: Path) -> None:
    a, b, c = (_station(tmp_path / f"{name}.sqlite", k) for k, name in enumerate("abc"))
    assert [p["number"] for p in b.participants()] == [1, 4]
    b.close()
    c.close()
    shutil.copytree(tmp_path, tmp_path / "copy")
    done = merge(a, tmp_path / "b.sqlite")
    assert done.added == {
        "participant": 2,
        "trial": 18,
        "session": 2,
        "verification": 2,
        "presentation": 18,
        "response": 18,
        "set_aside": 0,
    }
    assert done.traces == 12
    assert done.doubled_numbers == ()
    merge(a, tmp_path / "c.sqlite")
    once = _contents(a)
    again = merge(a, tmp_path / "b.sqlite")
    assert set(again.added.values()) == {0}
    assert again.present == done.added
    assert again.traces == 0
    assert _contents(a) == once
    assert sorted(p["number"] for p in a.participants()) == [0, 1, 2, 3, 4, 5]
    assert a.unreferenced_traces() == []
    a.close()
    with StudyStore.open(tmp_path / "copy" / "c.sqlite") as other:
        merge(other, tmp_path / "copy" / "b.sqlite")
        merge(other, tmp_path / "a.sqlite")
        assert _contents(other) == once


def test_a_participant_who_went_on_elsewhere_merges_and_one_who_forked_is_refused(
    tmp_path: Path,
) -> None:
    first = tmp_path / "first.sqlite"
    with StudyStore.create(first, gratings(), 7) as store:
        who = store.enrol()
        with pytest.raises(KeyboardInterrupt):
            conduct(session(store, who), NoDevice(), Script(most=4))
    for name in ("second", "third"):
        shutil.copy(first, tmp_path / f"{name}.sqlite")
    with StudyStore.open(tmp_path / "second.sqlite") as store:
        conduct(session(store, who), NoDevice(), Script())
    with StudyStore.open(first) as store:
        assert merge(store, tmp_path / "second.sqlite").added["response"] == 5
        before = _contents(store)
        with StudyStore.open(tmp_path / "third.sqlite") as forked:
            conduct(session(forked, who), NoDevice(), Script())
        with pytest.raises(ContradictionError, match="differs in"):
            merge(store, tmp_path / "third.sqlite")
        assert _contents(store) == before


def test_another_study_the_same_file_and_lost_traces_are_refused(tmp_path: Path) -> None:
    with _station(tmp_path / "a.sqlite", 0, people=1) as store:
        for name, design, seed, says in (
            ("seed", gratings(), 8, "its seed is 8"),
            ("design", staircase(), 7, "its design"),
        ):
            StudyStore.create(tmp_path / f"{name}.sqlite", design, seed).close()
            with pytest.raises(InputError, match=says):
                merge(store, tmp_path / f"{name}.sqlite")
        with pytest.raises(InputError, match="this file itself"):
            merge(store, tmp_path / "a.sqlite")
        _station(tmp_path / "b.sqlite", 1, people=1).close()
        shutil.rmtree(tmp_path / "b.traces")
        before = _contents(store)
        with pytest.raises(InputError, match="bring the folder along"):
            merge(store, tmp_path / "b.sqlite")
        assert _contents(store) == before


def test_doubled_numbers_are_told(tmp_path: Path) -> None:
    StudyStore.create(tmp_path / "b.sqlite", gratings(), 7).close()
    with StudyStore.open(tmp_path / "b.sqlite") as other:
        other.enrol()
    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as store:
        store.enrol()
        assert merge(store, tmp_path / "b.sqlite").doubled_numbers == (0,)


def test_files_that_are_no_studies_are_refused(tmp_path: Path) -> None:
    text, other = tmp_path / "text.sqlite", tmp_path / "other.sqlite"
    text.write_text("no database at all, " * 100)
    connection = sqlite3.connect(other)
    connection.execute("CREATE TABLE t (x)")
    connection.close()
    for path in (text, other, tmp_path / "none.sqlite"):
        with pytest.raises(InputError, match=r"no study's file|does not exist"):
            StudyStore.open(path)
    with pytest.raises(InputError, match="exists"):
        StudyStore.create(text, gratings(), 7)
    with pytest.raises(InputError, match="station"):
        StudyStore.create(tmp_path / "x.sqlite", gratings(), 7, station=3, stations=3)
    assert not (tmp_path / "x.sqlite").exists()


@pytest.mark.parametrize(
    "name",
    ["../../escaped.txt", "/escaped.txt", "..", "", ".", "a/b.csv", "con.csv", "x" * 300, "\u0000"],
)
def test_a_traces_name_that_leads_elsewhere_is_refused(tmp_path: Path, name: str) -> None:
    import json

    (tmp_path / "ours").mkdir()
    (tmp_path / "theirs" / "deep").mkdir(parents=True)
    (tmp_path / "escaped.txt").write_text("theirs")
    other = tmp_path / "theirs" / "deep" / "other.sqlite"
    _station(other, 1, people=1).close()
    connection = sqlite3.connect(other, isolation_level=None)
    connection.execute("UPDATE response SET traces = ?", [json.dumps([name])])
    connection.close()
    with _station(tmp_path / "ours" / "study.sqlite", 0, people=1) as store:
        before, files = _contents(store), sorted(tmp_path.rglob("*"))
        with pytest.raises(InputError, match="has traces = "):
            merge(store, other)
        assert _contents(store) == before
        assert sorted(tmp_path.rglob("*")) == files
    with pytest.raises(InputError, match="was not written by this program"):
        StudyStore.open(other)


def test_a_participant_whose_pseudonym_is_a_path_is_refused(tmp_path: Path) -> None:
    other = tmp_path / "other.sqlite"
    with StudyStore.create(other, gratings(), 7) as store:
        store.enrol()
    connection = sqlite3.connect(other, isolation_level=None)
    connection.execute("UPDATE participant SET uuid = '../../escaped'")
    connection.execute("UPDATE trial SET participant = '../../escaped'")
    connection.close()
    # It goes into names of files.
    with pytest.raises(InputError, match=r"participant '../../escaped' has uuid"):
        StudyStore.open(other)


def test_a_link_among_anothers_traces_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "secret.txt").write_text("of this machine")
    other = tmp_path / "b.sqlite"
    with _station(other, 1, people=1) as theirs:
        trace = next(theirs.traces.iterdir())
        trace.unlink()
        trace.symlink_to(tmp_path / "secret.txt")
    with _station(tmp_path / "a.sqlite", 0, people=1) as store:
        before = _contents(store)
        with pytest.raises(InputError, match="is a link"):
            merge(store, other)
        assert _contents(store) == before
        assert not (store.traces / trace.name).exists()


def test_a_link_in_place_of_the_folder_of_traces_is_not_written_through(tmp_path: Path) -> None:
    a, b = (_station(tmp_path / f"{name}.sqlite", k, 1) for k, name in enumerate("ab"))
    b.close()
    elsewhere = tmp_path / "elsewhere"
    a.traces.rename(elsewhere)
    before = sorted(elsewhere.iterdir())
    a.traces.symlink_to(elsewhere)
    with pytest.raises(InputError, match="is a link, and nothing is written to where it leads"):
        merge(a, tmp_path / "b.sqlite")
    with pytest.raises(RecordError, match="is a link"):
        a.save_trace("time_s,x_m\n")
    assert sorted(elsewhere.iterdir()) == before
    a.traces.unlink()
    elsewhere.rename(a.traces)
    assert merge(a, tmp_path / "b.sqlite").traces > 0
    a.close()


def test_stations_merge_into_a_new_file(tmp_path: Path) -> None:
    for number, name in enumerate("ab"):
        _station(tmp_path / f"{name}.sqlite", number, people=1).close()
    whole, paths = tmp_path / "all.sqlite", [tmp_path / "a.sqlite", tmp_path / "b.sqlite"]
    with open_or_begin(whole, paths[0]) as store:
        for path in paths:
            merge(store, path)
        assert len(store.participants()) == 2
    with open_or_begin(whole, paths[0]) as store:
        assert sum(merge(store, paths[1]).added.values()) == 0
