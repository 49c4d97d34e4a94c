"""Laws of dry friction and of energy that hold for every pad, motion, load and friction."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from hypothesis import given, reject
from hypothesis import strategies as st

from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.contact.sliding.march import DryFriction, Sliding, SpeedFriction, slide

SAMPLES = 200


class Mirrored(NamedTuple):
    """A motion and the same in a mirror; said in a word, since hypothesis prints what it draws."""

    motion: Sliding
    mirrored: Sliding

    def __repr__(self) -> str:
        return f"Mirrored(a motion of {self.motion.time.size} samples)"


@st.composite
def motions(draw: st.DrawFn) -> Mirrored:
    """A random motion under random friction, and the same seen in a mirror."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    pad = FingerpadDynamics(
        stiffness=draw(st.floats(100, 1e4)),
        damping=draw(st.one_of(st.just(0.0), st.floats(0.01, 10))),
        mass=draw(st.floats(3e-5, 1e-3)),
    )
    law = DryFriction(draw(st.one_of(st.just(1.0), st.floats(1, 2))))
    dt = 10 ** draw(st.floats(-5.5, -3.7))
    speed = draw(st.floats(-0.5, 0.5))
    jitter = draw(st.sampled_from([0.0, 1e-3, 0.1]))
    bone = np.cumsum(speed + jitter * rng.standard_normal(SAMPLES)) * dt
    friction = draw(st.sampled_from([0.0, 0.5, 3.0])) * rng.random(SAMPLES)
    load = draw(st.sampled_from([0.0, 1.0])) + rng.random(SAMPLES)
    start = draw(st.floats(-0.3, 0.3))
    stretch = draw(st.floats(-1e-3, 1e-3))
    return in_mirror((bone, dt, friction, load, pad, law), start, stretch)


def in_mirror(asked: tuple[Any, ...], start: float, stretch: float) -> Mirrored:
    """A motion as `slide` is asked for it, and the same seen in a mirror."""
    bone, *rest = asked
    return Mirrored(
        *(
            slide(side * bone, *rest, initial_speed=side * start, initial_stretch=side * stretch)
            for side in (1.0, -1.0)
        )
    )


def energy_scale(motion: Sliding) -> float:
    return float(
        motion.stored_energy.max()
        + np.abs(motion.bone_work).max()
        + motion.friction_loss[-1]
        + motion.damping_loss[-1]
    )


def energy_rounding(motion: Sliding) -> float:
    """What a stretch, the difference of two places, is rounded by does work in every sample; of
    motions that have less than 1e-21 J less is asked."""
    far, strong = np.abs(motion.skin_position).max(), np.abs(motion.bone_force).max()
    return float(SAMPLES * np.finfo(float).eps * far * strong) + 1e-27


@given(motions())
def test_energy_balances_and_friction_never_creates_any(both: Mirrored) -> None:
    motion = both.motion
    # Slips shorter than 1e-6 of a step are not followed: of 1e-49 m/s no energy is accounted for.
    assert motion.energy_residual <= 1e-6 * energy_scale(motion) + energy_rounding(motion)
    assert np.all(np.diff(motion.friction_loss) >= 0)
    assert np.all(np.diff(motion.damping_loss) >= 0)


@given(motions())
def test_coulombs_law_holds_at_every_sample(both: Mirrored) -> None:
    motion = both.motion
    limit = motion.law.static_ratio * motion.friction_limit
    rounding = 1e-12 * (limit.max() + np.abs(motion.bone_force).max())
    assert np.all(np.abs(motion.friction_force) <= limit + rounding)
    assert np.all(motion.skin_speed[motion.sticking] == 0)
    assert np.all(motion.friction_force[motion.sticking] == motion.bone_force[motion.sticking])
    free = ~motion.sticking
    assert np.all(motion.friction_force[free] * motion.skin_speed[free] >= 0)
    moving = free & (motion.skin_speed != 0)
    moving[0] = False
    wanted = motion.friction_limit[moving]
    assert np.all(np.abs(np.abs(motion.friction_force[moving]) - wanted) <= rounding)


@given(motions())
def test_a_mirrored_motion_gives_mirrored_forces(both: Mirrored) -> None:
    motion, mirrored = both
    for name in ("skin_position", "skin_speed", "friction_force", "bone_force"):
        assert np.array_equal(getattr(motion, name), -getattr(mirrored, name))
    assert np.array_equal(motion.sticking, mirrored.sticking)
    assert np.array_equal(motion.friction_loss, mirrored.friction_loss)


@st.composite
def motions_by_speed(draw: st.DrawFn) -> Mirrored:
    """A random motion under friction by random rows over speed, rising or not, and its mirror."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    pad = FingerpadDynamics(
        stiffness=draw(st.floats(100, 1e4)),
        damping=draw(st.one_of(st.just(0.0), st.floats(0.01, 10))),
        mass=draw(st.floats(3e-5, 1e-3)),
    )
    first = 10 ** draw(st.floats(-6, -1.5))
    knots = draw(st.integers(1, 5))
    grid = np.concatenate([[0.0], first + np.geomspace(1e-9, 1, knots) * draw(st.floats(0.1, 1))])
    many = draw(st.booleans())
    rows = draw(st.sampled_from([0.0, 0.5, 2.0])) * rng.random((SAMPLES if many else 1, grid.size))
    kind = draw(st.sampled_from(["as they are", "rising", "from nothing", "now and then nothing"]))
    # What falls steeply mostly needs more parts of a step than are allowed; the rest is rejected.
    rows[:, 1:] = np.maximum(rows[:, 1:], rows[:, :1]) if first < 1e-3 else rows[:, 1:]
    if kind != "as they are":
        rows = np.sort(rows, axis=1)
    if kind == "from nothing":
        rows[:, 0] = 0
    if kind == "now and then nothing":
        rows[rng.random(len(rows)) < 0.5, 0] = 0
    rows = np.maximum.accumulate(rows, axis=1) if knots > 1 else rows
    law = DryFriction(draw(st.one_of(st.just(1.0), st.floats(1, 2))))
    dt = 10 ** draw(st.floats(-5.5, -3.7))
    speed = draw(st.floats(-0.5, 0.5))
    jitter = draw(st.sampled_from([0.0, 1e-3, 0.1]))
    bone = np.cumsum(speed + jitter * rng.standard_normal(SAMPLES)) * dt
    load = draw(st.sampled_from([0.0, 1.0])) + rng.random(SAMPLES)
    start = draw(st.one_of(st.just(0.0), st.floats(-0.3, 0.3)))
    stretch = draw(st.floats(-1e-3, 1e-3))
    friction = SpeedFriction(grid, rows if many else rows[0])
    try:
        return in_mirror((bone, dt, friction, load, pad, law), start, stretch)
    except InputError as refused:
        if "parts of a step" not in str(refused):
            raise
        reject()


@given(motions_by_speed())
def test_friction_by_speed_keeps_the_laws_of_energy_and_of_mirrors(both: Mirrored) -> None:
    motion, mirrored = both
    assert motion.energy_residual <= 1e-6 * energy_scale(motion) + energy_rounding(motion)
    assert np.all(np.diff(motion.friction_loss) >= -1e-15 * energy_scale(motion) - 1e-30)
    assert np.all(np.diff(motion.damping_loss) >= 0)
    assert np.all(motion.skin_speed[motion.sticking] == 0)
    assert np.all(motion.friction_force[motion.sticking] == motion.bone_force[motion.sticking])
    rounding = 1e-15 * np.abs(motion.bone_force).max() + 1e-30
    assert np.all(motion.friction_force * motion.skin_speed >= -rounding)
    for name in ("skin_position", "skin_speed", "friction_force", "bone_force"):
        assert np.array_equal(getattr(motion, name), -getattr(mirrored, name))
    assert np.array_equal(motion.sticking, mirrored.sticking)
