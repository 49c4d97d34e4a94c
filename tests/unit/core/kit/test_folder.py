"""Files of a report: all of them, or what was there before."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.folder import csv_text, json_text, require_folder, write_folder


def test_all_files_are_written_texts_and_bytes(tmp_path: Path) -> None:
    write_folder(tmp_path / "new", {"a.json": "{}\n", "b.png": b"\x89"})
    assert (tmp_path / "new" / "a.json").read_text() == "{}\n"
    assert (tmp_path / "new" / "b.png").read_bytes() == b"\x89"


def test_one_that_cannot_be_written_leaves_all_as_they_were(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text("old")
    (tmp_path / "c.html").mkdir()
    with pytest.raises(InputError, match=r"cannot write .*c\.html"):
        write_folder(tmp_path, {"a.json": "new", "b.png": b"new", "c.html": "new", "d": "new"})
    assert (tmp_path / "a.json").read_text() == "old"
    assert sorted(one.name for one in tmp_path.iterdir()) == ["a.json", "c.html"]


def test_a_file_is_no_folder_and_one_to_come_is(tmp_path: Path) -> None:
    assert require_folder(str(tmp_path / "to come")) == tmp_path / "to come"
    assert require_folder(tmp_path) == tmp_path
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is a file, not a folder; choose another folder"):
        require_folder(tmp_path / "file")


def test_json_has_no_number_that_json_cannot_carry() -> None:
    text = json_text({"µ": np.array([1.0, np.nan]), "n": 2})
    assert json.loads(text) == {"µ": [1.0, None], "n": 2}
    assert text.startswith('{\n "µ": [')
    assert text.endswith("}\n")


def test_a_spreadsheet_takes_no_text_for_a_formula_and_a_number_for_no_text() -> None:
    rows = [("=1+1", "-2.5e-3", -0.1), ("-2+cmd", None, "")]
    assert csv_text(("a", "b", "c"), rows) == "a,b,c\n'=1+1,-2.5e-3,-0.1\n'-2+cmd,,\n"
