"""Rendering against closed forms: steady swings, lag, exactness in time, order in time step."""

import math

import numpy as np
import pytest

from squeezefilm.physics.render.fidelity.survival import fidelity_table, swing_kept
from squeezefilm.physics.render.fidelity.trace import friction_trace
from squeezefilm.physics.render.motion.stroke import Stroke
from squeezefilm.physics.render.resonator.envelope import (
    envelope_bandwidth,
    envelope_response,
    envelope_time_constant,
    finest_period,
    sine_swing_kept,
    square_swing_kept,
)
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SineWave, SquareWave

LOW, HIGH = 0.2e-6, 2e-6


def linear(amplitude: np.ndarray, speed: object) -> np.ndarray:
    return 1 - amplitude / 5e-6


def test_the_plate_of_the_paper() -> None:
    """PHYSICS §4: Q = 60 at 34.77 kHz and at the measured 30.5 kHz."""
    tau = envelope_time_constant(60.0, 34.77e3)
    assert tau == pytest.approx(0.5493e-3, rel=1e-4)
    assert envelope_bandwidth(60.0, 34.77e3) == pytest.approx(289.75)
    speeds = np.array([0.05, 0.1, 0.2])
    assert np.round(finest_period(speeds, tau) * 1e3, 2).tolist() == [0.16, 0.32, 0.65]
    slower = envelope_time_constant(60.0, 30.5e3)
    assert np.round(finest_period(speeds, slower) * 1e3, 2).tolist() == [0.18, 0.37, 0.74]


def test_half_duty_is_the_tanh_law() -> None:
    ratios = np.array([1e-6, 1e-3, 1.0, 10.0, 1e3, 1e6])  # T/τ
    kept = square_swing_kept(ratios, 1.0, 1.0)
    assert kept == pytest.approx(np.tanh(ratios / 4), rel=1e-13)


def test_bandwidth_is_where_a_sine_keeps_one_over_root_two() -> None:
    tau, speed = envelope_time_constant(60.0, 34.77e3), 0.1
    period = speed / envelope_bandwidth(60.0, 34.77e3)
    assert sine_swing_kept(period, speed, tau) == pytest.approx(1 / math.sqrt(2))


def test_the_response_to_a_step_is_exact_at_any_time_step() -> None:
    for step in (1e-6, 1e-4, 1e-3, 1e-1):
        response = envelope_response(np.full(50, HIGH), step, 1e-3, LOW)
        exact = HIGH + (LOW - HIGH) * np.exp(-np.arange(50) * step / 1e-3)
        assert response == pytest.approx(exact, rel=1e-12)


def test_splitting_every_step_changes_nothing() -> None:
    command = np.random.default_rng(2).uniform(0, HIGH, 200)
    coarse = envelope_response(command, 1e-4, 3e-4, LOW)
    for parts in (2, 7):
        fine = envelope_response(np.repeat(command, parts), 1e-4 / parts, 3e-4, LOW)
        assert fine[::parts] == pytest.approx(coarse, rel=1e-12)


@pytest.mark.parametrize("duty", [0.25, 0.5, 0.75])
@pytest.mark.parametrize("ratio", [0.5, 2.0, 5.888, 30.0])  # T/τ; 5.888 keeps 90 % at duty ½
def test_a_simulated_square_keeps_the_swing_of_the_law(ratio: float, duty: float) -> None:
    speed, tau = 0.1, 0.55e-3
    period = ratio * tau * speed
    texture = Amplitude(SquareWave(period, duty=duty), LOW, HIGH)
    # 400 samples a period put the edges of these duties on samples: what is left is settling.
    trace = friction_trace(texture, Stroke(speed, 0.004), tau, linear, 400 * speed / period)
    law = square_swing_kept(period, speed, tau, duty)
    assert swing_kept(trace) == pytest.approx(law, rel=2e-4)
    assert swing_kept(trace, "relative_friction") == pytest.approx(law, rel=2e-4)


@pytest.mark.parametrize("ratio", [0.5, 3.0, 12.97, 60.0])
@pytest.mark.parametrize("passes", [1, 3])
def test_a_simulated_sine_keeps_the_swing_of_the_law(ratio: float, passes: int) -> None:
    speed, tau = 0.1, 0.55e-3
    period = ratio * tau * speed
    trace = friction_trace(
        Amplitude(SineWave(period, phase=0.7), LOW, HIGH), Stroke(speed, 0.006, passes), tau, linear
    )
    assert swing_kept(trace) == pytest.approx(sine_swing_kept(period, speed, tau), rel=1e-3)


def test_the_measured_swing_does_not_depend_on_the_sample_rate() -> None:
    speed, period, tau = 0.2, 0.4e-3, 0.55e-3
    kept = [
        swing_kept(
            friction_trace(
                Amplitude(SquareWave(period), LOW, HIGH),
                Stroke(speed),
                tau,
                linear,
                samples * speed / period,
            )
        )
        for samples in (4, 16, 64, 1024)
    ]
    assert kept == pytest.approx([square_swing_kept(period, speed, tau)] * 4, rel=1e-4)


def test_a_sine_is_followed_to_second_order_in_the_time_step() -> None:
    speed, period, tau = 0.1, 1e-3, 0.55e-3
    angular = 2 * math.pi * speed / period
    gain, late = 1 / math.hypot(1, angular * tau), math.atan(angular * tau)
    errors = []
    for samples in (16, 32, 64):
        trace = friction_trace(
            Amplitude(SineWave(period), LOW, HIGH),
            Stroke(speed),
            tau,
            linear,
            samples * speed / period,
        )
        exact = (LOW + HIGH) / 2 + (HIGH - LOW) / 2 * gain * np.sin(angular * trace.time - late)
        settled = trace.time > 30 * tau
        errors.append(np.max(np.abs(trace.amplitude - exact)[settled]))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([2.0, 2.0], abs=0.05)


def test_a_slow_texture_trails_the_finger_by_the_lag() -> None:
    stroke, tau = Stroke(0.1), 0.55e-3
    texture = Amplitude(SineWave(10e-3), LOW, HIGH)
    trace = friction_trace(texture, stroke, tau, linear)
    settled = trace.time > 20 * tau
    # Second order in ωτ = 0.035 is what separates a pure delay from a first-order lag.
    behind = texture(trace.position - trace.lag, 0.0, stroke.speed, trace.time)
    assert np.max(np.abs(trace.amplitude - behind)[settled]) < 1e-3 * (HIGH - LOW)


def settled_ends(ratio: float) -> tuple[float, float]:
    """Ends of the amplitude's steady swing under a square of duty ½, T/τ = ratio."""
    lost = (HIGH - LOW) * (1 - math.tanh(ratio / 4)) / 2
    return LOW + lost, HIGH - lost


@pytest.mark.parametrize(
    ("law", "keeps_more"),
    [
        (lambda a, v: np.exp(-a / 1e-6), False),
        (lambda a, v: 1 / (1 + (a / 1e-6) ** 4), True),
    ],
    ids=["exponential", "S-shaped"],
)
def test_a_bent_friction_law_keeps_another_share(law: object, keeps_more: bool) -> None:
    tau = 0.55e-3
    table = fidelity_table(tau, law, low=LOW, high=HIGH)
    for row, period in enumerate(table.spatial_periods):
        for column, speed in enumerate(table.speeds):
            reached = np.array(settled_ends(period / (speed * tau)))
            exact = np.ptp(law(reached, speed)) / np.ptp(law(np.array([LOW, HIGH]), speed))
            assert table.friction_kept[row, column] == pytest.approx(exact, abs=2e-4)
    assert (table.friction_kept[0, -1] > table.amplitude_kept[0, -1]) == keeps_more


@pytest.mark.parametrize("shape", ["square", "sine"])
def test_a_straight_friction_law_keeps_the_share_of_amplitude(shape: str) -> None:
    table = fidelity_table(0.55e-3, linear, low=LOW, high=HIGH, shape=shape)
    assert table.friction_kept == pytest.approx(table.amplitude_kept, abs=1e-4)
    assert table.lag == pytest.approx(0.55e-3 * table.speeds)
