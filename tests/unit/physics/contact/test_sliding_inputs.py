"""What a sliding finger refuses, and the small parts around it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.contact.sliding.march import (
    DryFriction,
    Sliding,
    SpeedFriction,
    interval_speeds,
    slide,
)
from squeezefilm.physics.render.motion.stroke import Stroke
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope

DT = 1e-4
BONE = 0.08 * DT * np.arange(2000)
SPEEDS = np.array([0.0, 0.1, 0.5])
RISING = SpeedFriction(SPEEDS, np.array([0.1, 0.4, 0.5]))


@pytest.mark.parametrize(
    ("build", "word"),
    [
        (lambda: FingerpadDynamics(stiffness=0.0), "stiffness"),
        (lambda: FingerpadDynamics(damping=-1.0), "damping"),
        (lambda: FingerpadDynamics(mass=math.nan), "mass"),
        (lambda: DryFriction(static_ratio=0.9), "static_ratio"),
        (lambda: DryFriction(load_exponent=1.2), "load_exponent"),
        (lambda: slide(BONE[:1], DT, 0.5, 0.5), "at least two"),
        (lambda: slide(BONE, 0.0, 0.5, 0.5), "time_step"),
        (lambda: slide(BONE, DT, -0.5, 0.5), "friction_coefficient"),
        (lambda: slide(BONE, DT, 0.5, -0.5), "normal_force"),
        (lambda: slide(BONE, DT, np.ones(3), 0.5), "one value per sample"),
        (lambda: SpeedFriction(SPEEDS[:1], np.ones(1)), "at least 2"),
        (lambda: SpeedFriction(SPEEDS + 0.1, np.ones(3)), "begin at 0"),
        (lambda: SpeedFriction(SPEEDS[[0, 2, 1]], np.ones(3)), "rise from each"),
        (lambda: SpeedFriction(SPEEDS[[0, 0, 1]], np.ones(3)), "rise from each"),
        (lambda: SpeedFriction(SPEEDS[:, np.newaxis], np.ones(3)), "one row"),
        (lambda: SpeedFriction(SPEEDS, -np.ones(3)), "coefficient"),
        (lambda: SpeedFriction(SPEEDS, np.full(3, math.nan)), "coefficient"),
        (lambda: SpeedFriction(SPEEDS, np.ones(4)), "does not fit 3 speeds"),
        (lambda: SpeedFriction(SPEEDS, np.ones((3, 4))), "does not fit 3 speeds"),
        (lambda: SpeedFriction(SPEEDS, np.ones((2, 2, 3))), "does not fit 3 speeds"),
        (lambda: slide(BONE, DT, SpeedFriction(SPEEDS, np.ones((5, 3))), 0.5), "5 rows"),
        (lambda: slide(BONE, DT, SpeedFriction(SPEEDS, np.ones((1, 3))), 0.5), "1 rows"),
        (lambda: slide(BONE, DT, RISING, np.ones(3)), "one value per sample"),
        (lambda: slide(BONE, DT, RISING, -1.0), "normal_force"),
        (
            lambda: slide(BONE, DT, SpeedFriction(SPEEDS * 1e-6, np.array([0.5, 0.1, 0.1])), 0.5),
            "less steeply",
        ),
    ],
)
def test_what_cannot_be_is_refused_with_its_name(build: Any, word: str) -> None:
    with pytest.raises(InputError, match=word):
        build()


def test_friction_that_rises_however_steeply_is_taken() -> None:
    steep = SpeedFriction(SPEEDS * 1e-9, np.array([0.0, 0.4, 0.5]))
    assert slide(BONE, DT, steep, 1.0).bone_force[-1] == pytest.approx(0.5, rel=1e-9)
    # The friction limit shown is that of fast sliding.
    assert slide(BONE, DT, RISING, 2.0).friction_limit == pytest.approx(1.0)


def test_corners_that_fall_on_samples_stay_corners() -> None:
    bone = 0.01 * np.abs(np.arange(-5.0, 6.0))
    first, last = interval_speeds(bone, 1.0)
    assert np.all(first == last)
    assert first == pytest.approx([-0.01] * 5 + [0.01] * 5)


def test_smooth_motion_has_its_acceleration() -> None:
    t = np.arange(50) * 0.1
    first, last = interval_speeds(0.5 * 3.0 * t**2, 0.1)
    assert first == pytest.approx(3.0 * t[:-1], abs=1e-9)
    assert last == pytest.approx(3.0 * t[1:], abs=1e-9)


def test_the_default_pad_is_the_published_one() -> None:
    pad = FingerpadDynamics()
    # As published over the force, at 0.5 N: 1.48 N/mm, 1.78 N s/m and 0.20 g times powers of it.
    published = 1480 * 0.5**0.35, 1.78 * 0.5**0.35, 0.20e-3 * 0.5**0.26
    assert (pad.stiffness, pad.damping, pad.mass) == pytest.approx(published, rel=3e-3)
    resonance = math.sqrt(pad.stiffness / pad.mass) / (2 * math.pi)
    assert resonance == pytest.approx(419.5, abs=0.1)


STROKE = Stroke(0.08, 0.03, passes=2)


@pytest.fixture(scope="module")
def motion() -> Sliding:
    """A 1 mm square grating, 40 % of friction deep, under a finger at 80 mm/s, there and back."""
    steps = 20_000
    time = np.linspace(0.0, STROKE.duration, steps + 1)
    place = STROKE.position(time)
    vibrating = DrivenEnvelope(5e-4, 5e-4, 2e-6).response(
        2e-6 * (place % 1e-3 < 0.5e-3), STROKE.duration / steps
    )
    return slide(place, STROKE.duration / steps, 0.6 * (1 - vibrating / 5e-6), 0.5)


def test_a_settled_finger_drags_at_the_limit_of_its_friction(motion: Sliding) -> None:
    limit = motion.friction_limit
    there = (motion.time > 0.05) & (motion.time < 0.99 * STROKE.pass_duration)
    assert motion.friction_force[there] == pytest.approx(limit[there])
    back = motion.time > 1.1 * STROKE.pass_duration
    assert motion.friction_force[back] == pytest.approx(-limit[back])
