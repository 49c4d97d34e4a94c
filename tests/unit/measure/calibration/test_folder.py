"""A folder of recordings at the front door: calibrated, predicted, scored, and what is left out."""

from __future__ import annotations

import hashlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import squeezefilm as sf
from squeezefilm.core.calibration_record import UsedRecording
from squeezefilm.core.errors import InputError
from squeezefilm.measure.calibration import blind
from squeezefilm.measure.calibration import folder as calibrated_folder
from squeezefilm.measure.calibration.folder import FolderObservations, folder_observations
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.display import Display, load_display

PLATE, STATOR = "biet2008-plate", "biet2008-stator"
Q = 60.0


def ring_down(folder: Path, name: str = "ring") -> Path:
    """A made-up ring-down of 30 kHz and Q 60, with a little noise."""
    time = np.arange(2000) / 1e6
    random = np.random.default_rng(1)
    decay = np.exp(-np.pi * 30e3 * time / Q)
    motion = 1e-6 * decay * np.cos(2 * np.pi * 30e3 * time) + random.normal(0, 1e-9, time.size)
    data = folder / f"{name}.csv"
    folder.mkdir(parents=True, exist_ok=True)
    np.savetxt(data, np.column_stack([time, motion]), delimiter=",", header="t,w", comments="")
    data.with_suffix(".toml").write_text(
        'kind = "ring-down"\nname = "made up"\nsource = "made up"\n'
        'who = "A. Builder"\nwhen = "2026-11-01"\n'
        '[columns]\ntime = { column = "t", unit = "s" }\n'
        'displacement = { column = "w", unit = "m" }\n'
    )
    return data


def test_observations_know_their_recording_and_recordings_their_file(tmp_path: Path) -> None:
    data = ring_down(tmp_path)
    (tmp_path / "torn.toml").write_text('kind = "impedance"\n')
    found = folder_observations(load_display(STATOR), tmp_path, lambda _: None)
    assert {one.answer for one in found.observations} == {"resonance_frequency", "quality_factor"}
    assert {one.recording for one in found.observations} == {"ring.csv"}
    (used,) = found.recordings
    assert used == UsedRecording(
        "ring.csv", "ring-down", "A. Builder", "2026-11-01", "", "made up",
        hashlib.sha256(data.read_bytes()).hexdigest(),
    )  # fmt: skip
    assert any(one.startswith("torn") for one in found.left_out)


def test_a_calibration_takes_names_and_writes_what_it_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ring_down(tmp_path / "bench")
    asked: dict[str, Any] = {}

    def calibrate(display: Display, observations: Any, **named: Any) -> str:
        asked.update(named, display=display.name, answers=[one.answer for one in observations])
        return "found"

    monkeypatch.setattr(calibrated_folder, "calibrate", calibrate)
    monkeypatch.setattr(
        calibrated_folder, "write_calibrated", lambda found, out, used: Path(f"{out}-{len(used)}")
    )
    found = sf.calibrate_display(PLATE, tmp_path / "bench", "c.toml", seed=3)
    assert (found.calibration, found.file, found.left_out) == ("found", Path("c.toml-1"), ())
    assert asked["display"] == PLATE
    assert asked["seed"] == 3
    assert asked["answers"] == ["resonance_frequency", "quality_factor"]
    assert sf.calibrate_display(PLATE, tmp_path / "bench").file is None
    with pytest.raises(sf.SqueezefilmError, match="Did you mean 'biet2008-plate'"):
        sf.calibrate_display("biet2008-plat", tmp_path / "bench")


def test_a_folder_without_anything_to_use_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        calibrated_folder,
        "folder_observations",
        lambda *_: FolderObservations((), (), ("a.csv: torn",)),
    )
    with pytest.raises(InputError, match=r"nothing that a calibration can use: a\.csv: torn"):
        sf.calibrate_display(STATOR, tmp_path)


def test_a_measurement_is_predicted_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(
        blind, "predict_blind", lambda *given, **named: asked.append((given, named))
    )
    sf.predict_measurement(STATOR, "relative_friction: vibration_amplitude=1.7 um", "p.json")
    sf.predict_measurement(STATOR, ["mass", "quality_factor"], "p.json", seed=4)
    (display, first, out), named = asked[0]
    assert (display.name, out, named["seed"]) == (STATOR, "p.json", 1)
    assert first == [Observation("relative_friction", 0.0, 0.0, {"vibration_amplitude": 1.7e-6})]
    assert [one.answer for one in asked[1][0][1]] == ["mass", "quality_factor"]


@pytest.mark.slow
def test_a_prediction_is_scored_on_a_folder_made_since(tmp_path: Path) -> None:
    file = tmp_path / "p.json"
    ask = "relative_friction: vibration_amplitude=1 um"
    made = sf.predict_measurement(STATOR, ask, file)
    ring_down(tmp_path / "later")
    with pytest.raises(InputError, match="nothing that was measured"):
        sf.score_prediction(file, tmp_path / "later", STATOR)
    median = made.predictions[0].median
    seen = (
        Observation("relative_friction", median, 0.02, {"vibration_amplitude": 1e-6}, "a.csv"),
        Observation("relative_friction", 0.4, 0.02, {"vibration_amplitude": 2e-6}, "a.csv"),
        Observation("mass", 0.1, 1e-3, {}, "c.csv"),
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            calibrated_folder, "folder_observations",
            lambda *_: SimpleNamespace(observations=seen, left_out=("b.csv: torn",)),
        )  # fmt: skip
        (score,), left_out = sf.score_prediction(file, tmp_path, STATOR)
    assert score.inside
    assert score.error == 0
    assert left_out == (
        "b.csv: torn",
        "a.csv, its relative friction: predicted under other conditions",
        "c.csv, its mass: not predicted",
    )
    # A prediction that was changed is refused before the data are opened.
    file.write_text(file.read_text().replace('"median": 0.', '"median": 0.1'))
    with pytest.raises(InputError, match="changed after it was written"):
        sf.score_prediction(file, tmp_path / "none", STATOR)
