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
from squeezefilm.measure.recordings.kinds import FrictionCurve
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
        calibrated_folder, "calibrated_text", lambda found, used: f"{found}, {len(used)} used"
    )
    out = tmp_path / "c.toml"
    found = sf.calibrate_display(PLATE, tmp_path / "bench", out, seed=3)
    assert (found.calibration, found.file, found.left_out) == ("found", out, ())
    assert out.read_text() == "found, 1 used"
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


def test_a_measurement_is_predicted_in_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []
    made = blind.BlindPrediction(STATOR, "made up", (), {}, "")

    def predicted(*given: Any, **named: Any) -> blind.BlindPrediction:
        asked.append((given, named))
        return made

    monkeypatch.setattr(blind, "predicted", predicted)
    one, two = tmp_path / "1.json", tmp_path / "2.json"
    sf.predict_measurement(STATOR, "relative_friction: vibration_amplitude=1.7 um", one)
    sf.predict_measurement(STATOR, ["mass", "quality_factor"], two, seed=4)
    (display, first), named = asked[0]
    assert (display.name, named["seed"]) == (STATOR, 1)
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


class Fit(SimpleNamespace):
    """A fit that is adequate or not, with what it observed."""

    def __init__(self, *observations: Observation, adequate: bool = True) -> None:
        sentence = "the model does not describe it"
        adequacy = SimpleNamespace(adequate=adequate, sentence=sentence)
        super().__init__(adequacy=adequacy, observations=observations)


def test_what_of_a_folder_is_no_use_is_left_out_with_its_reason(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    plate = load_display(PLATE)
    conditions = {"vibration_amplitude": 1e-6, "normal_force": 0.5, "finger_speed": 0.05}
    friction = Observation("relative_friction", 0.6, 0.05, conditions)
    resonance = Observation("resonance_frequency", 30e3, 3.0)
    curve: Any = FrictionCurve.__new__(FrictionCurve)
    fits: dict[str, Any] = {
        "fine.csv": Fit(resonance, Observation("colour", 1.0, 0.1)),
        "poor.csv": Fit(resonance, adequate=False),
        "exact.csv": Fit(Observation("quality_factor", 60.0, 0.0)),
        "empty.csv": InputError("it holds one point"),
        "ceramic.csv": Fit(),
        "curve.csv": Fit(friction, adequate=False),
    }
    told = SimpleNamespace(who="A", when="today", instrument="an LDV", source="bench")

    def checked(name: str) -> Any:
        recording = SimpleNamespace(told=told, name=name)
        if name == "curve.csv":
            recording = curve
            object.__setattr__(curve, "told", told)
        (tmp_path / name).write_text(name)
        return SimpleNamespace(file=tmp_path / name, kind="a kind", recording=recording)

    steps: list[str] = []
    checks = [checked(name) for name in fits]
    refused = [SimpleNamespace(file=Path("torn.toml"), why="it has no end")]
    answers = iter(fits.values())

    def fit(recording: Any, display: Display, *, progress: Any) -> Any:
        assert display is plate
        assert progress == steps.append
        answer = next(answers)
        if isinstance(answer, InputError):
            raise answer
        return answer

    found_there = SimpleNamespace(checks=checks, refused=refused)
    monkeypatch.setattr(calibrated_folder, "check_folder", lambda _: found_there)
    monkeypatch.setattr(calibrated_folder, "fit_recording", fit)
    monkeypatch.setattr(calibrated_folder, "response_fit", lambda _: None)
    found = folder_observations(plate, tmp_path, steps.append)
    assert steps == [f"fit of {name}" for name in fits]
    seen = [(one.recording, one.answer) for one in found.observations]
    # A curve that no model describes is what a calibration is for.
    assert seen == [("fine.csv", "resonance_frequency"), ("curve.csv", "relative_friction")]
    assert [(one.file, one.kind, one.who) for one in found.recordings] == [
        ("fine.csv", "a kind", "A"), ("curve.csv", "a kind", "A"),
    ]  # fmt: skip
    assert found.recordings[1].sha256 == hashlib.sha256(b"curve.csv").hexdigest()
    assert found.left_out == (
        "torn.toml: it has no end",
        "fine.csv, its colour: a calibration has no use for it",
        "poor.csv: the model does not describe it",
        "exact.csv, its quality factor: it is not above 0, or has no error",
        "empty.csv: it holds one point",
        "ceramic.csv: its fit tells no answer of a display",
    )


def test_what_was_not_predicted_is_not_compared_and_told(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = [
        Observation("resonance_frequency", 30e3, 3.0, recording="a.csv"),
        Observation("resonance_frequency", 31e3, 3.0, recording="b.csv"),
        Observation("quality_factor", 60.0, 1.0, recording="a.csv"),
    ]
    found = FolderObservations(tuple(seen), (), ("torn.toml: it has no end",))
    predicted = SimpleNamespace(predictions=[SimpleNamespace(answer="resonance_frequency")])
    monkeypatch.setattr(calibrated_folder, "load_prediction", lambda _: predicted)
    monkeypatch.setattr(calibrated_folder, "folder_observations", lambda *_: found)
    scored = SimpleNamespace(observation=seen[0])
    monkeypatch.setattr(calibrated_folder, "score", lambda *_: (scored,))
    scores, left_out = sf.score_prediction("blind.json", "later", PLATE)
    assert scores == (scored,)
    assert left_out == (
        "torn.toml: it has no end",
        "b.csv, its resonance frequency: predicted under other conditions",
        "a.csv, its quality factor: not predicted",
    )


def test_a_prediction_and_its_scores_are_kept_at_the_end_of_a_display(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = SimpleNamespace(sha256="0" * 64, how="draws of 8 values")
    monkeypatch.setattr(blind, "load_prediction", lambda _: known)
    display = tmp_path / "mine.toml"
    display.write_text('name = "mine"\n\n\n')
    foretold = blind.Predicted("resonance_frequency", {}, 30e3, (29e3, 31e3), 500.0)
    inside = blind.Score(
        foretold, Observation("resonance_frequency", 30.3e3, 3.0), -0.0099, True, -7
    )
    blind.keep_scores(display, tmp_path / "blind.json", [inside])
    first, blank, *rest = display.read_text().splitlines()
    assert (first, blank) == ('name = "mine"', "")
    assert rest[0] == f"# blind prediction blind.json, SHA-256 {'0' * 64}, draws of 8 values:"
    assert rest[1:] == [f"#   {inside.sentence}"]
    assert "predicted 30000 (29000 to 31000), measured 30300 (SI): error -0.99 %, inside" in rest[1]
    # A friction's error is absolute, and what lies outside is said to.
    other = blind.Score(
        blind.Predicted("relative_friction", {}, 0.5, (0.4, 0.6), 0.06),
        Observation("relative_friction", 0.7, 0.02), -0.2, False, 1.0,
    )  # fmt: skip
    assert "error -0.200, outside of the 90 % interval, log score 1.00" in other.sentence


def test_nothing_that_was_predicted_was_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    foretold = blind.Predicted("resonance_frequency", {"voltage": 10.0}, 3e4, (2e4, 4e4), 500.0)
    known = SimpleNamespace(predictions=(foretold,))
    monkeypatch.setattr(blind, "load_prediction", lambda _: known)

    def at(**conditions: float) -> Observation:
        return Observation("resonance_frequency", 30e3, 3.0, conditions)

    # Conditions are the same within 1 %.
    (scored,) = blind.score("x", [at(voltage=10.09), at(voltage=10.2), at()])
    assert scored.observation.conditions == {"voltage": 10.09}
    says = r"measured \(quality_factor\) is what was predicted \(resonance_frequency, under"
    with pytest.raises(InputError, match=says):
        blind.score("x", [Observation("quality_factor", 60.0, 1.0)])
    with pytest.raises(InputError, match=r"measured \(nothing\)"):
        blind.score("x", [])


def test_a_value_that_most_draws_do_not_have_is_not_predicted() -> None:
    asked = Observation("relative_friction", 0.5, 1.0, {"normal_force": 0.5})
    draws = np.append(np.linspace(0.0, 1.0, 101), np.full(100, np.nan))
    found = blind._predicted(asked, draws)
    assert (found.median, found.interval) == (0.5, pytest.approx((0.05, 0.95)))
    assert found.standard_deviation == pytest.approx(np.std(draws[:101]))
    with pytest.raises(InputError, match="relative friction has no value in most draws"):
        blind._predicted(asked, np.append(draws, np.nan * np.ones(2)))
