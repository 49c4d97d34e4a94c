"""From observations to a calibrated file, to a blind prediction and its score."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.config.load import load_text
from squeezefilm.core.errors import InputError
from squeezefilm.measure.calibration.blind import (
    keep_scores,
    load_prediction,
    predict_measurement,
    score,
)
from squeezefilm.measure.calibration.calibrate import Effort, calibrate, friction_before
from squeezefilm.measure.calibration.calibration import Calibration
from squeezefilm.measure.calibration.folder import usable
from squeezefilm.measure.calibration.plate_fit import answers_to_solve, design_sizes
from squeezefilm.measure.calibration.solved_answers import (
    MODE_FREQUENCY,
    Asked,
    asked_by,
    solved_answers,
)
from squeezefilm.measure.calibration.written_display import (
    calibrated_display,
    calibrated_text,
)
from squeezefilm.measure.fits.circuit.impedance import fit_impedance
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.measure.recordings.kinds import ImpedanceSweep
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.electronics import ring_admittance
from squeezefilm.physics.plate.layout import DiscPlate
from squeezefilm.physics.plate.parts import assembly_mass
from squeezefilm.physics.uncertainty.draws import Mixture
from squeezefilm.physics.uncertainty.uncertainty import uncertain_friction

STATOR = "biet2008-stator"


def friction(value: float, amplitude: float, error: float = 0.03) -> Observation:
    return Observation("relative_friction", value, error, {"vibration_amplitude": amplitude})


SEEN = (friction(0.85, 0.3e-6), friction(0.7, 0.6e-6), friction(0.42, 2.0e-6))


@pytest.fixture(scope="module")
def calibration() -> Calibration:
    """On friction alone: a stator's amplitude is measured, so nothing is solved."""
    effort = Effort(finger_draws=256, joint_draws=256)
    return calibrate(load_display(STATOR), SEEN, seed=3, effort=effort)


@pytest.mark.slow
def test_friction_is_narrowed_and_the_file_has_the_same_interval(
    calibration: Calibration, tmp_path: Path
) -> None:
    assert calibration.fits
    before, after = calibration.before, calibration.after
    assert before is not None
    assert after is not None
    assert after.width < 0.8 * before.width
    assert any("of that interval is left" in one for one in calibration.sentences)
    file = tmp_path / "calibrated.toml"
    file.write_text(calibrated_text(calibration), encoding="utf-8")
    read = load_display(file)
    assert read == calibrated_display(calibration)
    found = uncertain_friction(read, predict(read), samples=16, seed=2)
    np.testing.assert_allclose(found.interval, after.interval, atol=0.2 * before.width)
    measured = {path for path, one in read.provenance.items() if one.evidence == "measured"}
    assert measured
    assert all(path.startswith(("finger", "surfaces", "gas")) for path in measured)
    assert read.calibration is not None
    assert [one.measured for one in read.calibration.compared] == ["0.85", "0.7", "0.42"]
    for one in read.calibration.compared:
        assert one.before[0] < one.after[0] <= one.after[2] < one.before[2]
    assert set(json.loads(json.dumps(calibration.summary()))["laws"]) >= {"height_law"}


@pytest.mark.slow
def test_text_with_sources_reads_back(calibration: Calibration) -> None:
    display = calibrated_display(calibration)
    read = load_text(Display, calibrated_text(calibration))
    for path, one in display.provenance.items():
        assert (read.provenance[path].source, read.provenance[path].evidence) == (
            one.source,
            one.evidence,
        )
        if one.distribution is not None:
            kept = read.provenance[path].distribution
            assert kept is not None
            np.testing.assert_allclose(kept.support, one.distribution.support, rtol=1e-9)
    mixture = Mixture(read, predict(read), driven=True)
    assert "joint.friction_offset" in mixture.paths


@pytest.mark.slow
def test_a_prediction_is_made_kept_and_scored(calibration: Calibration, tmp_path: Path) -> None:
    file = tmp_path / "prediction.json"
    ask = "relative_friction: vibration_amplitude=1.5 um"
    display = calibrated_display(calibration)
    made = predict_measurement(display, ask, file)
    assert made == load_prediction(file)
    assert len(made.sha256) == 64
    low, high = made.predictions[0].interval
    inside = friction((low + high) / 2, 1.5e-6)
    (one,) = score(file, [inside])
    assert one.inside
    assert abs(one.error) < 0.1
    assert "inside" in one.sentence
    (far,) = score(file, [friction(high + 0.2, 1.5e-6)])
    assert not far.inside
    assert far.log_score < one.log_score
    with pytest.raises(InputError, match="nothing that was measured"):
        score(file, [friction(0.4, 3e-6)])
    with pytest.raises(InputError, match="never overwritten"):
        predict_measurement(display, ask, file)
    told = tmp_path / "display.toml"
    told.write_text(calibrated_text(calibration), encoding="utf-8")
    keep_scores(told, file, [one])
    assert made.sha256 in told.read_text(encoding="utf-8")
    assert load_display(told).joint is not None
    file.write_text(file.read_text().replace('"median": 0.', '"median": 0.1'))
    with pytest.raises(InputError, match="changed after it was written"):
        score(file, [inside])


def test_a_prediction_that_is_none(tmp_path: Path) -> None:
    file = tmp_path / "other.json"
    file.write_text('{"kind": "something else"}')
    with pytest.raises(InputError, match="no prediction"):
        load_prediction(file)
    with pytest.raises(InputError, match="name at least one"):
        predict_measurement(load_display(STATOR), [], tmp_path / "new.json")


def test_what_cannot_be_used_is_refused_before_any_work() -> None:
    plate = load_display("biet2008-plate")
    with pytest.raises(InputError, match="nothing was observed"):
        calibrate(plate, [])
    with pytest.raises(InputError, match="vibration_amplitude"):
        calibrate(plate, [Observation("relative_friction", 0.5, 0.1)])
    with pytest.raises(InputError, match="measured values already"):
        calibrate(load_display(STATOR), [Observation("resonance_frequency", 4e4, 10.0)])
    with pytest.raises(InputError, match="Did you mean 'resonance_frequency'"):
        calibrate(plate, [Observation("resonance_freqency", 3e4, 10.0)])
    with pytest.raises(InputError, match="lines_across_length"):
        asked_by(Observation(MODE_FREQUENCY, 3e4, 10.0))
    assert "not above 0" in usable(Observation("mass", 0.0, 0.1))
    assert usable(Observation("mass", 0.1, 0.001)) == ""
    assert (
        usable(Observation("friction_coefficient", 0.5, 0.1)) == "a calibration has no use for it"
    )


def test_what_is_solved_of_a_display() -> None:
    plate = load_display("biet2008-plate")
    asked = answers_to_solve(plate, ())
    assert Asked(MODE_FREQUENCY, (7, 0)) in asked
    assert Asked("mass") in asked
    assert Asked("mass") in answers_to_solve(load_display("winfield2007-tpad"), ())
    assert sum(design_sizes(8)) < 150


@pytest.mark.slow
def test_solved_answers_of_plate_and_disc(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SQUEEZEFILM_CACHE", str(tmp_path))
    plate, disc = (load_display(one).actuator for one in ("biet2008-plate", "winfield2007-tpad"))
    asked = (Asked("mass"), Asked("resonance_frequency"), Asked("parallel_resonance_frequency"))
    found = solved_answers(plate, asked)
    assert found.values[0] == pytest.approx(assembly_mass(plate))
    assert found.values[1] < found.values[2]
    assert found.errors[1] < 3e-3
    # A fit of one circuit sees the neighbours in its band as a higher parallel resonance.
    assert found.readings[0] == 0
    assert 1e-5 < found.readings[2] < 1e-2
    again = solved_answers(plate, asked)
    np.testing.assert_array_equal(again.values, found.values)
    kept = {file.parent.name for file in tmp_path.rglob("*") if file.is_file()}
    # The numbers, and not the plate: a hundred of them would push out those that a user works on.
    assert "plate_answers" in kept
    assert "solved-plates" not in kept
    of_disc = solved_answers(disc, asked)
    assert of_disc.values[0] == pytest.approx(assembly_mass(disc))
    assert 0 < of_disc.values[1] < of_disc.values[2]
    with pytest.raises(InputError, match="has no answer"):
        solved_answers(disc, (Asked(MODE_FREQUENCY, (3, 0)),))


@pytest.mark.slow
def test_answers_of_a_disc_are_what_a_sweep_of_it_reads() -> None:
    disc = load_display("winfield2007-tpad").actuator
    assert isinstance(disc, DiscPlate)
    swept = ring_admittance(disc)
    fit = fit_impedance(ImpedanceSweep(swept.frequencies, swept.admittance))
    read = {one.answer: one.value for one in fit.observations}
    asked = tuple(Asked(name) for name in read)
    solved = dict(zip(read, solved_answers(disc, asked).values, strict=True))
    assert read["parallel_resonance_frequency"] == pytest.approx(
        solved["parallel_resonance_frequency"], rel=1e-3
    )
    assert read["static_capacitance"] == pytest.approx(solved["static_capacitance"], rel=0.02)
    assert read["quality_factor"] == pytest.approx(solved["quality_factor"], rel=0.01)


@pytest.mark.slow
def test_friction_before_is_that_of_the_uncertainty() -> None:
    found = friction_before(load_display(STATOR), seed=1)
    assert found is not None
    assert 0 < found.interval[0] < found.median < found.interval[1]
