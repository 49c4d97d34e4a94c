"""What the march by rows over speed is told by, and where it gives up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.contact.sliding.kernel import Track, slide_march, strongest_and_fall
from squeezefilm.physics.contact.sliding.march import DryFriction, SpeedFriction, slide
from squeezefilm.physics.contact.sliding.pieces import (
    BoneDrive,
    Rows,
    bounds_on,
    on_segment,
    works_of_rest,
)
from squeezefilm.physics.contact.sliding.skin_path import BonePull, LumpedSkin

SPEED = np.array([0.0, 0.1, 0.5])
ROWS = np.array([[0.2, 0.4, 0.3], [0.0, 0.9, 0.1]])


def test_a_row_is_linear_between_speeds_and_held_beyond() -> None:
    assert on_segment(SPEED, ROWS, 0, 0) == pytest.approx((0.2, 2.0))
    assert on_segment(SPEED, ROWS, 1, 1) == pytest.approx((0.9, -2.0))
    assert on_segment(SPEED, ROWS, 1, 2) == (0.1, 0.0)
    # One row is every sample's.
    assert on_segment(SPEED, ROWS[:1], 7, 0) == pytest.approx((0.2, 2.0))


def test_the_strongest_friction_and_its_steepest_fall() -> None:
    assert strongest_and_fall(Rows(SPEED, ROWS), np.array([1.0, 2.0])) == pytest.approx((1.8, 4.0))
    assert strongest_and_fall(Rows(SPEED, ROWS), np.array([4.0, 0.5])) == pytest.approx((1.6, 1.0))
    rising = np.sort(ROWS[:1], axis=1)
    assert strongest_and_fall(Rows(SPEED, rising), np.ones(5)) == (0.4, 0.0)


def test_a_line_is_followed_a_little_beyond_its_knots() -> None:
    low, high = bounds_on(SPEED, 1, False)
    assert low < 0.1 < 0.5 < high
    assert (low, high) == pytest.approx((0.1, 0.5), rel=1e-8)
    assert bounds_on(SPEED, 0, False)[0] == 0
    # Without friction at rest the line is its own mirror image.
    low, high = bounds_on(SPEED, 0, True)
    assert low == -high
    assert bounds_on(SPEED, 2, True) == (pytest.approx(0.5, rel=1e-8), math.inf)


def test_works_of_rest_are_exact_for_a_parabola_of_force() -> None:
    f, pull, c, part = 0.3, BonePull(9.0, 40.0, -300.0, 0.05, 2.0), 0.7, 0.02
    t = np.polynomial.Polynomial([0, 1])
    speed = pull.bone_speed + pull.bone_rate * t
    force = f + pull.rate * t + pull.bend * t**2
    bone, damped = (force * speed).integ()(part), (c * speed**2).integ()(part)
    assert works_of_rest(part, f, pull, c) == pytest.approx((bone, damped), rel=1e-12)


def test_too_many_slips_in_one_sample_are_given_up() -> None:
    skin = LumpedSkin(1.6e-4, 0.0, 1000.0)
    period = 2 * math.pi * math.sqrt(skin.mass / skin.stiffness)

    def march(swings: float) -> int:
        bone, track = np.zeros(3), np.zeros((4, 3))
        track[0, 0] = 1e-3
        drive = BoneDrive(bone, np.zeros(2), np.zeros(2), np.full(3, 1e-5), swings * period, 2000)
        rows = Rows(np.array([0.0, 1e-6]), np.array([[0.9, 1.0]]))
        written = Track(*track, np.zeros(3, bool), np.zeros((3, 3)), np.zeros(3))
        return int(slide_march(drive, skin, rows, 1.0, 1e-5, written))

    # It turns round twice a swing.
    assert march(90.0) == 3
    assert march(110.0) == 0


def test_a_skin_at_rest_without_friction_there_feels_exactly_none() -> None:
    """The line between two samples ends beside the law by rounding; what stands still shows it."""
    rng = np.random.default_rng(0)
    rows = rng.random((200, 2))
    rows[::2, 0] = 0.0
    pad = FingerpadDynamics(stiffness=100.0, damping=0.0, mass=6e-5)
    friction = SpeedFriction(np.array([0.0, 0.01]), np.sort(rows, axis=1))
    motion = slide(np.zeros(200), 1e-4, friction, rng.random(200), pad, DryFriction(1.0))
    assert not np.any(motion.skin_speed)
    assert not np.any(motion.friction_force)
