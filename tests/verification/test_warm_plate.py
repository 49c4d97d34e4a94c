"""The warm plate's states against a brute-force march of the twin's plant: the same display, one by
root-finding on the steady state, one by stepping the envelope through every 50 µs."""

import dataclasses
from functools import lru_cache

import pytest

from squeezefilm.instruments.twin.plant import Plant
from squeezefilm.instruments.twin.settings import PlateDrift, TwinAmplifier, TwinSettings
from squeezefilm.instruments.twin.working_point import WorkingPoint, working_point
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.thermal import Thermal
from squeezefilm.physics.plate.warming import Warming, warming_of_mode

# A plate that is warm within seconds: what it settles to does not depend on its heat capacity.
QUICK = 1.0
CALM = TwinSettings(
    drift=PlateDrift(ambient_swing=0.0), amplifier=TwinAmplifier(loss_tangent=0.0), truth_period=0.1
)


@lru_cache(maxsize=1)
def point() -> WorkingPoint:
    return working_point(load_display("winfield2007-tpad"), CALM)


def marched(thermal: Thermal, volts: float, *carriers: int, seconds: float = 12.0) -> Plant:
    """A plant that is driven at one carrier (mHz; 0 follows) after the other, each for a while."""
    display = dataclasses.replace(point().display, thermal=thermal)
    plant = Plant(dataclasses.replace(point(), display=display), CALM)
    for number, carrier in enumerate(carriers, 1):
        last = seconds if number == len(carriers) else 0.2
        plant.advance(plant.now + round(last * 1e6), round(volts * 1e6), carrier)
    return plant


def told(thermal: Thermal, volts: float, frequency: float | None = None) -> Warming:
    found = warming_of_mode(point().display.actuator, thermal, point().mode, volts, frequency)
    assert found is not None
    return found


def carrier(ratio: float = 1.0) -> int:
    return round(point().mode.resonance_frequency * ratio * 1000)


@pytest.mark.slow
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"thermal_resistance": 60.0},
        {"temperature_coefficient": -4e-4},
        {"quality_temperature_coefficient": -3e-3, "charge_temperature_coefficient": 2e-3},
        {"rayleigh_softening": 5e-3, "rayleigh_charge": 5e-6},
    ],
)
@pytest.mark.parametrize("volts", [5.0, 20.0])
def test_the_state_from_cold_is_that_of_the_plant(changes: dict[str, float], volts: float) -> None:
    thermal = dataclasses.replace(Thermal(thermal_time=QUICK), **changes)  # type: ignore[arg-type]
    found = told(thermal, volts, carrier() * 1e-3)
    plant = marched(thermal, volts, carrier())
    assert plant.temperature_rise == pytest.approx(found.fixed.temperature_rise, rel=5e-3)
    assert plant.amplitude == pytest.approx(found.fixed.amplitude, rel=5e-3)
    plant = marched(thermal, volts, 0)
    assert plant.temperature_rise == pytest.approx(found.tracked.temperature_rise, rel=5e-3)
    assert plant.amplitude == pytest.approx(found.tracked.amplitude, rel=5e-3)
    drift = plant.resonance_frequency - point().mode.resonance_frequency
    assert drift == pytest.approx(found.tracked.resonance_drift, rel=5e-3)


@pytest.mark.slow
def test_both_find_both_states_of_a_plate_driven_from_below() -> None:
    thermal = Thermal(thermal_resistance=60.0, thermal_time=QUICK, temperature_coefficient=-1e-3)
    found = told(thermal, 20.0, carrier(0.96) * 1e-3)
    (hot,) = found.other_fixed
    cold = marched(thermal, 20.0, carrier(0.96))
    assert cold.temperature_rise == pytest.approx(found.fixed.temperature_rise, rel=2e-2)
    assert cold.amplitude == pytest.approx(found.fixed.amplitude, rel=2e-2)
    # Coming down from the resonance slowly the plate takes its own resonance along.
    down = [carrier(1 - 0.04 * n / 40) for n in range(41)]
    warm = marched(thermal, 20.0, *down)
    assert warm.temperature_rise == pytest.approx(hot.temperature_rise, rel=2e-2)
    assert warm.amplitude == pytest.approx(hot.amplitude, rel=2e-2)
    assert warm.amplitude > 2 * cold.amplitude


@pytest.mark.slow
def test_the_time_to_lose_a_tenth_is_that_of_the_plant() -> None:
    thermal = Thermal(thermal_time=QUICK)
    found = told(thermal, 20.0, carrier() * 1e-3)
    assert found.time_to_fall is not None
    plant = marched(thermal, 20.0, carrier(), seconds=found.time_to_fall)
    assert plant.amplitude == pytest.approx(0.9 * found.cold_amplitude, rel=5e-3)
