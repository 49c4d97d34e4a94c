"""What a plate asks of its amplifier, against circuits whose answer is known."""

import dataclasses
from typing import Any

import numpy as np
import pytest
from tests.lost_power import lost_power

from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.circuit import DrivenResponse, EquivalentCircuit
from squeezefilm.physics.plate.electronics import (
    AMPLIFIERS,
    AmplifierPart,
    amplifier_check,
    driven_ceramics,
    electrical_load,
    load_of_mode,
    ring_admittance,
)
from squeezefilm.physics.plate.layout import AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.ring.body import ring_body
from squeezefilm.physics.plate.ring.modes import annular_admittance, clamped_capacitance
from squeezefilm.physics.plate.working_mode import working_mode

# C0 of 5 nF beside R1, L1, C1 in resonance at 40 kHz with Q = 100.
F0, Q, R1 = 40e3, 100.0, 2000.0
L1 = Q * R1 / (2 * np.pi * F0)
CIRCUIT = EquivalentCircuit(F0, Q, 5e-9, R1, L1, 1 / ((2 * np.pi * F0) ** 2 * L1))


class Response(DrivenResponse):
    """The circuit's own admittance around its resonance, on a grid that has the resonance."""

    def __init__(self) -> None:
        self.frequencies = np.linspace(39e3, 41e3, 201)
        self.admittance = CIRCUIT.admittance(self.frequencies)


def test_at_resonance_the_motional_resistor_and_the_held_capacitance_are_the_load() -> None:
    load = electrical_load(Response(), 30.0, F0, circuit=CIRCUIT, channels=4)
    omega = 2 * np.pi * F0
    Y = 1 / R1 + 1j * omega * 5e-9
    assert load.current == pytest.approx(30 * abs(Y))
    assert load.real_power == pytest.approx(30**2 / (2 * R1))
    assert load.apparent_power == pytest.approx(load.current * 30 / 2)
    assert load.power_factor == pytest.approx(load.real_power / load.apparent_power)
    assert load.slew_rate == pytest.approx(omega * 30)
    assert (load.capacitance, load.capacitance_per_channel) == (5e-9, 1.25e-9)
    assert load.current_per_channel == pytest.approx(load.current / 4)


@pytest.mark.parametrize("frequency", [39.2e3, 39.99e3, F0, 40.9e3])
def test_each_inductor_leaves_a_resistor_and_the_power_as_it_is(frequency: float) -> None:
    load = electrical_load(Response(), 30.0, frequency)
    omega = 2 * np.pi * frequency
    Y = np.interp(frequency, Response().frequencies, Response().admittance)
    assert load.parallel_inductance is not None
    assert load.series_inductance is not None
    beside = Y + 1 / (1j * omega * load.parallel_inductance)
    assert beside.imag == pytest.approx(0, abs=1e-12)
    assert load.matched_current == pytest.approx(30 * beside.real)
    before = 1 / Y + 1j * omega * load.series_inductance
    assert before.imag == pytest.approx(0, abs=1e-9)
    assert load.matched_voltage == pytest.approx(load.current * before.real)
    assert load.matched_current * 30 / 2 == pytest.approx(load.real_power)
    assert load.matched_voltage * load.current / 2 == pytest.approx(load.real_power)
    assert load.matched_current <= load.current
    assert load.matched_voltage <= 30


def test_an_inductive_load_needs_no_inductor() -> None:
    # Hardly any capacitance: above its resonance the mode is an inductor.
    bare = dataclasses.replace(CIRCUIT, static_capacitance=1e-15)
    response = Response()
    response.admittance = bare.admittance(response.frequencies)
    load = electrical_load(response, 30.0, 40.3e3)
    assert (load.parallel_inductance, load.series_inductance) == (None, None)
    assert (load.matched_current, load.matched_voltage) == (load.current, 30.0)
    assert (load.capacitance, load.capacitance_per_channel) == (None, None)


def test_everything_grows_with_the_voltage_as_it_must() -> None:
    one, two = (electrical_load(Response(), volts, F0) for volts in (10.0, 20.0))
    for name, power in (("current", 1), ("slew_rate", 1), ("real_power", 2), ("power_factor", 0)):
        assert getattr(two, name) == pytest.approx(2**power * getattr(one, name))
    assert electrical_load(Response(), 0.0, F0).current == 0


def test_no_admittance_is_made_up_beyond_what_was_solved() -> None:
    for frequency in (38.9e3, 41.1e3):
        with pytest.raises(OutOfRangeError, match="was solved from 39 kHz to 41 kHz"):
            electrical_load(Response(), 10.0, frequency)


PART = AmplifierPart("a kind", "a part", ((50.0, 1.0), (100.0, 0.5)), 20e6, "nobody")


@pytest.mark.parametrize(
    ("asked", "suffices", "why"),
    [
        ((50.0, 1.0, 1e6), True, "gives 1 A, and 1 A is wanted at 50 V"),
        ((51.0, 0.6, 1e6), False, "gives 500 mA, and 600 mA is wanted at 51 V"),
        ((101.0, 0.1, 1e6), False, "gives 100 V at most, and 101 V is wanted"),
        ((50.0, 0.5, 21e6), False, "gives 20 V/µs, and 21 V/µs is wanted"),
    ],
)
def test_an_amplifier_is_asked_for_voltage_current_and_slope(
    asked: tuple[float, float, float], suffices: bool, why: str
) -> None:
    found = amplifier_check(PART, *asked)
    assert (found.suffices, found.why, found.source) == (suffices, why, "nobody")
    silent = dataclasses.replace(PART, slew_rate=None)
    assert amplifier_check(silent, 50.0, 0.5, 1e12).suffices


def test_the_currents_of_the_data_sheets_follow_from_their_loads() -> None:
    chip, op_amp, laboratory = AMPLIFIERS
    # I = 2π f C V̂ at 300 Hz, and of 100 nF at each power bandwidth.
    assert chip.ranges[-1] == pytest.approx((100.0, 2 * np.pi * 300 * 100e-9 * 100))
    assert chip.ranges[0] == pytest.approx((25.0, 2 * np.pi * 300 * 680e-9 * 25))
    assert laboratory.ranges[0] == pytest.approx((50.0, 2 * np.pi * 56e3 * 100e-9 * 50))
    assert op_amp.ranges == ((25.0, 10.0),)
    for one in AMPLIFIERS:
        assert one.source
        assert list(one.ranges) == sorted(one.ranges)


@pytest.mark.parametrize(
    ("name", "assumed"),
    [
        ("winfield2007-tpad", False),
        # Its fit takes seconds.
        pytest.param("biet2008-stator", True, marks=pytest.mark.slow),
    ],
)
def test_a_ring_takes_what_its_motion_and_its_capacitance_take(name: str, assumed: bool) -> None:
    """At resonance ω³MA²/2Q, the power that the motion loses, with A as the chain has it; beside
    the mode more than the capacitance of the held ceramic and less than that of a free one, 2.05
    times as much of PZT-5A (free and clamped permittivity 1700 and 830)."""
    actuator = load_display(name).actuator
    assert isinstance(actuator, AnnularStator | DiscPlate)
    mode, body = working_mode(actuator), ring_body(actuator)
    load = load_of_mode(actuator, mode, 20.0, mode.resonance_frequency)
    assert load is not None
    omega, amplitude = 2 * np.pi * mode.resonance_frequency, 20 * mode.amplitude_per_volt
    lost = omega**3 * body.mode().modal_mass * amplitude**2 / (2 * mode.quality_factor)
    assert load.real_power == pytest.approx(lost, rel=0.03)
    held = clamped_capacitance(body.section, body.drive)
    assert load.capacitance is not None
    assert held < load.capacitance < 2.05 * held
    assert load.channels == 1
    assert bool(load.assumed) == assumed
    # No voltage and no admittance far from the mode: nothing is made up.
    assert load_of_mode(actuator, mode, None, mode.resonance_frequency) is None
    assert load_of_mode(actuator, mode, 20.0, 3 * mode.resonance_frequency) is None


@pytest.mark.slow
def test_the_harmonics_that_are_taken_are_nearly_all_of_a_discs_admittance() -> None:
    disc = dataclasses.replace(
        load_display("winfield2007-tpad").actuator, nodal_circles=0, nodal_diameters=2, sectors=4
    )
    found, body = ring_admittance(disc), ring_body(disc)  # type: ignore[arg-type]
    some = found.frequencies[::40]
    whole = annular_admittance(
        body.section, body.drive, some, harmonics=range(23), quality_factor=body.quality_factor
    )
    assert np.abs(found.admittance[::40] / whole - 1).max() < 0.05


def test_a_stator_that_nothing_fits_has_no_load() -> None:
    stator = load_display("biet2008-stator").actuator
    mode = working_mode(stator)
    low = dataclasses.replace(stator, resonance_frequency=900.0)
    assert load_of_mode(low, mode, 20.0, 900.0) is None


@pytest.mark.slow
def test_a_stator_with_a_measured_amplitude_takes_the_current_that_its_circuit_takes() -> None:
    """The circuit and the curve are each set to that amplitude, in ways of their own."""
    stator = load_display("biet2008-stator").actuator
    assert isinstance(stator, AnnularStator)
    found = ring_admittance(stator)
    assert found.circuit is not None
    peak = found.admittance.real.max()
    assert peak == pytest.approx(1 / found.circuit.motional_resistance, rel=0.1)


def test_ceramics_that_are_driven_are_counted() -> None:
    plate: Any = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    assert driven_ceramics(plate) == 7
    one = dataclasses.replace(plate.patches[0], electrode="open")
    assert driven_ceramics(dataclasses.replace(plate, patches=(one, *plate.patches[1:]))) == 6


@pytest.mark.slow
def test_the_papers_plate_is_the_same_load_by_its_response_and_by_its_circuit() -> None:
    plate = load_display("biet2008-plate").actuator
    mode = working_mode(plate)
    load = load_of_mode(plate, mode, 15.0, mode.resonance_frequency)
    assert load is not None
    assert mode.solid is not None
    circuit = mode.solid.circuit
    assert circuit is not None
    Y = circuit.admittance(np.array([mode.resonance_frequency]))[0]
    assert load.current == pytest.approx(15 * abs(Y), rel=0.01)
    assert load.real_power == pytest.approx(15**2 / 2 * Y.real, rel=0.01)
    at = int(np.argmin(np.abs(mode.solid.response.frequencies - mode.resonance_frequency)))
    dissipated = lost_power(mode.solid.response, 15.0)[at]
    assert load.real_power == pytest.approx(dissipated, rel=0.01)
    assert [check.suffices for check in load.amplifiers] == [False, True, True]
    assert load_of_mode(plate, mode, 15.0, 60e3) is None
    assert load_of_mode(plate, mode, None, mode.resonance_frequency) is None
