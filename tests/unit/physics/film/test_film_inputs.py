"""What the film refuses, and how it says so."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from squeezefilm.core.errors import ConvergenceError, GeometryError, InputError
from squeezefilm.physics.film.gas import MOST_SQUEEZE_NUMBER
from squeezefilm.physics.film.periodic import batch, film, nested
from squeezefilm.physics.film.periodic.batch import solve_films
from squeezefilm.physics.film.periodic.film import solve_profile, solve_uniform
from squeezefilm.physics.film.periodic.profile import (
    flexural_profile,
    profile_from_function,
)


@pytest.mark.parametrize("solve", [solve_uniform, solve_films])
@pytest.mark.parametrize(
    ("arguments", "offender"),
    [
        ({"squeeze_number": 0.0}, "squeeze_number = 0"),
        ({"squeeze_number": -3.0}, "squeeze_number = -3"),
        ({"squeeze_number": float("nan")}, "squeeze_number = nan"),
        ({"squeeze_number": 2.0 * MOST_SQUEEZE_NUMBER}, "squeeze_number = 2e+09"),
        ({"excursion_ratio": 1.0}, "excursion_ratio = 1"),
        ({"excursion_ratio": float("inf")}, "excursion_ratio = inf"),
        ({"polytropic_exponent": 0.9}, "polytropic_exponent = 0.9"),
        ({"knudsen_number": -0.1}, "knudsen_number = -0.1"),
        ({"tolerance": 0.0}, "tolerance = 0"),
        ({"slip": "diffuse"}, "slip = 'diffuse'"),
    ],
)
def test_bad_input_is_named(solve, arguments, offender):
    inputs = {"squeeze_number": 10.0, "excursion_ratio": 0.5} | arguments
    with pytest.raises(InputError) as caught:
        solve(**inputs)
    assert offender in str(caught.value)


def test_batch_names_the_offending_element_and_shapes():
    with pytest.raises(InputError, match=r"excursion_ratio = 1\.2"):
        solve_films([1.0, 2.0], [0.5, 1.2])
    with pytest.raises(InputError, match="broadcast"):
        solve_films([1.0, 2.0], [0.1, 0.2, 0.3])
    with pytest.raises(InputError, match="workers = 0"):
        solve_films(1.0, 0.5, workers=0)


def test_closed_gap_is_a_geometry_error_that_says_where():
    with pytest.raises(GeometryError, match=r"closes: H = -0\.[0-9]+ at X = "):
        flexural_profile(0.5, ridge_depth=0.6, ridge_wavenumber=20.0)
    with pytest.raises(GeometryError, match="closes"):
        solve_profile(10.0, lambda X, T: 0.5 + X + 0.2 * np.cos(T))


def test_profile_that_is_not_periodic_is_refused_with_the_values():
    with pytest.raises(InputError, match="not periodic in time"):
        solve_profile(10.0, lambda X, T: 1.0 + 0.01 * T + 0.0 * X)


def test_profile_that_is_not_finite_or_not_smooth_is_refused():
    with pytest.raises(InputError, match="not finite"):
        profile_from_function(lambda X, T: np.nan + 0.0 * X * T)
    with pytest.raises(InputError, match="harmonics in time"):
        profile_from_function(lambda X, T: 1.5 + 0.3 * np.sign(np.cos(T)) + 0.0 * X)
    with pytest.raises(InputError, match="GapProfile or a function"):
        solve_profile(10.0, 3.0)


def test_a_gap_of_ones_own_is_what_the_function_says():
    def gap(X, T):
        return 1.0 + 0.1 * X + 0.4 * np.cos(T - 0.3) * np.cos(2.0 * X)

    x, t = np.linspace(-0.5, 0.5, 41), np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    given = profile_from_function(gap)
    np.testing.assert_allclose(given.gap(x, t), gap(x[:, None], t[None, :]), atol=1e-12)
    assert not given.symmetric


def test_what_does_not_converge_raises_with_its_partial_result(monkeypatch):
    for rounds in (batch, nested):
        monkeypatch.setattr(rounds, "ROUNDS", 1)
    with pytest.raises(ConvergenceError) as caught:
        solve_uniform(10.0, 0.9, tolerance=1e-6)
    error = caught.value
    assert error.residual == error.partial.residual
    assert error.iterations == error.partial.iterations > 0
    assert error.partial.over_pressure == pytest.approx(1.33, abs=0.2)
    assert "not converged" in error.partial.status
    with pytest.raises(ConvergenceError) as caught:
        solve_films([1.0, 10.0], 0.9, tolerance=1e-6)
    kept = caught.value.partial
    assert kept.mean_load.shape == (2,)
    assert np.all(kept.over_pressure_error > 1e-6 * kept.over_pressure)


def test_a_partial_result_holds_nothing_that_was_not_computed(monkeypatch):
    # Compiled code is made while NumPy is itself.
    solve_profile(10.0, lambda X, T: 1.0 + 0.1 * X + 0.4 * np.cos(T))
    for rounds in (batch, nested):
        monkeypatch.setattr(rounds, "ROUNDS", 1)
    # What memory happens to hold is seen where it is no number.
    monkeypatch.setattr(film.np, "empty", lambda shape, **_: np.full(shape, np.nan))
    wavy = profile_from_function(lambda x, t: 1 + 0.3 * np.cos(6 * x) + 0.5 * np.cos(t))
    for solve in (
        lambda: solve_uniform(10.0, 0.9, tolerance=1e-6),
        lambda: solve_uniform(10.0, 0.9, shape="disc", tolerance=1e-6),
        lambda: solve_profile(30.0, wavy, tolerance=1e-6),
    ):
        with pytest.raises(ConvergenceError) as caught:
            solve()
        partial = caught.value.partial
        assert np.all(np.isfinite(partial.pressure))
        assert np.all(np.isfinite(partial.mean_pressure))


def test_still_plate_makes_no_pressure():
    solution = solve_uniform(10.0, 0.0)
    assert solution.over_pressure == 0.0
    assert np.all(solution.pressure == 1.0)
    assert solution.stiffness_relative == pytest.approx(0.411794, abs=1e-5)
    loads = solve_films(10.0, [0.0, 0.1]).over_pressure
    assert loads[0] == 0.0
    assert loads[1] > 0.0


def test_shapes_broadcast_and_progress_reaches_the_total():
    seen = []
    result = solve_films(
        np.geomspace(1.0, 100.0, 5)[:, None], np.linspace(0.1, 0.9, 4),
        workers=2, progress=lambda done, total: seen.append((done, total)),
    )  # fmt: skip
    assert result.mean_load.shape == (5, 4)
    assert result.times.shape == (5, 4)
    assert seen[-1] == (20, 20)


def test_workers_do_not_change_the_result():
    sigma = np.geomspace(0.1, 1e3, 200)
    one = solve_films(sigma, 0.5, workers=1)
    two = solve_films(sigma, 0.5, workers=2)
    np.testing.assert_array_equal(one.over_pressure, two.over_pressure)


def test_importing_the_film_imports_neither_scipy_nor_numba():
    code = (
        "import sys, squeezefilm.physics.film.periodic.film;"
        "import squeezefilm.physics.film.periodic.batch;"
        "print([m for m in ('scipy', 'numba') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.slow
def test_the_largest_squeeze_number_is_nearly_an_infinite_one():
    at = solve_films(MOST_SQUEEZE_NUMBER, 0.3, tolerance=1e-3).mean_load
    infinite = np.sqrt((1.0 + 1.5 * 0.3**2) / (1.0 - 0.3**2))  # Salbu's
    assert at == pytest.approx(infinite, rel=2e-4)
