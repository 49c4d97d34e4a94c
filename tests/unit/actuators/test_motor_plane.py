"""A slider free in the plane, in time, beside the march between events and the mean."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import root

from squeezefilm.actuators.motor import plane
from squeezefilm.actuators.motor.assembled import AssembledMotor, Stator, Working, assembled
from squeezefilm.actuators.motor.averaged import averaged
from squeezefilm.actuators.motor.in_time import simulate
from squeezefilm.actuators.motor.plane import _resting, simulate_plane

from .test_motor import PRELOAD, WORKING, final_speed, motor, plate

BOTH = replace(WORKING, second=1.0)


@cache
def planar(slider_mass: float = 0.05, direction: float = 0.0) -> AssembledMotor:
    """Three feet beside antinodes of both modes; both are driven by a volt, 1 kHz apart."""
    alone = motor().motor
    feet = tuple(replace(foot, y=0.0245 + 0.002) for foot in alone.feet)
    other = replace(plate(), lines_across="width", nodal_lines=5)
    cradle = replace(alone.cradle, direction=direction)
    described = replace(
        alone, feet=feet, second_plate=other, slider_mass=slider_mass, cradle=cradle
    )
    ready = assembled(described, "timoshenko")
    first, second = ready.modes
    driven = replace(
        second.working,
        amplitude_per_volt=first.working.amplitude_per_volt,
        resonance_frequency=first.working.resonance_frequency + 1e3,
    )
    return replace(ready, modes=(first, replace(second, working=driven)))


@pytest.mark.nightly
def test_along_one_line_it_is_the_march_between_events() -> None:
    for speed in (0.0, 0.02):
        events = simulate(motor(), WORKING, speed=speed, periods=200)
        found = simulate_plane(motor(), WORKING, velocity=(speed, 0.0), periods=200)
        assert found.thrust[0] == pytest.approx(events.thrust, abs=1e-4 * 0.3 * PRELOAD)
        assert found.thrust[1] == 0.0
    free = Working(voltage=15.0)
    events = simulate(motor(), free, periods=400)
    found = simulate_plane(motor(), free, periods=400)
    assert found.final_velocity[0] == pytest.approx(final_speed(events), rel=2e-3)
    assert found.period_amplitude[-1, 0] == pytest.approx(events.period_amplitude[-1], rel=2e-3)


@pytest.mark.parametrize("working", [BOTH, Working(voltage=15.0, second=1.0)])
@pytest.mark.parametrize("velocity", [None, (0.01, -0.01)])
def test_the_energy_closes_by_the_square_of_the_step(
    working: Working, velocity: tuple[float, float] | None
) -> None:
    guided = planar()
    cradle = replace(guided.motor.cradle, friction=0.1, damping=3.0)
    guided = replace(guided, motor=replace(guided.motor, cradle=cradle))
    steps = np.array([128, 256, 512, 1024])
    left = [
        simulate_plane(guided, working, velocity=velocity, periods=100, steps=n).energy_residual
        for n in steps.tolist()
    ]
    assert left[-1] < 1e-4
    order = -np.polyfit(np.log(steps), np.log(left), 1)[0]
    assert order > 1.5


def test_a_slider_free_in_the_plane_does_not_know_where_its_guide_points() -> None:
    straight = simulate_plane(planar(), BOTH, periods=300)
    turned = simulate_plane(planar(direction=np.pi / 2), BOTH, periods=300)
    there = np.stack([straight.period_velocity[:, 1], -straight.period_velocity[:, 0]], axis=1)
    np.testing.assert_allclose(turned.period_velocity, there, atol=1e-9)


def test_friction_holds_a_slider_in_every_direction() -> None:
    cradle = replace(planar().motor.cradle, friction=60.0)
    held = replace(planar(), motor=replace(planar().motor, cradle=cradle))
    assert not simulate_plane(held, BOTH, periods=50).period_velocity.any()


@pytest.mark.slow
def test_the_mean_holds_in_the_plane_where_the_slider_is_too_heavy_for_the_beat() -> None:
    """The modes are 1 kHz apart; 50 g on these feet follow that, 20 kg do not."""
    mean = averaged(planar(), BOTH)
    expected = np.array([mean.thrust, mean.sideways_thrust])
    heavy = simulate_plane(planar(20.0), BOTH, velocity=(0.0, 0.0), periods=8000, steps=64)
    light = simulate_plane(planar(), BOTH, velocity=(0.0, 0.0), periods=2000)
    most = 0.3 * PRELOAD
    assert np.max(np.abs(heavy.thrust - expected)) < 0.03 * most
    assert np.max(np.abs(light.thrust - expected)) > 0.04 * most


@pytest.mark.slow
def test_a_free_slider_ends_near_the_velocity_without_a_load() -> None:
    def thrust(velocity: np.ndarray) -> list[float]:
        there = averaged(
            planar(), BOTH, speed=1e-2 * velocity[0], sideways_speed=1e-2 * velocity[1]
        )
        return [there.thrust, there.sideways_thrust]

    # Where nothing pushes the slider any more.
    pushed = np.array(thrust(np.zeros(2)))
    balance = root(thrust, pushed / np.hypot(*pushed), tol=1e-6)
    expected = 1e-2 * balance.x
    assert np.hypot(*thrust(balance.x)) < 1e-3 * PRELOAD
    found = simulate_plane(planar(), BOTH, periods=4000).final_velocity
    # The same way within some degrees, and slower: it follows the beat.
    assert np.linalg.norm(found) < np.linalg.norm(expected)
    cosine = found @ expected / np.linalg.norm(found) / np.linalg.norm(expected)
    assert cosine > np.cos(np.radians(10))


@pytest.mark.slow
def test_two_voltages_find_two_amplitudes() -> None:
    working = Working(voltage=15.0, second=0.5)
    mean = averaged(planar(), working)
    heavy = simulate_plane(planar(20.0), working, velocity=(0.0, 0.0), periods=3000, steps=64)
    in_time = np.mean(heavy.period_amplitude[-500:], axis=0)
    assert mean.amplitude == pytest.approx(in_time[0], rel=0.05)
    assert mean.second_amplitude == pytest.approx(in_time[1], rel=0.05)


def test_the_path_is_kept() -> None:
    found = simulate_plane(planar(), BOTH, periods=10, steps=32)
    assert found.path.shape == (320, 2)
    assert found.time[-1] == pytest.approx(10 / planar().resonance_frequency)
    steps = np.diff(found.path[::32], axis=0) * planar().resonance_frequency
    np.testing.assert_allclose(steps, found.period_velocity[1:], atol=0.01)
    # Held amplitudes are what they are held at.
    assert found.period_amplitude.shape == (10, 2)
    held = [BOTH.amplitude, BOTH.second * found.period_amplitude[0, 0]]
    np.testing.assert_allclose(found.period_amplitude, np.tile(held, (10, 1)), rtol=1e-9)


def test_a_march_begins_at_rest_on_the_feet_with_the_modes_as_they_are_held() -> None:
    ready = planar()
    omega, phase, amplitude = np.array([2e5, 2.1e5]), np.array([0.3, -1.1]), np.array([1e-6, 2e-6])

    def held(time: float) -> np.ndarray:
        return np.asarray(amplitude * np.cos(omega * time + phase))

    stator: Any = SimpleNamespace(
        mass=np.ones(2), held=True, amplitude=amplitude, omega=omega, phase=phase
    )
    slider: Any = SimpleNamespace(preload=PRELOAD)
    march = _resting(ready, stator, slider, (0.02, -0.01))
    np.testing.assert_allclose(march.q, held(0.0))
    np.testing.assert_allclose(march.dq, (held(1e-9) - held(-1e-9)) / 2e-9, rtol=1e-6)
    height, rise, x, y, *velocity = march.slider
    assert (rise, x, y, velocity) == (0.0, 0.0, 0.0, [0.02, -0.01])
    feet = ready.feet
    assert feet.k_nn.sum() * -height == pytest.approx(PRELOAD)
    np.testing.assert_allclose(march.depth, feet.across @ march.q - height)
    np.testing.assert_allclose(march.last[:, 0], feet.along @ march.q)
    np.testing.assert_allclose(march.last[:, 1], ready.sideways @ march.q)
    stator.held = False
    free = _resting(ready, stator, slider, (0.0, 0.0))
    assert not np.any(free.q)
    assert not np.any(free.dq)


def test_kernels_agree_on_the_works_they_count() -> None:
    from squeezefilm.actuators.motor import kernel

    assert kernel.GUIDE_LOSS + 1 == kernel.THRUST == plane.TOTALS - 2
    assert Stator._fields[-1] == "held"
