"""The preset of shapes from its plan to its pages: every verb, simulated people of one finger."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from tests.e2e.program import run as program

from squeezefilm.core.presets import resolve
from squeezefilm.physics.perception.observer import load_observer


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A rehearsed file of the preset, with an observer of a single finger class."""
    folder = tmp_path_factory.mktemp("shapes")
    text = Path(resolve("fingertip", "observer")).read_text(encoding="utf-8")
    lines = [
        "finger_classes = 1" if one.startswith("finger_classes") else one
        for one in text.splitlines()
    ]
    (folder / "one.toml").write_text("\n".join(lines), encoding="utf-8")
    assert load_observer(folder / "one.toml").finger_classes == 1
    done = program(
        "study", "rehearse", "shapes-match", "--store", "s.sqlite", "--participants", "2",
        "--observer", "one.toml", cwd=folder,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.slow
def test_answers_are_analysed(place: Path) -> None:
    done = program("study", "analyze", "s.sqlite", "--out", "pages", cwd=place)
    assert done.returncode == 0, done.stderr
    found = json.loads((place / "pages/biet2008-plate/identification.json").read_text())
    assert found["origin"] == "simulated participants"
    assert found["trials"] == 72
    assert found["sensitivity"] is None
    assert any("no order" in note for note in found["notes"])
    # Nothing is known of how they explored.
    assert found["exploration"] == {}
    page = (place / "pages/biet2008-plate/index.html").read_text()
    assert "surfaces known from before" in page


@pytest.mark.slow
@pytest.mark.parametrize("form", ["csv", "psych-ds"])
def test_exports_name_surfaces(place: Path, form: str) -> None:
    done = program("study", "export", "s.sqlite", "--format", form, "--out", form, cwd=place)
    assert done.returncode == 0, done.stderr
    pattern = {
        "csv": "*_trials.csv",
        "psych-ds": "data/*match*_data.csv",
    }
    (file, *_) = sorted((place / form).glob(pattern[form]))
    with file.open(newline="") as text:
        rows = list(csv.DictReader(text))
    hashes = {row["stimulus"]: row["stimulus_surface_sha256"] for row in rows}
    assert len(hashes) == len(set(hashes.values())) == 6
    assert {len(one) for one in hashes.values()} == {64}
    disc = next(row for row in rows if row["stimulus"] == "disc")
    assert disc["stimulus_period_m"] == ""
    assert disc["coverage"] == ""


@pytest.mark.slow
def test_simulated_people_tell_the_surfaces_apart_better_than_by_guessing(place: Path) -> None:
    done = program(
        "study", "simulate", "shapes-match", "--participants", "12", "--observer", "one.toml",
        "--json", "--out", "sim", cwd=place,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)["displays"]["biet2008-plate"]
    share = np.array(found["confusion_percent"])
    assert found["proportion_correct"] > 2 / 6
    # Grooves across and along feel alike but for their direction, which the hand tells.
    assert share[0, 0] > 2 * share[1, 0]
    assert share[1, 1] > 2 * share[0, 1]
    assert "plain hand" in (place / "sim/index.html").read_text()
