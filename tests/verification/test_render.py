"""The envelope against closed forms: the paper's plate, exactness in time, order in time step."""

import math

import numpy as np
import pytest

from squeezefilm.physics.render.resonator.envelope import (
    DrivenEnvelope,
    envelope_bandwidth,
    envelope_time_constant,
    finest_period,
    sine_swing_kept,
)

LOW, HIGH = 0.2e-6, 2e-6


def response(command: np.ndarray, step: float, tau: float) -> np.ndarray:
    """A resonator's envelope from LOW on."""
    return DrivenEnvelope(tau, tau, HIGH).response(command, step, LOW)


def test_the_plate_of_the_paper() -> None:
    """PHYSICS §4: Q = 60 at 34.77 kHz and at the measured 30.5 kHz."""
    tau = envelope_time_constant(60.0, 34.77e3)
    assert tau == pytest.approx(0.5493e-3, rel=1e-4)
    assert envelope_bandwidth(60.0, 34.77e3) == pytest.approx(289.75)
    speeds = np.array([0.05, 0.1, 0.2])
    assert np.round(finest_period(speeds, tau) * 1e3, 2).tolist() == [0.16, 0.32, 0.65]
    slower = envelope_time_constant(60.0, 30.5e3)
    assert np.round(finest_period(speeds, slower) * 1e3, 2).tolist() == [0.18, 0.37, 0.74]


def test_bandwidth_is_where_a_sine_keeps_one_over_root_two() -> None:
    tau, speed = envelope_time_constant(60.0, 34.77e3), 0.1
    period = speed / envelope_bandwidth(60.0, 34.77e3)
    assert sine_swing_kept(period, speed, tau) == pytest.approx(1 / math.sqrt(2))


def test_the_response_to_a_step_is_exact_at_any_time_step() -> None:
    for step in (1e-6, 1e-4, 1e-3, 1e-1):
        exact = HIGH + (LOW - HIGH) * np.exp(-np.arange(50) * step / 1e-3)
        assert response(np.full(50, HIGH), step, 1e-3) == pytest.approx(exact, rel=1e-12)


def test_splitting_every_step_changes_nothing() -> None:
    command = np.random.default_rng(2).uniform(0, HIGH, 200)
    coarse = response(command, 1e-4, 3e-4)
    for parts in (2, 7):
        fine = response(np.repeat(command, parts), 1e-4 / parts, 3e-4)
        assert fine[::parts] == pytest.approx(coarse, rel=1e-12)


def test_a_sine_is_followed_to_second_order_in_the_time_step() -> None:
    speed, period, tau = 0.1, 1e-3, 0.55e-3
    angular = 2 * math.pi * speed / period
    gain, late = sine_swing_kept(period, speed, tau), math.atan(angular * tau)
    errors = []
    for samples in (16, 32, 64):
        step = period / speed / samples
        time = step * np.arange(20 * samples)
        middle, half = (LOW + HIGH) / 2, (HIGH - LOW) / 2
        # Held over a step, at the value of its middle.
        amplitude = response(middle + half * np.sin(angular * (time + step / 2)), step, tau)
        exact = middle + half * gain * np.sin(angular * time - late)
        errors.append(np.max(np.abs(amplitude - exact)[time > 30 * tau]))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([2.0, 2.0], abs=0.05)
