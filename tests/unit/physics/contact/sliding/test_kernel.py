"""The compiled march of the skin: closed motions, its ledger of work, and where it gives up."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squeezefilm.physics.contact.sliding.kernel import Track, slide_march
from squeezefilm.physics.contact.sliding.pieces import BoneDrive, Rows
from squeezefilm.physics.contact.sliding.skin_path import LumpedSkin

MASS, STIFFNESS = 1.6e-4, 1000.0
W = math.sqrt(STIFFNESS / MASS)
ALIKE = Rows(np.array([0.0, 1.0]), np.ones((1, 2)))


@dataclass
class Marched:
    """A march with all that it filled in."""

    done: int
    bone: np.ndarray
    x: np.ndarray
    v: np.ndarray
    friction: np.ndarray
    force: np.ndarray
    stuck: np.ndarray
    work: np.ndarray
    account: np.ndarray


def march(
    motion: tuple[float, float, float],
    limit: Any,
    dt: float,
    samples: int,
    *,
    substeps: int = 3,
    damping: float = 0.0,
    static_ratio: float = 1.0,
    start: tuple[float, float] = (0.0, 0.0),
) -> Marched:
    """The bone moves from place `motion[0]` with the speed `motion[1]`, speeding up by [2]."""
    t = np.arange(samples) * dt
    place, speed, rate = motion
    bone, speeds = place + speed * t + rate * t**2 / 2, speed + rate * t
    x, v, friction, force = (np.zeros(samples) for _ in range(4))
    stuck, work, account = np.zeros(samples, bool), np.zeros((3, samples)), np.zeros(3)
    x[0], v[0] = start
    limits = np.broadcast_to(np.asarray(limit, dtype=float), t.shape).copy()
    done = slide_march(
        BoneDrive(bone, speeds[:-1].copy(), speeds[1:].copy(), limits, dt, substeps),
        LumpedSkin(MASS, damping, STIFFNESS),
        ALIKE,
        static_ratio,
        limits.max(),
        Track(x, v, friction, force, stuck, work, account),
    )
    return Marched(done, bone, x, v, friction, force, stuck, work, account)


def test_a_stuck_skin_stores_the_bones_work_and_heats_the_damper() -> None:
    V, a, c = 0.02, 1.5, 0.3
    found = march((0.01, V, a), 1e3, 1e-3, 21, damping=c, start=(0.01, 0.0))
    t = np.arange(21) * 1e-3
    stretch, speed = V * t + a * t**2 / 2, V + a * t
    assert found.done == 21
    assert np.all(found.x == 0.01)
    assert not found.v.any()
    assert found.stuck.all()
    assert found.force == pytest.approx(STIFFNESS * stretch + c * speed)
    assert np.array_equal(found.friction, found.force)
    heat = c * (V**2 * t + V * a * t**2 + a**2 * t**3 / 3)
    assert found.work[0] == pytest.approx(STIFFNESS * stretch**2 / 2 + heat, rel=1e-12)
    assert not found.work[1].any()
    assert found.work[2] == pytest.approx(heat, rel=1e-12)
    assert found.account == pytest.approx([0.02, 0.0, 0.0])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_skin_that_keeps_up_with_the_bone_loses_all_work_to_friction(sign: float) -> None:
    V, F = 0.08, 0.4
    held = F
    found = march(
        (0.0, sign * V, 0.0), F, 1e-3, 11, damping=0.1, static_ratio=1.5,
        start=(-sign * held / STIFFNESS, sign * V),
    )  # fmt: skip
    t = np.arange(11) * 1e-3
    assert found.x == pytest.approx(sign * (V * t - held / STIFFNESS), abs=1e-11)
    assert found.v == pytest.approx(np.full(11, sign * V))
    assert found.force == pytest.approx(np.full(11, sign * held))
    assert found.friction == pytest.approx(np.full(11, sign * held))
    assert found.work[0] == pytest.approx(held * V * t)
    assert found.work[1] == pytest.approx(held * V * t)
    assert found.work[2] == pytest.approx(np.zeros(11), abs=1e-15)
    assert not found.stuck.any()
    # It slid from the start, so no slip has begun; its law is met to rounding.
    assert found.account == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("fall", [0.0, 8.0])
def test_a_slip_begins_when_the_load_meets_the_limit(sign: float, fall: float) -> None:
    V, c, L, r = 0.05, 0.2, 0.3, 1.4
    begins = (r * L - c * V) / (STIFFNESS * V + r * fall)
    # The last sample is within the first half swing of the slip.
    dt = (begins + 0.5e-3) / 10
    t = np.arange(11) * dt
    found = march((0.0, sign * V, 0.0), L - fall * t, dt, 11, damping=c, static_ratio=r)
    assert list(found.stuck) == [True] * 10 + [False]
    # Once it slides, it does so against the kinetic limit.
    assert found.friction[10] == pytest.approx(sign * (L - fall * t[10]))
    assert sign * found.v[10] > 0
    assert found.account == pytest.approx([begins, 1.0, 0.0])


def test_a_load_above_the_limit_slips_from_the_start() -> None:
    found = march((1e-3, 0.0, 0.0), 0.6, 1e-4, 3, static_ratio=1.5)
    assert found.force[0] == pytest.approx(1.0)
    assert (found.stuck[0], found.friction[0], found.account[1]) == (False, 0.6, 1.0)
    held = march((1e-3, 0.0, 0.0), 0.7, 1e-4, 3, static_ratio=1.5)
    assert held.stuck.all()
    assert held.friction[0] == pytest.approx(1.0)
    # A damper's force counts as well, and the skin's own speed as slip.
    damped = march((0.0, 2.0, 0.0), 0.6, 1e-4, 3, damping=0.5)
    assert not damped.stuck[0]
    moving = march((0.0, 0.0, 0.0), 0.6, 1e-4, 3, damping=0.5, start=(0.0, -1.0))
    assert moving.friction[0] == -0.6
    assert moving.force[0] == pytest.approx(0.5)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_coulomb_friction_takes_two_steps_of_stretch_from_each_whole_swing(sign: float) -> None:
    A, F = 1e-3, 0.12
    half = math.pi / W
    # Four samples a half swing: 1, 0.76, 0.52, 0.28 mm, and there, above F/k, once more to 0.04.
    found = march((0.0, 0.0, 0.0), F, half / 4, 25, start=(sign * A, 0.0))
    peaks = sign * A * np.array([1.0, -0.76, 0.52, -0.28, 0.04])
    assert found.x[:17:4] == pytest.approx(peaks, rel=1e-9)
    assert np.all(found.x[16:] == found.x[16])
    assert found.stuck[17:].all()
    assert found.account[:2] == pytest.approx([2 * half, 4.0])
    path = A * (1.76 + 1.28 + 0.8 + 0.32)
    assert found.work[1, -1] == pytest.approx(F * path, rel=1e-9)
    assert found.work[0] == pytest.approx(np.zeros(25), abs=1e-15)
    sliding = ~found.stuck[1:16]
    assert np.abs(found.friction[1:16][sliding]) == pytest.approx(F)


def test_a_belt_sticks_and_slips_with_its_closed_times() -> None:
    V, L, r = 0.05, 0.2, 1.5
    drop = (r - 1) * L / STIFFNESS
    stick = 2 * drop / V
    slip = (2 * math.pi - 2 * math.atan2(drop * W, V)) / W
    first = r * L / (STIFFNESS * V)
    dt = (first + 4 * (stick + slip) - stick / 2) / 100
    found = march((0.0, V, 0.0), L, dt, 101, static_ratio=r)
    assert found.account == pytest.approx([first + 3.5 * stick, 4.0, 0.0], rel=1e-9)
    # Each stick ends and each slip ends alike: the stretch swings about L/k by the drop.
    stretch = found.bone - found.x
    assert stretch[-1] == pytest.approx(L / STIFFNESS, rel=1e-6)


def followed(
    bone: Any, friction: Any, span: float, samples: int, start: tuple[float, float], damping: float
) -> np.ndarray:
    """Place, speed and the three works from an integrator that knows of no slip and stick."""

    def rate(t: float, y: np.ndarray) -> list[float]:
        x, v = y[:2]
        place, speed = bone(t)
        F = friction(t, x, v)
        pull = STIFFNESS * (place - x) + damping * (speed - v)
        return [v, (pull - F) / MASS, pull * speed, F * v, damping * (speed - v) ** 2]

    times = np.linspace(0.0, span, samples)
    return solve_ivp(
        rate, (0.0, span), [*start, 0, 0, 0], t_eval=times, rtol=1e-11, atol=1e-14, method="DOP853"
    ).y


def test_a_long_slide_agrees_with_an_integrator() -> None:
    V, a, c, dt, n = 0.6, -4.0, 0.15, 1e-3, 12
    limit = 0.5 + 20 * np.arange(n) * dt
    exact = followed(
        lambda t: (V * t + a * t**2 / 2, V + a * t), lambda t, x, v: 0.5 + 20 * t,
        (n - 1) * dt, n, (-3e-4, 0.5), c,
    )  # fmt: skip
    found = march((0.0, V, a), limit, dt, n, damping=c, start=(-3e-4, 0.5), substeps=20)
    assert found.v.min() > 0
    assert found.x == pytest.approx(exact[0], rel=1e-8)
    assert found.v == pytest.approx(exact[1], rel=1e-7)
    assert found.friction == pytest.approx(limit)
    for work, known in zip(found.work, exact[2:], strict=True):
        assert work == pytest.approx(known, rel=1e-6, abs=1e-12)


STICK_SLIP: dict[str, Any] = {"damping": 0.05, "static_ratio": 1.6, "substeps": 12}


def test_no_work_is_lost_from_the_ledger_through_sticks_and_slips() -> None:
    n, dt = 240, 2.5e-4
    limit = 0.25 + 0.08 * np.sin(np.arange(n) / 9)
    found = march((0.0, 0.1, -4.0), limit, dt, n, **STICK_SLIP)
    # The bone turns round, so that slips of both signs are seen.
    assert found.account[1] > 5
    assert found.v.max() > 0 > found.v.min()
    stored = STIFFNESS * (found.bone - found.x) ** 2 / 2 + MASS * found.v**2 / 2
    taken = found.work[0] - found.work[1] - found.work[2]
    assert taken == pytest.approx(stored - stored[0], abs=1e-6 * found.work[1, -1])
    assert np.all(np.diff(found.work[1]) >= 0)
    assert np.all(np.diff(found.work[2]) >= 0)
    assert np.all(found.v[found.stuck] == 0)
    # What it holds while stuck never exceeds what it can hold.
    assert np.all(np.abs(found.friction) <= 1.6 * limit * (1 + 1e-9))


def test_a_motion_turned_round_is_the_same_motion() -> None:
    n, dt = 240, 2.5e-4
    limit = np.linspace(0.2, 0.3, n)
    one = march((0.0, 0.1, -4.0), limit, dt, n, **STICK_SLIP)
    other = march((0.0, -0.1, 4.0), limit, dt, n, **STICK_SLIP)
    assert other.x == pytest.approx(-one.x, abs=1e-12)
    assert other.force == pytest.approx(-one.force, abs=1e-9)
    assert other.friction == pytest.approx(-one.friction, abs=1e-9)
    assert other.work == pytest.approx(one.work, abs=1e-12)
    assert other.account == pytest.approx(one.account, rel=1e-6)


def test_too_many_slips_in_one_sample_are_given_up() -> None:
    # Almost no friction: it turns round twice a swing, 300 times in 150 swings.
    span = 150 * 2 * math.pi / W
    swings: dict[str, Any] = {"start": (1e-3, 0.0)}
    assert march((0.0, 0.0, 0.0), 1e-5, span, 2, substeps=2000, **swings).done == 0
    assert march((0.0, 0.0, 0.0), 1e-5, span / 2, 3, substeps=1000, **swings).done == 3
    # The bone slows down from where its speed is above the swing's, 2.5 m/s, to below it.
    late = march((0.0, 7.6, -5 / span), 1e-5, span, 3, substeps=2000, start=(1e-3, 7.6))
    assert late.done == 1
    assert late.account[1] < 250


@pytest.mark.parametrize(("slips", "done"), [(95, 2), (105, 0)])
def test_starts_count_beside_ends_where_slips_are_too_many(slips: int, done: int) -> None:
    V, L, r = 0.05, 0.2, 1.5
    drop = (r - 1) * L / STIFFNESS
    cycle = 2 * drop / V + (2 * math.pi - 2 * math.atan2(drop * W, V)) / W
    span = r * L / (STIFFNESS * V) + (slips + 0.5) * cycle
    assert march((0.0, V, 0.0), L, span, 2, static_ratio=r, substeps=4000).done == done
