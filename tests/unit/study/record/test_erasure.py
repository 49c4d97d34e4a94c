"""Only plain files of our own are read from elsewhere, overwritten and removed."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from squeezefilm.errors import InputError
from squeezefilm.study.record.erasure import erase_file, read_plain, require_plain


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
