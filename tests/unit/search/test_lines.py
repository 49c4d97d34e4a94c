from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from squeezefilm.errors import InputError
from squeezefilm.search.lines import Lines


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
    file.write_bytes(file.read_bytes() + b"\xff\xfe\n7\n")
    assert read(file) == [1, 3]


def test_a_folder_that_cannot_be_used_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="choose another folder"):
        read(tmp_path / "file" / "lines.jsonl")
    lines = Lines(tmp_path / "gone" / "lines.jsonl")
    with pytest.raises(InputError, match="goes on from there"):
        lines.append([{"n": 1}])
