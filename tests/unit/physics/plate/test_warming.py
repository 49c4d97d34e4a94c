"""The states of a warm plate: closed forms, energy, several states, and what is said of them."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.optimize import brentq

from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.beam_response import patch_capacitance
from squeezefilm.physics.plate.heat_states import (
    EMISSIVITIES,
    HeatSource,
    conductance,
    cooling_of,
    drifts_of,
    heat_capacity,
)
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.thermal import LOSS_TANGENT, Thermal, thermal_body
from squeezefilm.physics.plate.warming import (
    heat_source,
    warming,
    warming_of_mode,
)
from squeezefilm.physics.plate.working_mode import working_mode

DISPLAY = load_display("biet2008-plate")
PLATE = DISPLAY.actuator
assert isinstance(PLATE, RectangularPlate)
SOURCE = HeatSource(33e3, 60.0, 1.7e-6, 7.8, quality_of_ceramic=60.0, field=15e3)
MEASURED = Thermal(thermal_resistance=12.0, thermal_time=480.0)


def test_a_fixed_resistance_gives_the_closed_form_where_the_frequency_follows() -> None:
    found = warming(SOURCE, PLATE, MEASURED)
    # The frequency falls by that much as well, and with it the power at a constant stiffness.
    rise = 7.8 * 12 / (1 + 7.8 * 12 * 1e-4)
    assert found.tracked.temperature_rise == pytest.approx(rise, rel=1e-9)
    assert found.tracked.resonance_drift == pytest.approx(-33e3 * 1e-4 * rise)
    assert found.tracked.amplitude == pytest.approx(1.7e-6, rel=1e-12)
    assert (found.thermal_resistance, found.thermal_time) == (pytest.approx(12), pytest.approx(480))
    assert found.half_bandwidth == pytest.approx(275)
    assert found.heat_capacity == pytest.approx(40.0)


def test_at_a_fixed_frequency_the_state_is_where_both_agree() -> None:
    found = warming(SOURCE, PLATE, MEASURED)

    def surplus(rise: float) -> float:
        off = 60 * (1 / (1 - 1e-4 * rise) ** 2 - 1)
        return 7.8 / (1 + off**2) * 12 - rise

    exact = brentq(surplus, 0.0, 100.0)
    assert found.fixed.temperature_rise == pytest.approx(exact, rel=1e-6)
    off = 60 * (1 / (1 - 1e-4 * exact) ** 2 - 1)
    assert found.fixed.amplitude == pytest.approx(1.7e-6 / math.sqrt(1 + off**2), rel=1e-6)
    assert found.other_fixed == ()
    assert found.time_to_fall is not None
    assert 0 < found.time_to_fall < 480


@pytest.mark.parametrize("voltage", [1.0, 5.0, 15.0, 60.0])
def test_what_is_lost_is_given_away_in_every_state(voltage: float) -> None:
    factor = (voltage / 15) ** 2
    source = dataclasses.replace(
        SOURCE, mechanical_power=7.8 * factor, dielectric_power=0.03 * factor,
        amplitude=1.7e-6 * voltage / 15,
    )  # fmt: skip
    thermal, body = Thermal(), thermal_body(PLATE)
    found = warming(source, PLATE, thermal)
    cooling = cooling_of(thermal, body)
    for state in (found.tracked, found.fixed):
        given = conductance(state.temperature_rise, cooling) * state.temperature_rise
        assert given == pytest.approx(state.power, rel=1e-6)
    given = conductance(found.tracked.temperature_rise, cooling)
    assert found.thermal_resistance == pytest.approx(1 / given)
    assert found.thermal_time == pytest.approx(body.heat_capacity / given)


def test_still_air_gives_the_plate_about_what_the_twin_once_assumed() -> None:
    # 12 K/W and 480 s were assumed; computed it is less where it is hotter.
    found = [warming(dataclasses.replace(SOURCE, mechanical_power=p), PLATE) for p in (1.0, 7.8)]
    mild, hot = (one.thermal_resistance for one in found)
    assert 9 < hot < mild < 14
    assert 300 < found[1].thermal_time < found[0].thermal_time < 550


def test_a_softening_drift_from_below_has_two_states_and_from_cold_the_lower_is_reached() -> None:
    strong = dataclasses.replace(MEASURED, temperature_coefficient=-1e-3)
    drive = 33e3 * 0.96
    found = warming(SOURCE, PLATE, strong, drive)
    (hot,) = found.other_fixed
    assert found.fixed.temperature_rise < 0.3 * hot.temperature_rise
    assert found.fixed.amplitude < 0.6 * hot.amplitude
    assert any("several states" in one for one in found.doubts)
    # Both are fixed points, and a slope below the air's makes them stable.
    rises = np.linspace(0, 100, 100_001)
    off = 60 * ((drive / (33e3 * (1 - 1e-3 * rises))) ** 2 - 1)
    net = 12 * (drive / 33e3) * 7.8 / (1 + off**2) - rises
    crossings = rises[:-1][(net[:-1] > 0) & (net[1:] <= 0)]
    expected = [found.fixed.temperature_rise, hot.temperature_rise]
    np.testing.assert_allclose(crossings, expected, atol=2e-3)


def test_a_plate_at_rest_and_one_held_at_room_temperature_stay_cold() -> None:
    still = warming(HeatSource(33e3, 60.0, 0.0, 0.0), PLATE)
    assert still.tracked.temperature_rise == still.fixed.temperature_rise == 0
    assert still.time_to_fall is None
    assert still.doubts == ()
    held = warming(SOURCE, PLATE, Thermal(thermal_resistance=0.0))
    assert held.fixed.temperature_rise == held.thermal_resistance == 0
    assert held.fixed.amplitude == pytest.approx(1.7e-6)


def test_a_plate_that_would_burn_is_said_to() -> None:
    found = warming(dataclasses.replace(SOURCE, mechanical_power=1e5), PLATE)
    assert found.tracked.temperature_rise == 2000
    assert any("destroyed" in one for one in found.doubts)


def test_what_is_doubtful_is_said_and_only_that() -> None:
    hot = warming(SOURCE, PLATE, MEASURED)
    said = " ".join(hot.doubts)
    assert "drifts by -306 Hz" in said
    assert "half-bandwidth is 275 Hz" in said
    assert "only up to 60 K" in said
    assert "soft ceramics" in said
    assert "coercive" not in said
    strong = dataclasses.replace(SOURCE, field=4e5, quality_of_ceramic=1000.0)
    said = " ".join(warming(strong, PLATE, MEASURED).doubts)
    assert "coercive field of 1 kV/mm" in said
    assert "m/s" not in said  # 0.25 m/s is little for a hard ceramic
    mild = dataclasses.replace(SOURCE, mechanical_power=0.1, amplitude=0.2e-6)
    assert warming(mild, PLATE).doubts == ()
    # Whoever measured what strong vibration does is not warned of it.
    known = dataclasses.replace(MEASURED, rayleigh_softening=1e-3)
    assert "soft ceramics" not in " ".join(warming(SOURCE, PLATE, known).doubts)
    # Nor is whoever states a limit that it keeps.
    fast = dataclasses.replace(MEASURED, highest_speed=2.0)
    assert "m/s" not in " ".join(warming(SOURCE, PLATE, fast).doubts)
    slow = dataclasses.replace(MEASURED, highest_speed=0.2)
    assert "0.2 m/s" in " ".join(warming(SOURCE, PLATE, slow).doubts)


def test_what_is_assumed_is_said() -> None:
    said = " ".join(warming(SOURCE, PLATE).assumed)
    for words in ("still air", "emissivity of 0.5", "-0.0001 per K", "linear"):
        assert words in said
    measured = dataclasses.replace(
        MEASURED, charge_temperature_coefficient=1e-3, rayleigh_softening=1e-3
    )
    (only,) = warming(SOURCE, PLATE, measured).assumed
    assert "temperature coefficient" in only
    assert drifts_of(measured) == (-1e-4, 0.0, 1e-3, 1e-3, 0.0)


def test_a_time_constant_alone_sets_the_capacity_of_a_plate_20_k_warm() -> None:
    thermal, body = Thermal(thermal_time=400.0), thermal_body(PLATE)
    given = conductance(20.0, cooling_of(thermal, body))
    assert heat_capacity(thermal, body) == pytest.approx(400 * given)
    assert heat_capacity(Thermal(thermal_resistance=0.0, thermal_time=1.0), body) > 0


def test_a_working_mode_loses_what_the_solved_plate_takes() -> None:
    mode = working_mode(PLATE)
    assert mode.solid is not None
    found = warming_of_mode(PLATE, DISPLAY.thermal, mode, 15.0)
    assert found is not None
    omega = 2 * math.pi * mode.resonance_frequency
    dielectric = 0.5 * omega * patch_capacitance(PLATE) * LOSS_TANGENT * 15**2
    # 7.83 W: the solved plate's admittance at its resonance, `squeezefilm plate`.
    assert found.cold_power - dielectric == pytest.approx(7.83, rel=0.01)
    assert warming_of_mode(PLATE, DISPLAY.thermal, mode, 0.0) is None
    unknown = dataclasses.replace(mode, modal_mass=None)
    assert warming_of_mode(PLATE, DISPLAY.thermal, unknown, 15.0) is None


def test_a_source_knows_the_ceramics_field_and_capacitance() -> None:
    found = heat_source(PLATE, 15.0, 33e3, 60.0, 1.7e-6, 7.8)
    assert found.field == pytest.approx(15e3)
    assert found.quality_of_ceramic == 60
    assert found.dielectric_power == pytest.approx(
        math.pi * 33e3 * patch_capacitance(PLATE) * 0.02 * 15**2
    )
    ring = load_display("biet2008-stator").actuator
    bare = heat_source(ring, 140.0, 40.5e3, 200.0, 2e-6, 1.0)
    assert (bare.field, bare.quality_of_ceramic, bare.dielectric_power) == (None, None, 0.0)


def test_a_plate_that_would_drift_to_no_frequency_at_all_keeps_some() -> None:
    """A coefficient stands for some tens of kelvin: beyond, it leaves a twentieth."""
    steep = dataclasses.replace(MEASURED, thermal_resistance=1e3, temperature_coefficient=-9e-3)
    for gain in (0.0, 5e-2):
        found = warming(
            SOURCE, PLATE, dataclasses.replace(steep, quality_temperature_coefficient=gain)
        )
        assert found.tracked.resonance_drift >= -0.95 * SOURCE.frequency * (1 + 1e-12)
        assert found.tracked.temperature_rise > 0


def test_the_ranges_are_those_of_the_assumed_emissivity_and_coefficient() -> None:
    """Each end is the state of a plate with that emissivity; a measured resistance leaves none."""
    found = warming(SOURCE, PLATE)
    rises = [
        warming(SOURCE, PLATE, Thermal(emissivity=emissivity)).tracked.temperature_rise
        for emissivity in EMISSIVITIES
    ]
    assert found.rise_range is not None
    assert found.rise_range == pytest.approx(tuple(sorted(rises)), rel=0.01)
    assert found.rise_range[0] < found.tracked.temperature_rise < found.rise_range[1]
    assert found.drift_range is not None
    assert found.drift_range[0] < found.tracked.resonance_drift < found.drift_range[1] < 0
    # Where one is told, neither the range nor the list of assumptions knows another.
    for told in (Thermal(thermal_resistance=9.0), Thermal(emissivity=0.3)):
        known = warming(SOURCE, PLATE, told)
        assert known.rise_range is None
        assert known.drift_range is not None
        assert not any("emissivity" in said for said in known.assumed)
    # The warmth hardly depends on the drift, so that only the coefficient's share is left in it.
    assert known.drift_range[0] / known.drift_range[1] == pytest.approx(4.0, rel=0.05)
