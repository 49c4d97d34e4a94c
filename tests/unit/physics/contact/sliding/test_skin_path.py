"""A piece of a slip under friction that is a line in speed: its equation, its works, its bounds."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from squeezefilm.physics.contact.sliding.skin_path import (
    TERMS,
    BonePull,
    Friction,
    LumpedSkin,
    SkinPath,
    passes,
    path_over,
    speed_on,
    way_on,
    works_on,
)

SKIN = LumpedSkin(1.5e-4, 1.0, 1000.0)
PULL = BonePull(0.4, 60.0, -9e4, 0.12, 15.0)
SPAN = 0.25 * math.sqrt(SKIN.mass / SKIN.stiffness)
RISES = [-0.3, 0.0, 0.3, 0.6, 3.0, 1e2, 1e4]


def along(
    rise: float, speed: float = 0.05, rate: float = -300.0
) -> tuple[SkinPath, Friction, np.ndarray]:
    friction, series = Friction(0.3, rise, rate), np.empty(TERMS)
    return path_over(SPAN, speed, PULL, friction, SKIN, series), friction, series


@pytest.mark.parametrize("rise", RISES)
def test_a_path_obeys_newton_however_steep_the_friction(rise: float) -> None:
    path, friction, series = along(rise)
    braking = SKIN.damping + rise
    assert speed_on(path, 0.0, series)[0] == pytest.approx(0.05, rel=1e-14)
    assert way_on(path, 0.0, series) == 0
    for t in np.array([0.0, 0.01, 0.3, 0.7, 1.0]) * SPAN:
        w, a = speed_on(path, t, series)
        outer = PULL.start + t * PULL.rate + t**2 * PULL.bend
        outer -= friction.start - rise * 0.05 + friction.rate * t
        inner = SKIN.mass * a + braking * w + SKIN.stiffness * way_on(path, t, series)
        assert inner == pytest.approx(outer, abs=1e-12 * (1 + braking))


@pytest.mark.parametrize("rise", RISES)
def test_a_path_is_what_a_stiff_solver_finds(rise: float) -> None:
    path, friction, series = along(rise)

    def rates(t: float, y: np.ndarray) -> list[float]:
        outer = PULL.start + t * PULL.rate + t**2 * PULL.bend - friction.start
        outer -= rise * (y[1] - 0.05) + friction.rate * t
        return [y[1], (outer - SKIN.stiffness * y[0] - SKIN.damping * y[1]) / SKIN.mass]

    done = solve_ivp(rates, (0, SPAN), [0.0, 0.05], "Radau", rtol=1e-10, atol=1e-14)
    assert way_on(path, SPAN, series) == pytest.approx(done.y[0, -1], rel=1e-6)
    assert speed_on(path, SPAN, series)[0] == pytest.approx(done.y[1, -1], rel=1e-6)


@pytest.mark.parametrize("rise", RISES)
@pytest.mark.parametrize("part", [1.0, 0.2, 1e-4])
def test_works_are_the_integrals_of_force_and_speed(rise: float, part: float) -> None:
    path, friction, series = along(rise)
    end = part * SPAN
    points = [min(end, n / path.decay) for n in (0.1, 1, 5, 20)] if path.fast else None

    def work(power: object) -> float:
        return float(quad(power, 0, end, points=points, epsabs=0, epsrel=1e-11, limit=300)[0])

    def speed(t: float) -> float:
        return float(speed_on(path, t, series)[0])

    def bone(t: float) -> float:
        return PULL.bone_speed + PULL.bone_rate * t

    def held(t: float) -> float:
        pull = PULL.start + t * (PULL.rate + t * PULL.bend)
        return pull - SKIN.stiffness * way_on(path, t, series) - SKIN.damping * speed(t)

    expected = (
        work(lambda t: held(t) * bone(t)),
        work(lambda t: (friction.start + rise * (speed(t) - 0.05) + friction.rate * t) * speed(t)),
        work(lambda t: SKIN.damping * (bone(t) - speed(t)) ** 2),
    )
    found = works_on(path, end, PULL, friction, SKIN, series)
    assert found == pytest.approx(expected, abs=1e-8 * max(map(abs, expected)))


def found_pass(path: SkinPath, series: np.ndarray, level: float, side: float) -> float:
    ends = (speed_on(path, 0.0, series)[1], *speed_on(path, SPAN, series))
    return float(passes(path, SPAN, level, side, ends, series))


@pytest.mark.parametrize("rise", [0.0, 3.0, 1e3])
def test_the_instant_at_which_a_speed_is_passed(rise: float) -> None:
    path, _, series = along(rise, 0.05, 4e3)
    times = np.linspace(0, SPAN, 4001)
    speeds = np.array([speed_on(path, t, series)[0] for t in times])
    # It falls all along, or rises first and then falls.
    for level in np.linspace(speeds.min(), speeds.max(), 7)[1:-1]:
        for side in (1.0, -1.0):
            if side * (0.05 - level) >= 0:
                continue
            beyond = np.flatnonzero(side * (speeds - level) > 0)
            found = found_pass(path, series, level, side)
            if beyond.size:
                assert times[beyond[0] - 1] <= found <= times[beyond[0]]
                assert speed_on(path, found, series)[0] == pytest.approx(level, rel=1e-9)
            else:
                assert found == -1
    assert found_pass(path, series, 1.01 * speeds.max(), 1.0) == -1
    assert found_pass(path, series, speeds.min() - 1e-3, -1.0) == -1


def test_a_speed_that_turns_inside_is_seen_beyond_its_level() -> None:
    path, _, series = along(0.0, 0.05, 4e3)
    times = np.linspace(0, SPAN, 4001)
    speeds = np.array([speed_on(path, t, series)[0] for t in times])
    top = int(np.argmax(speeds))
    assert 0 < top < 4000
    level = speeds[top] - 1e-3 * (speeds[top] - max(speeds[0], speeds[-1]))
    found = found_pass(path, series, level, 1.0)
    assert 0 < found < times[top]
    assert speed_on(path, found, series)[0] == pytest.approx(level, rel=1e-12)


def test_a_slip_from_rest_goes_on_ends_or_never_begins() -> None:
    series = np.empty(TERMS)

    def stop(excess: float, rate: float) -> float:
        path = path_over(
            SPAN,
            0.0,
            BonePull(0.3 + excess, 0.0, 0.0, 0.0, 0.0),
            Friction(0.3, 0.0, rate),
            SKIN,
            series,
        )
        return found_pass(path, series, 0.0, -1.0)

    assert stop(0.01, 0.0) == -1
    assert stop(-0.01, 0.0) == 0
    # Friction that soon is more than the pull: m w = 0.01 t − rate t²/2, nearly.
    rate = 0.4 / SPAN
    assert stop(0.01, rate) == pytest.approx(2 * 0.01 / rate, rel=0.05)
