"""What is expected of a display that is to be built, and the plan that asks for it."""

from __future__ import annotations

import typing
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.made_bench.bench import made_bench

import squeezefilm as sf
from squeezefilm.core.distributions import Uniform
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.quantities import Unit
from squeezefilm.design.fabrication import fabricate as module
from squeezefilm.design.fabrication import test_plan
from squeezefilm.design.fabrication.fabricate import ASKED, Fabrication, fabricate, sealed_already
from squeezefilm.design.fabrication.report.page import _allowed
from squeezefilm.design.fabrication.test_plan import Check
from squeezefilm.measure.calibration.blind import sealed
from squeezefilm.measure.calibration.folder import usable
from squeezefilm.measure.calibration.solved_answers import FRICTION
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.measure.recordings import description
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.plate.parts import assembly_mass
from squeezefilm.physics.uncertainty.parameters import Parameter

DISC = "winfield2007-tpad"


@pytest.fixture(scope="module")
def disc() -> Fabrication:
    return fabricate(DISC, samples=8)


def checks_of(made: Fabrication) -> dict[str, Check]:
    return {one.answer: one for step in made.steps for one in step.checks if one.answer}


@pytest.mark.slow
def test_a_disc_has_an_interval_of_every_answer_about_its_own(disc: Fabrication) -> None:
    found = {one.answer for one in disc.expected}
    assert found == {*ASKED, FRICTION}
    for answer, check in checks_of(disc).items():
        assert check.interval is not None, answer
        assert check.value is not None
        if answer != FRICTION:
            assert check.interval[0] < check.value < check.interval[1], answer
    assert disc.no_intervals == ""
    assert {one.path for one in disc.drawn} >= {"actuator.thickness", "actuator.quality_factor"}


@pytest.mark.slow
def test_the_amplitude_is_that_of_analyze(disc: Fabrication) -> None:
    assert disc.uncertainty is not None
    check = next(
        one
        for step in disc.steps
        for one in step.checks
        if one.what == "Amplitude at the antinode, finger on"
    )
    assert check.interval == disc.uncertainty.amplitude_interval
    assert check.value == disc.prediction.vibration_amplitude


@pytest.mark.slow
def test_a_bench_of_the_display_lies_in_what_was_expected(disc: Fabrication) -> None:
    from squeezefilm.measure.fits.by_kind import fit_recording

    bench = made_bench(sf.load_display(DISC), seed=2)
    checks = checks_of(disc)
    fit = fit_recording(bench.recordings["frequency-response"])
    seen = {one.answer: one.value for one in fit.observations}
    for answer in ("resonance_frequency", "quality_factor", "amplitude_per_volt"):
        low, high = typing.cast("tuple[float, float]", checks[answer].interval)
        assert low < seen[answer] < high, answer


@pytest.mark.slow
def test_what_was_sealed_stays_what_is_expected(disc: Fabrication, tmp_path: Path) -> None:
    file = tmp_path / "prediction.json"
    display = disc.display
    assert sealed_already(file, display) is None
    assert disc.blind is not None
    file.write_text(sealed(disc.blind), encoding="utf-8")
    kept = sealed_already(file, display)
    assert kept is not None
    assert kept.predictions == disc.blind.predictions
    again = fabricate(display, prediction=disc.prediction, samples=0, blind=kept)
    assert again.blind is kept
    with pytest.raises(InputError, match="another description"):
        sealed_already(file, sf.load_display("biet2008-plate"))
    file.write_text(file.read_text().replace("0.9", "0.8"), encoding="utf-8")
    with pytest.raises(InputError, match="was changed"):
        sealed_already(file, display)


def test_recordings_of_the_plan_are_kinds_that_can_be_read() -> None:
    made = fabricate("biet2008-plate", intervals=False)
    kinds = [one.kind for one in made.steps if one.kind]
    assert set(kinds) <= set(description.KINDS)
    assert {"impedance", "frequency response", "line scan", "grid scan", "ring-down",
            "voltage sweeps", "friction bench"} == set(kinds)  # fmt: skip
    for step in made.steps:
        for one in step.checks:
            if one.answer and one.answer != FRICTION:
                assert usable(Observation(one.answer, 1.0, 0.1)) == "", one.answer


def test_without_intervals_numbers_are_those_of_the_prediction() -> None:
    made = fabricate("biet2008-plate", intervals=False)
    checks = checks_of(made)
    assert checks["resonance_frequency"].value == made.prediction.mode.resonance_frequency
    assert checks["mass"].value == pytest.approx(assembly_mass(made.display.actuator))
    assert all(one.interval is None for one in checks.values())
    assert made.no_intervals == "none were asked for"
    nodal = [
        one.value for step in made.steps for one in step.checks if one.what.startswith("Nodal line")
    ]
    assert nodal == list(made.nodal.positions)
    assert len(nodal) == 8


@pytest.mark.slow
def test_of_a_stator_only_friction_is_drawn() -> None:
    made = fabricate("biet2008-stator", samples=0)
    assert {one.answer for one in made.expected} == {FRICTION}
    assert "measured values" in made.no_intervals
    assert made.drawn == ()


def test_what_cannot_be_drawn_leaves_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    display = sf.load_display("biet2008-plate")
    beam = predict(display, theory="timoshenko")

    def nothing(*_: Any, **__: Any) -> None:
        raise OutOfRangeError("a finger is pressed through")

    asked: list[Sequence[Observation]] = []

    def noted(_: object, what: Sequence[Observation], **__: Any) -> None:
        asked.append(what)
        nothing()

    monkeypatch.setattr(module, "predicted", noted)
    made = fabricate(display, prediction=beam, samples=0)
    assert {one.answer for one in asked[0]} == {FRICTION}
    assert (made.blind, made.no_intervals) == (None, "a finger is pressed through")
    assert made.steps


def known(*expected: Any, unsure: Any = None) -> Any:
    """What is known of a display whose µ′/µ falls by 0.4 per µm, 0.6 at its own 1 µm."""
    law = SimpleNamespace(at=lambda amplitude: 1 - 0.4e6 * amplitude)
    p = SimpleNamespace(
        normal_force=0.5, speed=0.08, friction_coefficient=0.7, vibration_amplitude=1e-6,
        relative_friction=0.61, law=law, surface=SimpleNamespace(name="glass"),
    )  # fmt: skip
    return SimpleNamespace(prediction=p, uncertainty=unsure, expected=expected)


def foretold(answer: str, **conditions: float) -> Any:
    return SimpleNamespace(answer=answer, conditions=conditions, interval=(0.3, 0.8), level=0.9)


def test_a_friction_bench_reads_what_was_foretold_at_each_amplitude() -> None:
    # At its own amplitude the whole prediction stands, elsewhere the law alone.
    own = foretold(FRICTION, vibration_amplitude=1.0005e-6, normal_force=0.5)
    less = foretold(FRICTION, vibration_amplitude=0.5e-6)
    step = test_plan._strokes(known(own, less, foretold("mass")))
    assert step.do.startswith("Strokes at 80 mm/s with 500 mN on 'glass'")
    still, driven, *frictions = step.checks
    assert (still.value, still.unit, still.remark) == (0.7, "1", "of 'glass', as described")
    assert (driven.value, driven.unit, driven.interval) == (1e-6, "m", None)
    assert driven.remark == "zero-to-peak"
    assert [one.value for one in frictions] == pytest.approx([0.61, 0.8])
    assert [one.interval for one in frictions] == [(0.3, 0.8)] * 2
    assert frictions[0].conditions == (("vibration_amplitude", 1.0005e-6), ("normal_force", 0.5))
    assert frictions[1].what == "µ′/µ at 500 nm"


def test_a_friction_that_nobody_foretold_is_read_with_its_own_interval() -> None:
    unsure = SimpleNamespace(amplitude_interval=(0.8e-6, 1.2e-6), interval=(0.4, 0.7), level=0.9)
    _, driven, friction = test_plan._strokes(known(unsure=unsure)).checks
    assert (driven.interval, driven.level) == ((0.8e-6, 1.2e-6), 0.9)
    assert "friction's interval" in driven.remark
    assert (friction.value, friction.interval, friction.level) == (0.61, (0.4, 0.7), 0.9)
    # A stator's amplitude is what its description says.
    unsure.amplitude_interval = (1e-6, 1e-6)
    _, driven, _ = test_plan._strokes(known(unsure=unsure)).checks
    assert (driven.interval, driven.remark) == (None, "zero-to-peak")
    _, _, friction = test_plan._strokes(known()).checks
    assert (friction.interval, friction.level) == (None, None)


def test_what_the_intervals_allow_is_listed_or_why_there_are_none() -> None:
    why: Any = SimpleNamespace(drawn=(), no_intervals="no <plate> was solved")
    assert _allowed(why) == "<p>Nothing: no &lt;plate&gt; was solved.</p>"
    why.no_intervals = ""
    assert "no interval was computed" in _allowed(why)
    drawn = [
        Parameter("actuator.thickness", 1e-3, Unit("m"), Uniform(0.9e-3, 1.1e-3), origin, source)
        for origin, source in (("given", "a drawing"), ("assumed", "a guess"))
    ]
    said = _allowed(SimpleNamespace(drawn=drawn))  # type: ignore[arg-type]
    for words in ("as described", "a drawing", "assumed", "a guess", "actuator.thickness"):
        assert words in said
    assert said.index("as described") < said.index("a guess")
