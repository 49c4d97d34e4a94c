"""The parts of the compiled uniform film: weights in time, grids in space, its row of answers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.film.periodic.grids import Mesh, fill_cells, kept_size, prolong
from squeezefilm.physics.film.periodic.kernel import MOST_STEPS
from squeezefilm.physics.film.periodic.resolution import (
    DISC,
    STRIP,
    Cells,
    Films,
    collocation_times,
    resolution_of,
)
from squeezefilm.physics.film.periodic.uniform import (
    CHECK,
    COARSE,
    COLUMNS,
    DAMPING,
    ERROR,
    FINE,
    FORCE_ERROR,
    FORCE_SPACE,
    FORCE_TIME,
    ITERATIONS,
    MIDDLE,
    OVER,
    RESIDUAL,
    SPACE,
    STIFFNESS,
    TIME,
    edge_grading,
    fill_mesh,
    fill_times,
    rounding,
    solve_rows,
    space_error,
)


def test_the_grading_grows_with_the_layers_sharpness() -> None:
    assert edge_grading(0.0, 0.5) == 0.0
    assert edge_grading(10.0, 0.0) == pytest.approx(0.22)
    # The layer is that of the least gap.
    assert edge_grading(10.0 * 0.04, 0.8) == pytest.approx(0.22)
    assert edge_grading(1e9, 0.3) == pytest.approx(0.44)


@pytest.mark.parametrize("n", [1.0, 1.4, 5 / 3])
@pytest.mark.parametrize("eps", [0.0, 0.4, 0.9])
@pytest.mark.parametrize("nt", [5, 9])
def test_weights_in_time_integrate_what_is_nearly_constant_exactly(
    nt: int, eps: float, n: float
) -> None:
    H, w, c, s = (np.full(8 if nt == 5 else 16, np.nan) for _ in range(4))
    fill_times(collocation_times(nt), eps, n, H, w, c, s)
    times, fine = 2 * np.pi * np.arange(nt) / nt, 2 * np.pi * np.arange(2000) / 2000
    for seed in range(3):
        even, odd = np.random.default_rng(seed).standard_normal((2, nt // 2 + 1))

        def pressure(T: np.ndarray) -> np.ndarray:
            # Times Hⁿ it is a sum of harmonics that the times resolve.
            k = np.arange(nt // 2 + 1)[:, None]
            waves = even @ np.cos(k * T) + odd @ np.sin(k * T)  # noqa: B023
            return np.asarray(waves / (1 + eps * np.cos(T)) ** n)

        p, exact = pressure(times), pressure(fine)
        assert w[:nt] @ p == pytest.approx(exact.mean(), rel=1e-9, abs=1e-10)
        assert c[:nt] @ p == pytest.approx(2 * (exact * np.cos(fine)).mean(), rel=1e-9, abs=1e-10)
        assert s[:nt] @ p == pytest.approx(2 * (exact * np.sin(fine)).mean(), rel=1e-9, abs=1e-10)
    for one in (w, c, s):
        assert np.all(one[nt:] == 0.0)
    assert np.all(H[nt:] == 1.0)
    assert H[:nt] == pytest.approx(1 + eps * np.cos(times))


def grid(m: int, shape: int, sigma: float, a: float) -> Cells:
    """The cells of a grid of m, which is a coarser one of what it is taken from."""
    mesh = Mesh(np.empty(4 * m + 1), np.empty(4 * m + 1), True)
    fill_mesh(shape, a, mesh)
    cells = Cells(np.empty(m + 1), np.empty(m), np.empty(m))
    assert fill_cells(m, sigma, mesh, cells) == m
    return cells


def sums(m: int, shape: int, a: float) -> tuple[float, float, np.ndarray]:
    """The mean of 1 − (2x)⁴ (1 − r⁴ on the disc), σ × the half width or area, fluxes of x²."""
    g, vol, share = grid(m, shape, 7.0, a)
    xi = np.arange(m + 1) / m
    place = (0.5 if shape == STRIP else 1.0) * xi * (1 + a * (1 - xi**2))
    assert g[0] == 0.0
    mean = share @ (1 - (place[:-1] / place[-1]) ** 4)
    return float(mean), float(vol.sum()), g[1:] * np.diff(place**2)


@pytest.mark.parametrize("a", [0.0, 0.3, 0.44])
@pytest.mark.parametrize(("shape", "mean"), [(STRIP, 1 - 1 / 5), (DISC, 1 - 2 / 6)])
def test_a_grids_shares_and_faces_are_those_of_the_film_to_second_order(
    shape: int, mean: float, a: float
) -> None:
    coarse, fine = sums(64, shape, a), sums(128, shape, a)
    assert fine[0] + (fine[0] - coarse[0]) / 3 == pytest.approx(mean, rel=1e-6)
    half = (np.arange(128) + 0.5) / 128
    place = half * (1 + a * (1 - half**2))
    # dx²/dx = 2x through a strip's face, r dr²/dr = 2r² through a disc's.
    expected = place if shape == STRIP else 2 * place**2
    assert fine[2] == pytest.approx(expected, rel=2e-2, abs=1e-4)
    middle = slice(32, 96)
    assert fine[2][middle] == pytest.approx(expected[middle], rel=1e-3)
    # All cells but the half one at the edge: σ/2 on a strip, and a disc's ∫ r dr on top.
    whole = 7.0 * 0.5
    lacking = whole - fine[1]
    assert 0 < lacking < whole / 64
    assert whole - coarse[1] == pytest.approx(2 * lacking, rel=0.1)


def test_a_discs_middle_cell_is_a_small_disc_and_volumes_go_with_the_squeeze_number() -> None:
    _, vol, share = grid(4, DISC, 3.0, 0.2)
    radius = 0.125 * (1 + 0.2 * (1 - 0.125**2))
    assert share[0] == pytest.approx(radius**2)
    assert vol == pytest.approx(1.5 * share)
    _, vol, share = grid(4, STRIP, 3.0, 0.2)
    # Half a cell of 1/4 at the middle, where the map has the slope (1 + a)/2.
    assert share[0] == pytest.approx(0.125 * 1.2)
    assert vol == pytest.approx(1.5 * share)


def test_the_error_of_space_is_a_part_of_what_the_extrapolated_value_changed_by() -> None:
    # Coarse to middle changes four times middle to fine, and a bit: the change is that bit.
    assert space_error(0.0, 4.0 + 0.3, 5.0 + 0.3, 1e-9, 0.1, 12, STRIP) == pytest.approx(0.01)
    assert space_error(1.0, 2.0, 2.0, 50.0, 0.1, 12, DISC) == pytest.approx(1 / 30)
    # Of a harmonic, by its size.
    grids = [(0.6 + 0.8j) * one for one in (0.0, 4.0 + 0.3, 5.0 + 0.3)]
    assert space_error(*grids, 1e-9, 0.1, 12, STRIP) == pytest.approx(0.01)


@pytest.mark.parametrize(("shape", "part"), [(STRIP, 0.08), (DISC, 0.06)])
def test_the_floor_under_it_goes_with_the_layer_the_cells_and_the_excursion(
    shape: int, part: float
) -> None:
    def floor(layer: float, eps: float = 0.0, cells: int = 8) -> float:
        # The extrapolated value stands still by accident; the last change is 1.
        return float(space_error(0.0, 4.0, 5.0, layer * cells**2, eps, cells, shape))

    assert floor(1e-4) == pytest.approx(part * 1e-2, rel=1e-3)
    rise = 0.05 if shape == STRIP else 0.32
    assert floor(1.0) == pytest.approx(part * (1 + rise))
    assert floor(1e-4, eps=0.9) == pytest.approx(floor(1e-4) * (1 + 7 * 0.9**6))
    assert floor(1e-4, cells=4) == pytest.approx(2 * floor(1e-4))
    assert floor(1e-4, cells=12) == pytest.approx(floor(1e-4))
    assert floor(1e-4, cells=24) == pytest.approx(floor(1e-4) / 2)
    assert floor(1e6) == 1.5


def test_rounding_is_of_the_solve_the_value_and_a_pressure_not_kept_by_its_excess() -> None:
    assert rounding(0.0, 1.0, -2.0) == pytest.approx(2e-13)
    assert rounding(1e6, 1.0, 0.0) == pytest.approx(4e-12)
    assert rounding(0.0, 1.4, 0.0) == pytest.approx(4e-17)


def answers(
    cells: int, shape: int, *, n: float = 1.0, kn: float = 0.0, tolerance: float = 1e-11
) -> tuple[np.ndarray, Any, np.ndarray]:
    """The row of answers, the resolution, and what is kept of the three grids."""
    resolution = resolution_of(cells, 9)
    films = Films(*(np.array([v]) for v in (20.0, 0.5, n, kn)), 1 if kn else 0, shape)
    check = max(cells // 4, 2) * (resolution.check.row + 1)
    out, keep = np.full((1, COLUMNS), np.nan), np.full(kept_size(resolution), np.nan)
    solve_rows(0, 1, films, resolution, tolerance, out, keep)
    bare = np.full((1, COLUMNS), np.nan)
    solve_rows(0, 1, films, resolution, tolerance, bare, np.empty(0))
    assert bare == pytest.approx(out, abs=0, nan_ok=True)
    assert np.all(np.isfinite(keep))
    return out[0], resolution, keep[check:]


@pytest.mark.parametrize("shape", [STRIP, DISC])
@pytest.mark.parametrize(("n", "kn"), [(1.0, 0.0), (1.4, 0.05)])
@pytest.mark.parametrize("cells", [4, 16])
def test_a_row_of_answers_is_what_its_grids_say(
    cells: int, n: float, kn: float, shape: int
) -> None:
    row, resolution, keep = answers(cells, shape, n=n, kn=kn)
    assert np.all(np.isfinite(row))
    assert row[OVER] == pytest.approx((4 * row[FINE] - row[MIDDLE]) / 3, rel=1e-12)
    # A check on one cell would see one node only: the middle grid is checked then.
    checked = row[MIDDLE] if cells == 4 else row[COARSE]
    assert row[TIME] == pytest.approx(2 * abs(row[CHECK] - checked), rel=1e-12)
    # A disc of radius 1 is like a strip of 1.5; gas and slip leave less of the squeeze number.
    local = 20.0 * (1.0 if shape == STRIP else 1.5**2) / (n * (1 + 6 * kn))
    assert row[SPACE] == pytest.approx(
        space_error(row[COARSE], row[MIDDLE], row[FINE], local, 0.5, cells, shape), rel=1e-12
    )
    assert row[ERROR] == pytest.approx(
        row[SPACE] + row[TIME] + row[RESIDUAL] * abs(row[OVER]) + rounding(20.0, n, row[OVER]),
        rel=1e-12,
    )
    assert 0 <= row[RESIDUAL] < 1e-10
    assert row[ITERATIONS] == int(row[ITERATIONS])
    # After those of the check, the pressures kept are those of the three grids.
    nt, ntp = resolution.times.number, resolution.times.row
    H, w, c, s = (np.empty(ntp) for _ in range(4))
    fill_times(resolution.times, 0.5, n, H, w, c, s)
    found = []
    for m in (cells // 4, cells // 2, cells):
        p, share, keep = np.split(keep, [m * ntp, m * (ntp + 1)])
        a = edge_grading(20.0 * (1.0 if shape == STRIP else 2.25), 0.5)
        assert share == pytest.approx(grid(m, shape, 20.0, a).share, rel=1e-12)
        found.append([share @ p.reshape(m, ntp)[:, :nt] @ one[:nt] for one in (w, c, s)])
    coarse, middle, fine = np.array(found)
    assert coarse[0] == pytest.approx(row[COARSE], rel=1e-7)
    assert (middle[0], fine[0]) == pytest.approx((row[MIDDLE], row[FINE]), rel=1e-7)
    best = fine + (fine - middle) / 3
    # p = −(k + i d) ε e^{iT}: in step with the gap −k ε, and with sin T it is d ε.
    assert row[STIFFNESS] == pytest.approx(-best[1] / 0.5, rel=1e-7)
    assert row[DAMPING] == pytest.approx(best[2] / 0.5, rel=1e-7)
    grids = [complex(one[1], -one[2]) for one in (coarse, middle, fine)]
    assert row[FORCE_SPACE] == pytest.approx(
        space_error(*grids, local, 0.5, cells, shape) / 0.5, rel=1e-4
    )
    left = row[RESIDUAL] * abs(row[OVER]) + rounding(20.0, n, row[OVER])
    whole = row[FORCE_SPACE] + row[FORCE_TIME] + left / 0.5
    assert row[FORCE_ERROR] == pytest.approx(whole, rel=1e-12)


def test_the_steps_allowed_are_those_of_each_of_four_solves() -> None:
    for tolerance, steps in ((1e9, 1), (-1.0, MOST_STEPS)):
        row, _, _ = answers(8, STRIP, tolerance=tolerance)
        assert row[ITERATIONS] == 4 * steps


def halfway(values: np.ndarray, at: float, nodes: np.ndarray) -> float:
    """The polynomial through the values at the nodes, at a place."""
    weights = [np.prod([(at - b) / (a - b) for b in nodes if b != a]) for a in nodes]
    return float(np.array(weights) @ values)


@pytest.mark.parametrize("m", [1, 2, 3, 4, 7])
def test_a_symmetric_film_is_carried_to_a_finer_grid_by_cubics(m: int) -> None:
    coarse = np.full((m + 2, 8), np.nan)  # what lies beyond must not be read
    coarse[:m] = np.random.default_rng(m).standard_normal((m, 8))
    flat = np.full(2 * m * 8, np.nan)
    prolong(coarse.ravel(), m, 8, True, flat)
    fine = flat.reshape(2 * m, 8)
    assert fine[::2] == pytest.approx(coarse[:m], abs=0)
    for i in range(m):
        first = min(i - 1, m - 3)
        nodes = np.arange(first, first + 4) if m > 1 else np.array([-1, 0, 1])
        for t in range(8):
            # Even about node 0, and 0 at the edge, node m.
            values = np.array([0.0 if abs(j) == m else coarse[abs(j), t] for j in nodes])
            assert fine[2 * i + 1, t] == pytest.approx(halfway(values, i + 0.5, nodes))


@pytest.mark.parametrize("m", [1, 2, 3, 4, 7])
def test_a_film_between_two_edges_is_carried_to_a_finer_grid(m: int) -> None:
    coarse = np.full((m + 1, 8), np.nan)
    coarse[:m] = np.random.default_rng(m).standard_normal((m, 8))
    flat = np.full((2 * m + 1) * 8, np.nan)
    prolong(coarse.ravel(), m, 8, False, flat)
    fine = flat.reshape(2 * m + 1, 8)
    assert fine[1::2] == pytest.approx(coarse[:m], abs=0)
    whole = np.vstack([np.zeros(8), coarse[:m], np.zeros(8)])
    for i in range(m + 1):
        # With two nodes or one it is by lines.
        nodes = np.array([i, i + 1]) if m < 3 else np.arange(4) + min(max(i - 1, 0), m - 2)
        for t in range(8):
            assert fine[2 * i, t] == pytest.approx(halfway(whole[nodes, t], i + 0.5, nodes))
