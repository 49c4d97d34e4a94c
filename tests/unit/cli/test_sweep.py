"""`squeezefilm sweep` as a person types it, on a stator, whose points take milliseconds."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from squeezefilm.cli import app
from squeezefilm.errors import InputError
from squeezefilm.search import sweep as sweeps

STATOR = "biet2008-stator"
ASKED = ["sweep", STATOR, "--vary", "voltage=50 V..100 V:3", "--ask", "relative_friction"]


def run(*arguments: str) -> str:
    done = CliRunner().invoke(app, list(arguments), catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.stdout


def test_a_sweep_is_shown_and_written_where_asked(tmp_path: Path) -> None:
    shown = run(*ASKED, "--jobs", "1", "--out", str(tmp_path))
    assert "biet2008-stator: 3 points" in shown
    assert "3 answers computed" in shown
    assert f"table: {tmp_path / 'sweep.csv'}" in shown.replace("\n", "")
    again = json.loads(run(*ASKED, "--jobs", "1", "--out", str(tmp_path), "--json"))
    assert (again["answers_computed"], again["answers_kept"]) == (0, 3)
    assert [row["voltage_V"] for row in again["rows"]] == [50.0, 75.0, 100.0]


def test_all_answers_are_listed_without_a_display() -> None:
    assert "relative_friction" in run("sweep", "--answers")


def test_a_sweep_without_a_display_or_with_another_table_is_refused() -> None:
    for arguments, message in (
        (["sweep", "--ask", "relative_friction"], "needs a display"),
        ([*ASKED, "--table", "xlsx"], "csv or parquet"),
    ):
        with pytest.raises(InputError, match=message):
            CliRunner().invoke(app, arguments, catch_exceptions=False)


def test_one_that_is_stopped_says_so_and_ends_as_interrupted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*_: object, **__: object) -> object:
        raise KeyboardInterrupt

    monkeypatch.setattr(sweeps, "answered", stopped)
    for options, hint in ((["--out", str(tmp_path)], "the same command goes on"),
                          ([], "add --out DIR to keep what is done")):  # fmt: skip
        done = CliRunner().invoke(app, [*ASKED, *options], catch_exceptions=False)
        assert done.exit_code == 130
        assert f"stopped, 3 points are missing; {hint}" in done.output
