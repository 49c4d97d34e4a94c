"""The skin between two samples: its equation, its closed swings, and when it starts and stops."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm

from squeezefilm.physics.contact.sliding.skin_motion import (
    Forces,
    Skin,
    end_of_slip,
    first_rise,
    slide_along,
    slide_by,
    transition,
)

MASS, STIFFNESS = 2e-4, 900.0
W = math.sqrt(STIFFNESS / MASS)
CRITICAL = 2 * math.sqrt(MASS * STIFFNESS)
NONE = np.zeros(3)
FREE = Skin(MASS, 0.0, STIFFNESS)


@pytest.mark.parametrize("ratio", [0.0, 0.05, 0.7, 1 - 1e-7, 1.0, 1 + 1e-7, 1.3, 30.0])
@pytest.mark.parametrize("phase", [0.004, 0.1, 1.0, 4.0])
def test_the_free_skin_moves_as_its_matrix_says(ratio: float, phase: float) -> None:
    damping = ratio * CRITICAL
    matrix = np.array([[0.0, 1.0], [-STIFFNESS / MASS, -damping / MASS]])
    exact = expm(matrix * phase / W)
    found = np.array(transition(phase / W, Skin(MASS, damping, STIFFNESS))).reshape(2, 2)
    # In units in which places and speeds are alike.
    scale = np.array([[1.0, W], [1 / W, 1.0]])
    assert found * scale == pytest.approx(exact * scale, rel=1e-11, abs=1e-13)


@pytest.mark.parametrize("sign", [1, -1])
def test_near_critical_damping_the_series_meets_the_functions(sign: int) -> None:
    # (decay² − ω²) s² on both sides of where the series takes over, at 1e-4.
    for z in (0.9e-4, 1.1e-4):
        decay = math.sqrt(1 + sign * z)
        fade = math.exp(-decay)
        r = math.sqrt(z)
        even, odd = (math.cosh(r), math.sinh(r) / r) if sign > 0 else (math.cos(r), math.sin(r) / r)
        found = transition(1.0, Skin(1.0, 2 * decay, 1.0))
        expected = (even + decay * odd, odd, -odd, even - decay * odd)
        assert found == pytest.approx([fade * e for e in expected], rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(
    ("a", "b", "c", "span", "expected"),
    [
        (0.5, -1.0, 0.0, 1.0, 0.0),
        (0.5, -9.0, -9.0, 1.0, 0.0),
        (-1.0, 4.0, 0.0, 1.0, 0.25),
        (-1.0, 1.0, 0.0, 1.0, 1.0),
        (-1.0, 1.0, 0.0, 0.99, -1.0),
        (-1.0, -1.0, 0.0, 1.0, -1.0),
        (-1.0, 0.0, 0.0, 1.0, -1.0),
        (0.0, 2.0, 0.0, 1.0, 0.0),
        # (s + 1)(s − ½), rising through ½; its mirror image has no rise.
        (-0.5, 0.5, 1.0, 1.0, 0.5),
        (-0.5, -0.5, 1.0, 2.0, 1.0),
        (-0.5, -0.5, 1.0, 0.9, -1.0),
        # −(s − ¼)(s − 1): up at ¼, down again at 1.
        (-0.25, 1.25, -1.0, 2.0, 0.25),
        (-1.0, 1.0, -1.0, 2.0, -1.0),
        # It touches zero and is never positive.
        (-0.25, 1.0, -1.0, 2.0, -1.0),
        (-0.25, -1.25, -1.0, 2.0, -1.0),
        (-1.0, 0.0, 4.0, 1.0, 0.5),
    ],
)
def test_the_first_rise_of_a_parabola(
    a: float, b: float, c: float, span: float, expected: float
) -> None:
    assert first_rise(a, b, c, span) == pytest.approx(expected, abs=1e-15)


def test_like_numbers_are_not_subtracted() -> None:
    assert first_rise(-1e-12, 1.0, 1e-6, 1.0) == pytest.approx(1e-12, rel=1e-12)


def test_sliding_obeys_newton_against_a_rising_friction() -> None:
    pull, force, slope, damping = np.array([0.7, 300.0, -2e4]), 0.4, 150.0, 0.3
    law = (Forces(pull, force, slope), Skin(MASS, damping, STIFFNESS))
    x0, v0 = 2e-4, 0.05
    start = slide_along(0.0, x0, v0, *law)
    assert start[:2] == pytest.approx((x0, v0))
    for s in (0.0, 3e-4, 2e-3, 9e-3):
        x, v, a = slide_along(s, x0, v0, *law)
        outer = pull[0] + pull[1] * s + pull[2] * s**2 - force - slope * s
        assert MASS * a + damping * v + STIFFNESS * x == pytest.approx(outer, rel=1e-11)
        h = 1e-6
        before, after = (slide_along(s + d, x0, v0, *law) for d in (-h, h))
        assert (after[0] - before[0]) / (2 * h) == pytest.approx(v, rel=1e-5, abs=1e-6)
        assert (after[1] - before[1]) / (2 * h) == pytest.approx(a, rel=1e-5, abs=1e-3)
        passed = transition(s, law[1])
        assert slide_by(passed, s, x0, v0, *law) == (x, v, a)


def stop(
    span: float, x: float, v: float, sign: float, pull: np.ndarray, force: float, slope: float = 0.0
) -> float:
    passed = transition(span, FREE)
    return float(end_of_slip(passed, span, x, v, sign, Forces(pull, force, slope), FREE))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_pushed_skin_comes_to_rest_where_spring_and_friction_stop_it(sign: float) -> None:
    force, speed = 0.2, 0.3
    # About −F/k it swings as a sine: v = v0 cos ωt − (ω F/k) sin ωt.
    rest = math.atan2(speed, W * force / STIFFNESS) / W
    for span in (1.01 * rest, 1.7 * rest):
        found = stop(span, 0.0, sign * speed, sign, NONE, sign * force)
        assert found == pytest.approx(rest, rel=1e-13)
    assert stop(0.99 * rest, 0.0, sign * speed, sign, NONE, sign * force) == -1.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_speed_that_dips_to_zero_within_the_span_ends_the_slip(sign: float) -> None:
    # A bone at the speed V drags a skin that swings about it: v = V + A cos(ωt).
    V = 0.1
    pull = sign * np.array([0.0, STIFFNESS * V, 0.0])

    def after(swing: float, start: float, span: float) -> float:
        x, v = swing / W * math.sin(start), V + swing * math.cos(start)
        return stop(span / W, sign * x, sign * v, sign, pull, 0.0)

    # From cos = 0, falling, over 1.2 π: the speed has its minimum inside and is positive after.
    start, span = math.pi / 2, 1.2 * math.pi
    for swing in (1.0001 * V, 1.5 * V, 3.0 * V):
        touched = math.acos(-V / swing) - start
        assert after(swing, start, span) * W == pytest.approx(touched, rel=1e-6)
    assert after(0.999 * V, start, span) == -1.0
    assert after(3.0 * V, start, 0.9 * (math.acos(-1 / 3) - start)) == -1.0
    # Rising all along.
    assert after(0.5 * V, 1.1 * math.pi, 0.5 * math.pi) == -1.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_slip_from_rest_ends_half_a_swing_later(sign: float) -> None:
    x, force = -sign * 1e-3, 0.3
    half = math.pi / W
    for span in (1.001, 1.5, 1.99, 3.5):
        assert stop(span * half, x, 0.0, sign, NONE, sign * force) == pytest.approx(half, rel=1e-12)
    assert stop(0.999 * half, x, 0.0, sign, NONE, sign * force) == -1.0
    # Pulled the other way it never starts.
    assert stop(0.5 * half, -x, 0.0, sign, NONE, sign * force) == 0.0


def test_friction_that_rises_in_time_stops_the_skin_sooner() -> None:
    # With a spring too soft to count: m v = m v0 − F s − slope s²/2.
    soft, force, slope, v0 = Skin(MASS, 0.0, 1e-9), 0.2, 400.0, 0.3
    expected = (math.sqrt(force**2 + 2 * slope * MASS * v0) - force) / slope
    passed = transition(1e-3, soft)
    found = end_of_slip(passed, 1e-3, 0.0, v0, 1.0, Forces(NONE, force, slope), soft)
    assert found == pytest.approx(expected, rel=1e-4)
