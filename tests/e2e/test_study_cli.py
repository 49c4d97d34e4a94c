"""A study from plan to export as a person runs it, at the command line."""

from __future__ import annotations

import csv
import io
import json
from collections import Counter
from pathlib import Path

import pytest
from tests.e2e import program
from tests.e2e.program import Done, run_program

DESIGN = """
name = "tiny"
title = "Two gratings"
task = "match-to-sample"
displays = ["biet2008-plate"]
familiarisation = 1
practice = 1
repetitions = 2
break_between_blocks = "0 s"

[[stimuli]]
name = "2 mm"
spatial_period = "2 mm"
period_means = "period"

[[stimuli]]
name = "8 mm"
spatial_period = "8 mm"
period_means = "period"

[[alternatives]]
name = "2 mm"
spatial_period = "2 mm"
period_means = "period"

[[alternatives]]
name = "8 mm"
spatial_period = "8 mm"
period_means = "period"
"""


def run(*arguments: str | Path, cwd: Path, keys: str = "") -> Done:
    """A verb of `study`; who types keys has a program of their own."""
    return (run_program if keys else program.run)("study", *arguments, cwd=cwd, keys=keys)


def test_a_plan_says_what_it_takes(tmp_path: Path) -> None:
    done = run("plan", "biet2008-gratings", "--seed", "7", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["trials_by_phase"] == {"familiarisation": 20, "main": 100}
    assert found["duration_per_participant_s"] == 120 * 20 + 3 * 120
    assert [one["spatial_period_m"] for one in found["stimuli"]] == [4e-4, 2e-3, 4e-3, 8e-3, 1e-2]
    assert "repetitions" in found["assumed"]
    shown = run("plan", "biet2008-gratings-as-widths", cwd=tmp_path)
    assert "groove width" in shown.stdout
    assert "20 mm" in shown.stdout


@pytest.mark.slow
def test_a_study_is_run_interrupted_resumed_exported_merged_and_forgotten(tmp_path: Path) -> None:
    (tmp_path / "tiny.toml").write_text(DESIGN, encoding="utf-8")
    start = ("run", "tiny.toml", "--store", "a.sqlite", "--consent", "--drive", "none")
    # Two gratings to feel, one practice trial, one answer (after a slip), each once its surface is
    # in place; then a surface is in place, and the input ends.
    first = run(*start, cwd=tmp_path, keys="\n\n\n1\n\n9\n2\n\n")
    assert first.returncode == 130
    assert "Traceback" not in first.stderr
    who = first.stdout.split("participant ")[1].split(":")[0]
    assert "Feel '" in first.stdout
    assert "Answer with a number from 1 to 2." in first.stdout
    assert "Right." in first.stdout or "It was '" in first.stdout
    status = json.loads(run("status", "a.sqlite", "--json", cwd=tmp_path).stdout)
    assert [(one["answered"], one["planned"]) for one in status["participants"]] == [(4, 7)]
    again = run(*start, "--participant", who, cwd=tmp_path, keys="\n2 mm\n\n1\n\n2\n")
    assert again.returncode == 0, again.stderr
    assert "3 trials on biet2008-plate recorded" in again.stdout
    assert "every trial" in run(*start, "--participant", who, cwd=tmp_path).stdout

    done = run("export", "a.sqlite", "--format", "csv", "--out", "csv", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "csv" / "tiny_trials.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(io.StringIO(text)))
    assert [row["trial"] for row in rows] == ["1", "2", "3", "4", "5", "6", "7"]
    assert rows[4]["choice"] == "2 mm"
    assert rows[4]["presentations"] == "2"
    assert {row["participant_id"] for row in rows} == {who}
    assert run("export", "a.sqlite", "--format", "psych-ds", cwd=tmp_path).returncode == 0

    other = ("run", "tiny.toml", "--store", "b.sqlite", "--consent")
    assert run(*other, "--station", "1", "--stations", "2", cwd=tmp_path, keys="\n\n\n1\n").stdout
    merged = run("merge", "a.sqlite", "b.sqlite", cwd=tmp_path)
    assert "1 participants and 3 answers added" in merged.stdout
    assert run("backup", "a.sqlite", cwd=tmp_path).returncode == 0
    kept = run("delete-participant", "a.sqlite", who, cwd=tmp_path, keys="n\n")
    assert kept.returncode != 0
    gone = run("delete-participant", "a.sqlite", who, "--yes", cwd=tmp_path)
    assert gone.returncode == 0, gone.stderr
    assert "7 answers" in gone.stdout
    left = [p for p in tmp_path.rglob("*") if p.is_file() and who.encode() in p.read_bytes()]
    assert left == []


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("plan", "biet2008-grating"), "Did you mean 'biet2008-gratings'"),
        (("run", "tiny.toml", "--store", "a.sqlite"), "consent = true"),
        (
            ("run", "tiny.toml", "--store", "a.sqlite", "--consent", "--drive", "x"),
            "drive = 'x' is not known",
        ),
        (("status", "none.sqlite"), "does not exist"),
        (("status", "tiny.toml"), "no study's file"),
        (("export", "tiny.toml"), "no study's file"),
    ],
)
def test_mistakes_are_one_message(arguments: tuple[str, ...], says: str, tmp_path: Path) -> None:
    (tmp_path / "tiny.toml").write_text(DESIGN, encoding="utf-8")
    done = run(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert says in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.realtime
@pytest.mark.nightly
def test_a_session_on_the_twin_acknowledges_the_ultrasound(tmp_path: Path) -> None:
    (tmp_path / "tiny.toml").write_text(DESIGN, encoding="utf-8")
    start = ("run", "tiny.toml", "--store", "a.sqlite", "--consent", "--drive", "twin")
    refused = run(*start, cwd=tmp_path, keys="no\n")
    assert refused.returncode == 2
    assert "dB above the guidance" in refused.stdout
    assert "was not acknowledged" in refused.stderr
    status = json.loads(run("status", "a.sqlite", "--json", cwd=tmp_path).stdout)
    assert status["participants"] == []
    answers = "\n\n1\n1\n2\n1\n2\n"
    done = run(*start, "--acknowledge-ultrasound", cwd=tmp_path, keys=answers)
    assert done.returncode == 0, done.stderr
    assert "7 trials" in done.stdout
    # Of each surface the trace that studies read, and every tick of the loop.
    traces = Counter(path.suffix for path in (tmp_path / "a.traces").iterdir())
    assert traces == {".csv": 5, ".sqft": 5}
    run("export", "a.sqlite", "--out", "csv", cwd=tmp_path)
    text = (tmp_path / "csv" / "tiny_sessions.csv").read_text(encoding="utf-8")
    (row,) = csv.DictReader(io.StringIO(text))
    assert row["ultrasound_acknowledged"] == row["verified_before"] == "true"
    assert row["verified_after"] == "true"
    # At a quarter of the drive's 15 V.
    assert float(row["amplitude_before_m"]) == pytest.approx(3.75 * 114.8e-9, rel=0.02)
