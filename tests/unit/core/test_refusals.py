"""What the core refuses to read or write, in a word of each message."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.config.load import load_text
from squeezefilm.core.config.schema import text_of
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.formats.traces import Table, table_from_csv
from squeezefilm.core.presets import path as preset_path
from squeezefilm.core.results import write_named


@dataclasses.dataclass(frozen=True)
class Named:
    name: str = "a"
    length: si.Metre = 1e-3


@dataclasses.dataclass(frozen=True)
class Loose:
    bare: object = 1.5


DEEP = ".".join(["a"] * 60)


def nested(depth: int) -> str:
    return "name = " + "[" * depth + "]" * depth


@pytest.mark.parametrize(
    ("build", "word"),
    [
        (lambda: load_text(Named, nested(120)), "nested"),
        # A table's head may be as deep as its keys again: each alone is read.
        (lambda: load_text(Named, f"[{DEEP}]\n{DEEP} = 1"), "is nested 120 deep; at most"),
        (lambda: load_text(Named, 'length = { value = "1 mm", source = 3 }'), "no text"),
        (lambda: text_of(Named("\ud800")), "half a character"),
        (lambda: text_of("a"), "no dataclass"),
        (lambda: text_of(Named), "no dataclass"),
        (lambda: text_of(Named(length=math.nan)), "not finite"),
        (lambda: text_of(Loose(2.5)), "no unit or no place"),
        (lambda: Table({}), "at least one column"),
        (lambda: preset_path("biet2008"), "no preset 'biet2008'"),
        (lambda: preset_path("friction-jn", "study"), "no study 'friction-jn'"),
    ],
)
def test_what_cannot_be_read_or_written_says_so(build: Callable[[], object], word: str) -> None:
    with pytest.raises((InputError, ConfigError), match=word):
        build()


def test_what_lies_in_the_way_is_not_replaced(tmp_path: Path) -> None:
    text = 'name = "a"\n'
    with pytest.raises(InputError, match="is a directory"):
        write_named(tmp_path, text)
    file = tmp_path / "mine.toml"
    write_named(file, text)
    with pytest.raises(InputError, match="exists"):
        write_named(file, text)
    write_named(file, 'name = "b"\n', replace=True)
    assert file.read_text() == 'name = "mine"\n'


def test_a_table_that_is_no_csv_names_its_file(tmp_path: Path) -> None:
    file = tmp_path / "t.csv"
    for text, word in (
        ("", "no header"),
        ("a,a\n1,2\n", "a column twice"),
        ("a,b\n1\n", "line 2"),
        ("a\n" + "1" * 200_000 + "\n", "no CSV"),
    ):
        file.write_text(text)
        with pytest.raises(ConfigError, match=word):
            table_from_csv(file)
    file.write_text("a,b\n1,2\n3,4\n")
    assert np.array_equal(table_from_csv(file).columns["b"], [2.0, 4.0])
