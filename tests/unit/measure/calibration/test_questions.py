"""Questions to a blind prediction, read from text."""

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import squeezefilm as sf
from squeezefilm.core.calibration_record import CalibratedAnswer, CalibrationRecord
from squeezefilm.core.errors import InputError
from squeezefilm.measure.calibration import blind
from squeezefilm.measure.calibration.solved_answers import question
from squeezefilm.measure.calibration.written_display import actuator_digest
from squeezefilm.measure.fits.estimate import Observation


def test_an_answer_is_read_with_its_conditions() -> None:
    assert question("resonance_frequency") == Observation("resonance_frequency", 0.0, 0.0, {})
    found = question("relative_friction: vibration_amplitude = 1.7 um, normal_force=0.5 N")
    assert found.conditions == {"vibration_amplitude": 1.7e-6, "normal_force": 0.5}
    lines = question("mode_frequency: lines_across_length=7, lines_across_width=0").conditions
    assert lines == {"lines_across_length": 7.0, "lines_across_width": 0.0}


@pytest.mark.parametrize(
    "text", ["mass: wind=1 m", "mass: normal_force", "relative_friction: vibration_amplitude=1.7"]
)
def test_a_condition_that_cannot_be_read_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        question(text)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"value": math.nan}, "value = nan"),
        ({"standard_error": math.inf}, "standard_error = inf"),
        ({"standard_error": -1.0}, "at least 0"),
        ({"conditions": {"voltage": math.nan}}, "voltage = nan"),
    ],
)
def test_what_was_observed_is_finite(changed: dict[str, Any], said: str) -> None:
    observed = {"answer": "resonance_frequency", "value": 34e3, "standard_error": 17.0}
    with pytest.raises(InputError, match=said):
        Observation(**{**observed, **changed})


def test_a_calibrated_file_answers_what_its_draws_hold(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a plate solved, and as closely as it was measured; a changed plate is solved."""
    plate = sf.load_display("biet2008-plate")
    draws = tuple((33.2e3 + 5.0 * np.random.default_rng(1).standard_normal(256)).tolist())
    answers = (CalibratedAnswer("resonance frequency", draws),)
    record = CalibrationRecord(
        "2026-11-28", "0.2.0", True, answers=answers, actuator=actuator_digest(plate)
    )
    file = tmp_path / "mine.toml"
    sf.save_display(dataclasses.replace(plate, calibration=record), file)
    monkeypatch.setattr(blind, "solved_answers", lambda *_: pytest.fail("a plate was solved"))
    (found,) = sf.predict_measurement(file, "resonance_frequency", tmp_path / "a.json").predictions
    assert found.median == pytest.approx(np.median(draws))
    assert found.interval == pytest.approx(np.quantile(draws, [0.05, 0.95]))
    thicker = sf.replaced(file, {"actuator.thickness": "2.001 mm"})
    with pytest.raises(pytest.fail.Exception, match="was solved"):
        sf.predict_measurement(thicker, "resonance_frequency", tmp_path / "b.json")
    with pytest.raises(pytest.fail.Exception, match="was solved"):
        sf.predict_measurement(file, "quality_factor", tmp_path / "c.json")
