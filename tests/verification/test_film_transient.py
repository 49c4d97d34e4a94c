"""The film in time: tables, measured orders, balances, and motions without a period."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import ConvergenceError, GeometryError, InputError
from squeezefilm.physics.film.gas import FilmGas
from squeezefilm.physics.film.line_grid import uniform_gap
from squeezefilm.physics.film.transient.march import solve_transient
from squeezefilm.physics.film.transient.settling import settle_to_periodic

STRIP = {
    (0.1, 1.0): 1.000108, (0.1, 10.0): 1.005188, (0.1, 100.0): 1.010778,
    (0.5, 1.0): 1.009029, (0.5, 10.0): 1.160251, (0.5, 100.0): 1.307197,
    (0.9, 1.0): 1.373299, (0.9, 10.0): 2.333313, (0.9, 100.0): 3.148871,
}  # fmt: skip


@pytest.mark.parametrize(("case", "expected"), STRIP.items())
def test_the_strip_settles_to_the_tabulated_load(case, expected):
    result = settle_to_periodic(uniform_gap(case[0]), case[1], tolerance=2e-4)
    rounding = 5e-7
    assert abs(result.mean_load - expected) <= result.over_pressure_error + rounding
    assert result.over_pressure_error <= 2e-4 * result.over_pressure


@pytest.mark.parametrize(
    ("squeeze_number", "expected"), [(1.0, 1.018267), (10.0, 1.196820), (100.0, 1.306992)]
)
def test_the_disc_settles_to_the_tabulated_load(squeeze_number, expected):
    result = settle_to_periodic(uniform_gap(0.5), squeeze_number, shape="disc", tolerance=2e-4)
    assert abs(result.mean_load - expected) <= result.over_pressure_error + 5e-7


def test_polytropic_gas_and_slip_reach_the_tabulated_load():
    rare = FilmGas(knudsen_number=0.026)
    warm = settle_to_periodic(uniform_gap(0.5), 10.0, gas=FilmGas(1.4), tolerance=2e-4)
    slip = settle_to_periodic(uniform_gap(0.5), 10.0, gas=rare, tolerance=2e-4)
    assert warm.mean_load == pytest.approx(1.173567, abs=2e-5)
    assert slip.mean_load == pytest.approx(1.139260, abs=2e-5)


def test_large_squeeze_numbers_follow_the_edge_layer_law():
    result = settle_to_periodic(uniform_gap(0.5), 1e4, tolerance=1e-3)
    assert result.mean_load == pytest.approx(1.354006 - 0.46890 / 100.0, abs=2e-5)


def _order(errors: list[float]) -> float:
    return float(np.log2(errors[-2] / errors[-1]))


@pytest.mark.parametrize(("scheme", "order"), [("backward_euler", 1.0), ("bdf2", 2.0)])
def test_the_order_in_time_is_the_scheme_s(scheme, order):
    def load(steps: int) -> float:
        film = solve_transient(uniform_gap(0.5), 10.0, 3.0, steps=steps, cells=32, scheme=scheme)
        return float(film.load[-1])

    exact = (4 * load(4096) - load(2048)) / 3 if order == 2 else 2 * load(8192) - load(4096)
    errors = [abs(load(steps) - exact) for steps in (64, 128, 256)]
    assert _order(errors) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize(("scheme", "order"), [("backward_euler", 1.0), ("bdf2", 2.0)])
def test_the_periodic_load_converges_in_time_at_least_at_the_scheme_s_order(scheme, order):
    def load(steps: int, how: str = scheme) -> float:
        return settle_to_periodic(
            uniform_gap(0.5), 10.0, steps=steps, cells=32, tolerance=None, scheme=how
        ).over_pressure

    exact = load(2048, "bdf2")
    errors = [abs(load(steps) - exact) for steps in (32, 64, 128)]
    assert _order(errors) >= order - 0.1


@pytest.mark.parametrize("shape", ["strip", "disc"])
def test_the_order_in_space_is_two(shape):
    def load(cells: int) -> float:
        return settle_to_periodic(
            uniform_gap(0.5), 10.0, steps=32, cells=cells, tolerance=None, shape=shape
        ).over_pressure

    exact = (4 * load(512) - load(256)) / 3
    errors = [abs(load(cells) - exact) for cells in (16, 32, 64)]
    assert _order(errors) == pytest.approx(2.0, abs=0.1)


def test_no_gas_is_lost_over_a_settled_period():
    rare = FilmGas(knudsen_number=0.02)
    result = settle_to_periodic(uniform_gap(0.7), 30.0, gas=rare, tolerance=1e-3)
    assert result.mass_residual < 1e-9


@pytest.mark.parametrize("scheme", ["backward_euler", "sdirk2", "bdf2"])
def test_a_transient_balances_its_gas(scheme):
    film = solve_transient(uniform_gap(0.8), 20.0, 5.0, steps=200, scheme=scheme)
    assert film.mass_residual < 1e-11
    assert film.load.shape == film.time.shape == (201,)
    assert film.pressure.shape == (11, 64)


def test_acceleration_does_not_change_the_state_but_saves_periods():
    def settled(accelerate: bool):
        return settle_to_periodic(
            uniform_gap(0.5), 300.0, cells=32, tolerance=None, accelerate=accelerate
        )

    plain, mixed = settled(False), settled(True)
    assert mixed.mean_load == pytest.approx(plain.mean_load, abs=1e-9)
    assert 3 * mixed.periods < plain.periods


def test_a_march_from_rest_reaches_the_settled_state():
    steps = 256
    film = solve_transient(uniform_gap(0.5), 10.0, 12 * np.pi, steps=6 * steps, cells=96)
    settled = settle_to_periodic(uniform_gap(0.5), 10.0, cells=96, steps=steps, tolerance=None)
    assert film.load[-steps:].mean() == pytest.approx(settled.mean_load, abs=1e-8)


def test_a_plate_lifting_off_sucks_and_then_lets_go():
    film = solve_transient(lambda X, T: 1.0 + 4.0 * T + 0.0 * X, 500.0, 5.0, steps=2000)
    assert film.load[0] == pytest.approx(1.0)
    assert film.load.min() < 0.4
    assert np.all(film.pressure > 0)
    assert film.load[-1] > film.load.min()


def test_a_step_of_the_gap_decays_at_the_linear_rate():
    # A small step: p = P − 1 obeys H² p'' = σ ṗ, whose slowest mode decays with π²H²/σ.
    film = solve_transient(
        lambda X, T: np.where(T > 0, 0.999, 1.0) + 0.0 * X, 10.0, 4.0, steps=4000, cells=64
    )
    late = film.load[2000::1000] - 1.0
    assert film.load[1] == pytest.approx(1.001, abs=1e-4)
    assert np.log(late[0] / late[1]) == pytest.approx(0.999**2 * np.pi**2 / 10.0, rel=1e-3)


def test_an_amplitude_step_leads_from_one_periodic_state_to_the_other():
    steps, periods = 128, 12

    def gap(X, T):
        return 1.0 + np.where(T / np.pi > 8.001, 0.5, 0.2) * np.cos(T) + 0.0 * X

    film = solve_transient(gap, 20.0, 2 * np.pi * periods, steps=steps * periods, cells=48)
    loads = film.load[1:].reshape(periods, steps).mean(axis=1)
    for excursion, mean in ((0.2, loads[3]), (0.5, loads[-1])):
        settled = settle_to_periodic(
            uniform_gap(excursion), 20.0, cells=48, steps=steps, tolerance=None
        )
        assert mean == pytest.approx(settled.mean_load, abs=1e-5)


def test_sealed_grooves_of_the_paper_s_finger():
    whole = 0.6 + 2.0 + 50.0
    wave, ridges = 2 * np.pi * 10.0 / 18.7, 2 * np.pi * 10.0 / 0.35

    def gap(X, T):
        return 1.0 + (2 * np.cos(wave * X) * np.cos(T) + 50 * np.cos(ridges * X)) / whole

    film = settle_to_periodic(gap, 20.418, cells=200, steps=32, tolerance=1e-3)
    assert film.over_pressure == pytest.approx(7.246e-3, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "error", "says"),
    [
        ({"squeeze_number": 0.0}, InputError, "squeeze_number = 0"),
        ({"squeeze_number": float("nan")}, InputError, "nan"),
        ({"gas": FilmGas(0.5)}, InputError, "polytropic_exponent = 0.5"),
        ({"gas": FilmGas(1.0, -1.0)}, InputError, "knudsen_number = -1"),
        ({"gas": FilmGas(slip="veijolla")}, InputError, "Did you mean 'veijola'"),
        ({"shape": "square"}, InputError, "square"),
        ({"scheme": "rk4"}, InputError, "rk4"),
        ({"gap": lambda X, T: 1.0 + 1.2 * np.cos(T)}, GeometryError, "the gap closes: H = -0.2"),
        ({"gap": lambda X, T: np.nan * (X + T)}, InputError, "nan"),
        ({"gap": lambda X, T: np.ones(3)}, InputError, "broadcasts"),
    ],
)
def test_what_cannot_be_used_is_refused_with_its_value(change, error, says):
    asked = {"gap": uniform_gap(0.5), "squeeze_number": 10.0} | change
    with pytest.raises(error, match=says):
        settle_to_periodic(tolerance=None, **asked)
    with pytest.raises(error, match=says):
        solve_transient(end=2 * np.pi, **asked)


@pytest.mark.parametrize("excursion", [0.0, 1.0, -0.1, float("nan")])
def test_an_excursion_that_closes_the_gap_is_refused(excursion):
    with pytest.raises(InputError, match="excursion_ratio"):
        uniform_gap(excursion)


def test_a_march_that_does_not_settle_says_so_with_what_it_had():
    with pytest.raises(ConvergenceError) as caught:
        settle_to_periodic(uniform_gap(0.5), 1000.0, accelerate=False, max_periods=3)
    assert caught.value.partial.over_pressure == pytest.approx(0.339, abs=0.01)
    assert caught.value.residual > 1e-10
    assert caught.value.iterations == 3


def test_a_resolution_that_does_not_reach_the_tolerance_says_so():
    with pytest.raises(ConvergenceError, match="max_cells") as caught:
        settle_to_periodic(uniform_gap(0.5), 10.0, tolerance=1e-8, max_cells=100)
    assert caught.value.partial.cells <= 100
