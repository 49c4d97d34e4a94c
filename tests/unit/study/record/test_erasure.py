"""Only plain files of our own are read from elsewhere, overwritten and removed."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.study.record import erasure
from squeezefilm.study.record.erasure import (
    erase_file,
    overwrite,
    plain_file,
    read_plain,
    require_plain,
)


def _not_plain(folder: Path) -> dict[str, Path]:
    """What leads to somebody's file, or is none."""
    target = folder / "somebody.txt"
    target.write_text("precious")
    (folder / "target").mkdir()
    (folder / "target" / "file.csv").write_text("precious")
    found = {name: folder / name for name in ("link", "second name", "folder", "pipe", "dangling")}
    found["link"].symlink_to(target)
    found["dangling"].symlink_to(folder / "nothing")
    (folder / "other.txt").write_text("precious")
    os.link(folder / "other.txt", found["second name"])
    found["folder"].mkdir()
    os.mkfifo(found["pipe"])
    (folder / "linked").symlink_to(folder / "target")
    found["in a linked folder"] = folder / "linked" / "file.csv"
    return found


@pytest.mark.skipif(os.name == "nt", reason="Windows has other links, and no pipes in folders")
def test_what_is_no_plain_file_is_neither_read_nor_erased(tmp_path: Path) -> None:
    for what, path in _not_plain(tmp_path).items():
        for do in (erase_file, require_plain, read_plain):
            with pytest.raises(InputError, match="somebody's own"):
                do(path)
        assert os.path.lexists(path), what
    for name in ("somebody.txt", "other.txt", "target/file.csv"):
        assert (tmp_path / name).read_text() == "precious"


def test_a_plain_file_is_overwritten_and_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "trace.csv"
    path.write_bytes(b"secret" * 400_000)
    assert read_plain(path) == b"secret" * 400_000
    kept = path.open("rb")
    monkeypatch.setattr("squeezefilm.study.record.erasure._PIECE", 1000)
    erase_file(path)
    assert not path.exists()
    assert set(kept.read()) == {0}
    kept.close()
    with pytest.raises(InputError, match="cannot be opened"):
        erase_file(path)


def test_as_many_zeros_are_written_as_there_were_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(erasure, "_PIECE", 64)
    for size in (0, 1, 63, 64, 65, 200):
        path = tmp_path / f"{size}"
        path.write_bytes(b"\x01" * size)
        with plain_file(path, os.O_RDWR) as handle:
            overwrite(handle, path)
        assert path.read_bytes() == b"\x00" * size


def test_a_disk_that_refuses_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a"
    path.write_bytes(b"secret")

    def refused(*_: object, **__: object) -> None:
        raise OSError(errno.EIO, "Input/output error")

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", refused)
        with pytest.raises(RecordError, match="could not be overwritten: Input/output error"):
            erase_file(path)
    with monkeypatch.context() as patched:
        patched.setattr(os, "unlink", refused)
        with pytest.raises(RecordError, match="is empty but cannot be removed: Input/output"):
            erase_file(path)
    assert path.read_bytes() == bytes(6)
    erase_file(path)
    assert not path.exists()


def test_a_file_that_is_not_there_cannot_be_opened(tmp_path: Path) -> None:
    for path in (tmp_path / "none", tmp_path / "none" / "a"):
        with pytest.raises(InputError, match="cannot be opened: No such file or directory; see"):
            erase_file(path)
