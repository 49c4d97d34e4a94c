"""What must hold for every film, not only for tabulated ones."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from squeezefilm.physics.film.gas import SLIP_LAWS
from squeezefilm.physics.film.periodic.batch import solve_films
from squeezefilm.physics.film.periodic.film import solve_profile, solve_uniform
from squeezefilm.physics.film.periodic.profile import flexural_profile

sigmas = st.floats(-2.0, 4.0).map(lambda power: 10.0**power)
excursions = st.floats(0.02, 0.95)
exponents = st.floats(1.0, 1.4)
knudsens = st.floats(0.0, 0.3)
slips = st.sampled_from(sorted(SLIP_LAWS))
# The first call compiles or loads compiled code.
calm = settings(settings.get_profile("dear"))


@calm
@given(sigmas, excursions, exponents, knudsens, slips)
def test_load_is_even_in_the_excursion(sigma, eps, n, kn, slip):
    result = solve_films(sigma, [eps, -eps], polytropic_exponent=n, knudsen_number=kn, slip=slip)
    assert result.over_pressure[0] == result.over_pressure[1]
    assert result.over_pressure[0] > 0.0


@calm
@given(excursions, exponents, knudsens, slips)
def test_load_rises_with_the_squeeze_number(eps, n, kn, slip):
    sigma = np.geomspace(0.01, 1e4, 13)
    for shape in ("strip", "disc"):
        result = solve_films(
            sigma, eps, shape=shape, polytropic_exponent=n, knudsen_number=kn, slip=slip
        )
        assert np.all(np.diff(result.over_pressure) > 0.0)


@calm
@given(sigmas, exponents, knudsens, slips)
def test_load_rises_with_the_excursion(sigma, n, kn, slip):
    eps = np.linspace(0.05, 0.95, 10)
    result = solve_films(sigma, eps, polytropic_exponent=n, knudsen_number=kn, slip=slip)
    assert np.all(np.diff(result.over_pressure) > 0.0)


@calm
@given(sigmas, excursions, knudsens)
def test_slip_lowers_the_load(sigma, eps, kn):
    result = solve_films(sigma, eps, knudsen_number=[kn, kn + 0.05], tolerance=1e-4)
    assert result.over_pressure[1] < result.over_pressure[0]


@calm
@given(sigmas, excursions)
def test_load_stays_below_the_infinite_squeeze_number_limit(sigma, eps):
    limit = np.sqrt((1.0 + 1.5 * eps**2) / (1.0 - eps**2))
    result = solve_films(sigma, eps, tolerance=1e-3)
    assert result.mean_load - result.over_pressure_error < limit


@calm
@given(st.floats(0.0, 3.0).map(lambda p: 10.0**p), st.floats(0.05, 0.9), exponents)
def test_pressure_is_symmetric_positive_and_ambient_at_the_edges(sigma, eps, n):
    solution = solve_uniform(sigma, eps, polytropic_exponent=n)
    np.testing.assert_array_equal(solution.pressure, solution.pressure[::-1])
    np.testing.assert_allclose(solution.pressure[[0, -1]], 1.0, rtol=1e-12)
    assert np.all(solution.pressure > 0.0)
    assert solution.stiffness_relative > 0.0
    assert solution.damping_relative > 0.0


@calm
@given(st.floats(0.0, 3.0).map(lambda p: 10.0**p), st.floats(0.05, 0.5), st.floats(0.02, 0.3))
def test_mirrored_profile_mirrors_the_pressure(sigma, eps, tilt):
    right, left = (
        solve_profile(sigma, flexural_profile(eps, tilt=sign * tilt)) for sign in (1.0, -1.0)
    )
    assert np.isclose(right.over_pressure, left.over_pressure, rtol=1e-9)
    np.testing.assert_allclose(right.pressure, left.pressure[::-1], rtol=1e-7)


@calm
@given(sigmas, st.floats(0.05, 0.9), exponents, knudsens)
def test_mass_flow_over_a_period_vanishes(sigma, eps, n, kn):
    # ⟨H^(2−n) φ ∂(Ψ^((n+1)/n))⟩ = 0 inside: for n = 1 without slip, ⟨H (Ψ² − H²)⟩ does not depend
    # on X, since it is the mean mass flow's potential and none flows through the centre.
    solution = solve_uniform(sigma, eps, tolerance=1e-4)
    potential = np.mean(solution.gap**3 * (solution.pressure**2 - 1.0), axis=1)
    scale = np.mean(np.abs(solution.gap**3 * (solution.pressure**2 - 1.0)), axis=1).max()
    assert np.all(np.abs(potential) <= 2e-3 * scale)
