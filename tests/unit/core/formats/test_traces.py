"""Tables in CSV and Parquet: every float comes back, metadata too; what is broken has its line."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.unit.core.formats.read_parquet import table_in_parquet

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.formats.traces import (
    Table,
    csv_text,
    parquet_bytes,
    table_from_csv,
)

META = {"config_sha256": "ab", "squeezefilm_version": "1", "seed": 4, "created_utc": "2026"}


def same(a: Table, b: Table) -> bool:
    return a.metadata == b.metadata and list(a.columns) == list(b.columns) and all(
        np.array_equal(a.column(name), b.column(name), equal_nan=True) for name in a.columns
    )  # fmt: skip


@given(st.lists(st.floats(allow_infinity=False), min_size=1, max_size=30))
def test_every_float_comes_back(values: list[float]) -> None:
    import tempfile

    column = np.array(values)
    table = Table({"time_s": np.arange(column.size) / 3, "position_m": column}, META)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "t.csv").write_text(csv_text(table), encoding="utf-8")
        assert same(table_from_csv(Path(folder) / "t.csv"), table)
        assert same(table_in_parquet(parquet_bytes(table)), table)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "has no header"),
        ("# {}\n", "has no header"),
        ("time_s,x_m\n0,1\n1,two\n", r"line 3: x_m: 'two' is no number"),
        ("time_s,x_m\n0,1\n1\n", r"line 3: has 1 cells where the header has 2"),
        ("time_s,x_m\n0,1\n\n2,3\n", r"line 3: has 0 cells"),
        ("time_s,time_s\n0,1\n", r"line 1: names a column twice"),
        ("# {}\ntime_s,x m\n0,1\n", r"line 2: 'x m' is no name"),
        ("time_s\ninf\n", "infinity"),
        ("time_s\n" + "1" * 140_000, "line 2: is no CSV: field larger"),
    ],
)
def test_what_is_broken_is_located(text: str, says: str, tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text(text)
    with pytest.raises(ConfigError, match=says):
        table_from_csv(tmp_path / "t.csv")


def test_another_comment_is_kept_as_text(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("# from the lab\nx_m\n1\n")
    assert table_from_csv(tmp_path / "t.csv").metadata == {"comment": "from the lab"}


def test_files_that_are_none_are_refused(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_bytes(b"x_m\n\xff\n")
    with pytest.raises(ConfigError, match="UTF-8"):
        table_from_csv(tmp_path / "t.csv")
    with pytest.raises(ConfigError, match="cannot be read"):
        table_from_csv(tmp_path / "none.csv")
    with pytest.raises(InputError, match="arrays of equal length"):
        Table({"a": np.zeros(2), "b": np.zeros(3)})


@given(st.text(alphabet="=+-@,;\t\r\n\"'\\\\ab# {}[]:", max_size=30))
def test_no_text_of_the_metadata_becomes_a_formulas_cell(text: str) -> None:
    import csv
    import io
    import tempfile

    table = Table({"time_s": np.array([-1.5, 2.0])}, {"title": text, text: ["=1", text]})
    written = csv_text(table)
    for separator in ",;\t":
        for row in csv.reader(io.StringIO(written), delimiter=separator):
            for cell in row:
                assert cell.lstrip()[:1] not in ("=", "+", "@")
                assert not cell.lstrip().startswith("-") or float(cell.split(",")[0]) < 0
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "t.csv").write_text(written, encoding="utf-8", newline="")
        assert same(table_from_csv(Path(folder) / "t.csv"), table)
