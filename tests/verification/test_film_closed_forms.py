"""The film's closed forms against limits, series, quadrature and a solved Reynolds equation."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ive
from tests.verification.trapped_film import trapped_load

from squeezefilm.core.errors import ConvergenceError, InputError, OutOfRangeError
from squeezefilm.physics.film import closed
from squeezefilm.physics.film.gap import PaperGap
from squeezefilm.physics.film.gas import slip_law
from squeezefilm.physics.film.periodic.resolution import STRIP, Films
from squeezefilm.physics.film.periodic.small import small_vibration

EVERY_SIGMA = np.geomspace(1e-12, 1e12, 200)


def strip_load(
    sigma: float, epsilon: float, n: float = 1.0, knudsen: float = 0.0, cells: int = 24
) -> float:
    """W of a strip, solved: finite volumes on half the width, collocation in time, Newton.

    ∂/∂X[(H³ + 6 Kn H²/P) P^(1/n) ∂P/∂X] = σ ∂(P^(1/n) H)/∂T, H = 1 + ε cos T; second order in the
    cell, which `extrapolated_load` takes to fourth.
    """
    times = 9
    T = 2 * np.pi * np.arange(times) / times
    H = 1 + epsilon * np.cos(T)
    k = np.arange(1, times // 2 + 1)
    lag = T[:, None] - T[None, :]
    D = -2 / times * np.sum(k * np.sin(k * lag[..., None]), axis=-1)
    # Faces crowd towards the edge, where the layer of thickness σ^-1/2 lies.
    x = 0.5 * np.sin(np.pi / 2 * np.linspace(0, 1, cells + 1))
    dx = np.diff(x)[:, None]
    volume = np.gradient(x)[:-1].copy()
    volume[1:] = (x[2:] - x[:-2]) / 2
    volume[0] = x[1] / 2
    P = np.ones((cells + 1, times))
    for _ in range(20):
        middle = (P[1:] + P[:-1]) / 2
        drop = np.diff(P, axis=0) / dx
        G = H**3 * middle ** (1 / n) + 6 * knudsen * H**2 * middle ** (1 / n - 1)
        dG = H**3 * middle ** (1 / n - 1) / n
        dG += 6 * knudsen * H**2 * (1 / n - 1) * middle ** (1 / n - 2)
        flux, left, right = G * drop, dG * drop / 2 - G / dx, dG * drop / 2 + G / dx
        mass, slope = P[:-1] ** (1 / n) * H, P[:-1] ** (1 / n - 1) * H / n
        residual = flux - sigma * volume[:, None] * (mass @ D.T)
        residual[1:] -= flux[:-1]
        J = np.zeros((cells, times, cells, times))
        t = np.arange(times)
        for i in range(cells):
            J[i, :, i, :] -= sigma * volume[i] * D * slope[i]
            J[i, t, i, t] += left[i]
            if i + 1 < cells:
                J[i, t, i + 1, t] += right[i]
                J[i + 1, t, i, t] -= left[i]
                J[i + 1, t, i + 1, t] -= right[i]
        size = cells * times
        step = np.linalg.solve(J.reshape(size, size), -residual.ravel())
        P[:-1] += step.reshape(cells, times)
        if np.max(np.abs(step)) < 1e-12:
            break
    else:
        raise AssertionError("the reference solution did not converge")
    mean = P.mean(axis=1)
    return float(np.sum((mean[1:] + mean[:-1]) * np.diff(x)))


def extrapolated_load(sigma: float, epsilon: float, n: float = 1.0, knudsen: float = 0.0) -> float:
    coarse, fine = (strip_load(sigma, epsilon, n, knudsen, cells) for cells in (14, 28))
    return fine + (fine - coarse) / 3


def test_reference_solution_agrees_with_published_load() -> None:
    # Two independent codes: PHYSICS.md's table (error < 1e-8) and the solver above.
    assert extrapolated_load(10, 0.5) - 1 == pytest.approx(0.160251, rel=2e-4)
    assert extrapolated_load(10, 0.1) - 1 == pytest.approx(0.005188, rel=2e-4)
    assert extrapolated_load(10, 0.5, n=1.4) - 1 == pytest.approx(0.173567, rel=3e-4)
    assert extrapolated_load(10, 0.5, knudsen=0.026) - 1 == pytest.approx(0.139260, rel=3e-4)


# --- linear: stiffness and damping ----------------------------------------------------------


def force_of(planform, sigma):
    """The complex force −fk − i fd over p0 A ε."""
    fk = closed.relative_stiffness(sigma, planform)
    return -fk - 1j * closed.relative_damping(sigma, planform)


def test_strip_is_the_textbook_formula_where_that_is_stable() -> None:
    sigma = np.geomspace(5, 1e4, 60)
    a = np.sqrt(sigma / 2)
    below = a * (np.cosh(a) + np.cos(a))
    force = force_of("strip", sigma)
    np.testing.assert_allclose(-force.real, 1 - (np.sinh(a) + np.sin(a)) / below, rtol=1e-12)
    np.testing.assert_allclose(-force.imag, (np.sinh(a) - np.sin(a)) / below, rtol=1e-12)


def test_strip_at_small_squeeze_number_is_its_power_series() -> None:
    # 1 − tanh z/z = z²/3 − 2 z⁴/15 + 17 z⁶/315 − 62 z⁸/2835 + …, z² = iσ/4
    sigma = np.geomspace(1e-9, 3e-3, 30)
    force = force_of("strip", sigma)
    damping = sigma / 12 - 17 * sigma**3 / (64 * 315)
    stiffness = sigma**2 / 120 - 62 * sigma**4 / (256 * 2835)
    np.testing.assert_allclose(-force.imag, damping, rtol=1e-13)
    np.testing.assert_allclose(-force.real, stiffness, rtol=1e-13)


def test_disc_is_the_bessel_formula() -> None:
    sigma = np.geomspace(10, 1e7, 60)
    s = np.sqrt(1j * sigma)
    expected = -1 + 2 * ive(1, s) / (s * ive(0, s))
    np.testing.assert_allclose(force_of("disc", sigma), expected, rtol=1e-13)


@pytest.mark.parametrize("planform", get_args(closed.Planform))
def test_force_is_stable_and_monotone_over_24_decades(planform: closed.Planform) -> None:
    fk = closed.relative_stiffness(EVERY_SIGMA, planform)
    fd = closed.relative_damping(EVERY_SIGMA, planform)
    assert np.all(np.diff(fk[fk < 1 - 1e-12]) > 0)
    assert np.all(fd > 0)
    assert np.all(fk <= 1)
    extreme = closed.relative_stiffness(np.array([0.0, 1e-300, 1e300]), planform)
    np.testing.assert_array_equal(extreme, [0, 0, 1])
    assert closed.relative_damping(0.0, planform) == 0


@pytest.mark.parametrize("planform", ["strip", "disc"])
def test_force_is_continuous_where_the_form_changes(planform: closed.Planform) -> None:
    switch = closed._SWITCH
    for f in (closed.relative_stiffness, closed.relative_damping):
        below, above = f(switch, planform), f(np.nextafter(switch, 1e9), planform)
        assert above == pytest.approx(below, rel=1e-13)


@pytest.mark.parametrize(
    ("planform", "stiffness", "damping"), [("strip", 120, 12), ("disc", 48, 8)]
)
def test_low_squeeze_limits_err_by_the_square_of_sigma(planform, stiffness, damping) -> None:
    # fk → σ²/120 of a strip, σ²/48 of a disc; fd → σ/12 and σ/8.
    sigma = np.array([0.02, 0.04])
    for exact, limit in (
        (closed.relative_stiffness, sigma**2 / stiffness),
        (closed.relative_damping, sigma / damping),
    ):
        error = limit / exact(sigma, planform) - 1
        assert np.log2(error[1] / error[0]) == pytest.approx(2, abs=0.01)


@pytest.mark.parametrize(("planform", "edge"), [("strip", 2.0), ("disc", 2.0)])
def test_high_squeeze_limit_is_an_edge_layer_along_the_perimeter(planform, edge: float) -> None:
    sigma = np.array([1e8, 1e10])
    lost = 1 - closed.relative_stiffness(sigma, planform)
    np.testing.assert_allclose(lost, edge / np.sqrt(2 * sigma), rtol=1e-4)
    np.testing.assert_allclose(closed.relative_damping(sigma, planform), lost, rtol=3e-4)


@pytest.mark.parametrize(("planform", "expected"), [("strip", 10.13418), ("disc", 6.23324)])
def test_crossover_is_where_stiffness_equals_damping(planform, expected: float) -> None:
    def excess(sigma: float) -> float:
        return closed.relative_stiffness(sigma, planform) - closed.relative_damping(sigma, planform)

    assert brentq(excess, 0.1, 100.0, xtol=1e-12) == pytest.approx(expected, abs=6e-6)


def test_low_squeeze_film_is_the_incompressible_damper() -> None:
    area, h, p0, eta, length = 1e-4, 5e-6, 1e5, 1.85e-5, 1e-3
    for frequency in (0.01, 0.1):
        sigma = 12 * eta * 2 * np.pi * frequency * length**2 / (p0 * h**2)
        omega = 2 * np.pi * frequency
        damping = closed.relative_damping(sigma) * p0 * area / (h * omega)
        expected = eta * area * length**2 / h**3
        assert damping == pytest.approx(expected, rel=1e-5)


def test_trapped_film_is_a_gas_spring() -> None:
    # Boyle: d(p A)/dh = p0 A/h.
    assert closed.relative_stiffness(1e14) * 1e5 * 1e-4 / 5e-6 == pytest.approx(2e6, rel=1e-6)


def second_order_load(epsilon: float, sigma: float, n: float, knudsen: float = 0.0) -> float:
    """W of a strip by the closed form that the solver of small vibrations has."""
    one = (np.array([value]) for value in (sigma, epsilon))
    gas = np.array([n]), np.array([knudsen]), slip_law("first", knudsen)
    return 1 + float(small_vibration(Films(*one, *gas, STRIP)).over_pressure[0])


@pytest.mark.parametrize(
    ("sigma", "n", "knudsen"),
    [(1, 1, 0), (10, 1, 0), (100, 1, 0), (10, 1.4, 0), (10, 1, 0.05), (30, 1.4, 0.1)],
)
def test_second_order_load_errs_by_the_fourth_power(sigma, n, knudsen) -> None:
    errors = []
    for epsilon in (0.05, 0.1):
        solved = extrapolated_load(sigma, epsilon, n, knudsen)
        errors.append((solved - second_order_load(epsilon, sigma, n, knudsen)) / epsilon**2)
    # What is left is c0 (the reference's own discretization) + c2 ε²: the closed form is the
    # ε² coefficient.
    limit = errors[0] - (errors[1] - errors[0]) / 3
    coefficient = second_order_load(1.0, sigma, n, knudsen) - 1
    assert limit == pytest.approx(0, abs=1e-3 * coefficient)


# --- limits: σ → ∞ --------------------------------------------------------------------------


def test_small_amplitude_asymptote_joins_the_second_order_load() -> None:
    for n in (1.0, 1.4):
        small = trapped_load(1e-3, n) - 1
        second = second_order_load(1e-3, 1e16, n) - 1
        assert small == pytest.approx(second, rel=1e-5)


# --- the paper's pressure -------------------------------------------------------------------

STATOR = PaperGap(0.6e-6, 2e-6, 50e-6, 350e-6, 18.7e-3, 10e-3)
FEW = PaperGap(0.6e-6, 2e-6, 3e-6, 2e-3, 7e-3, 10e-3)


def numbers(gap: PaperGap) -> tuple[float, float, float, float]:
    return gap.amplitude_ratio, gap.ridge_ratio, gap.wave_number, gap.ridge_number


def test_mean_pressure_is_the_time_mean_of_the_pressure() -> None:
    X = np.linspace(-0.5, 0.5, 101)
    T = 2 * np.pi * np.arange(200) / 200
    epsilon, delta, k1, k2 = numbers(STATOR)

    def least_and_wave(X: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        return 1 + delta * np.cos(k2 * X), epsilon * np.cos(k1 * X)

    (a, b), (a_edge, b_edge) = least_and_wave(X[:, None]), least_and_wave(0.5)
    trapped = a / a_edge * np.sqrt(a_edge**2 + 1.5 * b_edge**2)
    mean = (trapped / (a + b * np.cos(T))).mean(axis=1)
    np.testing.assert_allclose(closed.paper_mean_pressure(X, *numbers(STATOR)), mean, rtol=1e-12)


def test_printed_mean_pressure_is_right_without_vibration_in_space() -> None:
    # Without vibration in space (k1 → 0) the misprints vanish.
    flat = (0.04, 0.3, 1e-9, 20.0)
    printed = closed.paper_mean_pressure_printed(0.1, *flat)
    assert printed == pytest.approx(closed.paper_mean_pressure(0.1, *flat), rel=1e-12)


def test_smooth_flat_contact_is_salbus_limit() -> None:
    gap = PaperGap(1e-6, 1e-6, 0.0, 350e-6, 1e3, 10e-3)
    assert closed.contact_mean_pressure(gap) == pytest.approx(trapped_load(0.5), rel=1e-8)


@pytest.mark.parametrize(
    "gap",
    [STATOR, FEW, PaperGap(1e-8, 5e-6, 50e-6, 350e-6, 5e-3, 10e-3)],
    ids=["stator", "few ridges", "near contact"],
)
def test_contact_mean_is_converged_quadrature(gap: PaperGap) -> None:
    # Brute force: a midpoint rule and its Richardson extrapolation.
    means = []
    for count in (400_000, 800_000):
        X = (np.arange(count) + 0.5) / count - 0.5
        means.append(float(np.mean(closed.mean_pressure_profile(X, gap) - 1)))
    expected = means[1] + (means[1] - means[0]) / 3
    assert closed.contact_mean_pressure(gap) - 1 == pytest.approx(expected, rel=2e-10, abs=1e-13)


def test_contact_mean_is_the_same_one_by_one_and_vectorised() -> None:
    amplitudes = np.array([0.0, 0.5e-6, 2e-6, 8e-6])
    together = closed.contact_mean_pressure(STATOR.with_amplitude(amplitudes))
    alone = [closed.contact_mean_pressure(STATOR.with_amplitude(a)) for a in amplitudes]
    np.testing.assert_allclose(together, alone, rtol=1e-12)
    assert together[0] == 1
    assert closed.mean_pressure_profile(
        np.linspace(-0.5, 0.5, 7), STATOR.with_amplitude(amplitudes)
    ).shape == (4, 7)


def test_pressure_refuses_a_closed_gap_and_a_point_outside() -> None:
    with pytest.raises(OutOfRangeError, match="roughness"):
        closed.paper_mean_pressure(0.0, 0.5, 0.5, 1.0, 1.0)
    with pytest.raises(InputError, match="X = "):
        closed.mean_pressure_profile(np.array([0.6]), STATOR)
    with pytest.raises(InputError, match="is not known"):
        closed.contact_mean_pressure(STATOR, "paper2007")
    with pytest.raises(ConvergenceError, match="settle"):
        closed.contact_mean_pressure(
            PaperGap(1e-13, 5e-6, 50e-6, 350e-6, 5e-3, 10e-3), tolerance=1e-16
        )
