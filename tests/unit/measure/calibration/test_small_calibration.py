"""A calibration of plate and friction at once, from solves to the scored file, on plates whose
answers are powers of what they are made of, and so small that it takes seconds."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import norm
from tests.shared import shared

from squeezefilm.core.errors import InputError, UnreachableError
from squeezefilm.measure.calibration import (
    blind,
    calibrate,
    plate_fit,
    plate_posterior,
    written_display,
)
from squeezefilm.measure.calibration.blind import predicted, score, sealed
from squeezefilm.measure.calibration.calibrate import Effort
from squeezefilm.measure.calibration.calibration import CalibratedValue, Calibration
from squeezefilm.measure.calibration.discrepancy import BELIEVED
from squeezefilm.measure.calibration.plate_fit import Solves
from squeezefilm.measure.calibration.priors import NormalScores, calibration_parameters
from squeezefilm.measure.calibration.solved_answers import MODE_FREQUENCY, Asked, SolvedAnswers
from squeezefilm.measure.calibration.written_display import calibrated_display, calibrated_text
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate

THICKNESS, QUALITY = "actuator.thickness", "actuator.quality_factor"
PLATE = load_display("biet2008-plate")
DRAWS, PLATES, MORE_PLATES, COUPLING, SOLVER = 64, 24, 8, 0.25, 1e-5


def by_scaling(plate: RectangularPlate, asked: tuple[Asked, ...]) -> SolvedAnswers:
    """A plate as stiff as it is thick, and as lively as its losses allow."""
    thick, sharp = plate.thickness / 2e-3, plate.quality_factor / 60
    answers = {
        "resonance_frequency": 3e4 * thick,
        "parallel_resonance_frequency": 3e4 * thick / np.sqrt(1 - COUPLING**2),
        "coupling_coefficient": COUPLING,
        "static_capacitance": 1e-9,
        "quality_factor": 60 * sharp,
        "amplitude_per_volt": 1e-7 * sharp,
        "half_wavelength": 8e-3,
        "mass": 30e-3 * thick,
        MODE_FREQUENCY: 2e4 * thick,
    }
    values = np.array([answers[answer.name] for answer in asked])
    return SolvedAnswers(values, np.full(values.size, SOLVER), np.zeros(values.size))


def friction(value: float, amplitude: float, error: float = 0.03) -> Observation:
    return Observation("relative_friction", value, error, {"vibration_amplitude": amplitude})


SEEN = (
    Observation("resonance_frequency", 3.03e4, 3.0, recording="admittance"),
    friction(0.85, 0.3e-6),
    Observation("quality_factor", 45.0, 0.5),
    friction(0.7, 0.6e-6),
    friction(0.42, 2.0e-6),
)


@pytest.fixture(scope="module")
def small() -> Iterator[None]:
    def short(problem: Any, *, steps: int = 0, **options: Any) -> Any:
        return plate_posterior.sampled_posterior(problem, steps=60, **options)

    on_the_plate = shared("biet2008-plate predicted", lambda: predict(PLATE))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plate_posterior, "BURN_IN", 20)
        patch.setattr(plate_fit, "sampled_posterior", short)
        patch.setattr(plate_fit, "solved_answers", by_scaling)
        patch.setattr(blind, "solved_answers", by_scaling)
        patch.setattr(blind, "_FRICTION", DRAWS)
        patch.setattr(calibrate, "_BEFORE", DRAWS)
        # The finger is on the plate as described, which is solved once.
        for module in (calibrate, blind, written_display):
            patch.setattr(module, "predict", lambda _: on_the_plate)
        yield


@pytest.fixture(scope="module")
def said() -> list[str]:
    return []


@pytest.fixture(scope="module")
def found(small: None, said: list[str]) -> Calibration:
    return calibrate.calibrate(
        PLATE,
        SEEN,
        seed=3,
        parameters={THICKNESS: None, QUALITY: None},
        effort=Effort((PLATES, MORE_PLATES), DRAWS, DRAWS),
        progress=said.append,
    )


def value(found: Calibration, path: str) -> CalibratedValue:
    (only,) = [value for value in found.values if value.path == path]
    return only


def test_what_a_plate_is_made_of_is_what_its_answers_tell(found: Calibration) -> None:
    """Thickness by the frequency, losses by the width, each as well as a model is believed."""
    for path, true, answer in (
        (THICKNESS, 2e-3 * 1.01, "resonance_frequency"),
        (QUALITY, 45.0, "quality_factor"),
    ):
        learnt, believed = value(found, path), BELIEVED[answer]
        assert learnt.median == pytest.approx(true, rel=0.5 * believed)
        assert learnt.interval[0] < true < learnt.interval[1]
        assert 0.5 * believed < learnt.standard_deviation / true < 1.2 * believed
        low, high = learnt.prior
        assert np.ptp(learnt.interval) == pytest.approx(3.29 * learnt.standard_deviation, rel=0.25)
        assert learnt.left == pytest.approx(np.ptp(learnt.interval) / (high - low), rel=0.35)
    prior = calibration_parameters(PLATE, {THICKNESS: None})[0].distribution
    np.testing.assert_allclose(
        value(found, THICKNESS).prior, prior.quantile(np.array([0.05, 0.95]))
    )
    assert found.fits
    assert len(found.misfits) == 2
    assert {THICKNESS, QUALITY} <= {value.path for value in found.values}
    assert any(value.path.startswith("finger.") for value in found.values)
    assert isinstance(found.display.actuator, RectangularPlate)
    assert found.display.actuator.thickness == pytest.approx(2.02e-3, rel=2e-3)


def test_joint_draws_go_with_one_another(found: Calibration) -> None:
    joint = found.joint
    assert len(joint.finger) == len(joint.friction) == DRAWS
    swing = drawn(found, "amplitude_per_volt")
    np.testing.assert_allclose(joint.amplitude, swing * 15.0, rtol=1e-12)
    # Each draw's frequency is that of its own thickness, but for what a model may be off by.
    tune = np.log(drawn(found, "resonance_frequency") / 3.03e4)
    assert tune.std() < 2e-3
    assert np.all((joint.friction > 0) & (joint.friction <= 1.2))
    assert 0 < np.std(joint.law_error) < 0.2
    before, after = found.before, found.after
    assert before is not None
    assert after is not None
    np.testing.assert_allclose(
        [*after.interval, after.median],
        np.quantile(joint.friction, [0.05, 0.95, 0.5], method="weibull"),
    )
    assert after.width == pytest.approx(after.interval[1] - after.interval[0])
    # A finger takes some of the free vibration.
    assert 0 < after.amplitude < np.median(joint.amplitude)


def test_solves_are_counted_and_their_emulator_knows_a_power(found: Calibration) -> None:
    assert found.solves in (PLATES, PLATES + MORE_PLATES)
    assert {"resonance frequency", "mass", "mode frequency (7,0)"} <= set(found.emulator_errors)
    assert "modal mass" not in found.emulator_errors
    assert max(found.emulator_errors.values()) < 3e-3


def test_what_was_measured_stands_beside_the_model_alone(found: Calibration) -> None:
    told = found.compared
    assert [row.said for row in told[::2]] == [
        "resonance frequency",
        "quality factor",
        told[4].said,
    ]
    assert told[0].measured == "30.3 kHz"
    assert told[0].recording == "admittance"
    assert told[0].error == 9.9e-5
    assert told[0].relative_friction is None
    assert (told[4].relative_friction, told[4].vibration_amplitude) == (0.42, 2e-6)
    for row in told:
        assert row.before[0] < row.before[1] < row.before[2]
        assert np.ptp(row.after) < np.ptp(row.before)
    # Thicknesses of 1.95 to 2.05 mm, over the 2.02 mm that were measured.
    np.testing.assert_allclose(told[0].before, np.array([1.955, 2.0, 2.045]) / 2.02, atol=2e-3)


def test_what_to_measure_next_was_not_measured_yet(found: Calibration) -> None:
    left = [option.left for option in found.next_measurements]
    assert left == sorted(left)
    assert all(0 < share <= 1 for share in left)
    names = [option.name for option in found.next_measurements]
    assert sum(name.startswith("µ′/µ on a friction bench at") for name in names) == 2
    micrometres = [
        float(re.findall(r"at ([\d.]+) µm", name)[0]) for name in names if "bench" in name
    ]
    assert max(micrometres) == pytest.approx(2 * min(micrometres), rel=0.1)
    assert not any("quality" in name for name in names)
    assert found.sentences[-1] == f"Next: {found.next_measurements[0].sentence}."


def test_few_draws_are_doubted_and_each_step_is_told(found: Calibration, said: list[str]) -> None:
    doubts = " ".join(found.doubts)
    assert "The draws of finger and laws are worth" in doubts
    assert found.sentences[: len(found.doubts)] == found.doubts
    shares = [f"plate {number + 1} of {PLATES}" for number in range(PLATES)]
    assert [share for share in shares if any(share in text for text in said)] == shares
    for step in ("emulator", "least squares", "posterior, 90 %", "friction as described"):
        assert any(step in text for text in said)
    assert any("draw 1 of 64" in text for text in said)


def test_laws_weigh_as_much_after_as_before(found: Calibration) -> None:
    assert {"height_law"} <= set(found.laws)
    for weights in found.laws.values():
        assert sum(weights.values()) == pytest.approx(1.0)


def test_the_file_keeps_what_was_learnt_and_how_it_goes_together(found: Calibration) -> None:
    display = calibrated_display(found)
    for path in (THICKNESS, QUALITY):
        origin, learnt = display.provenance[path], value(found, path)
        assert origin.evidence == "measured"
        assert "from the 5 observations below" in origin.source
        assert origin.distribution is not None
        ends = origin.distribution.quantile(np.array([0.05, 0.95]))
        np.testing.assert_allclose(ends, learnt.interval, atol=0.1 * np.ptp(learnt.interval))
    assert display.calibration is not None
    assert display.calibration.compared == found.compared
    kept = {answer.said: answer.draws for answer in display.calibration.answers}
    assert set(kept) == {asked.said for asked in found.joint.answers}
    np.testing.assert_allclose(kept["mass"], drawn(found, "mass"), rtol=1e-6)
    joint = display.joint
    assert joint is not None
    assert len(joint.draws) == DRAWS
    assert len(joint.draws[0]) == len(joint.paths)
    assert all(0 <= share <= 1 for row in joint.draws for share in row)
    assert joint.amplitude_share_deviation == pytest.approx(
        np.std(found.joint.amplitude) / np.mean(found.joint.amplitude) * joint.amplitude_share
    )
    assert joint.friction_offset == pytest.approx(np.mean(found.joint.law_error))
    assert joint.friction_offset_deviation == pytest.approx(np.std(found.joint.law_error))
    text = calibrated_text(found)
    assert text.startswith(f"# {PLATE.name}, calibrated: values marked as measured")


ASKED = (
    Observation("resonance_frequency", 0.0, 0.0),
    Observation("mass", 0.0, 0.0),
    friction(0.0, 1.5e-6, 0.0),
)


def drawn(found: Calibration, answer: str) -> np.ndarray[Any, Any]:
    return found.joint.answers[Asked(answer)]


def ends(draws: np.ndarray[Any, Any]) -> list[float]:
    low, middle, high = np.quantile(draws, [0.05, 0.5, 0.95]).tolist()
    return [low, middle, high]


def test_a_calibration_and_its_file_predict_from_its_draws(
    found: Calibration, small: None, tmp_path: Path
) -> None:
    display = calibrated_display(found)
    of_file = predicted(display, ASKED, seed=2)
    assert of_file.how == f"the calibration in the description of {PLATE.name}"
    for told, asked in zip(of_file.predictions[:2], ASKED, strict=False):
        low, middle, high = ends(drawn(found, asked.answer))
        np.testing.assert_allclose(
            [told.interval[0], told.median, told.interval[1]], [low, middle, high], rtol=1e-5
        )
    assert 0 < of_file.predictions[2].interval[0] < of_file.predictions[2].interval[1] <= 1.2

    file = tmp_path / "prediction.json"
    file.write_text(sealed(of_file), encoding="utf-8")
    told = of_file.predictions[0]
    (scored,) = score(file, [Observation("resonance_frequency", 1.01 * told.median, 30.0)])
    assert scored.error == pytest.approx(1 / 1.01 - 1)
    assert scored.inside == (1.01 * told.median < told.interval[1])
    spread = np.hypot(told.standard_deviation, 30.0)
    assert scored.log_score == pytest.approx(
        norm.logpdf(0.01 * told.median / spread) - np.log(spread)
    )


def test_plates_are_predicted_from_the_spreads_of_a_description(small: None) -> None:
    """As a product of what they are made of and what a model is believed to be off by."""
    steps: list[str] = []
    made = predicted(PLATE, ASKED[1:2], seed=2, progress=steps.append)
    assert made.how == f"plates drawn from the spreads in the description of {PLATE.name}"
    assert len(steps) == 32
    (mass,) = made.predictions
    # Thickness evenly within 2.5 %.
    expected = np.hypot(0.05 / np.sqrt(12), BELIEVED["mass"])
    assert mass.standard_deviation / mass.median == pytest.approx(expected, rel=0.15)
    assert mass.median == pytest.approx(30e-3, rel=0.01)


class Refusing:
    """Solves that refuse some plates and have no mode of others."""

    def __init__(self, thin: float, lossy: float) -> None:
        self.thin, self.lossy = thin, lossy

    def __call__(self, plate: RectangularPlate, asked: tuple[Asked, ...]) -> SolvedAnswers:
        if plate.thickness < self.thin:
            raise UnreachableError(f"a plate of {1e3 * plate.thickness:.2f} mm has no such mode")
        solved = by_scaling(plate, asked)
        if plate.quality_factor < self.lossy:
            solved.values[asked.index(Asked("resonance_frequency"))] = np.nan
        solved.values[asked.index(Asked("half_wavelength"))] = np.nan
        return solved


def test_plates_without_an_answer_are_counted_and_many_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    parameters = calibration_parameters(PLATE, {THICKNESS: None, QUALITY: None})
    scores = NormalScores(parameters)
    count = 27
    points = plate_fit.prior_scores(2, count, seed=1)
    made = scores.values(points)
    thick, quality = made[:, 0], made[:, 1]
    monkeypatch.setattr(plate_fit, "solved_answers", Refusing(np.sort(thick)[2], 0.0))
    solves = Solves(PLATE, scores, SEEN[:1])
    shares: list[float] = []
    solves.add(points, "tried", lambda _, share: shares.append(share))
    np.testing.assert_allclose(shares, np.arange(count) / count)
    assert len(solves.refused) == 2
    first = thick[thick < np.sort(thick)[2]][0]
    assert solves.refused[0] == f"a plate of {1e3 * first:.2f} mm has no such mode"
    solves.require_enough()
    problem = solves.problem(SEEN[:1])
    assert Asked("half_wavelength") not in problem.asked
    assert len(problem.solver_errors) == len(problem.asked)
    np.testing.assert_allclose(problem.solver_errors, SOLVER)
    at = problem.asked.index(Asked("resonance_frequency"))
    np.testing.assert_allclose(
        np.exp(problem.answers(points)[:, at]), 3e4 * thick / 2e-3, rtol=2e-3
    )

    monkeypatch.setattr(plate_fit, "solved_answers", Refusing(0.0, np.sort(quality)[7]))
    solves = Solves(PLATE, scores, SEEN[:1])
    solves.add(points, "tried", lambda _, __: None)
    assert len(solves.refused) == 7
    with pytest.raises(InputError, match=r"7 of 27 plates .* no resonance frequency\); narrow"):
        solves.require_enough()
