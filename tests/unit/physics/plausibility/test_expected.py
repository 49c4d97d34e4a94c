"""Closed estimates against the solved plate, disc and stator."""

import dataclasses

import pytest
from tests.verification.random_plates import random_plate

from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.beam_response import beam_response
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.forecast import band_seconds, expected_seconds, solve_size
from squeezefilm.physics.plate.working_mode import working_mode
from squeezefilm.physics.plausibility.checks import foreseen
from squeezefilm.physics.plausibility.expected import Expectation, expectation


def of(name: str) -> Expectation:
    found = expectation(load_display(name).actuator)
    assert found is not None
    return found


def test_a_covered_plate_is_the_beam() -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    beam, seen = beam_response(plate), of("biet2008-plate")
    assert seen.frequency == beam.mode.frequency
    assert seen.amplitude_per_volt == beam.amplitude_per_volt
    assert seen.sentence == (
        "about 33.7 kHz (mostly right to 15 %), 110 nm/V (to a factor of two), by a beam"
    )


def test_the_stator_is_what_was_measured() -> None:
    seen = of("biet2008-stator")
    assert (seen.frequency, seen.off) == (40.5e3, 1.0)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["biet2008-plate", "winfield2007-tpad"])
def test_the_solved_frequency_lies_within_the_doubt_of_the_estimate(name: str) -> None:
    seen = of(name)
    solved = working_mode(load_display(name).actuator).resonance_frequency
    assert seen.frequency / seen.off < solved < seen.frequency * seen.off


def test_an_estimate_is_doubted_only_beyond_its_own_doubt() -> None:
    low = Expectation(15e3, 1.5, "a thin plate")
    assert low.nearest_frequency == 20e3
    assert dataclasses.replace(low, off=1.1).nearest_frequency == pytest.approx(16.5e3)
    high = Expectation(300e3, 1.2, "a thin plate")
    assert high.nearest_frequency == pytest.approx(250e3)
    assert dataclasses.replace(low, frequency=33e3).nearest_frequency == 33e3


def test_power_grows_with_the_square_of_the_voltage_and_falls_with_mass() -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    once, heavy = expectation(plate), expectation(dataclasses.replace(plate, quality_factor=120))
    assert once is not None
    assert heavy is not None
    assert once.power_per_mass is not None
    assert heavy.power_per_mass is not None
    # Twice the quality is twice the amplitude and twice the power at resonance.
    assert heavy.power_per_mass == pytest.approx(2 * once.power_per_mass)
    # The whole plate: 7.8 W at 15 V are computed of the solved one, of some 95 g.
    assert 15**2 * once.power_per_mass * 0.095 == pytest.approx(7.8, rel=0.5)


def test_the_size_of_a_solve_is_counted_before_it() -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    size = solve_size(plate, plate.working_label, 33.6e3)
    finer = solve_size(plate, plate.working_label, 67e3)
    assert 10_000 < size.unknowns < finer.unknowns
    assert size.coarse < size.refined
    assert size.seconds == size.coarse + size.refined + size.response
    assert band_seconds(plate, 36e3) > size.coarse


@pytest.mark.slow
def test_the_counted_unknowns_are_those_that_are_solved() -> None:
    from squeezefilm.physics.plate.solid.layers import NORMAL
    from squeezefilm.physics.plate.solid.mesh import plate_model
    from squeezefilm.physics.plate.solid.working import solid_mode

    plate = random_plate(502)
    solved = solid_mode(plate)
    size = solve_size(plate, plate.working_label, solved.frequency)
    assert solved.modes.unknowns <= size.unknowns
    parity = solved.modes.parities[solved.index]
    assert expected_seconds(plate_model(plate, 1.15 * solved.frequency, NORMAL, parity)) > 0


def test_what_is_foreseen_is_one_sentence() -> None:
    said = foreseen("biet2008-plate").sentence
    assert said.startswith(
        "expected about 33.7 kHz (mostly right to 15 %), 110 nm/V (to a factor of two), by a beam; "
        "solving"
    )
    assert (
        foreseen("biet2008-stator").sentence
        == "expected about 40.5 kHz, 14 nm/V, by its measurement"
    )
