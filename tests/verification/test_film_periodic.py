"""The periodic film against closed forms, published values, its own convergence and itself."""

from __future__ import annotations

import numpy as np
import pytest
from tests.verification.trapped_film import trapped_load

from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.film.gas import CompiledGas
from squeezefilm.physics.film.periodic.batch import solve_films
from squeezefilm.physics.film.periodic.film import solve_profile, solve_uniform
from squeezefilm.physics.film.periodic.grids import Mesh, fill_cells, room_for
from squeezefilm.physics.film.periodic.kernel import newton
from squeezefilm.physics.film.periodic.profile import flexural_profile
from squeezefilm.physics.film.periodic.resolution import (
    FilmResolution,
    GridGap,
    collocation_times,
)

STRIP_LOADS = {
    (0.1, 1.0): 1.000108, (0.1, 10.0): 1.005188, (0.1, 100.0): 1.010778,
    (0.5, 1.0): 1.009029, (0.5, 10.0): 1.160251, (0.5, 100.0): 1.307197,
    (0.9, 1.0): 1.373299, (0.9, 10.0): 2.333313, (0.9, 100.0): 3.148871,
}  # fmt: skip
DISC_LOADS = {1.0: 1.018267, 10.0: 1.196820, 100.0: 1.306992}
ROUNDED = 6e-7
"""The tabulated loads are rounded to 1e-6."""


def strip_force(sigma):
    """fk + i fd of the linear strip film; sinh and cosh scaled so that they don't overflow."""
    a = np.sqrt(np.asarray(sigma, dtype=float) / 2.0)
    even, odd, scale = 1.0 + np.exp(-2.0 * a), 1.0 - np.exp(-2.0 * a), 2.0 * np.exp(-a)
    bottom = a * (even + scale * np.cos(a))
    return 1.0 - (odd + scale * np.sin(a)) / bottom + 1j * (odd - scale * np.sin(a)) / bottom


def disc_force(sigma):
    from scipy.special import ive

    s = np.sqrt(1j * np.asarray(sigma, dtype=float))
    return 1.0 - 2.0 * ive(1, s) / (s * ive(0, s))


@pytest.mark.parametrize(("case", "load"), STRIP_LOADS.items())
def test_tabulated_strip_loads(case, load):
    eps, sigma = case
    assert solve_uniform(sigma, eps, tolerance=1e-7).mean_load == pytest.approx(load, abs=ROUNDED)
    for tolerance in (2e-2, 5e-3, 1e-4):
        loose = solve_films(sigma, eps, tolerance=tolerance)
        assert abs(loose.mean_load - load) <= loose.over_pressure_error + ROUNDED
        assert loose.over_pressure_error <= tolerance * loose.over_pressure


@pytest.mark.parametrize(("sigma", "load"), DISC_LOADS.items())
def test_tabulated_disc_loads(sigma, load):
    assert solve_uniform(sigma, 0.5, shape="disc", tolerance=1e-7).mean_load == pytest.approx(
        load, abs=ROUNDED
    )


def test_tabulated_slip_and_polytropic_loads():
    slip = solve_uniform(10.0, 0.5, knudsen_number=0.026, tolerance=1e-7)
    assert slip.mean_load == pytest.approx(1.139260, abs=ROUNDED)
    polytropic = solve_uniform(10.0, 0.5, polytropic_exponent=1.4, tolerance=1e-7)
    assert polytropic.mean_load == pytest.approx(1.173567, abs=ROUNDED)


def test_linear_limit_of_stiffness_and_damping():
    sigma = np.geomspace(0.01, 1e4, 25)
    for shape, force in (("strip", strip_force), ("disc", disc_force)):
        batch = solve_films(sigma, 1e-4, shape=shape, tolerance=1e-5)
        exact = force(sigma)
        np.testing.assert_allclose(batch.stiffness_relative, exact.real, rtol=2e-4)
        np.testing.assert_allclose(batch.damping_relative, exact.imag, rtol=2e-4)


def test_linear_values_and_crossovers():
    ten = solve_uniform(10.0, 1e-3, tolerance=1e-6)
    hundred = solve_uniform(100.0, 1e-3, tolerance=1e-6)
    assert ten.stiffness_relative == pytest.approx(0.411794, abs=2e-6)
    assert ten.damping_relative == pytest.approx(0.417175, abs=2e-6)
    assert hundred.stiffness_relative == pytest.approx(0.858578, abs=2e-6)
    assert hundred.damping_relative == pytest.approx(0.141082, abs=2e-6)
    for shape, crossover in (("strip", 10.13418), ("disc", 6.23324)):
        batch = solve_films(crossover, 1e-3, shape=shape, tolerance=1e-6)
        assert batch.stiffness_relative == pytest.approx(float(batch.damping_relative), abs=2e-6)


@pytest.mark.parametrize("sigma", [0.03, 1.0, 30.0, 3000.0])
@pytest.mark.parametrize("n", [1.0, 1.2, 1.4])
def test_second_order_identity(sigma, n):
    # W = 1 + (5/4) ε² n fk(σ/n) + O(ε⁴), exact for any planform under a rigid uniform gap.
    for shape, force in (("strip", strip_force), ("disc", disc_force)):
        eps = np.array([0.02, 0.04])
        films = solve_films(sigma, eps, shape=shape, polytropic_exponent=n, tolerance=1e-5)
        ratio = films.over_pressure / eps**2
        limit = ratio[0] + (ratio[0] - ratio[1]) / 3.0
        assert limit == pytest.approx(1.25 * n * force(sigma / n).real, rel=3e-5)


@pytest.mark.parametrize("sigma", [0.1, 10.0, 1000.0])
@pytest.mark.parametrize("kn", [0.02, 0.1, 0.3])
def test_second_order_identity_with_slip(sigma, kn):
    eps = np.array([0.02, 0.04])
    ratio = solve_films(sigma, eps, knudsen_number=kn, tolerance=1e-5).over_pressure / eps**2
    q = 1.0 + 6.0 * kn
    exact = strip_force(sigma / q).real * (1.25 + 6.0 * kn) / q
    assert ratio[0] + (ratio[0] - ratio[1]) / 3.0 == pytest.approx(exact, rel=3e-5)


def edge_layer_constant(eps, n, tolerance):
    """C(ε) of W = W∞ − C/√σ: at σ = 3600 the edges of a strip are e^-20 to each other."""
    batch = solve_films(3600.0, eps, polytropic_exponent=n, tolerance=tolerance)
    return 60.0 * (trapped_load(eps, n) - float(batch.mean_load))


@pytest.mark.parametrize("eps", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("n", [1.0, 1.4])
def test_infinite_squeeze_number_and_edge_layer_law(eps, n):
    limit = trapped_load(eps, n)
    sigma = np.array([500.0, 2000.0, 1e4])
    batch = solve_films(sigma, eps, polytropic_exponent=n, tolerance=1e-7)
    law = limit - edge_layer_constant(eps, n, 1e-5 / 80.0) / np.sqrt(sigma)
    np.testing.assert_allclose(batch.mean_load, law, atol=2e-6 * limit)


def test_edge_layer_constant():
    assert edge_layer_constant(0.5, 1.0, 1e-6 / 80.0) == pytest.approx(0.46890, abs=5e-6)


def paper_profile():
    h_vib, h_r, h_e = 2.0, 0.6, 50.0
    h0 = h_vib + h_r + h_e
    return flexural_profile(
        h_vib / h0,
        wavenumber=2.0 * np.pi * 10.0 / 18.7,
        ridge_depth=h_e / h0,
        ridge_wavenumber=2.0 * np.pi * 10.0 / 0.35,
    )


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-5])
def test_paper_geometry_with_sealed_grooves(tolerance):
    solution = solve_profile(20.4, paper_profile(), tolerance=tolerance)
    # 7.246e-3 is rounded to four digits.
    assert abs(solution.over_pressure - 7.246e-3) <= solution.over_pressure_error + 5e-7
    fine = solve_profile(20.4, paper_profile(), tolerance=1e-6)
    assert abs(solution.over_pressure - fine.over_pressure) <= 1.02 * solution.over_pressure_error


def test_profile_without_variation_is_the_strip_on_half_and_whole_domain():
    inputs = {"knudsen_number": 0.05, "tolerance": 1e-6}
    strip = solve_uniform(30.0, 0.6, **inputs)
    half = solve_profile(30.0, flexural_profile(0.6), **inputs)
    # A tilt too small to matter, but not symmetric: the whole domain is solved.
    whole = solve_profile(30.0, flexural_profile(0.6, tilt=1e-8), **inputs)
    for other in (half, whole):
        assert other.over_pressure == pytest.approx(strip.over_pressure, rel=2e-6)
        assert other.stiffness_relative == pytest.approx(strip.stiffness_relative, rel=1e-5)
        assert other.damping_relative == pytest.approx(strip.damping_relative, rel=1e-5)
    assert whole.cells > half.cells


def test_infinite_sigma_under_a_wavy_gap():
    # σ → ∞: P̄(X) = (a/a_B) √(a_B² + 1.5 b²)/√(a² − b²) for a symmetric finger (the paper's
    # eq 11, corrected); what remains is the edge layer, ∝ 1/√σ.
    eps, delta, k2 = 0.3, 0.2, 2.0 * np.pi
    profile = flexural_profile(eps, ridge_depth=delta, ridge_wavenumber=k2)
    x = np.linspace(-0.5, 0.5, 20001)
    a = 1.0 + delta * np.cos(k2 * x)
    mean = a / a[0] * np.sqrt(a[0] ** 2 + 1.5 * eps**2) / np.sqrt(a**2 - eps**2)
    limit = float(np.mean(0.5 * (mean[1:] + mean[:-1])))
    loads = [solve_profile(s, profile, tolerance=1e-5).mean_load for s in (2.5e3, 1e4)]
    assert 2.0 * loads[1] - loads[0] == pytest.approx(limit, abs=2e-4)
    assert abs(loads[1] - limit) < abs(loads[0] - limit)


def load_on_one_grid(cells, nt, sigma=30.0, eps=0.6):
    """The over-pressure on one grid, without extrapolation."""
    from squeezefilm.physics.film.periodic import uniform as u

    times = collocation_times(nt)
    H, w, c, s = (np.empty(times.row) for _ in range(4))
    mesh = Mesh(np.empty(2 * cells + 1), np.empty(2 * cells + 1), True)
    u.fill_times(times, eps, 1.0, H, w, c, s)
    u.fill_mesh(0, 0.3, mesh)
    room = room_for(FilmResolution(cells, times, times))
    fill_cells(cells, sigma, mesh, room.cells)
    over, _, left = newton(
        cells, times, room.cells, GridGap(H, w, 0, 0), CompiledGas(1.0, 0.0, 0), room.p,
        room.newton, 1e-12,
    )  # fmt: skip
    assert left < 1e-9
    return over


def test_measured_order_in_space_is_two_and_four_when_extrapolated():
    loads = np.array([load_on_one_grid(c, 15) for c in (16, 32, 64, 128)])
    steps = np.diff(loads)
    np.testing.assert_allclose(np.log2(steps[:-1] / steps[1:]), 2.0, atol=0.1)
    extrapolated = np.diff(loads[1:] + steps / 3.0)
    assert np.log2(extrapolated[0] / extrapolated[1]) == pytest.approx(4.0, abs=0.5)


def test_convergence_in_time_is_exponential():
    exact = load_on_one_grid(16, 63)
    errors = np.array([abs(load_on_one_grid(16, nt) - exact) for nt in (5, 9, 13, 17, 21)])
    assert np.all(errors[1:] < 0.1 * errors[:-1])
    assert errors[-1] < 1e-7 * exact


def test_gas_is_conserved_over_a_period():
    # The gas held changes by what flows in at both edges, at every instant and over a period.
    solution = solve_uniform(30.0, 0.6, tolerance=1e-8)
    x, H, P = solution.position, solution.gap, solution.pressure
    gas = P * H
    held = 0.5 * np.diff(x) @ (gas[1:] + gas[:-1])
    orders = np.fft.fftfreq(len(solution.time), 1.0 / len(solution.time))
    rate = 30.0 * np.fft.ifft(1j * orders * np.fft.fft(held)).real
    # One-sided slope of P²/2 at the edge from five nodes of the graded grid.
    nodes = x[-5:] - x[-1]
    slope = np.linalg.solve(np.vander(nodes, increasing=True).T, np.eye(5)[1])
    flow = H[-1] ** 3 * (slope @ P[-5:] ** 2) / 2.0
    assert abs(np.mean(flow)) < 1e-3 * np.abs(flow).max()
    np.testing.assert_allclose(2.0 * flow, rate, atol=5e-3 * np.abs(rate).max())


def test_field_and_load_agree():
    solution = solve_uniform(30.0, 0.6, tolerance=1e-5)
    x, mean = solution.position, solution.mean_pressure
    integral = np.sum(0.5 * np.diff(x) * (mean[1:] + mean[:-1]))
    assert integral == pytest.approx(solution.mean_load, abs=5e-4)
    assert solution.force_harmonics[0].real == solution.over_pressure
    first = -(solution.stiffness_relative + 1j * solution.damping_relative) * 0.6
    assert solution.force_harmonics[1] == pytest.approx(first)
    batch = solve_films(30.0, 0.6, tolerance=1e-5)
    assert batch.stiffness_relative == pytest.approx(solution.stiffness_relative, rel=1e-4)
    assert batch.damping_relative == pytest.approx(solution.damping_relative, rel=1e-4)


def test_the_load_of_a_motion_grows_as_the_gap_closes_and_stays_below_salbu():
    # One amplitude at smaller and smaller mean gaps: σ goes with ε².
    eps = np.array([0.5, 0.8, 0.95])
    loads = solve_films(1000.0 * eps**2, eps).mean_load
    assert np.all(np.diff(loads) > 0.0)
    assert np.all(loads < trapped_load(eps))


def random_cases(count, seed=20240806):
    """σ log-uniform 0.01–1e4, ε 0.02–0.95, n 1–1.4 and Kn 0–0.3; each of these off in 30 %."""
    rng = np.random.default_rng(seed)
    sigma = 10.0 ** rng.uniform(-2.0, 4.0, count)
    eps = rng.uniform(0.02, 0.95, count)
    n = np.where(rng.random(count) < 0.3, 1.0, rng.uniform(1.0, 1.4, count))
    kn = np.where(rng.random(count) < 0.3, 0.0, rng.uniform(0.0, 0.3, count))
    return sigma, eps, n, kn


def as_far_as_it_goes(sigma, eps, tolerance, **inputs):
    """Films to a tolerance, or as far as they come."""
    try:
        return solve_films(sigma, eps, tolerance=tolerance, **inputs)
    except ConvergenceError as error:
        return error.partial


def honesty(count, tolerances, seed=20240806):
    """For strips and discs: tolerance, share of cases within the estimate, median estimate/true."""
    sigma, eps, n, kn = random_cases(count, seed)
    rows = []
    for shape in ("strip", "disc"):
        inputs = {"shape": shape, "polytropic_exponent": n, "knudsen_number": kn}
        fine = as_far_as_it_goes(sigma, eps, min(tolerances) / 100.0, **inputs).over_pressure
        for tolerance in tolerances:
            batch = as_far_as_it_goes(sigma, eps, tolerance, **inputs)
            true = np.abs(batch.over_pressure - fine)
            within = np.mean(true <= batch.over_pressure_error)
            met = np.mean(batch.over_pressure_error <= tolerance * batch.over_pressure)
            ratio = np.median(batch.over_pressure_error / np.maximum(true, 1e-300))
            rows.append((shape, tolerance, within, ratio, met))
    return rows


def check_honest(rows):
    for row in rows:
        _, _, within, ratio, met = row
        assert within >= 0.95, row
        assert ratio <= 5.0, row
        assert met == 1.0, row


def test_error_estimate_is_honest_on_200_random_cases():
    check_honest(honesty(200, (2e-2, 5e-3, 1e-3)))


# The estimator was calibrated while its first sample was looked at; the second was drawn after.
@pytest.mark.nightly
@pytest.mark.parametrize("seed", [20240806, 20261120])
def test_error_estimate_is_honest_on_3000_random_cases(seed):
    check_honest(honesty(3000, (2e-2, 5e-3, 1e-3, 1e-4), seed))
