"""Arrays kept on disk: given back to the bit, never out of date, never in the way."""

import os
from pathlib import Path

import numpy as np
import pytest

from squeezefilm import kept_arrays
from squeezefilm.kept_arrays import (
    CACHE_VARIABLE,
    KeptArrays,
    KeptResults,
    cache_folder,
    in_passing,
)

VALUES = np.array([0.1, -3.0, 1e300, np.nextafter(1.0, 2.0)])


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "kept"))
    return tmp_path / "kept"


@pytest.fixture
def source(tmp_path: Path) -> Path:
    made_by = tmp_path / "made_by.py"
    made_by.write_text("one = 1\n")
    return made_by


def test_another_process_gets_what_was_put_to_the_bit(folder: Path, source: Path) -> None:
    KeptArrays("kind", [source]).put("asked", VALUES)
    found = KeptArrays("kind", [source]).get("asked", VALUES.size)
    assert found is not None
    assert found.tobytes() == VALUES.tobytes()
    assert KeptArrays("kind", [source]).get("other", VALUES.size) is None
    assert KeptArrays("other", [source]).get("asked", VALUES.size) is None


def test_nothing_is_given_once_the_source_has_changed(folder: Path, source: Path) -> None:
    KeptArrays("kind", [source]).put("asked", VALUES)
    source.write_text("one = 2\n")
    assert KeptArrays("kind", [source]).get("asked", VALUES.size) is None
    # A folder of source counts with all that is below it.
    KeptArrays("kind", [source.parent]).put("asked", VALUES)
    assert KeptArrays("kind", [source.parent]).get("asked", VALUES.size) is not None
    (source.parent / "below").mkdir()
    (source.parent / "below" / "more.py").write_text("")
    assert KeptArrays("kind", [source.parent]).get("asked", VALUES.size) is None


def test_source_that_cannot_be_read_keeps_nothing(folder: Path, tmp_path: Path) -> None:
    KeptArrays("kind", [tmp_path / "gone.py"]).put("asked", VALUES)
    assert not folder.exists()


@pytest.mark.parametrize("damage", [b"", b"short", None])
def test_a_damaged_file_counts_as_none_and_is_written_again(
    folder: Path, source: Path, damage: bytes | None
) -> None:
    kept = KeptArrays("kind", [source])
    kept.put("asked", VALUES)
    (file,) = (folder / "kind").iterdir()
    whole = file.read_bytes()
    # One bit of a number, where nothing else was lost.
    file.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]) if damage is None else damage)
    assert kept.get("asked", VALUES.size) is None
    kept.put("asked", VALUES)
    assert file.read_bytes() == whole
    assert kept.get("asked", VALUES.size - 1) is None


def test_off_keeps_nothing(tmp_path: Path, source: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, "off")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "caches"))
    kept = KeptArrays("kind", [source])
    kept.put("asked", VALUES)
    assert kept.get("asked", VALUES.size) is None
    assert sorted(tmp_path.iterdir()) == [source]


def test_a_folder_that_cannot_be_written_to_is_no_error(
    tmp_path: Path, source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, str(source))  # a file
    kept = KeptArrays("kind", [source])
    kept.put("asked", VALUES)
    assert kept.get("asked", VALUES.size) is None


def test_a_write_that_fails_leaves_no_part(
    folder: Path, source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError("no space left")

    monkeypatch.setattr(Path, "replace", full)
    KeptArrays("kind", [source]).put("asked", VALUES)
    assert list((folder / "kind").iterdir()) == []


def test_the_older_half_goes_where_there_are_too_many(
    folder: Path, source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kept_arrays, "MOST_FILES", 10)
    first = KeptArrays("kind", [source])
    for number in range(12):
        first.put(str(number), np.array([float(number)]))
    for age, file in enumerate((folder / "kind").iterdir()):
        os.utime(file, (1e9 + age, 1e9 + age))
    KeptArrays("kind", [source]).put("new", VALUES)
    left = list((folder / "kind").iterdir())
    assert len(left) == 10 // 2 + 1
    assert all(file.stat().st_mtime >= 1e9 + 7 for file in left)


@pytest.mark.parametrize(
    ("platform", "variable", "inside"),
    [("linux", "XDG_CACHE_HOME", ""), ("win32", "LOCALAPPDATA", ""), ("darwin", "HOME", "Library")],
)
def test_it_is_where_the_system_keeps_caches(
    platform: str, variable: str, inside: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv(CACHE_VARIABLE)
    monkeypatch.setattr("sys.platform", platform)
    monkeypatch.setenv(variable, str(tmp_path))
    found = cache_folder()
    assert found is not None
    assert found.name == "squeezefilm"
    assert found.is_relative_to(tmp_path / inside)


def test_a_user_without_a_home_keeps_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless() -> Path:
        raise RuntimeError("no home")

    monkeypatch.delenv(CACHE_VARIABLE)
    monkeypatch.setattr(Path, "home", homeless)
    assert cache_folder() is None


def test_a_result_is_kept_as_it_is(folder: Path, source: Path) -> None:
    KeptResults("kind", [source]).put("asked", {"values": VALUES})
    found = KeptResults("kind", [source]).get("asked")
    assert np.array_equal(found["values"], VALUES)
    assert KeptResults("kind", [source]).get("other") is None
    source.write_text("changed")
    assert KeptResults("kind", [source]).get("asked") is None


def test_a_damaged_or_unreadable_result_counts_as_not_there(folder: Path, source: Path) -> None:
    kept = KeptResults("kind", [source])
    kept.put("asked", VALUES)
    (file,) = (folder / "kind").iterdir()
    whole = file.read_bytes()
    file.write_bytes(whole[:-1] + b"?")
    assert kept.get("asked") is None
    # Whole, but what is pickled in it no longer exists.
    kept._write("asked", b"cgone_module\nNothing\n.", 10)
    assert kept.get("asked") is None


def test_of_results_few_are_kept(
    folder: Path, source: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kept_arrays, "MOST_RESULTS", 6)
    kept = KeptResults("kind", [source])
    for number in range(20):
        kept.put(str(number), number)
    assert len(list((folder / "kind").iterdir())) <= 7
    assert kept.get("19") == 19


def test_in_passing_results_are_read_and_none_is_kept(folder: Path, source: Path) -> None:
    kept = KeptResults("kind", [source])
    kept.put("mine", 1)
    with in_passing():
        kept.put("of many", 2)
        assert kept.get("mine") == 1
        # Small, and what a stopped calibration goes on with.
        KeptArrays("numbers", [source]).put("asked", VALUES)
    assert kept.get("of many") is None
    assert KeptArrays("numbers", [source]).get("asked", VALUES.size) is not None
    kept.put("of many", 2)
    assert kept.get("of many") == 2
