"""An export is replaced whole, or left whole: what lies there is looked at before it goes."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.record.exports import (
    LIST,
    export_again,
    export_study,
    exported_folders,
    own_files,
)
from squeezefilm.study.record.store import StudyStore

from ..scripted import gratings


@pytest.fixture
def store(tmp_path: Path) -> Iterator[StudyStore]:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as found:
        yield found


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.skipif(os.name == "nt", reason="Windows has other links")
def test_a_file_with_a_second_name_keeps_an_export_as_it_is(
    store: StudyStore, tmp_path: Path
) -> None:
    folder = export_study(store, "csv")
    before = contents(folder)
    first, *_ = sorted(name for name in before if name.endswith(".csv"))
    os.link(folder / first, tmp_path / "mine.csv")
    with pytest.raises(InputError, match="one of 2 names of the same file"):
        own_files(folder)
    with pytest.raises(InputError, match="one of 2 names of the same file"):
        export_study(store, "csv")
    assert contents(folder) == before
    assert (tmp_path / "mine.csv").read_bytes() == before[first]


def test_files_of_ones_own_are_named_up_to_three(store: StudyStore) -> None:
    folder = export_study(store, "csv")
    for name in ("d.txt", "b.txt", "c.txt", "a.txt"):
        (folder / name).write_text("mine")
    with pytest.raises(InputError, match=r"files of its own \(a\.txt, b\.txt, c\.txt\), which"):
        export_study(store, "csv")
    assert (folder / "a.txt").read_text() == "mine"


def test_what_a_killed_program_was_writing_goes_with_the_export(store: StudyStore) -> None:
    folder = export_study(store, "csv")
    half = folder / ".small_trials.csv.1234"
    half.write_text("half")
    assert half in own_files(folder)
    export_study(store, "csv")
    assert not half.exists()


def test_every_export_that_is_still_there_is_made_again(store: StudyStore, tmp_path: Path) -> None:
    assert exported_folders(store) == []
    csv, other = export_study(store, "csv"), export_study(store, "psych-ds", tmp_path / "b")
    export_study(store, "psych-ds", tmp_path / "gone")
    for path in sorted((tmp_path / "gone").rglob("*"), reverse=True):
        path.rmdir() if path.is_dir() else path.unlink()
    assert dict(exported_folders(store)) == {"csv": csv.resolve(), "psych-ds": other.resolve()}
    (csv / "small_trials.csv").write_text("old")
    assert export_again(store) == 2
    assert (csv / "small_trials.csv").read_text() != "old"
    (store.exports / LIST).unlink()
    assert export_again(store) == 0
