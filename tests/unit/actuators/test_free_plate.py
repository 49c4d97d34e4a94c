"""A freely vibrating plate that bends with its amplitude: in time, in the mean, from sweeps."""

from dataclasses import replace

import numpy as np
import pytest
from tests.made_bench.duffing import SofteningResonance

from squeezefilm.actuators.motor.assembled import AssembledMotor, Working
from squeezefilm.actuators.motor.averaged import averaged, free_amplitude
from squeezefilm.actuators.motor.in_time import simulate
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.measure.fits.vibration.voltage_sweeps import fit_voltage_sweeps
from squeezefilm.measure.recordings.kinds import FrequencyResponse, VoltageSweeps
from squeezefilm.physics.plate.loaded_mode import FreePlate

from .test_motor import motor

SQUARE = FreePlate(by_square=-0.005 / (2e-6) ** 2, loss_rise=0.2 / 2e-6)
PROPORTIONAL = FreePlate(by_amplitude=-0.005 / 2e-6, loss_rise=0.2 / 2e-6)


def free(law: FreePlate) -> AssembledMotor:
    """A motor whose feet touch nothing that the plate feels."""
    there = motor()
    nothing = np.zeros_like(there.feet.across)
    feet = there.feet._replace(across=nothing, along=nothing)
    return replace(there, motor=replace(there.motor, free_plate=law), feet=feet)


def resonance(there: AssembledMotor, law: FreePlate) -> SofteningResonance:
    mode = there.modes[0].working
    return SofteningResonance(
        mode.resonance_frequency,
        mode.quality_factor,
        mode.amplitude_per_volt,
        law.by_square,
        law.loss_rise,
    )


@pytest.mark.slow
def test_in_time_the_amplitude_is_that_of_a_softening_resonance() -> None:
    there = free(SQUARE)
    alone = resonance(there, SQUARE)
    for shift in (-0.01, -0.003, 0.003):
        f = there.resonance_frequency * (1 + shift)
        working = Working(voltage=15.0, frequency=f)
        expected = abs(alone.swept(np.linspace(1.03, 1 + shift, 60) * f / (1 + shift), 15.0)[-1])
        found = simulate(there, working, speed=0.0, periods=600)
        assert found.period_amplitude[-1] == pytest.approx(expected, rel=5e-3)
        assert free_amplitude(there, working) == pytest.approx(expected, rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("law", [SQUARE, PROPORTIONAL])
def test_the_mean_has_the_backbone_that_time_has(law: FreePlate) -> None:
    there = free(law)
    for f in (0.99, 0.995, 1.0):
        working = Working(voltage=15.0, frequency=f * there.resonance_frequency)
        found = simulate(there, working, speed=0.0, periods=600)
        assert free_amplitude(there, working) == pytest.approx(found.period_amplitude[-1], rel=5e-3)
    assert found.energy_residual < 1e-4


def test_a_plate_that_softens_is_driven_below_its_small_resonance() -> None:
    soft = replace(motor(), motor=replace(motor().motor, free_plate=PROPORTIONAL))
    working = Working(voltage=15.0)
    assert averaged(soft, working).amplitude < averaged(motor(), working).amplitude
    assert free_amplitude(motor(), working) == pytest.approx(
        15.0 * motor().modes[0].working.amplitude_per_volt, rel=1e-6
    )
    assert free_amplitude(motor(), Working(amplitude=1e-6)) == 1e-6


def test_what_sweeps_measured_goes_into_a_motor() -> None:
    there = free(SQUARE)
    alone = resonance(there, SQUARE)
    f = np.linspace(0.96, 1.04, 90) * alone.frequency
    random, sweeps, ways = np.random.default_rng(2), [], []
    # The point that was measured moves half as much as the lobe.
    for volts in (2.0, 6.0, 15.0):
        for way in ("up", "down"):
            at = f if way == "up" else f[::-1]
            parts = 1e-9 * random.standard_normal((2, at.size))
            x = 0.5 * alone.swept(at, volts) + parts[0] + 1j * parts[1]
            sweeps.append(FrequencyResponse(at, x / volts, volts))
            ways.append(way)
    fit = fit_voltage_sweeps(VoltageSweeps(tuple(sweeps), tuple(ways)))
    found = fit.free_plate(share=0.5)
    assert found.by_amplitude == 0.0
    assert found.by_square == pytest.approx(SQUARE.by_square, rel=0.05)
    assert found.loss_rise == pytest.approx(SQUARE.loss_rise, rel=0.1)
    working = Working(voltage=15.0)
    assert free_amplitude(free(found), working) == pytest.approx(
        free_amplitude(there, working), rel=0.01
    )
    falling = replace(fit, damping_rise=replace(fit.damping_rise, value=-1e6))
    with pytest.raises(InputError, match="losses fall with the amplitude"):
        falling.free_plate()
    with pytest.raises(InputError, match="not adequate"):
        replace(fit, adequacy=replace(fit.adequacy, adequate=False)).free_plate()


def test_a_law_beyond_its_range_is_refused() -> None:
    wild = replace(motor(), motor=replace(motor().motor, free_plate=FreePlate(by_amplitude=-1e5)))
    with pytest.raises(OutOfRangeError, match=r"would change .* by -1\d %; .* holds to 5 %"):
        averaged(wild, Working(voltage=15.0))
