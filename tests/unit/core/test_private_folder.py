"""A folder in which others can write is told from one's own, and said once."""

import logging
import os
import sys
from pathlib import Path

import pytest

from squeezefilm.core import private_folder
from squeezefilm.core.private_folder import is_shared

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="of POSIX's owners and modes")


@pytest.mark.parametrize(
    ("mode", "shared"), [(0o700, False), (0o755, False), (0o757, True), (0o1777, True)]
)
def test_a_folder_that_everybody_can_write_in_is_shared(
    tmp_path: Path, mode: int, shared: bool
) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    folder.chmod(mode)
    assert is_shared(folder, "NAMED_BY") == shared


def test_it_is_said_once_with_what_to_do(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    folder.chmod(0o777)
    with caplog.at_level(logging.WARNING):
        assert is_shared(folder, "NAMED_BY")
        assert is_shared(folder, "NAMED_BY")
    (record,) = caplog.records
    assert str(folder) in record.message
    assert "everybody can write in it" in record.message
    assert "let NAMED_BY name a folder that is" in record.message


def test_a_folder_of_another_user_is_shared_and_one_of_root_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    owner = tmp_path.stat().st_uid
    monkeypatch.setattr(os, "geteuid", lambda: owner + 1)
    assert is_shared(tmp_path, "NAMED_BY") == (owner != 0)
    assert not is_shared(Path("/"), "NAMED_BY")


def test_the_group_that_is_the_users_own_is_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    folder.chmod(0o770)
    for own in (False, True):
        monkeypatch.setattr(private_folder, "_is_own_group", lambda _, own=own: own)
        assert is_shared(folder, "NAMED_BY") != own
    monkeypatch.undo()
    # No group has this number.
    assert not private_folder._is_own_group(2**31 - 7)


def test_what_is_not_there_is_not_shared(tmp_path: Path) -> None:
    assert not is_shared(tmp_path / "gone", "NAMED_BY")
