"""The verbs that calibrate, predict and score: what they hand on, print and refuse."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from tests.e2e.program import run

from squeezefilm.cli.measure import calibrate, predict_unseen, score
from squeezefilm.measure.calibration.blind import BlindPrediction, Predicted, Score, load_prediction
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.display import load_display

StandsIn = Callable[..., Any]
PLATE = "biet2008-plate"
PREDICTED = Predicted("relative_friction", {"vibration_amplitude": 1.7e-6}, 0.4, (0.3, 0.5), 0.05)
BLIND = BlindPrediction(PLATE, "plates drawn", (PREDICTED,), {}, "abc123")


def test_the_verbs_are_named_as_people_type_them() -> None:
    listed = run("measure", "--help").stdout
    for verb in (calibrate, score):
        assert verb.__name__ in listed
    assert predict_unseen.__name__ not in listed
    assert "predict" in listed


@dataclass(frozen=True)
class Found:
    """Stands for a `FolderCalibration`."""

    fits: bool
    left_out: tuple[str, ...] = ()

    @property
    def calibration(self) -> Found:
        return self

    def summary(self) -> dict[str, Any]:
        return {"fits": self.fits}


@pytest.mark.parametrize("fits", [True, False])
def test_a_calibration_that_does_not_fit_ends_with_1(
    fits: bool, stands_in: StandsIn, tmp_path: Path
) -> None:
    found, alone = Found(fits), tmp_path / "c.toml"
    asked = stands_in("measure.calibration.folder:calibrate_display", found)
    shown = stands_in("measure.report.calibration_page:show_calibration", None, tells=False)
    drawn = stands_in("measure.report.calibration_page:write_calibration", None, tells=False)
    given = ("measure", "calibrate", PLATE, str(tmp_path), "--out", str(alone))
    done = run(*given, "--seed", "7")
    assert done.returncode == (0 if fits else 1), done.stderr
    assert asked.given[1:] == (tmp_path, alone)
    assert asked.named["seed"] == 7
    assert shown.given == (found,)
    assert not drawn.calls
    assert f"display: {alone}" in done.stdout
    assert json.loads(run(*given, "--json").stdout) == {"fits": fits}


def test_a_calibration_is_written_into_a_folder_with_a_page(
    stands_in: StandsIn, tmp_path: Path
) -> None:
    found, out = Found(fits=True), tmp_path / "calibrated"
    asked = stands_in("measure.calibration.folder:calibrate_display", found)
    stands_in("measure.report.calibration_page:show_calibration", None, tells=False)
    drawn = stands_in(
        "measure.report.calibration_page:write_calibration", out / "calibration.html", tells=False
    )
    done = run("measure", "calibrate", PLATE, str(tmp_path), "--out", str(out))
    assert done.returncode == 0, done.stderr
    assert asked.given[2] == out / "calibrated.toml"
    assert drawn.given == (found, out)
    assert f"page: {out / 'calibration.html'}" in done.stdout.replace("\n", "")
    # A file in the folder's place is refused before anything is computed.
    (tmp_path / "taken").write_text("")
    refused = run("measure", "calibrate", PLATE, str(tmp_path), "--out", str(tmp_path / "taken"))
    assert refused.returncode == 2
    assert len(asked.calls) == 1


def test_a_prediction_is_told_with_its_hash(stands_in: StandsIn, tmp_path: Path) -> None:
    asked = stands_in("measure.calibration.blind:predicted", BLIND)
    out = tmp_path / "p.json"
    ask = ("--ask", "relative_friction: vibration_amplitude=1.7 um", "--ask", "mass")
    done = run("measure", "predict", PLATE, *ask, "--out", str(out))
    assert done.returncode == 0, done.stderr
    assert asked.given[1] == [
        Observation("relative_friction", 0.0, 0.0, {"vibration_amplitude": 1.7e-6}),
        Observation("mass", 0.0, 0.0, {}),
    ]
    assert "vibration_amplitude 1.7e-06: 0.4 (0.3 to 0.5, 90 %)" in done.stdout.replace("\n", " ")
    assert f"SHA-256 {load_prediction(out).sha256}" in done.stdout
    refused = run("measure", "predict", PLATE, "--ask", "mass: wind=1 m", "--out", str(out))
    assert refused.returncode == 2
    assert "no condition" in refused.stderr


def test_a_score_is_kept_with_the_display_where_that_is_asked(
    stands_in: StandsIn, tmp_path: Path
) -> None:
    seen = Observation("relative_friction", 0.41, 0.03, {"vibration_amplitude": 1.7e-6})
    scored = ((Score(PREDICTED, seen, -0.01, True, 1.2),), ("a.csv: torn",))
    asked = stands_in("measure.calibration.folder:score_prediction", scored)
    kept = stands_in("measure.calibration.blind:keep_scores", None, tells=False)
    done = run("measure", "score", str(tmp_path / "p.json"), str(tmp_path), PLATE, "--keep")
    assert done.returncode == 0, done.stderr
    assert asked.given == (tmp_path / "p.json", tmp_path, load_display(PLATE))
    assert kept.given[:2] == (PLATE, tmp_path / "p.json")
    assert "inside the 90 % interval" in " ".join(done.stdout.split())
    assert "left out: a.csv: torn" in done.stdout
