"""`squeezefilm study simulate` as a person uses it."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from tests.e2e.program import run

from squeezefilm.core import presets

DESIGN = """
name = "two-gratings"
title = "Two gratings on one display"
task = "match-to-sample"
displays = ["biet2008-stator"]
repetitions = 4

[[stimuli]]
name = "2 mm"
spatial_period = "2 mm"
period_means = "period"

[[stimuli]]
name = "4 mm"
spatial_period = "4 mm"
period_means = "period"

[[alternatives]]
name = "2 mm"
spatial_period = "2 mm"
period_means = "period"

[[alternatives]]
name = "4 mm"
spatial_period = "4 mm"
period_means = "period"
"""


def files(folder: Path) -> tuple[Path, Path]:
    design, observer = folder / "design.toml", folder / "observer.toml"
    design.write_text(DESIGN)
    text = presets.resolve("fingertip", "observer").read_text()
    assert "finger_classes = { value = 6" in text
    observer.write_text(
        text.replace("finger_classes = { value = 6", "finger_classes = { value = 1")
    )
    return design, observer


@pytest.mark.slow
def test_tables_are_written_labelled_and_come_back_from_the_seed(tmp_path: Path) -> None:
    design, observer = files(tmp_path)
    arguments = ("study", "simulate", design, "--observer", observer, "--participants", "5")
    out = tmp_path / "out"
    done = run(*arguments, "--seed", "7", "--out", out, "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["origin"] == "simulated"
    assert found["rows"] == found["columns"] == ["2 mm", "4 mm"]
    counts = np.array(found["confusion"]["biet2008-stator"])
    assert counts.sum(axis=0).tolist() == [20, 20]
    assert found["proportion_correct"]["biet2008-stator"] == np.trace(counts) / 40

    written = json.loads((out / "simulated.json").read_text())
    assert written["confusion"] == found["confusion"]
    with (out / "trials.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    again = np.zeros((2, 2), dtype=int)
    for row in rows:
        assert row["origin"] == "simulated"
        again[found["rows"].index(row["choice"]), found["columns"].index(row["stimulus"])] += 1
    assert np.array_equal(again, counts)
    page = (out / "index.html").read_text()
    assert "simulated" in page
    assert "no person answered" in page
    assert (out / "biet2008-stator" / "index.html").exists()

    text = run(*arguments, "--seed", "7")
    assert text.returncode == 0, text.stderr
    assert "SIMULATED" in text.stdout
    assert all(f"({count})" in text.stdout for count in counts.ravel())


def test_a_design_without_gratings_is_refused(tmp_path: Path) -> None:
    done = run("study", "simulate", "no-such-study")
    assert done.returncode != 0
    assert "biet2008-gratings" in done.stderr


@pytest.mark.slow
def test_power_grows_with_people_and_names_its_assumptions(tmp_path: Path) -> None:
    design, observer = files(tmp_path)
    arguments = ("study", "power", design, "2 mm", "4 mm", "--observer", observer)
    done = run(*arguments, "--studies", "50", "--out", tmp_path / "power.png", "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    curve = found["curve"]
    assert found["origin"] == "simulated"
    assert curve["power"][-1] >= curve["power"][0]
    # Period and twice the period, four answers each: nobody needs dozens of people for that.
    assert curve["needed"] is not None
    assert curve["needed"] <= 12
    assert (tmp_path / "power.png").read_bytes().startswith(b"\x89PNG")
    wrong = run("study", "power", design, "2mm", "4 mm")
    assert wrong.returncode == 2
    assert "Did you mean '2 mm'" in wrong.stderr
