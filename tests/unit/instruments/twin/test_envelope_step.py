"""The tables, one step of the envelope and what the amplifier gives, against other ways there."""

from __future__ import annotations

import cmath
import itertools
import math

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from squeezefilm.instruments.twin.envelope_step import (
    Electrical,
    EnvelopeLimits,
    Fingers,
    Resonance,
    between,
    decay_rate,
    drawn_current,
    envelope_step,
    finger_on_mode,
    table_place,
    voltage_given,
)

HIGHEST = 3e-6
FORCES = np.array([0.1, 0.4, 0.5, 2.0])
AMPLITUDES = HIGHEST * (np.arange(6) / 5) ** 2
_dice = np.random.default_rng(5)
FRICTION = _dice.uniform(0.1, 1.0, (4, 6))
LOAD = _dice.uniform(0.1, 1.0, (4, 6)) + 1j * _dice.uniform(0.1, 1.0, (4, 6))
FINGERS = Fingers(FORCES, LOAD, HIGHEST)
SOME_FORCES = (0.1, 0.15, 0.4, 0.45, 0.5, 0.9, 2.0)
SOME_AMPLITUDES = (0.0, 0.01e-6, 0.12e-6, 0.3e-6, 1.0e-6, 1.92e-6, 2.5e-6, 2.999e-6, 3e-6)


def test_tables_are_read_linearly_between_their_points() -> None:
    for force, amplitude in itertools.product(SOME_FORCES, SOME_AMPLITUDES):
        i, p, j, q, beyond = table_place(force, amplitude, FINGERS)
        assert not beyond
        assert 0.0 <= p <= 1.0
        assert 0.0 <= q <= 1.0
        for table in (FRICTION, LOAD):
            expected = RegularGridInterpolator((FORCES, AMPLITUDES), table)([[force, amplitude]])
            assert between(table, i, p, j, q) == pytest.approx(expected[0], rel=1e-9)


def test_what_lies_outside_the_tables_is_held_at_their_edge() -> None:
    def read(force: float, amplitude: float) -> tuple[float, bool]:
        i, p, j, q, beyond = table_place(force, amplitude, FINGERS)
        return float(between(FRICTION, i, p, j, q)), bool(beyond)

    assert read(0.01, 0.0) == (pytest.approx(FRICTION[0, 0]), False)
    assert read(9.0, 0.0) == (pytest.approx(FRICTION[3, 0]), False)
    assert read(9.0, HIGHEST) == (pytest.approx(FRICTION[3, 5]), False)
    assert read(0.4, 5e-6) == (pytest.approx(FRICTION[1, 5]), True)
    # A rounding error is not beyond.
    assert read(0.4, HIGHEST * (1 + 1e-12)) == (pytest.approx(FRICTION[1, 5]), False)


def test_a_finger_lighter_than_the_tables_loads_in_proportion() -> None:
    assert finger_on_mode(0.0, 1e-6, FINGERS) == 0j
    assert finger_on_mode(-1.0, 1e-6, FINGERS) == 0j
    lightest = finger_on_mode(0.1, 1e-6, FINGERS)
    assert finger_on_mode(0.025, 1e-6, FINGERS) == pytest.approx(lightest / 4)
    # Heavier than that it is the tables' own.
    assert finger_on_mode(0.4, HIGHEST, FINGERS) == pytest.approx(LOAD[1, 5])
    assert finger_on_mode(2.0, 0.0, FINGERS) == pytest.approx(LOAD[3, 0])


def test_the_rate_is_the_one_of_the_module_s_equation() -> None:
    plate, load = Resonance(1.01, 60.0, 5e-4), 0.03 + 0.02j
    expected = (1 + 60 * 0.02 + 1j * 60 * (1.01**2 - 1 - 0.03)) / 5e-4
    assert decay_rate(plate, load) == pytest.approx(expected, rel=1e-12)


# In proportion to the amplitude, which the tables read exactly: no kinks to step over.
SMOOTH = Fingers(FORCES, np.tile((0.01 + 0.02j) * (1 + 3 * AMPLITUDES / HIGHEST), (4, 1)), HIGHEST)


def loaded_march(z: complex, held: float, span: float, plate: Resonance, force: float) -> complex:
    """The same equation by Runge and Kutta's fourth order in many small steps."""
    count, u = 400, held
    h = span / count

    def rate(at: complex) -> complex:
        delta = finger_on_mode(force, abs(at), SMOOTH)
        tuned = 1 + plate.quality * delta.imag
        tuned += 1j * plate.quality * (plate.ratio**2 - 1 - delta.real)
        return (u - tuned * at) / plate.time_constant

    for _ in range(count):
        a = rate(z)
        b = rate(z + 0.5 * h * a)
        c = rate(z + 0.5 * h * b)
        z += h / 6 * (a + 2 * b + 2 * c + rate(z + h * c))
    return z


@pytest.mark.parametrize("held", [0.0, 2e-6])
def test_a_loaded_step_is_of_second_order(held: float) -> None:
    plate, z, span = Resonance(1.002, 40.0, 1e-3), 0.6e-6 - 0.3e-6j, 200e-6
    exact = loaded_march(z, held, span, plate, 0.4)
    errors = []
    for parts in (1, 2, 4):
        found = z
        for _ in range(parts):
            found = envelope_step(found, held, span / parts, plate, 0.4, SMOOTH)
        errors.append(abs(found - exact))
    assert errors[0] < 1e-2 * abs(exact - z)
    assert math.log2(errors[0] / errors[2]) / 2 > 1.7


def test_without_a_finger_a_step_is_the_closed_form() -> None:
    plate, z, held, h = Resonance(0.99, 50.0, 2e-3), 1e-6 + 2e-6j, 3e-6, 1.5e-3
    rate = (1 + 1j * 50 * (0.99**2 - 1)) / 2e-3
    rest = held / (2e-3 * rate)
    expected = rest + (z - rest) * cmath.exp(-h * rate)
    assert envelope_step(z, held, h, plate, 0.0, FINGERS) == pytest.approx(expected, rel=1e-12)


def test_a_plate_that_stands_stays_and_a_driven_one_begins() -> None:
    plate = Resonance(1.0, 50.0, 2e-3)
    assert envelope_step(5e-16 + 0j, 0.0, 1e-4, plate, 0.0, FINGERS) == 0j
    assert abs(envelope_step(0j, 1e-6, 1e-4, plate, 0.0, FINGERS)) > 0.0
    # One picometre is no rest.
    assert abs(envelope_step(1e-12 + 0j, 0.0, 1e-4, plate, 0.0, FINGERS)) > 0.9e-12


OMEGA = 2e5
PLATE = Electrical(20e-9, 0.03, 0.4)
Z = 0.8e-6 + 0.5e-6j
FREE = EnvelopeLimits(100.0, 10.0, 1e9)


def test_the_current_is_the_capacitance_s_and_the_motional_one() -> None:
    expected = OMEGA * 20e-9 * 12.0 * (0.03 + 1j) + OMEGA * 0.4 * Z
    assert drawn_current(12.0, Z, OMEGA, PLATE) == pytest.approx(expected, rel=1e-12)


def test_each_limit_of_the_amplifier_holds() -> None:
    assert voltage_given(40.0, Z, OMEGA, PLATE, FREE) == 40.0
    assert voltage_given(100.0, Z, OMEGA, PLATE, FREE) == 100.0
    assert voltage_given(140.0, Z, OMEGA, PLATE, FREE) == 100.0
    given = voltage_given(40.0, Z, OMEGA, PLATE, EnvelopeLimits(100.0, 10.0, 4e6))
    assert given == pytest.approx(4e6 / OMEGA)
    assert voltage_given(0.0, 0j, OMEGA, PLATE, FREE) == 0.0


@pytest.mark.parametrize("z", [Z, -Z, 0j, 0.8e-6 - 0.6e-6j])
def test_a_current_that_is_too_large_is_brought_to_the_limit(z: complex) -> None:
    highest = 0.15
    given = voltage_given(90.0, z, OMEGA, PLATE, EnvelopeLimits(100.0, highest, 1e9))
    assert 0.0 < given < 90.0
    assert abs(drawn_current(given, z, OMEGA, PLATE)) == pytest.approx(highest, rel=1e-9)


def test_where_the_motion_alone_draws_too_much_nothing_is_given() -> None:
    # The motional current, 0.08 A across the capacitance's, is more than all that is allowed.
    given = voltage_given(90.0, 1e-6 + 0j, OMEGA, PLATE, EnvelopeLimits(100.0, 0.01, 1e9))
    assert given == 0.0
    # And where it is more already along it: both roots are below zero.
    given = voltage_given(90.0, 1e-6j, OMEGA, PLATE, EnvelopeLimits(100.0, 0.01, 1e9))
    assert given == 0.0
