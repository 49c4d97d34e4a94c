from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import Any

import pytest

from squeezefilm.core.errors import InputError, SqueezefilmWarning
from squeezefilm.design.sweep.points import Lines


def read(file: Path) -> list[Any]:
    found: list[Any] = []
    Lines(file).read(lambda one: found.append(one["n"]))
    return found


def test_lines_are_read_as_they_were_appended(tmp_path: Path) -> None:
    file = tmp_path / "new" / "lines.jsonl"
    assert read(file) == []
    lines = Lines(file)
    lines.append([{"n": 1}, {"n": "µ"}])
    lines.append([])
    Lines(file).append([{"n": 3}])
    assert read(file) == [1, "µ", 3]


def test_a_line_that_was_cut_off_is_passed_over_and_swallows_none(tmp_path: Path) -> None:
    file = tmp_path / "lines.jsonl"
    lines = Lines(file)
    lines.append([{"n": 1}, {"n": 2}])
    file.write_bytes(file.read_bytes()[:-5])
    lines.append([{"n": 3}, {"other": 4}])
    file.write_bytes(file.read_bytes() + b"7\n")
    assert read(file) == [1, 3]


BOMB = b"[" * 200_000


@pytest.mark.parametrize("damage", [BOMB, b"\xff\xfe", b'{"n":4,"check":"00000000"}'])
def test_a_damaged_line_is_named_and_set_aside(damage: bytes, tmp_path: Path) -> None:
    """Once: the file is then as if the line had not been there, and goes on."""
    file = tmp_path / "lines.jsonl"
    lines = Lines(file)
    lines.append([{"n": 1}])
    file.write_bytes(file.read_bytes() + damage + b"\n")
    lines.append([{"n": 3}])
    with pytest.warns(SqueezefilmWarning, match=r"damaged lines \(3\) are set aside"):
        assert read(file) == [1, 3]
    assert (tmp_path / "lines.jsonl.damaged").read_bytes() == damage + b"\n"
    assert read(file) == [1, 3]


def test_any_changed_byte_of_a_line_is_found(tmp_path: Path) -> None:
    """What is read is what was written, or nothing."""
    file = tmp_path / "lines.jsonl"
    Lines(file).append([{"n": 1234}, {"n": 5}])
    written = file.read_bytes()
    for position in range(1, 26):
        data = bytearray(written)
        data[position] ^= 1
        file.write_bytes(data)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SqueezefilmWarning)
            assert read(file) == [5], position


@pytest.mark.skipif(os.name == "nt", reason="no pipes with names")
def test_a_pipe_a_device_and_a_folder_are_refused(tmp_path: Path) -> None:
    for name, make in (
        ("pipe", os.mkfifo),
        ("device", lambda path: path.symlink_to("/dev/zero")),
        ("folder", Path.mkdir),
    ):
        make(tmp_path / name)
        with pytest.raises(InputError, match=f"{name}: cannot be read"):
            read(tmp_path / name)


def test_a_folder_that_cannot_be_used_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="choose another folder"):
        read(tmp_path / "file" / "lines.jsonl")
    lines = Lines(tmp_path / "gone" / "lines.jsonl")
    with pytest.raises(InputError, match="goes on from there"):
        lines.append([{"n": 1}])
