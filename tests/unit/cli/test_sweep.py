"""`squeezefilm sweep` as a person types it, on a stator, whose points take milliseconds."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from squeezefilm.cli import app
from squeezefilm.core.errors import InputError
from squeezefilm.design.sweep import sweep as sweeps

STATOR = "biet2008-stator"
ASKED = ["sweep", STATOR, "--vary", "voltage=50 V..100 V:3", "--ask", "relative_friction"]


def run(*arguments: str) -> str:
    done = CliRunner().invoke(app, list(arguments), catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.stdout


@pytest.mark.slow
def test_a_sweep_is_shown_and_written_where_asked(tmp_path: Path) -> None:
    shown = run(*ASKED, "--jobs", "1", "--out", str(tmp_path))
    assert "biet2008-stator: 3 points" in shown
    assert "3 answers computed" in shown
    assert f"page: {tmp_path / 'index.html'}" in shown.replace("\n", "")
    again = json.loads(run(*ASKED, "--jobs", "1", "--out", str(tmp_path), "--json"))
    assert (again["answers_computed"], again["answers_kept"]) == (0, 3)
    assert [row["voltage_V"] for row in again["rows"]] == [50.0, 75.0, 100.0]


def test_a_sweep_is_under_the_finger_asked_for(tmp_path: Path) -> None:
    one = ["sweep", STATOR, "--vary", "voltage=50 V", "--ask", "relative_friction", "--jobs", "1"]
    found = json.loads(run(*one, "--finger", "mean", "--json"))
    assert found["provenance"]["finger"].startswith("the mean of people")
    assert "Finger: a new person's, as described" in run(*one)


def test_all_answers_are_listed_without_a_display() -> None:
    assert "relative_friction" in run("sweep", "--answers")


def test_a_sweep_without_a_display_or_with_another_table_is_refused() -> None:
    for arguments, message in (
        (["sweep", "--ask", "relative_friction"], "needs a display"),
        ([*ASKED, "--table", "xlsx"], "csv or parquet"),
    ):
        with pytest.raises(InputError, match=message):
            CliRunner().invoke(app, arguments, catch_exceptions=False)


@pytest.mark.slow
def test_samples_are_drawn_and_what_no_other_beats_is_on_the_page(tmp_path: Path) -> None:
    varied = ["--vary", "voltage=20 V..100 V:log", "--vary", "speed=20 mm/s..0.2 m/s"]
    wanted = ["--ask", "relative_friction,vibration_amplitude"]
    asked = ["sweep", STATOR, *varied, *wanted, "--jobs", "1", "--out", str(tmp_path)]
    found = json.loads(run(*asked, "--sample", "10", "--json"))
    assert len(found["rows"]) == 10
    more = json.loads(
        run(*asked, "--sample", "16", "--json", "--less", "relative_friction,vibration_amplitude")
    )
    assert (more["answers_computed"], more["answers_kept"]) == (6, 10)
    assert more["rows"][:10] == found["rows"]
    page = (tmp_path / "index.html").read_text()
    assert "Points that no other beats" in page
    assert "of 16 points; rows are those of the table" in page
    assert "share" in page.lower()
    with pytest.raises(InputError, match="--more lag was not asked for"):
        CliRunner().invoke(app, [*asked, "--more", "lag"], catch_exceptions=False)


def test_one_that_is_stopped_says_so_and_ends_as_interrupted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*_: object, **__: object) -> object:
        raise KeyboardInterrupt

    monkeypatch.setattr(sweeps, "workers", stopped)
    for options, hint in ((["--out", str(tmp_path)], "the same command goes on"),
                          ([], "add --out DIR to keep what is done")):  # fmt: skip
        done = CliRunner().invoke(app, [*ASKED, *options], catch_exceptions=False)
        assert done.exit_code == 130
        assert f"stopped, 3 points are missing; {hint}" in done.output
