"""Two rows of a sweep side by side: only what differs, as it stands in the table."""

from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.sweep.report.terminal import compared_rows, show_comparison

TABLE = """voltage_V,speed_m_per_s,relative_friction,reason
10.0,0.1,0.8,
20.0,0.1,0.4,
30.0,0.1,,too much
"""


def test_what_differs_is_told_with_its_ratio(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "sweep.csv").write_text(TABLE)
    found = compared_rows(tmp_path, "1,2")
    assert found == (
        ("voltage_V", "10.0", "20.0", "2"),
        ("relative_friction", "0.8", "0.4", "0.5"),
    )
    assert compared_rows(tmp_path, " 2 , 3 ")[1:] == (
        ("relative_friction", "0.4", "", ""), ("reason", "", "too much", ""),
    )  # fmt: skip
    show_comparison(found)
    show_comparison(compared_rows(tmp_path, "1,1"))
    said = capsys.readouterr().out
    assert all(text in said for text in ("voltage ", "10 V", "20 V"))
    assert "nothing: both rows say the same" in said


@pytest.mark.parametrize("rows", ["1", "0,1", "1,4", "a,b", "1,2,3"])
def test_rows_that_are_none_are_refused(tmp_path: Path, rows: str) -> None:
    (tmp_path / "sweep.csv").write_text(TABLE)
    with pytest.raises(InputError, match="two numbers from 1 to 3"):
        compared_rows(tmp_path, rows)


def test_a_folder_without_a_sweep_is_refused(tmp_path: Path) -> None:
    for folder in (None, tmp_path):
        with pytest.raises(InputError, match="as `out`"):
            compared_rows(folder, "1,2")


def test_a_table_whose_rows_have_other_numbers_of_cells_is_no_sweeps(tmp_path: Path) -> None:
    (tmp_path / "sweep.csv").write_text("a,b\n1,2\n3\n")
    with pytest.raises(InputError, match="no table of a sweep: its rows have different numbers"):
        compared_rows(tmp_path, "1,2")
