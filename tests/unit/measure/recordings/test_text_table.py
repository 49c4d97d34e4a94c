"""Tables of text as they are found in the world: separators, decimals, names, and what is amiss."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import ConfigError
from squeezefilm.measure.recordings.files.raw_table import RawTable
from squeezefilm.measure.recordings.files.text_table import read_text_table


def table_of(text: str | bytes, folder: Path, **told: Any) -> RawTable:
    file = folder / "table.txt"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    said: Any = {"header": None, "delimiter": None, "decimal": None, **told}
    return read_text_table(file, SimpleNamespace(**said) if told else None)


ROWS = np.array([[1.0, 2.5], [3.0, -4.5e-3], [5.0, 6.0]])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1,2.5\n3,-4.5e-3\n5,6\n", "commas between the columns, decimals after a point"),
        ("1;2,5\n3;-4,5e-3\n5;6\n", "semicolons between the columns, decimals after a comma"),
        ("1\t2.5\r\n3\t-4.5E-3\r\n5\t6\r\n", "tabs between the columns, decimals after a point"),
        (" 1  2.5\r 3 -4.5e-3\r 5 6\r", "blanks between the columns, decimals after a point"),
        ('"1","2.5"\n"3","-0.0045",\n5,6,\n', "commas between the columns, decimals after a point"),
    ],
)
def test_the_notation_is_found_out(text: str, words: str, tmp_path: Path) -> None:
    table = table_of(text, tmp_path)
    np.testing.assert_array_equal(table.values, ROWS)
    assert table.format == f"text, {words}"
    assert table.names == ("", "")
    assert table.header_line is None
    assert (table.notes, table.doubts) == ((), ())
    assert table.lines is not None
    assert table.lines.tolist() == [1, 2, 3]


NUMBERS = "1,2\n3,4\n5,6\n"


@pytest.mark.parametrize(
    ("head", "told", "line", "names"),
    [
        ("f,u\n", {}, 1, ("f", "u")),
        ("\n\nf,u\n\n", {}, 3, ("f", "u")),
        ("# 'f', \"u\"\n", {}, 1, ("f", "u")),
        ("f,u,\n", {}, 1, ("f", "u")),
        ("a word\nf,u\n", {}, 2, ("f", "u")),
        ("a word\n", {}, None, ("", "")),
        ("f,u,w\n", {}, None, ("", "")),
        ("f,u\nHz,mV\n", {}, 2, ("f (Hz)", "u (mV)")),
        ("f,u\n[Hz],(mV)\n", {}, 2, ("f (Hz)", "u (mV)")),
        ("f,u,w\nHz,mV\n", {}, 2, ("Hz", "mV")),
        ("Hz,mV\n", {}, 1, ("Hz", "mV")),
        ("f,u\na,b\n", {"header": 1}, 1, ("f", "u")),
        ("f,u\na,b\n", {"header": 2}, 2, ("a", "b")),
        ("f,u\n", {"header": 0}, None, ("", "")),
    ],
)
def test_names_are_those_of_the_line_above_or_told(
    head: str, told: dict[str, int], line: int | None, names: tuple[str, str], tmp_path: Path
) -> None:
    table = table_of(head + NUMBERS, tmp_path, **told)
    assert (table.header_line, table.names) == (line, names)
    np.testing.assert_array_equal(table.values, np.arange(1.0, 7.0).reshape(3, 2))


@pytest.mark.parametrize(
    ("head", "names"),
    [
        ('"of a wave" "of a plate"\n', ("of a wave", "of a plate")),
        ("of a wave  of a plate\n", ("of a wave", "of a plate")),
        ("wave plate\n", ("wave", "plate")),
        ("wave\tplate\n", ("wave", "plate")),
        ("of wave plate\n", ("", "")),
    ],
)
def test_names_between_blanks(head: str, names: tuple[str, str], tmp_path: Path) -> None:
    assert table_of(head + NUMBERS.replace(",", " "), tmp_path).names == names


def test_lines_that_are_no_table_are_counted(tmp_path: Path) -> None:
    table = table_of("made by hand\non Monday\n# a comment\nf,u\n" + NUMBERS, tmp_path)
    assert table.notes == ("2 lines before the table were not read as numbers",)
    assert table_of("f,u\n" + NUMBERS, tmp_path).notes == ()
    latin = table_of(b"f in \xb0C,u\n" + NUMBERS.encode(), tmp_path)
    assert latin.names[0] == "f in °C"
    assert latin.notes == ("the file is no UTF-8 text and was read as Latin-1",)
    for data in (("f,u\n" + NUMBERS).encode("utf-16"), b"\xef\xbb\xbff,u\n" + NUMBERS.encode()):
        assert table_of(data, tmp_path).names == ("f", "u")


@pytest.mark.parametrize(
    ("text", "doubted"),
    [
        ("1.25,2.5\n3.25,4.5\n5.25,6", True),
        ("1.25,2.5\n3.25,4.5\n5.25,6\n", False),
        ("1.25,2.5\n3.25,4.5\n5.25,6.5", False),
        ("1.25,2.5\n5.25,6", False),
    ],
)
def test_a_last_row_without_an_end_may_be_cut(text: str, doubted: bool, tmp_path: Path) -> None:
    doubts = table_of(text, tmp_path).doubts
    assert [doubt[:24] for doubt in doubts] == ["the last row (line 3) is"] * doubted


@pytest.mark.parametrize(
    ("text", "told", "words", "line", "column"),
    [
        ("f,u\n1,2\n3,4,5\n6,7\n", {}, "has 3 cells where .* have 2; mend the row", 3, 3),
        ("1,2\n3,4\n5\n", {}, "has 1 cells .*: the file ends within a row", 3, 1),
        ("1,2\n3,4\n5\n6,7\n", {}, "has 1 cells .*; mend the row", 3, 1),
        ("1,2\n3,x\n6,7\n", {}, "'x' is no number; mend it", 2, 2),
        ("1,2\n3," + 50 * "x" + "\n6,7\n", {}, f"'{40 * 'x'}…' is no number", 2, 2),
        ("1,2\n3," + 40 * "x" + "\n6,7\n", {}, f"'{40 * 'x'}' is no number", 2, 2),
        ("1,2\n,4\n6,7\n", {}, "the cell is empty", 2, 1),
        ("1,2\n1_0,4\n6,7\n", {}, "'1_0' is no number", 2, 1),
        ("1;2.5\n3;4,5\n6;7.5\n", {}, "decimals after ',', and other rows after '.'", 2, 2),
        ("1;2,5\n3;4.5\n6;7,5\n", {}, "decimals after '.', and other rows after ','", 2, 2),
        ("a,b\n1,2,3,4\n5,6,7,8\n", {}, "has 4 cells where the header above has 2", 2, 3),
        ("1,x\n" + NUMBERS, {}, "'x' stands beside a number, above the first row", 1, 2),
        ("f,u\n" + NUMBERS, {"header": 2}, "header = 2, and the first row .* line 2", None, None),
        ("f,u\n" + NUMBERS, {"header": -1}, "header = -1, and the first", None, None),
        ("f,u,w\n" + NUMBERS, {"header": 1}, "header has 3 cells, and the rows have 2", 1, None),
        ("words\nalone\n", {}, "no line with two numbers or more; give", 1, None),
        (NUMBERS, {"delimiter": "tab"}, "two numbers or more as delimiter and decimal", 1, None),
        (NUMBERS, {"decimal": ","}, "two numbers or more as delimiter and decimal", 1, None),
        ("1,2\n3,\0\n", {}, "bytes that no text has", None, None),
        ("f,u\n" + 2000 * "1,2\n" + "3,\0\n", {}, "holds a NUL", 2002, None),
        ("", {}, "no line with two numbers", None, None),
    ],
)
def test_what_is_amiss_is_told_with_its_place(
    text: str,
    told: dict[str, Any],
    words: str,
    line: int | None,
    column: int | None,
    tmp_path: Path,
) -> None:
    with pytest.raises(ConfigError, match=words) as caught:
        table_of(text, tmp_path, **told)
    assert (caught.value.line, caught.value.column) == (line, column)
