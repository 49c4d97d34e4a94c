"""The film in the plane: series, tables, limits, orders, ridges, and the march as a check."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.film_march import settle_to_periodic, uniform_gap

from squeezefilm.core.errors import ConvergenceError, GeometryError, InputError
from squeezefilm.core.hard_limits import PLANAR_MEMORY
from squeezefilm.physics.film.gas import CompiledGas, FilmGas
from squeezefilm.physics.film.periodic.resolution import derivative
from squeezefilm.physics.film.planar.balance import Balancer, Film, resampled
from squeezefilm.physics.film.planar.film import solve_planar
from squeezefilm.physics.film.planar.grid import (
    PlanarGap,
    disc_grid,
    ellipse_grid,
    graded_line,
    rectangle_grid,
)


def plane(shape, squeeze_number, excursion, aspect=1.0, *, tolerance=5e-3, **waves):
    return solve_planar(
        shape,
        PlanarGap(excursion, **waves),
        squeeze_number,
        aspect_ratio=aspect,
        tolerance=tolerance,
    )


def blech(squeeze_number: float, aspect: float, terms: int = 4001) -> tuple[float, float]:
    """fk, fd of the rectangle, Blech (1983), as the double series of its eigenfunctions.

    Modes of p'' = iσ(p + ε): each odd (m, n) holds 64/(π⁴m²n²) of the load and answers with
    iσ/(iσ + λ), λ = π²(m² + n²/aspect²). The sum over n is taken in closed form.
    """
    total = 0.0 + 0.0j
    for m in range(1, terms, 2):
        z = np.sqrt(1j * squeeze_number + (np.pi * m) ** 2) * aspect / 2
        tanh = np.tanh(z) if abs(z) < 300 else 1.0
        share = 8.0 / (np.pi * m) ** 2
        total += share * 1j * squeeze_number * (aspect / 2 / z) ** 2 * (1.0 - tanh / z)
    return float(total.real), float(total.imag)


def test_the_series_reaches_its_known_crossover():
    stiffness, damping = blech(21.63490, 1.0)
    assert stiffness == pytest.approx(damping, rel=1e-6)


@pytest.mark.parametrize(
    "squeeze_number",
    [0.5, 200.0, *(pytest.param(one, marks=pytest.mark.slow) for one in (10.0, 21.6349))],
)
@pytest.mark.parametrize("aspect", [1.0, 2.5])
def test_small_motion_of_a_rectangle_agrees_with_blech(squeeze_number, aspect):
    excursion = 2e-3
    stiffness, damping = blech(squeeze_number, aspect)
    film = plane("rectangle", squeeze_number, excursion, aspect, tolerance=1e-4)
    assert film.over_pressure == pytest.approx(1.25 * excursion**2 * stiffness, rel=2e-4)
    assert film.stiffness_relative == pytest.approx(stiffness, rel=3e-4)
    assert film.damping_relative == pytest.approx(damping, rel=3e-4)


@pytest.mark.slow
def test_square_crossover():
    film = plane("rectangle", 21.63490, 1e-3, 1.0, tolerance=1e-5)
    assert film.stiffness_relative == pytest.approx(film.damping_relative, rel=1e-4)


@pytest.mark.parametrize("tolerance", [5e-3, 2e-4])
@pytest.mark.parametrize(
    ("squeeze_number", "expected"), [(1.0, 1.018267), (10.0, 1.196820), (100.0, 1.306992)]
)
def test_the_disc_agrees_with_the_axisymmetric_values(squeeze_number, expected, tolerance):
    film = solve_planar("disc", PlanarGap(0.5), squeeze_number, tolerance=tolerance)
    assert abs(film.mean_load - expected) <= film.over_pressure_error + 5e-7
    assert film.over_pressure_error <= tolerance * film.over_pressure


@pytest.mark.parametrize("aspect", [0.999, 1.001])
def test_an_ellipse_passes_into_the_disc(aspect):
    film = plane("ellipse", 10.0, 0.5, aspect, tolerance=1e-3)
    assert film.over_pressure == pytest.approx(0.196820, rel=2e-3)


def test_a_long_rectangle_passes_into_the_strip():
    film = plane("rectangle", 10.0, 0.5, 100.0, tolerance=1e-4)
    longer = plane("rectangle", 10.0, 0.5, 200.0, tolerance=1e-4)
    # What the two ends lose goes with 1/aspect.
    assert 2 * longer.over_pressure - film.over_pressure == pytest.approx(0.160251, rel=3e-4)


def test_an_ellipse_turned_by_a_quarter_is_the_same_film():
    tall = plane("ellipse", 10.0, 0.5, 2.0, tolerance=1e-4)
    wide = plane("ellipse", 40.0, 0.5, 0.5, tolerance=1e-4)
    assert tall.over_pressure == pytest.approx(wide.over_pressure, rel=2e-4)


def test_polytropic_gas_and_slip_on_a_disc_agree_with_the_march():
    for gas in (FilmGas(1.4), FilmGas(knudsen_number=0.05), FilmGas(1.2, 0.05, "veijola")):
        film = solve_planar("disc", PlanarGap(0.6), 20.0, tolerance=1e-3, gas=gas)
        march = settle_to_periodic(uniform_gap(0.6), 20.0, shape="disc", tolerance=1e-4, gas=gas)
        allowed = film.over_pressure_error + march.error
        assert abs(film.over_pressure - march.over_pressure) <= allowed


@pytest.mark.slow
def test_a_wave_over_a_long_strip_agrees_with_the_march():
    excursion, wave, squeeze_number = 0.5, 2.5, 30.0
    march = settle_to_periodic(
        lambda X, T: 1.0 + excursion * np.cos(wave * X) * np.cos(T), squeeze_number, tolerance=2e-4
    )
    ends = [
        plane("rectangle", squeeze_number, excursion, a, wave_number=wave, tolerance=1e-4)
        for a in (50.0, 100.0)
    ]
    strip = 2 * ends[1].over_pressure - ends[0].over_pressure
    assert strip == pytest.approx(march.over_pressure, rel=1e-3)


def _solved(grid, excursion=0.5, squeeze_number=10.0, count=7):
    film = Film(PlanarGap(excursion), squeeze_number, CompiledGas(1.0, 0.0, 0))
    return Balancer(film, grid, count).solve(None, 1e-10)


def _grids(shape: str, k: int):
    if shape == "disc":
        return disc_grid(10.0, (k, k))
    if shape == "ellipse":
        return ellipse_grid(1.6, 10.0, (k, k))
    return rectangle_grid(graded_line(k, 0.5, 10.0), graded_line(k, 0.8, 10.0))


@pytest.mark.parametrize("shape", ["rectangle", "disc", "ellipse"])
def test_a_grid_covers_a_quarter_of_its_shape(shape):
    area = {"rectangle": 1.6, "disc": np.pi, "ellipse": 1.6 * np.pi}[shape]
    assert 4 * _grids(shape, 6).area.sum() == pytest.approx(area, rel=1e-12)


@pytest.mark.parametrize("shape", ["rectangle", "disc", "ellipse"])
def test_the_order_in_space_is_two(shape):
    loads = [_solved(_grids(shape, k)).over_pressure for k in (6, 12, 24)]
    order = np.log2((loads[0] - loads[1]) / (loads[1] - loads[2]))
    assert order == pytest.approx(2.0, abs=0.15)


def test_harmonics_converge_geometrically():
    exact = _solved(_grids("ellipse", 6), count=31).over_pressure
    errors = [
        abs(_solved(_grids("ellipse", 6), count=M).over_pressure - exact) for M in (7, 11, 15)
    ]
    assert errors[1] < 0.05 * errors[0]
    assert errors[2] < 0.05 * errors[1]


def test_no_gas_is_lost_over_a_period():
    state = _solved(_grids("ellipse", 8), excursion=0.7, count=15)
    grid = state.grid
    T = 2 * np.pi * np.arange(15) / 15
    P = state.gas / (1.0 + 0.7 * np.cos(T))
    H = 1.0 + 0.7 * np.cos(T)
    inside = P[grid.faces.edge_node]
    flow = grid.faces.edge_conductance[:, None] * H**3 * 0.5 * (inside + 1.0) * (inside - 1.0)
    assert abs(flow.sum(axis=0).mean()) < 1e-9 * np.abs(flow).sum(axis=0).mean()


def test_the_spectral_derivative_and_resampling_are_exact_on_what_they_carry():
    T = 2 * np.pi * np.arange(9) / 9
    wave = 0.3 + np.cos(3 * T) - 2 * np.sin(4 * T)
    assert derivative(9) @ wave == pytest.approx(-3 * np.sin(3 * T) - 8 * np.cos(4 * T), abs=1e-12)
    fine = 2 * np.pi * np.arange(24) / 24
    assert resampled(wave, 24) == pytest.approx(0.3 + np.cos(3 * fine) - 2 * np.sin(4 * fine))
    assert resampled(resampled(wave, 24), 9) == pytest.approx(wave)


def test_force_harmonics_follow_the_sign_of_stiffness_and_damping():
    film = plane("ellipse", 10.0, 0.3, 1.3, tolerance=1e-3)
    first = film.force_harmonics[0]
    assert first == pytest.approx(
        -0.3 * (film.stiffness_relative + 1j * film.damping_relative), rel=1e-12
    )
    assert film.stiffness_relative > 0
    assert film.damping_relative > 0
    assert film.mean_load == 1.0 + film.over_pressure
    whole = float(film.area @ (film.mean_pressure - 1.0) / film.area.sum())
    assert whole == pytest.approx(film.over_pressure, rel=0.03)


# The paper's finger on its stator (PHYSICS, section 1), over l0 = 10 mm.
_H0 = 0.6e-6 + 2e-6 + 50e-6
RIDGED = PlanarGap(
    excursion_ratio=2e-6 / _H0,
    wave_number=2 * np.pi * 10.0 / 18.7,
    ridge_height=50e-6 / _H0,
    ridge_wave_number=2 * np.pi * 10.0 / 0.35,
)


def test_open_grooves_of_the_paper_s_finger_leave_hardly_any_over_pressure():
    film = solve_planar("rectangle", RIDGED, 20.418, tolerance=1e-2)
    assert film.over_pressure == pytest.approx(1.651e-4, rel=1e-2)
    assert abs(film.over_pressure - 1.651e-4) <= film.over_pressure_error


def test_grooves_sealed_at_their_ends_are_the_line_s():
    x = np.linspace(0, 0.5, 1441)
    grid = rectangle_grid(x, np.linspace(0, 0.5, 3))
    faces = grid.faces
    edge_X = grid.faces_X[-faces.edge_node.size :]
    sealed = np.where(edge_X < 0.5, 0.0, faces.edge_conductance)
    film = Film(RIDGED, 20.418, CompiledGas(1.0, 0.0, 0))
    state = Balancer(film, replace(grid, faces=faces._replace(edge_conductance=sealed)), 13).solve(
        None, 1e-9
    )
    assert state.over_pressure == pytest.approx(7.246e-3, rel=5e-3)


@pytest.mark.parametrize("squeeze_number", [0.01, 1.0, 1e4])
def test_the_largest_excursion_is_within_reach(squeeze_number):
    film = plane("ellipse", squeeze_number, 0.95, 1.3, tolerance=2e-2)
    assert film.over_pressure > 0
    assert film.over_pressure_error <= 2e-2 * film.over_pressure


@pytest.mark.nightly
def test_the_error_estimate_is_honest():
    """True error within the estimate in 95 % of random films; seed 20, 60 films, 3 tolerances."""
    random = np.random.default_rng(20)
    ratios = []
    for _ in range(60):
        film = {
            "shape": str(random.choice(["rectangle", "ellipse"])),
            "gap": PlanarGap(random.uniform(0.05, 0.9), random.choice([0.0, 2.0])),
            "squeeze_number": 10 ** random.uniform(-1.5, 4.0),
            "aspect_ratio": float(np.exp(random.uniform(-1.0, 1.0))),
            "gas": FilmGas(
                random.choice([1.0, 1.4]),
                random.choice([0.0, 0.05]),
                str(random.choice(["first", "veijola"])),
            ),
        }
        exact = solve_planar(**film, tolerance=1.5e-4)
        for tolerance in (2e-2, 5e-3, 1e-3):
            asked = solve_planar(**film, tolerance=tolerance)
            true = abs(asked.over_pressure - exact.over_pressure)
            ratios.append(true / (asked.over_pressure_error + exact.over_pressure_error))
    assert np.mean(np.array(ratios) <= 1.0) >= 0.95
    assert 1.0 / np.median(ratios) <= 12.0


@pytest.mark.nightly
def test_open_grooves_converge_on_grids_of_two_kinds():
    film = solve_planar("rectangle", RIDGED, 20.418, tolerance=3e-4)
    equations = Film(RIDGED, 20.418, CompiledGas(1.0, 0.0, 0))
    uniform = []
    for k in (256, 512):
        grid = rectangle_grid(np.linspace(0, 0.5, 2 * k + 1), np.linspace(0, 0.5, k // 16 + 1))
        uniform.append(Balancer(equations, grid, 13).solve(None, 1e-8).over_pressure)
    assert uniform[1] + (uniform[1] - uniform[0]) / 3 == pytest.approx(film.over_pressure, rel=1e-2)


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        ({"squeeze_number": 0.0}, InputError, "squeeze_number = 0"),
        ({"squeeze_number": float("nan")}, InputError, "nan"),
        ({"aspect_ratio": -1.0}, InputError, "aspect_ratio = -1"),
        ({"gas": {"polytropic_exponent": 3.0}}, InputError, "polytropic_exponent = 3"),
        ({"gas": {"knudsen_number": float("inf")}}, InputError, "inf"),
        ({"gas": {"slip": "secund"}}, InputError, "Did you mean 'second'"),
        ({"tolerance": 0.0}, InputError, "tolerance"),
        ({"shape": "triangle"}, InputError, "triangle"),
        ({"shape": "disc", "aspect_ratio": 2.0}, InputError, "disc"),
    ],
)
def test_what_cannot_be_used_is_refused_with_its_value(change, error, says):
    asked = {"shape": "rectangle", "gap": PlanarGap(0.5), "squeeze_number": 10.0} | change
    with pytest.raises(error, match=says):
        solve_planar(**asked | {"gas": FilmGas(**asked.get("gas", {}))})


@pytest.mark.parametrize("excursion", [0.0, 1.0, float("nan")])
def test_an_excursion_out_of_range_is_refused(excursion):
    with pytest.raises(InputError, match="excursion_ratio"):
        plane("rectangle", 10.0, excursion)


def test_ridges_that_reach_the_surface_are_refused():
    with pytest.raises(GeometryError, match="the gap closes"):
        plane("rectangle", 10.0, 0.5, ridge_height=0.6, ridge_wave_number=40.0)


def test_a_tolerance_out_of_reach_raises_with_the_best_state(monkeypatch):
    lower = replace(PLANAR_MEMORY, most=2e6)
    monkeypatch.setattr("squeezefilm.physics.film.planar.film.PLANAR_MEMORY", lower)
    with pytest.raises(ConvergenceError, match="memory") as caught:
        plane("ellipse", 10.0, 0.5, 1.5, tolerance=1e-5)
    assert caught.value.partial.over_pressure == pytest.approx(0.22470, rel=5e-3)
    assert caught.value.partial.over_pressure_error > 0
