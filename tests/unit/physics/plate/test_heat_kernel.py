"""The compiled heat (`physics.plate.heat_states`) against textbooks, integrals and scipy."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squeezefilm.physics.plate import heat_states as k
from squeezefilm.physics.plate.thermal import Cooling

LINEAR = k.Drifts(0.0, 0.0, 0.0, 0.0, 0.0)
DRIVEN = k.Driven(30e3, 60.0, 2e-6, 5.0, 0.1, 1e4)


def plate(emissivity: float = 0.0, length: float = 15e-3) -> Cooling:
    return Cooling(0.0, 4e-3, length, emissivity, 293.15)


def test_a_measured_resistance_is_taken_as_it_is() -> None:
    assert k.conductance(50.0, plate()._replace(fixed=0.1)) == 0.1


def test_a_plate_barely_warm_conducts_into_air_at_rest_and_radiates() -> None:
    # A disc of radius a at one temperature conducts 8 k a from both faces (Weber's disc).
    a = 5e-6
    tiny = Cooling(0.0, math.pi * a**2, a / 2, 0.0, 300.0)
    assert k.conductance(0.0, tiny) == pytest.approx(8 * 0.0263 * a, rel=1e-9)
    black = tiny._replace(emissivity=1.0)
    light = k.conductance(0.0, black) - k.conductance(0.0, tiny)
    assert light == pytest.approx(2 * tiny.area * 4 * 5.670374e-8 * 300**3, rel=1e-6)
    hot = k.conductance(100.0, black) - k.conductance(100.0, tiny)
    both = 2 * tiny.area * 5.670374e-8 * (400**4 - 300**4) / 100
    assert hot == pytest.approx(both, rel=1e-6)


def test_convection_is_that_of_horizontal_plates_in_textbooks() -> None:
    # At a film of 300 K with Ra = 1e4: 0.54 Ra^(1/4) above, 0.52 Ra^(1/5) below.
    rise = 20.0
    nu_over_buoyancy = 9.81 * rise / 300.0 / (15.89e-6 * 22.5e-6)
    length = (1e4 / nu_over_buoyancy) ** (1 / 3)
    found = k.conductance(rise, Cooling(0.0, 1.0, length, 0.0, 290.0))
    expected = (0.54 * 10 + 0.52 * 10**0.8) * 0.0263 / length
    assert found == pytest.approx(expected, rel=0.01)
    # Faces of 83 x 49 mm lose 5 to 13 W/(m2 K) each, as handbooks say of still air.
    for warm in (10.0, 50.0, 100.0):
        assert 10 < k.conductance(warm, plate(0.3)) / 4e-3 < 26


def test_warming_is_the_exponential_for_a_fixed_conductance_whatever_the_step() -> None:
    fixed = plate()._replace(fixed=0.1)
    one = k.warmed(3.0, 5.0, 90.0, 40.0, fixed)
    assert one == pytest.approx(50.0 + (3.0 - 50.0) * math.exp(-90.0 * 0.1 / 40.0), rel=1e-14)
    many = 3.0
    for _ in range(90):
        many = k.warmed(many, 5.0, 1.0, 40.0, fixed)
    assert many == pytest.approx(one, rel=1e-12)


def test_warming_with_a_computed_conductance_converges_to_scipy_in_first_order() -> None:
    cooling, capacity, power, span = plate(0.5), 40.0, 8.0, 300.0
    exact = solve_ivp(
        lambda _, y: (power - k.conductance(float(y[0]), cooling) * y) / capacity,
        (0, span), [0.0], "DOP853", rtol=1e-10, atol=1e-10,
    ).y[0, -1]  # fmt: skip
    errors = []
    for steps in (50, 100, 200):
        rise = 0.0
        for _ in range(steps):
            rise = k.warmed(rise, power, span / steps, capacity, cooling)
        errors.append(abs(rise - exact))
    assert errors[2] < 2e-3 * exact
    order = np.log2(errors[0] / errors[2]) / 2
    assert order == pytest.approx(1.0, abs=0.1)


def test_the_rayleigh_law_ties_loss_to_softening() -> None:
    # Strain over a loop of stress X0: (s0 + a X0) X ± a/2 (X0² − X²), + on the way down.
    s0, a, top = 1.0, 0.05, 1.0
    x = np.linspace(-top, top, 20_001)
    up = (s0 + a * top) * x - a / 2 * (top**2 - x**2)
    down = (s0 + a * top) * x + a / 2 * (top**2 - x**2)
    area = np.trapezoid(down - up, x)
    stored = 0.5 * s0 * top**2
    loss = area / (2 * math.pi * stored)  # per softening, to first order
    softening = 0.5 * a * top / s0
    drifts = LINEAR._replace(softening=1e-3)
    quality, gain, soft = k.changed(60.0, 0.0, 2.0, 0.0, drifts)
    assert soft == pytest.approx(1 - 2e-3)
    assert 1 / quality - 1 / 60 == pytest.approx(loss / softening * 2e-3, rel=1e-6)
    assert gain == 1


def test_coefficients_of_warmth_and_field_change_what_they_say() -> None:
    drifts = k.Drifts(-1e-4, 2e-3, -1e-3, 0.0, 1e-6)
    quality, gain, soft = k.changed(60.0, 50.0, 1.0, 2e4, drifts)
    assert (quality, soft) == (pytest.approx(66.0), 1.0)
    assert gain == pytest.approx(0.95 * 1.02)
    # None turns a sign, however hot.
    quality, gain, _ = k.changed(60.0, 1e4, 1.0, 0.0, k.Drifts(0, -1e-2, -1e-2, 0, 0))
    assert quality > 0
    assert gain > 0


def test_power_goes_with_the_square_of_the_amplitude_over_q() -> None:
    at_rest = k.lost(0.0, 0.0, DRIVEN, LINEAR)
    assert at_rest == (2e-6, pytest.approx(5.1))
    detuned = 30e3 * (1 + 1 / 120)
    moved, power = k.lost(detuned, 0.0, DRIVEN, LINEAR)
    off = 60 * ((detuned / 30e3) ** 2 - 1)
    assert moved == pytest.approx(2e-6 / math.sqrt(1 + off**2), rel=1e-12)
    pace = detuned / 30e3
    assert power == pytest.approx(pace * (5.0 / (1 + off**2) + 0.1), rel=1e-12)
    # A warmer plate with a lower Q: amplitude goes with Q, power at resonance too.
    moved, power = k.lost(0.0, 10.0, DRIVEN, LINEAR._replace(quality=-1e-2))
    assert (moved, power) == (pytest.approx(1.8e-6), pytest.approx(4.6))


def test_a_softening_mode_settles_where_amplitude_and_resonance_agree() -> None:
    soft = LINEAR._replace(softening=0.05)
    for frequency in (0.0, 29e3, 29.8e3, 30e3):
        moved = k.amplitude(frequency, 0.0, DRIVEN, soft)
        again = k.response(frequency, 0.0, moved, DRIVEN, soft)
        assert again == pytest.approx(moved, rel=1e-3)
        assert moved <= 2e-6
    assert k.amplitude(0.0, 0.0, DRIVEN, soft) < k.amplitude(0.0, 0.0, DRIVEN, LINEAR)


def test_the_time_to_fall_is_the_linear_one_where_power_hardly_changes() -> None:
    # A plate whose dielectric loss alone warms it: θ = P R (1 − exp(−t/τ)).
    driven = DRIVEN._replace(mechanical=0.0, dielectric=5.0)
    drifts, fixed = LINEAR._replace(frequency=-1e-4), plate()._replace(fixed=0.1)
    resistance, tau = 10.0, 400.0
    warm: Any = (30e3, driven, drifts, 40.0, fixed)
    found = k.time_until(0.9 * 2e-6, 0.2, 40_000, warm)
    off = math.sqrt(1 / 0.81 - 1) / 60
    rise = (1 - 1 / math.sqrt(1 + off)) / 1e-4
    exact = -tau * math.log(1 - rise / (5.0 * resistance))
    assert found == pytest.approx(exact, rel=1e-4)
    assert k.time_until(0.1 * 2e-6, 0.2, 40_000, warm) == -1.0


def test_surpluses_are_power_less_what_is_given_away() -> None:
    cooling = plate(0.5)
    rises = np.array([0.0, 20.0, 80.0])
    found = k.surpluses(rises, 30e3, DRIVEN, LINEAR, cooling)
    given = [k.conductance(float(one), cooling) * one for one in rises]
    np.testing.assert_allclose(found, 5.1 - np.array(given), rtol=1e-12)
