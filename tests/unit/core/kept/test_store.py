"""What is kept on disk: given back to the bit, never in the way, and never more than numbers."""

import os
import pickle
import sys
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import HardLimit
from squeezefilm.core.kept import store
from squeezefilm.core.kept.store import CACHE_VARIABLE, Kept, in_passing

VALUES = np.array([0.1, -3.0, 1e300, np.nextafter(1.0, 2.0)])


def arrays(kind: str = "kind", *, large: bool = False) -> Kept[si.FloatArray]:
    """As another process has it."""
    return Kept(kind, si.FloatArray, large=large)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "kept"))
    return tmp_path / "kept"


@pytest.fixture
def kept_file(folder: Path) -> Path:
    """The one file of what was `asked`."""
    arrays().put("asked", VALUES)
    (file,) = (folder / "kind").iterdir()
    return file


def test_another_process_gets_what_was_put_to_the_bit(kept_file: Path) -> None:
    found = arrays().get("asked")
    assert found is not None
    assert found.tobytes() == VALUES.tobytes()
    assert arrays().get("other") is None
    assert arrays("other").get("asked") is None


def test_nothing_is_given_once_the_code_has_changed(
    kept_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store, "computed_by", lambda: "another")
    assert arrays().get("asked") is None


@pytest.mark.parametrize("damage", [b"", b"short", None])
def test_a_damaged_file_counts_as_none_and_is_written_again(
    kept_file: Path, damage: bytes | None
) -> None:
    whole = kept_file.read_bytes()
    # One bit of a number, where nothing else was lost.
    kept_file.write_bytes(whole[:-1] + bytes([whole[-1] ^ 1]) if damage is None else damage)
    assert arrays().get("asked") is None
    arrays().put("asked", VALUES)
    assert kept_file.read_bytes() == whole


class _Runs:
    """What a pickle would run."""

    def __reduce__(self) -> tuple[object, ...]:
        return pytest.fail, ("a kept file was run",)


def test_a_whole_file_with_other_code_in_it_is_not_run(kept_file: Path) -> None:
    for data in (pickle.dumps(_Runs()), b"[" * 200_000, b'"a text"\n'):
        kept_file.write_bytes(store._digest(data) + data)
        assert arrays().get("asked") is None


def test_too_large_a_file_is_neither_read_nor_written(
    kept_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store, "KEPT_BYTES", HardLimit("bytes", 0, 40, "of a test"))
    assert arrays().get("asked") is None
    arrays().put("more", VALUES)
    assert len(list(kept_file.parent.iterdir())) == 1


@pytest.mark.skipif(sys.platform == "win32", reason="of POSIX's modes")
@pytest.mark.parametrize("inside", ["", "kind"])
def test_where_others_can_write_nothing_is_read_or_kept(
    folder: Path, kept_file: Path, inside: str
) -> None:
    (folder / inside).chmod(0o777)
    assert arrays().get("asked") is None
    arrays().put("more", VALUES)
    assert list((folder / "kind").iterdir()) == [kept_file]
    (folder / inside).chmod(0o700)
    assert arrays().get("asked") is not None


@pytest.mark.skipif(sys.platform == "win32", reason="of POSIX's modes")
def test_the_folder_is_made_for_its_user_alone(folder: Path) -> None:
    before = os.umask(0)
    try:
        arrays().put("asked", VALUES)
    finally:
        os.umask(before)
    assert [place.stat().st_mode & 0o777 for place in (folder, folder / "kind")] == [0o700] * 2


def test_off_keeps_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, "off")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "caches"))
    arrays().put("asked", VALUES)
    assert arrays().get("asked") is None
    assert list(tmp_path.iterdir()) == []


def test_tests_share_what_they_solve_until_one_replaces_something(shared_cache: str) -> None:
    """pytest replaces attributes of its own, which must not turn the sharing off for good."""
    assert os.environ["SQUEEZEFILM_CACHE"] == shared_cache
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(store, "MOST_LARGE", 6)
        assert os.environ["SQUEEZEFILM_CACHE"] == "off"
    assert os.environ["SQUEEZEFILM_CACHE"] == shared_cache


def test_a_folder_that_cannot_be_written_to_is_no_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "file"
    file.write_text("")
    monkeypatch.setenv(CACHE_VARIABLE, str(file))
    arrays().put("asked", VALUES)
    assert arrays().get("asked") is None


def test_a_write_that_fails_leaves_no_part(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError("no space left")

    monkeypatch.setattr(Path, "replace", full)
    arrays().put("asked", VALUES)
    assert list((folder / "kind").iterdir()) == []


def test_the_older_half_goes_where_there_are_too_many(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store, "MOST_SMALL", 10)
    first = arrays()
    for number in range(12):
        first.put(str(number), np.array([float(number)]))
    for age, file in enumerate((folder / "kind").iterdir()):
        os.utime(file, (1e9 + age, 1e9 + age))
    arrays().put("new", VALUES)
    left = list((folder / "kind").iterdir())
    assert len(left) == 10 // 2 + 1
    assert all(file.stat().st_mtime >= 1e9 + 7 for file in left)


def test_of_large_results_few_are_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(store, "MOST_LARGE", 6)
    kept = arrays(large=True)
    for number in range(20):
        kept.put(str(number), np.array([float(number)]))
    assert len(list((folder / "kind").iterdir())) <= 7
    assert kept.get("19") == [19.0]


def test_in_passing_results_are_read_and_no_large_one_is_kept(folder: Path) -> None:
    kept = arrays(large=True)
    kept.put("mine", VALUES)
    with in_passing():
        kept.put("of many", VALUES)
        assert kept.get("mine") is not None
        # Small, and what a stopped calibration goes on with.
        arrays("numbers").put("asked", VALUES)
    assert kept.get("of many") is None
    assert arrays("numbers").get("asked") is not None
    kept.put("of many", VALUES)
    assert kept.get("of many") is not None
