"""The compiled solve under a gap that varies: its gaps, its weights, and known films.

The solver is called as the Python it is compiled from: its inner loops are compiled anyway.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.film.gas import CompiledGas
from squeezefilm.physics.film.periodic.grids import Mesh, gap_rows, room_for, solve_nested
from squeezefilm.physics.film.periodic.nested import levels_of
from squeezefilm.physics.film.periodic.resolution import STRIP, FilmResolution, collocation_times
from squeezefilm.physics.film.periodic.uniform import (
    CHECK,
    COARSE,
    COLUMNS,
    ERROR,
    FINE,
    ITERATIONS,
    MIDDLE,
    OVER,
    RESIDUAL,
    SPACE,
    TIME,
    judge,
    rounding,
    space_error,
)

# Two harmonics in time at five points.
EVEN = np.array([[1.0, 1.1, 1.2, 1.3, 1.4], [0.3, 0.2, 0.1, 0.0, -0.2], [0.05] * 5])
ODD = np.array([[0.0] * 5, [0.1, 0.1, 0.2, 0.3, 0.1], [-0.1, 0.0, 0.1, 0.02, 0.03]])
SERIES = EVEN - 1j * ODD


def gap_at(point: int, T: np.ndarray) -> np.ndarray:
    k = np.arange(3)[:, None]
    return np.asarray(EVEN[:, point] @ np.cos(k * T) + ODD[:, point] @ np.sin(k * T))


def test_gaps_are_their_series_at_the_times_and_one_in_the_padding() -> None:
    found = gap_rows(SERIES, 1.0, collocation_times(7), 20).gap.reshape(5, 8)
    T = 2 * np.pi * np.arange(7) / 7
    for point in range(5):
        assert found[point, :7] == pytest.approx(gap_at(point, T), rel=1e-14)
    assert np.all(found[:, 7] == 1.0)


@pytest.mark.parametrize("n", [1.0, 1.4])
def test_weights_integrate_gas_that_is_a_series_over_the_gap(n: float) -> None:
    nt, ntp, fine = 7, 8, 120
    out = gap_rows(SERIES, n, collocation_times(nt), fine).weight
    assert np.all(out.reshape(3, ntp)[:, nt:] == 0.0)

    def gas(T: np.ndarray) -> np.ndarray:
        return 1.3 + 0.2 * np.cos(T) - 0.4 * np.sin(2 * T) + 0.1 * np.cos(3 * T)

    T, every = (2 * np.pi * np.arange(count) / count for count in (nt, 1000))
    for row in range(3):
        # Every other point: the nodes, not the faces.
        P = gas(T) / gap_at(2 * row, T) ** n
        exact = np.mean(gas(every) / gap_at(2 * row, every) ** n)
        assert out[row * ntp : row * ntp + nt] @ P == pytest.approx(exact, rel=1e-12)


def solved(
    gap: Any, closed: bool, sigma: float = 10.0, cells: int = 16, *, n: float = 1.0,
    kn: float = 0.0, law: int = 0, times: tuple[int, int] = (9, 13),
    stretch: float = 0.0, tolerance: float = 1e-3,
) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:  # fmt: skip
    """The result row, p on the three grids and X on the finest; X = ½ ξ (1 + a (1 − ξ²)).

    `gap(X)` gives the series: rows of cosine, then rows of sine coefficients.
    """
    xi = np.linspace(0.0 if closed else -1.0, 1.0, 2 * cells + 1)
    x = 0.5 * xi * (1 + stretch * (1 - xi**2))
    slope = 0.5 * (1 + stretch - 3 * stretch * xi**2)
    even, odd = (np.array(part) + 0.0 * x for part in gap(x))
    out, over = np.full(COLUMNS, np.nan), np.empty(4)
    resolution = FilmResolution(cells, *(collocation_times(one) for one in times))
    keep = np.full(cells // 4 * (7 * (resolution.times.row + 1) + resolution.check.row + 1), np.nan)
    rows = gap_rows(even - 1j * odd, n, resolution.times, 60)
    check_rows = gap_rows(even - 1j * odd, n, resolution.check, 70)
    out[ITERATIONS], out[RESIDUAL] = solve_nested.py_func(  # type: ignore[attr-defined]
        sigma, CompiledGas(n, kn, law), Mesh(slope, np.ones_like(slope), closed), rows, check_rows,
        resolution, tolerance, room_for(resolution), over, keep,
    )  # fmt: skip
    local = sigma / (n * (1 + 6 * kn))
    judge(over, sigma, local, n, 0.5, cells if closed else cells // 2, STRIP, 3.0, out)
    _, *levels = levels_of(keep, resolution, closed)
    if np.isfinite(out[OVER]):
        assert all(np.all(np.isfinite(p)) and np.all(np.isfinite(share)) for p, share in levels)
    return out, [level.pressure for level in levels], x


def uniform(x: np.ndarray) -> Any:
    return [[1.0 + 0 * x, 0.5 + 0 * x], [0 * x, 0 * x]]


def tilted(x: np.ndarray) -> Any:
    """A gap that is wider on the right, and moves with a delay there."""
    return [[1 + 0.3 * x, 0.3 + 0.1 * x], [0 * x, 0.2 * x]]


@pytest.mark.parametrize("closed", [True, False])
def test_a_uniform_gap_has_the_known_load(closed: bool) -> None:
    out, _, _ = solved(uniform, closed, cells=16 if closed else 32, stretch=0.2, tolerance=1e-4)
    # PHYSICS: W = 1.160251 for the strip at σ = 10, ε = 0.5.
    assert abs(out[OVER] - 0.160251) <= out[ERROR] + 5e-7
    assert out[ERROR] < 1e-3 * out[OVER]
    assert out[RESIDUAL] < 3e-6
    # Three grids, each with a quarter of the error of the one before.
    assert (out[COARSE] - out[OVER]) / (out[MIDDLE] - out[OVER]) == pytest.approx(4, rel=0.15)
    assert (out[MIDDLE] - out[OVER]) / (out[FINE] - out[OVER]) == pytest.approx(4, rel=1e-6)


def test_half_of_a_symmetric_film_is_the_whole() -> None:
    def wave(x: np.ndarray) -> Any:
        return [[1 + 0.2 * np.cos(9 * x), 0.4 * np.cos(4 * x)], [0 * x, 0 * x]]

    more: dict[str, Any] = {"n": 1.3, "kn": 0.05, "law": 1, "sigma": 30.0, "stretch": 0.1}
    half, p, _ = solved(wave, True, cells=8, **more)
    whole, q, _ = solved(wave, False, cells=16, **more)
    assert whole[[OVER, COARSE, MIDDLE, FINE, CHECK]] == pytest.approx(
        half[[OVER, COARSE, MIDDLE, FINE, CHECK]], rel=1e-6
    )
    assert whole[[SPACE, TIME]] == pytest.approx(half[[SPACE, TIME]], rel=1e-3)
    # Half a film is from the plane of symmetry to the edge.
    for m, part, all_of_it in zip((2, 4, 8), p, q, strict=True):
        assert part == pytest.approx(all_of_it[m:], abs=1e-7)
    assert p[1] == pytest.approx(p[2][::2], abs=0.02)


def test_the_film_obeys_the_balance_of_its_cells() -> None:
    cells, sigma = 8, 20.0
    out, (_, _, p), _ = solved(tilted, False, sigma, cells, tolerance=1e-9)
    T = 2 * np.pi * np.arange(9) / 9
    X = np.linspace(-0.5, 0.5, 2 * cells + 1)[:, None]
    H = 1 + 0.3 * X + (0.3 + 0.1 * X) * np.cos(T) + 0.2 * X * np.sin(T)
    P = 1 + p
    step = 1 / cells
    flow = H[1::2] ** 3 * np.diff(P**2, axis=0) / 2 / step
    gas = (P * H[::2])[1:-1]
    spectrum = np.fft.rfft(gas, axis=1) * 1j * np.arange(5)
    rate = np.fft.irfft(spectrum, 9, axis=1)
    assert np.diff(flow, axis=0) == pytest.approx(sigma * step * rate, abs=1e-6)
    # The load is the integral over the length of the mean over the period.
    every = 2 * np.pi * np.arange(400) / 400
    k = np.arange(5)[:, None]
    series = np.fft.rfft(gas, axis=1) / 9 * np.where(np.arange(5) > 0, 2, 1)
    fine = np.real(series @ np.exp(1j * k * every))
    x = X[2:-1:2]
    gap = 1 + 0.3 * x + (0.3 + 0.1 * x) * np.cos(every) + 0.2 * x * np.sin(every)
    assert out[FINE] == pytest.approx(step * np.sum(np.mean(fine / gap - 1, axis=1)), rel=1e-9)


def test_the_errors_are_those_of_space_time_iteration_and_rounding() -> None:
    for closed, kn in ((True, 0.0), (False, 0.05)):
        out, _, _ = solved(uniform, closed, 40.0, 16, n=1.2, kn=kn, law=1 if kn else 0)
        assert out[OVER] == pytest.approx(out[FINE] + (out[FINE] - out[MIDDLE]) / 3)
        assert out[TIME] == pytest.approx(3 * abs(out[CHECK] - out[COARSE]))
        # Slip and compression thin the edge layer's σ; an open domain has half the cells a side.
        local = 40.0 / (1.2 * (1 + 6 * kn))
        levels = (out[COARSE], out[MIDDLE], out[FINE])
        cells = 16 if closed else 8
        assert out[SPACE] == pytest.approx(space_error(*levels, local, 0.5, cells, STRIP))
        parts = out[SPACE] + out[TIME] + out[RESIDUAL] * out[OVER]
        assert out[ERROR] == pytest.approx(parts + rounding(40.0, 1.2, out[OVER]), rel=1e-12)


def test_iterations_are_counted_over_all_grids_and_few_are_not_enough() -> None:
    full, _, _ = solved(uniform, True)
    once, _, _ = solved(uniform, True, tolerance=1e9)
    assert once[ITERATIONS] == 4
    assert full[ITERATIONS] > 4
    assert once[RESIDUAL] > 1e-3 > full[RESIDUAL]


def test_what_does_not_converge_is_not_a_number() -> None:
    out, _, _ = solved(lambda x: [[np.nan * x, 0.5 + 0 * x], [0 * x, 0 * x]], True)
    assert np.isnan(out[OVER])
    assert not out[ERROR] < 1.0
