"""The skin between two samples: its equation, its closed swings, and when it starts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm

from squeezefilm.physics.contact.sliding.skin_path import (
    Forces,
    LumpedSkin,
    first_rise,
    slide_by,
    transition,
)

MASS, STIFFNESS = 2e-4, 900.0
W = math.sqrt(STIFFNESS / MASS)
CRITICAL = 2 * math.sqrt(MASS * STIFFNESS)


@pytest.mark.parametrize("ratio", [0.0, 0.05, 0.7, 1 - 1e-7, 1.0, 1 + 1e-7, 1.3, 30.0])
def test_the_free_skin_moves_as_its_matrix_says(ratio: float) -> None:
    damping = ratio * CRITICAL
    matrix = np.array([[0.0, 1.0], [-STIFFNESS / MASS, -damping / MASS]])
    # In units in which places and speeds are alike.
    scale = np.array([[1.0, W], [1 / W, 1.0]])
    for phase in (0.004, 0.1, 1.0, 4.0):
        exact = expm(matrix * phase / W)
        moved = np.array(transition(phase / W, LumpedSkin(MASS, damping, STIFFNESS))).reshape(2, 2)
        assert moved * scale == pytest.approx(exact * scale, rel=1e-11, abs=1e-13)


@pytest.mark.parametrize("sign", [1, -1])
def test_near_critical_damping_the_series_meets_the_functions(sign: int) -> None:
    # (decay² − ω²) s² on both sides of where the series takes over, at 1e-4.
    for z in (0.9e-4, 1.1e-4):
        decay = math.sqrt(1 + sign * z)
        fade = math.exp(-decay)
        r = math.sqrt(z)
        even, odd = (math.cosh(r), math.sinh(r) / r) if sign > 0 else (math.cos(r), math.sin(r) / r)
        found = transition(1.0, LumpedSkin(1.0, 2 * decay, 1.0))
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
    law = (Forces(pull, force, slope), LumpedSkin(MASS, damping, STIFFNESS))
    x0, v0 = 2e-4, 0.05
    start = slide_by(transition(0.0, law[1]), 0.0, x0, v0, *law)
    assert start[:2] == pytest.approx((x0, v0))
    for s in (0.0, 3e-4, 2e-3, 9e-3):
        x, v, a = slide_by(transition(s, law[1]), s, x0, v0, *law)
        outer = pull[0] + pull[1] * s + pull[2] * s**2 - force - slope * s
        assert MASS * a + damping * v + STIFFNESS * x == pytest.approx(outer, rel=1e-11)
        h = 1e-6
        before, after = (slide_by(transition(s + d, law[1]), s + d, x0, v0, *law) for d in (-h, h))
        assert (after[0] - before[0]) / (2 * h) == pytest.approx(v, rel=1e-5, abs=1e-6)
        assert (after[1] - before[1]) / (2 * h) == pytest.approx(a, rel=1e-5, abs=1e-3)
