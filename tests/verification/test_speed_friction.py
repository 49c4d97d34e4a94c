"""Friction that depends on the skin's speed: closed forms, Coulomb's limit, a stiff solver."""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from squeezefilm.core.quantities import FloatArray
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.contact.sliding.march import DryFriction, Sliding, SpeedFriction, slide

PAD = FingerpadDynamics()
RATE = 19_200.0
GRID = np.concatenate([[0.0], np.geomspace(1e-3, 1.0, 12)])
SERIES = (
    "skin_position", "skin_speed", "bone_force", "friction_force", "bone_work", "friction_loss",
    "damping_loss",
)  # fmt: skip


def smooth_stroke(
    count: int, friction: Any, damping: float, duration: float = 0.05, **options: Any
) -> Sliding:
    """A motion to and fro under a changing load; `friction` is asked at the times of samples."""
    t = np.linspace(0, duration, count + 1)
    return slide(
        0.08 * t + 2e-4 * np.sin(2 * np.pi * 60 * t),
        duration / count,
        friction(t),
        0.5 * (1 + 0.2 * np.cos(2 * np.pi * 40 * t)),
        FingerpadDynamics(1000.0, damping, 1.5e-4),
        **options,
    )


def over_time(t: FloatArray) -> FloatArray:
    return 0.5 * (1 + 0.4 * np.sin(2 * np.pi * 90 * t))


@pytest.mark.parametrize("damping", [0.1, 1.0])
@pytest.mark.parametrize("law", [DryFriction(), DryFriction(1.4), DryFriction(load_exponent=0.7)])
def test_rows_that_are_constant_over_speed_are_friction_over_time(
    law: DryFriction, damping: float
) -> None:
    def rows(t: FloatArray) -> SpeedFriction:
        return SpeedFriction(GRID, np.repeat(over_time(t)[:, np.newaxis], GRID.size, axis=1))

    options = {"law": law}
    plain = smooth_stroke(6400, over_time, damping, **options)
    by_rows = smooth_stroke(6400, rows, damping, **options)
    assert plain.slips == by_rows.slips >= 3
    assert by_rows.stuck_share == pytest.approx(plain.stuck_share, rel=1e-9)
    assert np.array_equal(plain.sticking, by_rows.sticking)
    # Knots that are passed change nothing but rounding, of each quantity's largest value.
    for name in SERIES:
        one, other = getattr(plain, name), getattr(by_rows, name)
        atol = 1e-12 * np.abs(one).max()
        np.testing.assert_allclose(other, one, rtol=0, atol=atol, err_msg=name)
    np.testing.assert_allclose(by_rows.friction_limit, plain.friction_limit, 1e-15, 1e-12)
    assert by_rows.friction_law_error < 1e-15


def test_one_row_for_all_times_is_that_row_at_each() -> None:
    row = 0.2 + 0.3 * np.minimum(1, GRID / 0.05)
    alone = smooth_stroke(800, lambda t: SpeedFriction(GRID, row), 0.5)
    many = smooth_stroke(800, lambda t: SpeedFriction(GRID, np.tile(row, (t.size, 1))), 0.5)
    for name in SERIES:
        assert np.array_equal(getattr(alone, name), getattr(many, name))


@pytest.mark.parametrize("rise", [0.05, 1.0, 40.0, 1e3, 1e5])
@pytest.mark.parametrize("damping", [0.0, 1.0])
def test_friction_in_proportion_to_speed_is_a_damped_oscillator(
    rise: float, damping: float
) -> None:
    pad = FingerpadDynamics(1000.0, damping, 1.5e-4)
    dt, n, speed = 1 / RATE, 600, 0.08
    # To and fro, with the turn on a sample.
    bone = speed * dt * np.concatenate([np.arange(n), np.arange(n - 2, -1, -1.0)])
    viscous = SpeedFriction(np.array([0.0, 10.0]), np.array([0.0, rise * 10]))
    motion = slide(bone, dt, viscous, 1.0, pad, initial_stretch=-1e-4)
    # Stretch, speed of the skin, and 1, with the bone at a constant speed.
    k, m = pad.stiffness, pad.mass
    exact = []
    state = np.array([-1e-4, 0.0, 1.0])
    for side in (1.0, -1.0):
        matrix = np.array(
            [
                [0.0, 1.0, -side * speed],
                [-k / m, -(damping + rise) / m, damping * side * speed / m],
                [0.0, 0.0, 0.0],
            ]
        )
        step = expm(matrix * dt)
        for _ in range(n - 1):
            exact.append(state)
            state = step @ state
    exact.append(state)
    found = np.array(exact)
    assert motion.stretch == pytest.approx(found[:, 0], abs=1e-9 * np.abs(found[:, 0]).max())
    assert motion.skin_speed == pytest.approx(found[:, 1], abs=1e-9 * np.abs(found[:, 1]).max())
    assert motion.friction_force[1:] == pytest.approx(rise * motion.skin_speed[1:], rel=1e-9)
    # It turns with the bone, through rest, and never stays.
    assert not motion.sticking.any()
    assert (motion.stuck_share, motion.slips) == (0.0, 1)
    assert motion.energy_residual < 1e-9 * motion.bone_work[-1]


def rising(least: float, saturation: Any) -> Any:
    """Rows from `least` to 0.5 that level off at a speed which may change with time."""

    def rows(t: FloatArray) -> SpeedFriction:
        part = np.minimum(1.0, GRID / np.reshape(saturation(t) * np.ones_like(t), (-1, 1)))
        return SpeedFriction(GRID, least + (0.5 - least) * part)

    return rows


def decades(t: FloatArray) -> FloatArray:
    """A saturation speed that goes from 0.3 mm/s to 0.3 m/s and back, 90 times a second."""
    return np.asarray(10 ** (-2 + 1.5 * np.sin(2 * np.pi * 90 * t)))


@pytest.mark.parametrize("damping", [0.1, pytest.param(1.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("least", "saturation"), [(0.1, lambda t: 0.2), (0.0, lambda t: 0.2), (0.2, decades)]
)
def test_second_order_in_the_time_step(least: float, saturation: Any, damping: float) -> None:
    finest = 204_800
    reference = smooth_stroke(finest, rising(least, saturation), damping)
    counts = [800, 1600, 3200, 6400, 12_800]
    errors = []
    for count in counts:
        motion = smooth_stroke(count, rising(least, saturation), damping)
        errors.append(
            float(np.abs(motion.bone_force - reference.bone_force[:: finest // count]).max())
        )
    order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert 1.8 < order < 2.3, (order, errors)
    assert errors[-1] < 3e-5 * np.ptp(reference.bone_force)
    assert reference.energy_residual < 1e-9 * reference.bone_work[-1]


def test_static_friction_joins_in_at_second_order() -> None:
    options = {"law": DryFriction(1.3)}
    finest = 102_400
    reference = smooth_stroke(finest, rising(0.4, lambda t: 0.1), 0.2, **options)
    assert reference.slips >= 2
    assert 0.05 < reference.stuck_share < 0.9
    counts = [1600, 3200, 6400, 12_800]
    errors = [
        np.abs(
            smooth_stroke(count, rising(0.4, lambda t: 0.1), 0.2, **options).bone_force
            - reference.bone_force[:: finest // count]
        ).max()
        for count in counts
    ]
    assert 1.7 < -np.polyfit(np.log(counts), np.log(errors), 1)[0] < 2.4


@pytest.mark.parametrize("damping", [0.1, 1.0])
def test_rows_that_level_off_ever_sooner_become_coulombs_law(damping: float) -> None:
    """As the saturation speed U → 0 the skin creeps at most at U where Coulomb's law holds it: its
    place, and so its force, is away by less than k U t + c U."""
    duration = 0.05
    coulomb = smooth_stroke(3200, lambda t: 0.4, damping)
    assert coulomb.slips >= 2
    assert coulomb.stuck_share > 0.04
    errors = []
    speeds = np.array([1e-4, 1e-5, 1e-6])
    for U in speeds:
        rows = SpeedFriction(np.array([0.0, U]), np.array([0.0, 0.4]))
        crept = smooth_stroke(3200, lambda t, rows=rows: rows, damping)
        assert not crept.sticking.any()
        errors.append(np.abs(crept.bone_force - coulomb.bone_force).max())
        assert errors[-1] < (1000.0 * duration + damping) * U
    assert np.log(np.array(errors[:-1]) / errors[1:]) == pytest.approx(np.log(10.0), abs=0.25)


def test_where_nothing_holds_the_skin_it_creeps_and_a_held_one_does_not() -> None:
    dt = 1 / RATE
    still = np.zeros(2000)
    grid = np.array([0.0, 1e-3, 1.0])
    crept = SpeedFriction(grid, np.array([0.0, 0.5, 0.5]))
    free = slide(still, dt, crept, 1.0, initial_stretch=2e-4)
    # k x against 500 N·s/m and the pad's damper; its mass does not matter.
    creep = (500.0 + PAD.damping) / PAD.stiffness
    np.testing.assert_allclose(free.skin_position, 2e-4 * np.exp(-free.time / creep), rtol=1e-4)
    assert not free.sticking.any()
    sticky = SpeedFriction(grid, np.array([0.25, 0.5, 0.5]))
    held = slide(still, dt, sticky, 1.0, initial_stretch=2e-4)
    assert held.sticking.all()
    slips = slide(still, dt, sticky, 1.0, initial_stretch=3e-4)
    # It creeps back towards where the least friction holds it, against 250 N·s/m.
    rest, creep = 0.25 / PAD.stiffness, (250.0 + PAD.damping) / PAD.stiffness
    expected = rest + (3e-4 - rest) * np.exp(-slips.time / creep)
    np.testing.assert_allclose(slips.skin_position, expected, rtol=1e-4)
    at_rest = slide(still, dt, crept, 1.0)
    assert np.all(at_rest.skin_position == 0)
    assert at_rest.stuck_share == 0


def stiff_solution(
    t: FloatArray, bone: FloatArray, grid: FloatArray, force: FloatArray, pad: FingerpadDynamics
) -> FloatArray:
    """Skin positions and speeds from Radau, interval by interval of constant bone speed; what holds
    at rest is smoothed over 0.2 µm/s."""
    speeds, rest = list(grid), 2e-7
    answer = [(bone[0], 0.0)]
    dt = t[1] - t[0]
    for i in range(t.size - 1):
        vb = (bone[i + 1] - bone[i]) / dt
        rows = force[i].tolist(), force[i + 1].tolist()

        def law(s: float, v: float, rows: Any = rows) -> tuple[float, float]:
            w = abs(v)
            j = min(bisect_right(speeds, w) - 1, len(speeds) - 2)
            part = min((w - speeds[j]) / (speeds[j + 1] - speeds[j]), 1.0)
            values = [row[j] + part * (row[j + 1] - row[j]) for row in rows]
            rises = [(row[j + 1] - row[j]) / (speeds[j + 1] - speeds[j]) for row in rows]
            F = values[0] + s / dt * (values[1] - values[0])
            dF = rises[0] + s / dt * (rises[1] - rises[0]) if part < 1 else 0.0
            smooth = math.tanh(v / rest)
            return F * smooth, dF * abs(smooth) + F * (1 - smooth**2) / rest

        def rates(s: float, y: Any, i: int = i, vb: float = vb, law: Any = law) -> list[float]:
            x, v = y
            pull = pad.stiffness * (bone[i] + vb * s - x) + pad.damping * (vb - v)
            return [v, (pull - law(s, v)[0]) / pad.mass]

        def jacobian(s: float, y: Any, law: Any = law) -> list[list[float]]:
            rise = pad.damping + law(s, y[1])[1]
            return [[0.0, 1.0], [-pad.stiffness / pad.mass, -rise / pad.mass]]

        done = solve_ivp(
            rates, (0.0, dt), answer[-1], "Radau", jac=jacobian, rtol=1e-7, atol=[1e-12, 1e-9]
        )
        assert done.success
        answer.append((float(done.y[0, -1]), float(done.y[1, -1])))
    return np.array(answer)


@pytest.mark.parametrize(
    ("saturation", "edge"),
    [
        *(pytest.param(*pair, marks=pytest.mark.slow) for pair in ((0.7, 0.0), (3.4e-4, 6.0))),
        *(pytest.param(*pair, marks=pytest.mark.nightly) for pair in ((0.7, 6.0), (3.4e-4, 0.0))),
    ],
)
def test_a_stiff_solver_finds_the_same_force_over_a_grating(edge: float, saturation: float) -> None:
    """Friction of 0.9 and rows that rise from 0 to 0.5 take turns, at once or over 6 samples, on
    the way to and fro."""
    dt, n = 1 / RATE, 500
    way = 0.08 * dt * np.concatenate([np.arange(n), np.arange(n - 2, -1, -1.0)])
    t = np.arange(way.size) * dt
    # Vibrating on every other half of 0.5 mm, as its finger sensor sees it.
    on = ((way / 5e-4) % 1 < 0.5).astype(float)
    if edge:
        kernel = np.exp(-np.arange(60) / edge)
        on = np.convolve(np.pad(on, (60, 0), mode="edge"), kernel / kernel.sum())[60 : 60 + t.size]
    grid = np.array([0.0, 1e-4, 3.4e-4, 1e-3, 1e-2, 0.1, 0.7])
    top = 0.5 * np.minimum(1.0, grid / saturation)
    rows = 0.9 + on[:, np.newaxis] * (top - 0.9)
    ours = slide(way, dt, SpeedFriction(grid, rows), 0.5, PAD)
    place, speed = stiff_solution(t, way, grid, 0.5 * rows, PAD).T
    rate = np.append(np.diff(way)[:1], np.diff(way)) / dt
    theirs = PAD.stiffness * (way - place) + PAD.damping * (rate - speed)
    away = np.abs(ours.bone_force - theirs)[1:]
    assert away.max() < 3e-5 * np.ptp(theirs), away.max() / np.ptp(theirs)
    assert ours.energy_residual < 1e-8 * ours.bone_work[-1]
