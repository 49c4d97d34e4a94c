"""Films that hardly move: closed forms under a uniform gap, the linear film under a profile."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.film.closed import relative_damping, relative_stiffness
from squeezefilm.physics.film.gas import slip_law
from squeezefilm.physics.film.periodic.batch import solve_films
from squeezefilm.physics.film.periodic.film import solve_profile, solve_uniform
from squeezefilm.physics.film.periodic.profile import flexural_profile, profile_from_function
from squeezefilm.physics.film.periodic.resolution import DISC, STRIP, Films
from squeezefilm.physics.film.periodic.small import (
    LEAST_DEPTH,
    enlarged,
    flow_factor,
    reduced,
    small_film,
    small_pressure,
    small_vibration,
)
from squeezefilm.physics.film.periodic.solution import NO_FIELD, Field, Found

SHAPES = {"strip": STRIP, "disc": DISC}


def film_of(sigma: float, eps: float, n: float, kn: float, slip: str, shape: str) -> Films:
    return Films(*np.array([[sigma], [eps], [n], [kn]]), slip_law(slip, kn), SHAPES[shape])


@pytest.mark.parametrize("shape", ["strip", "disc"])
@pytest.mark.parametrize(("n", "kn"), [(1.0, 0.0), (1.4, 0.0), (1.2, 0.08)])
def test_it_is_the_second_order_of_the_linear_film(shape: str, n: float, kn: float) -> None:
    sigma = np.geomspace(1e-2, 1e6, 9)
    rest = (np.full(9, value) for value in (1e-3, n, kn))
    small = small_vibration(Films(sigma, *rest, slip_law("first", kn), SHAPES[shape]))
    local = sigma / (n * (1 + 6 * kn))
    springs = n * relative_stiffness(local, shape)
    known = springs * (1.25 + 6 * kn - 1.5 * kn * (1 - n)) / (1 + 6 * kn)
    assert small.over_pressure == pytest.approx(1e-6 * known, rel=1e-6)
    assert small.force.real == pytest.approx(springs)
    assert small.force.imag == pytest.approx(n * relative_damping(local, shape))


@pytest.mark.parametrize("slip", ["first", "second", "fukui-kaneko", "veijola"])
@pytest.mark.parametrize("shape", ["strip", "disc"])
def test_the_solver_differs_by_no_more_than_the_error_stated(shape: str, slip: str) -> None:
    films = [
        (0.3, 1.0, 0.05, 0.05),
        (8.0, 1.4, 0.3, 0.05),
        (300.0, 1.0, 0.0, 0.03),
        (4e3, 5 / 3, 1.0, 0.03),
    ]
    for sigma, n, kn, eps in films:
        gas = {"polytropic_exponent": n, "knudsen_number": kn, "slip": slip}
        solved = solve_uniform(sigma, eps, shape=shape, tolerance=1e-5, **gas)
        small = small_vibration(film_of(sigma, eps, n, kn, slip, shape))
        over, allowed = small.over_pressure[0], small.over_pressure_error[0]
        assert abs(solved.over_pressure - over) <= allowed + solved.over_pressure_error
        force = -solved.force_harmonics[1] / eps
        assert abs(force - small.force[0]) <= small.force_error[0] + solved.force_error
        # Not by far less either: the next order is there.
        assert abs(solved.over_pressure - over) >= 0.01 * allowed


def test_the_flow_factor_has_its_slope() -> None:
    for slip in ("first", "second", "fukui-kaneko", "veijola"):
        law = slip_law(slip, 0.1)
        kn = np.array([0.03, 0.2])
        phi, psi = flow_factor(kn, law)
        near = flow_factor(kn * (1 + 1e-6), law)[0]
        assert (near - phi) / 1e-6 == pytest.approx(psi, rel=1e-4)


@pytest.mark.parametrize("shape", ["strip", "disc"])
def test_the_pressure_in_closed_form_is_that_of_the_force(shape: str) -> None:
    gas = {"polytropic_exponent": 1.3, "knudsen_number": 0.1, "slip": "second"}
    solved = solve_uniform(50.0, 2e-3, shape=shape, tolerance=1e-4, **gas)
    x = solved.position
    swing, mean = small_pressure(x, film_of(50.0, 2e-3, 1.3, 0.1, "second", shape))
    first = 2 * np.fft.fft(solved.pressure - 1.0, axis=1)[:, 1] / len(solved.time)
    assert np.abs(swing - first).max() < 2e-3 * np.abs(first).max()
    level = solved.mean_pressure - 1.0
    assert np.abs(mean - level).max() < 2e-3 * np.abs(level).max()


@pytest.mark.parametrize("shape", ["strip", "disc"])
def test_the_field_of_a_film_that_hardly_moves_has_its_force(shape: str) -> None:
    found, field = small_film(film_of(20.0, 1e-3, 1.2, 0.0, "first", shape), 1e-2)
    assert found.met
    x, T = field.position, field.time
    assert pytest.approx(2 * np.pi * np.arange(T.size) / T.size) == T
    np.testing.assert_allclose(field.gap, np.tile(1 + 1e-3 * np.cos(T), (x.size, 1)))
    # The mean over a strip is along x; a disc's rings count by their radius.
    weight = np.ones(x.size) if shape == "strip" else 2 * x
    force = np.trapezoid(field.over * weight[:, None], x, axis=0)
    harmonics = np.fft.rfft(force) / T.size
    assert 2 * harmonics[1] == pytest.approx(found.harmonics[1], rel=2e-3)
    assert harmonics[0].real == pytest.approx(found.over, rel=5e-3)


@pytest.mark.parametrize("shape", ["strip", "disc"])
@pytest.mark.parametrize(
    "sigma",
    [10.0, *(pytest.param(sigma, marks=pytest.mark.slow) for sigma in (1e3, 1e5, 1e6)), 1e8],
)
def test_a_vibration_goes_to_zero_at_any_squeeze_number(sigma: float, shape: str) -> None:
    # They were solved as 1e-6, or came to an error after seconds.
    for eps in (1e-4, -1e-6, 1e-8, 1e-12, 0.0):
        film = solve_uniform(sigma, eps, shape=shape)
        exact = 1.25 * eps**2 * relative_stiffness(sigma, shape)
        assert film.over_pressure == pytest.approx(exact, rel=5e-3, abs=0.0)
        force = relative_stiffness(sigma, shape) + 1j * relative_damping(sigma, shape)
        off = abs(film.stiffness_relative + 1j * film.damping_relative - force)
        assert off <= film.force_error + 1e-9
        assert film.force_harmonics[1] == pytest.approx(-force * eps, rel=5e-3, abs=0.0)
        moved = np.broadcast_to(1.0 + eps * np.cos(film.time), film.gap.shape)
        assert film.gap == pytest.approx(moved, rel=1e-12)
    batch = solve_films(sigma, [1e-6, 1e-8, 0.0], shape=shape, force=True)
    assert batch.over_pressure == pytest.approx(
        1.25 * np.array([1e-12, 1e-16, 0.0]) * relative_stiffness(sigma, shape), rel=1e-3, abs=0.0
    )
    assert np.all(batch.cells[1:] == 0)
    assert np.all(batch.force_error >= 0.0)


def test_what_no_solve_reaches_is_refused_quickly() -> None:
    # Rounding at this σ is more than the tolerance, and the closed form is not near enough.
    with pytest.raises(ConvergenceError) as caught:
        solve_uniform(1e7, 2e-4, tolerance=1e-9)
    assert caught.value.iterations < 200
    with pytest.raises(ConvergenceError):
        solve_films(1e7, 2e-4, tolerance=1e-9)


def wavy(eps: float) -> object:
    return flexural_profile(
        eps, wavenumber=3.0, ridge_depth=0.3, ridge_wavenumber=4 * np.pi, tilt=0.2
    )


def test_a_profile_that_hardly_moves_is_linear() -> None:
    moved = solve_profile(1e3, wavy(1e-3), tolerance=1e-4)
    for eps in (3e-5, 1e-7, 1e-12):
        small = solve_profile(1e3, wavy(eps), tolerance=1e-3)
        ratio = eps / 1e-3
        assert small.over_pressure == pytest.approx(moved.over_pressure * ratio**2, rel=1e-3)
        assert small.stiffness_relative == pytest.approx(moved.stiffness_relative, rel=1e-3)
        assert small.damping_relative == pytest.approx(moved.damping_relative, rel=2e-3)
        apart = np.abs(small.force_harmonics[1:] / ratio - moved.force_harmonics[1:])
        assert apart.max() <= 2e-3 * abs(moved.force_harmonics[1])
        still = wavy(eps).gap(small.position, [np.pi / 2])[:, 0]
        assert small.gap.mean(axis=1) == pytest.approx(still, rel=1e-12)
        swing = np.ptp(small.gap, axis=1)
        assert swing.max() == pytest.approx(2 * eps, rel=1e-3)
    alone = solve_profile(1e3, wavy(1e-9), tolerance=1e-3, field=False)
    assert alone.over_pressure == pytest.approx(moved.over_pressure * 1e-12, rel=2e-3)


def test_only_a_motion_too_small_is_enlarged() -> None:
    profile = wavy(1e-3)
    assert enlarged(profile) == (profile, 1.0)
    still = profile_from_function(lambda x, t: 1 + 0.1 * x + 0 * t)
    assert enlarged(still) == (still, 1.0)
    larger, factor = enlarged(wavy(1e-8))
    assert larger.depth == pytest.approx(LEAST_DEPTH)
    assert factor == pytest.approx(larger.excursion / 1e-8)
    x, T = np.linspace(-0.5, 0.5, 7), np.linspace(0, 6, 5)
    assert pickle.loads(pickle.dumps(larger)).gap(x, T) == pytest.approx(larger.gap(x, T))


def test_a_motion_made_smaller_takes_its_film_along() -> None:
    """Swings in proportion, means with the square, the next order in the errors."""
    random = np.random.default_rng(2)
    harmonics = random.normal(size=9) + 1j * random.normal(size=9)
    swing, mean = random.normal(size=(2, 4, 1)), 3.0
    time = 2 * np.pi * np.arange(4) / 4
    gap, over = 1 + swing[0, :2] * np.cos(time), mean + swing[1, :2] * np.sin(time)
    field = Field(np.array([0.0, 0.5]), time, gap, over)
    found = Found(0.5, 1e-4, True, 7, 1e-9, 32, 16, harmonics, np.full(9, 1e-5))
    assert reduced(found, field, 1.0, 1e-2) == (found, field)
    small, less = reduced(found, field, 10.0, 1e-2)
    assert (small.over, small.iterations, small.cells, small.met) == (0.5 / 100, 7, 32, True)
    assert small.harmonics == pytest.approx(np.r_[0.005, harmonics[1:] / 10])
    largest = np.abs(harmonics[1:]).max() / 10
    assert small.error == pytest.approx(1e-6 + 100 * LEAST_DEPTH**2 * 0.005)
    assert small.harmonics_error[0] == small.error
    assert small.harmonics_error[1:] == pytest.approx(1e-6 + 2 * LEAST_DEPTH * largest)
    assert less.gap == pytest.approx(1 + swing[0, :2] * np.cos(time) / 10)
    assert less.over == pytest.approx(mean / 100 + swing[1, :2] * np.sin(time) / 10)
    assert (less.position is field.position, less.time is field.time) == (True, True)
    # Both the load and the harmonics must meet the tolerance.
    assert not reduced(found, field, 10.0, 1.5e-4)[0].met
    rough = replace(found, harmonics_error=np.full(9, 0.1))
    assert not reduced(rough, field, 10.0, 1e-2)[0].met
    assert not reduced(replace(found, met=False), field, 10.0, 1e-2)[0].met
    assert reduced(found, NO_FIELD, 10.0, 1e-2)[1] is NO_FIELD
