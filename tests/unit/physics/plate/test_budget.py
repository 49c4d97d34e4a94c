"""A plate's solve under a budget: the best answer in time, with its larger error."""

import pytest
from tests.verification.random_plates import random_plate

from squeezefilm.core.errors import InputError, OutOfTimeError
from squeezefilm.core.progress import Pace
from squeezefilm.design.plate.command import solve_plate
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.chain.touch import chosen_mode
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid import mesh
from squeezefilm.physics.plate.solid.forecast import solve_size
from squeezefilm.physics.plate.solid.layers import COARSE, NORMAL
from squeezefilm.physics.plate.solid.modes import COARSE_AMPLITUDE_ERROR, COARSE_ERROR
from squeezefilm.physics.plate.solid.working import solid_mode


@pytest.fixture(autouse=True)
def nothing_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is kept on disk takes no time, so that no budget is too small for it."""
    monkeypatch.setenv("SQUEEZEFILM_CACHE", "off")


@pytest.fixture(scope="module")
def display() -> Display:
    return load_display("biet2008-plate")


def plate_of(display: Display) -> RectangularPlate:
    assert isinstance(display.actuator, RectangularPlate)
    return display.actuator


def frozen(budget: float) -> Pace:
    """A budget by a clock that stands still: what is allowed depends on the counted size only."""
    return Pace(budget, clock=lambda: 0.0)


def just_coarse(plate: RectangularPlate) -> Pace:
    size = solve_size(plate, plate.working_label, 34e3)
    return frozen(1.02 * (size.coarse + size.coarse_response))


@pytest.mark.slow
def test_the_coarse_answer_comes_with_its_error(display: Display) -> None:
    plate = plate_of(display)
    fine, rough = solid_mode(plate), solid_mode(plate, pace=just_coarse(plate))
    assert (fine.modes.left_coarse, rough.modes.left_coarse) == (False, True)
    assert (fine.modes.resolution, rough.modes.resolution) == (NORMAL, COARSE)
    assert fine.coarseness == ""
    assert "within 2 %" in rough.coarseness
    assert rough.frequency_error == COARSE_ERROR * rough.frequency
    assert rough.frequency != fine.frequency
    assert abs(rough.frequency - fine.frequency) < rough.frequency_error
    off = rough.amplitude_per_volt / fine.amplitude_per_volt - 1
    assert abs(off) < COARSE_AMPLITUDE_ERROR
    assert "the time was up" in rough.modes.status


def test_answers_under_different_budgets_are_kept_apart(display: Display) -> None:
    plate = plate_of(display)
    rough = solid_mode(plate, pace=just_coarse(plate))
    assert solid_mode(plate, pace=just_coarse(plate)) is rough
    assert solid_mode(plate) is not rough
    assert solid_mode(plate) is solid_mode(plate, pace=Pace(tell=lambda text, share: None))


@pytest.mark.slow
def test_enough_time_gives_the_same_answer(display: Display) -> None:
    plate = plate_of(display)
    fine, unhurried = solid_mode(plate), solid_mode(plate, pace=frozen(1e6))
    assert unhurried.frequency == fine.frequency
    assert unhurried.amplitude_per_volt == fine.amplitude_per_volt


def test_too_little_for_any_mesh_is_refused_or_a_beam_stands_in(display: Display) -> None:
    with pytest.raises(OutOfTimeError, match=r"more than the budget of 0\.001 s"):
        solid_mode(plate_of(display), pace=frozen(1e-3))
    p = predict(display, pace=frozen(1e-3))
    assert p.mode.solid is None
    assert len(p.objections) == 1
    assert "those of a beam" in p.objections[0]
    with pytest.raises(OutOfTimeError):
        chosen_mode(plate_of(display), strict=True, pace=frozen(1e-3))


def test_a_coarse_answer_is_an_objection(display: Display) -> None:
    p = predict(display, pace=just_coarse(plate_of(display)))
    assert p.mode.solid is not None
    assert p.objections == (p.mode.solid.coarseness,)
    assert predict(display).objections == ()


def test_a_plates_analysis_within_a_budget(display: Display) -> None:
    with pytest.raises(OutOfTimeError, match=r"Without a solve: about 33.7 kHz"):
        solve_plate(display, budget=1e-3)


@pytest.mark.slow
def test_coarse_answers_of_random_plates_are_within_their_error() -> None:
    for seed in (2502, 2503, 2507, 2510, 2512):
        plate = random_plate(seed)
        size = solve_size(plate, plate.working_label, 34e3)
        if size.seconds > 5:
            continue
        fine = solid_mode(plate)
        rough = solid_mode(plate, pace=frozen(size.coarse + size.coarse_response + 0.05))
        assert abs(rough.frequency - fine.frequency) < rough.frequency_error


def test_meshes_of_too_high_a_frequency_are_refused_before_they_are_made(
    display: Display, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of half a gigahertz the counting alone took minutes."""
    plate = plate_of(display)
    refused = pytest.raises(InputError, match="and no more than 1 is resolved")
    with refused:
        solve_size(plate, plate.working_label, 2e6)
    monkeypatch.setattr(mesh, "BoxModel", None)
    with refused:
        solve_size(plate, plate.working_label, 5.6e8)
