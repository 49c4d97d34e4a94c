"""The amplitude of a display that is not quite the described one, against its plate solved anew."""

from __future__ import annotations

import dataclasses

import pytest

from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.working_mode import working_mode
from squeezefilm.physics.uncertainty.free_amplitude import FreeAmplitude
from squeezefilm.physics.uncertainty.parameters import replaced

STIFFNESS, CHARGE = (
    f"actuator.ceramic.{one}" for one in ("in_plane_stiffness", "charge_coefficient")
)


def _with_shares(display: Display, stiffness: float, charge: float) -> Display:
    ceramic = display.actuator.ceramic  # type: ignore[union-attr]
    return replaced(
        display,
        {
            STIFFNESS: stiffness * ceramic.in_plane_stiffness,
            CHARGE: charge * ceramic.charge_coefficient,
        },
    )


@pytest.mark.parametrize(
    ("name", "within"),
    [
        pytest.param("biet2008-plate", 0.012, marks=pytest.mark.slow),
        pytest.param("touchpad-glass", 0.01, marks=pytest.mark.nightly),
        ("winfield2007-tpad", 0.005),
    ],
)
@pytest.mark.parametrize(
    ("stiffness", "charge"),
    [
        *(pytest.param(*share, marks=pytest.mark.slow) for share in ((1.1, 1.2), (0.9, 1.2))),
        (0.9, 0.8),
    ],
)
def test_another_batch_of_ceramic_moves_the_amplitude_as_it_does_the_solved_plate(
    name: str, within: float, stiffness: float, charge: float
) -> None:
    display = load_display(name)
    p = predict(display)
    other = _with_shares(display, stiffness, charge)
    solved = working_mode(other.actuator).amplitude_per_volt / p.mode.amplitude_per_volt
    moved = FreeAmplitude(display, p)(other) / p.touch.free_amplitude
    assert moved == pytest.approx(solved, rel=within)


@pytest.fixture(scope="module")
def glass() -> tuple[Display, Prediction]:
    display = load_display("touchpad-glass")
    return display, predict(display, theory="timoshenko")


def test_of_a_plate_what_it_is_made_of_counts_once(glass: tuple[Display, Prediction]) -> None:
    """Amplitude ∝ d31 Q, whatever goes along of the ceramic's full constants."""
    display, p = glass
    free = FreeAmplitude(display, p)
    assert free(display) == p.touch.free_amplitude
    quality = display.actuator.quality_factor
    for charge, share in ((0.8, 1.0), (1.2, 1.0), (1.2, 0.7)):
        other = replaced(
            _with_shares(display, 1.0, charge), {"actuator.quality_factor": share * quality}
        )
        moved = free(other) / p.touch.free_amplitude
        assert moved == pytest.approx(charge * share, rel=1e-6)


def test_a_layout_and_a_ceramic_are_moved_together(glass: tuple[Display, Prediction]) -> None:
    """A beam with both different, within what two parabolas miss."""
    display, p = glass
    free = FreeAmplitude(display, p)
    thicker = {"actuator.thickness": 1.02 * display.actuator.thickness}
    both = replaced(_with_shares(display, 1.1, 0.8), thicker)
    beams = [free._per_volt(one.actuator) for one in (both, display)]
    assert free(both) / p.touch.free_amplitude == pytest.approx(beams[0] / beams[1], rel=2e-3)


def test_a_constant_of_a_ceramic_that_is_another_by_itself_counts() -> None:
    """Of a disc: what did not go along with stiffness and d31 moves it by itself."""
    display = load_display("winfield2007-tpad")
    ceramic = display.actuator.ceramic  # type: ignore[union-attr]
    # What is stated twice would contradict it.
    alone = {f"free_permittivity_{axis}": None for axis in (11, 33)}
    alone |= {f"stress_coefficient_{pair}": None for pair in (31, 33, 15)}
    full = dataclasses.replace(ceramic.full_constants, **alone)
    actuator = dataclasses.replace(
        display.actuator, ceramic=dataclasses.replace(ceramic, constants=full)
    )
    display = dataclasses.replace(display, actuator=actuator)
    p = predict(display)
    softer = replaced(
        display, {"actuator.ceramic.constants.compliance_33": 1.05 * full.compliance_33}
    )
    solved = working_mode(softer.actuator).amplitude_per_volt / p.mode.amplitude_per_volt
    moved = FreeAmplitude(display, p)(softer) / p.touch.free_amplitude
    assert moved != 1
    assert moved == pytest.approx(solved, rel=1e-4)
