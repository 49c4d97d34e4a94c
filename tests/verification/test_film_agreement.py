"""The three film solvers are independent: where they solve the same film, they must agree."""

import numpy as np
import pytest
from tests.film_march import settle_to_periodic, uniform_gap

from squeezefilm.physics.film.closed import relative_damping, relative_stiffness
from squeezefilm.physics.film.gas import FilmGas
from squeezefilm.physics.film.periodic.film import solve_profile, solve_uniform
from squeezefilm.physics.film.periodic.profile import flexural_profile
from squeezefilm.physics.film.planar.film import solve_planar
from squeezefilm.physics.film.planar.grid import PlanarGap


@pytest.mark.parametrize(
    ("sigma", "excursion", "n", "knudsen", "slip"),
    [
        (3.0, 0.3, 1.0, 0.0, "first"),
        (30.0, 0.6, 1.0, 0.0, "first"),
        (300.0, 0.4, 1.2, 0.0, "first"),
        (20.0, 0.5, 1.0, 0.05, "second"),
        (20.0, 0.5, 1.0, 0.1, "fukui-kaneko"),
        (20.0, 0.5, 1.3, 0.1, "veijola"),
        # As deep as the table of load balances goes (`gas_table.DEEPEST_EXCURSION`).
        (5.0, 0.993, 1.0, 0.02, "first"),
    ],
)
@pytest.mark.parametrize("shape", ["strip", "disc"])
def test_harmonic_balance_agrees_with_the_march(
    shape: str, sigma: float, excursion: float, n: float, knudsen: float, slip: str
) -> None:
    balance = solve_uniform(
        sigma,
        excursion,
        shape=shape,
        tolerance=1e-5,
        polytropic_exponent=n,
        knudsen_number=knudsen,
        slip=slip,
    )
    march = settle_to_periodic(
        uniform_gap(excursion),
        sigma,
        shape=shape,
        tolerance=1e-3,
        gas=FilmGas(n, knudsen, slip),
    )
    assert march.over_pressure == pytest.approx(balance.over_pressure, rel=2e-3)


@pytest.mark.parametrize("slip", ["first", "second", "fukui-kaneko", "veijola"])
def test_a_very_long_rectangle_is_a_strip(slip: str) -> None:
    strip = solve_uniform(20.0, 0.5, knudsen_number=0.1, slip=slip, tolerance=1e-4)
    rare = FilmGas(knudsen_number=0.1, slip=slip)
    long = solve_planar(
        "rectangle", PlanarGap(0.5), 20.0, aspect_ratio=400.0, gas=rare, tolerance=2e-3
    )
    assert long.over_pressure == pytest.approx(strip.over_pressure, rel=5e-3)


def test_a_round_ellipse_is_a_disc() -> None:
    disc = solve_uniform(10.0, 0.5, shape="disc", tolerance=1e-5)
    round_ = solve_planar("ellipse", PlanarGap(0.5), 10.0, tolerance=2e-3)
    assert abs(round_.over_pressure - disc.over_pressure) <= round_.over_pressure_error + 1e-6
    assert round_.stiffness_relative == pytest.approx(disc.stiffness_relative, rel=5e-3)


def test_small_excursions_have_the_closed_linear_force() -> None:
    for sigma in (0.1, 1.0, 10.0, 100.0, 1000.0):
        film = solve_uniform(sigma, 0.01, tolerance=1e-5)
        assert film.stiffness_relative == pytest.approx(float(relative_stiffness(sigma)), rel=1e-3)
        assert film.damping_relative == pytest.approx(float(relative_damping(sigma)), rel=1e-3)


@pytest.mark.slow
def test_sealed_and_open_grooves_of_the_paper_s_finger() -> None:
    """28 ridges at σ = 20.418: sealed 7.246e-3; open 1.651e-4 (a prototype found 1.61e-4)."""
    reference, length = 52.6e-6, 10e-3
    wave, ridges = 2 * np.pi * length / 18.7e-3, 2 * np.pi * length / 350e-6
    excursion, depth = 2e-6 / reference, 50e-6 / reference
    sealed = solve_profile(
        20.418149,
        flexural_profile(excursion, wavenumber=wave, ridge_depth=depth, ridge_wavenumber=ridges),
        tolerance=1e-4,
    )
    assert sealed.over_pressure == pytest.approx(7.246e-3, rel=2e-4)
    opened = solve_planar(
        "rectangle", PlanarGap(excursion, wave, depth, ridges), 20.418149, tolerance=2e-3
    )
    assert opened.over_pressure == pytest.approx(1.651e-4, rel=3e-3)
