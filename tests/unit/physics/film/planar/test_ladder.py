"""The ladder of planar grids: which grids it makes, what two rungs give, when the climb ends."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import PLANAR_MEMORY
from squeezefilm.physics.film.gas import CompiledGas
from squeezefilm.physics.film.planar import film as module
from squeezefilm.physics.film.planar.balance import Balance, Balancer, Film
from squeezefilm.physics.film.planar.film import (
    RUNGS,
    Climb,
    Extrapolated,
    Ladder,
    _moved,
    _richardson,
    _solve_or_continue,
    climb_to,
)
from squeezefilm.physics.film.planar.grid import PlanarGap

HALF = PlanarGap(0.5)


def ladder(
    gap: PlanarGap = HALF,
    shape: Any = "rectangle",
    aspect: float = 1.0,
    sigma: float = 10.0,
    cells: tuple[int, int] | None = None,
) -> Ladder:
    """With so many cells on the rung 2."""
    made = Ladder(shape, aspect, Film(gap, sigma, CompiledGas(1.0, 0.0, 0)))
    if cells is not None:
        made._base = cells[0] // 2, cells[1] // 2
    return made


def sides(made: Ladder, rung: int = 2) -> tuple[int, int]:
    grid = made.grid(rung)
    return grid.rows, grid.columns


WAVES = PlanarGap(0.5, 5 * np.pi)
RIDGES = PlanarGap(0.3, 0.0, 0.3, 8 * np.pi)


@pytest.mark.parametrize(
    ("gap", "shape", "expected"),
    [
        (HALF, "rectangle", (4, 4)),
        (HALF, "disc", (4, 2)),
        (HALF, "ellipse", (4, 2)),
        # 2½ waves of the plate are 5 of the film's mean; on a half width they are twice as many.
        (WAVES, "rectangle", (10, 4)),
        (WAVES, "disc", (20, 20)),
        # 4 ridges ask for 6 of anything.
        (RIDGES, "rectangle", (12, 4)),
        (RIDGES, "ellipse", (24, 24)),
        (PlanarGap(0.3, 0.0, 0.0, 8 * np.pi), "disc", (4, 2)),
    ],
)
def test_the_coarsest_grid_resolves_what_the_gap_holds(
    gap: PlanarGap, shape: str, expected: tuple[int, int]
) -> None:
    made = ladder(gap, shape)
    assert sides(made) == expected
    assert sides(made, 3) == tuple(3 * n // 2 for n in expected)
    assert made.grid(2) is made.grid(2)


@pytest.mark.parametrize(
    ("gap", "shape", "area"),
    [(HALF, "rectangle", 2), (RIDGES, "ellipse", 2 * np.pi), (HALF, "ellipse", 2 * np.pi)],
)
def test_the_grid_covers_a_quarter_of_the_shape(gap: PlanarGap, shape: str, area: float) -> None:
    grid = ladder(gap, shape, aspect=2.0).grid(2)
    assert grid.area.sum() == pytest.approx(area / 4, rel=1e-9)
    for line, end in ((grid.X, 1.0), (grid.Y, 2.0)):
        end = end / 2 if shape == "rectangle" else end
        assert 0.7 * end < line.max() < end
        assert line.min() > 0


def test_half_the_cells_lie_in_the_edge_layer_but_not_where_the_gap_varies() -> None:
    def around(places: np.ndarray, end: float) -> tuple[float, float]:
        """How far from the edge, over the half width, the two nodes in the middle lie."""
        line = np.unique(np.round(places / end, 9))
        return float(1 - line[line.size // 2]), float(1 - line[line.size // 2 - 1])

    def holds(gap: PlanarGap, aspect: float, least: tuple[float, float]) -> None:
        grid = ladder(gap, aspect=aspect, sigma=1e9, cells=(8, 8)).grid(4)
        ends = (0.5, aspect / 2)
        for places, end, share in zip((grid.X, grid.Y), ends, least, strict=True):
            near, far = around(places, end)
            assert near < share < far < 2.5 * near

    slow = PlanarGap(0.5, 0.01)
    holds(HALF, 1.0, (2e-3, 2e-3))
    holds(PlanarGap(0.5, 0.0, 0.01), 1.0, (0.15, 0.15))
    holds(slow, 0.5, (0.15, 0.15))
    # Along a long side the share is one of the short side.
    holds(slow, 3.0, (0.15, 0.05))
    for shape in ("disc", "ellipse"):
        grid = ladder(slow, shape, sigma=1e9, cells=(8, 8)).grid(4)
        near, far = around(np.hypot(grid.X, grid.Y), 1.0)
        assert near < 0.15 < far


def test_lines_crowd_where_the_mean_gap_is_small() -> None:
    grid = ladder(PlanarGap(0.05, 0.0, 0.9, np.pi), sigma=1.0).grid(4)
    x, y = np.unique(grid.X), np.unique(grid.Y)
    assert np.diff(y) == pytest.approx(np.diff(y)[0])
    # The mean gap falls from the middle on.
    assert x[-1] - x[-2] < 0.9 * (x[1] - x[0])


def test_the_mean_gap_is_the_mean_over_a_period() -> None:
    X, T = np.array([0.1, 0.2]), 2 * np.pi * np.arange(8) / 8
    ridged = PlanarGap(0.3, 2.0, 0.3, 8 * np.pi)
    assert ridged.mean(X) == pytest.approx(ridged(X[:, None], T[None, :]).mean(axis=1))


def test_the_relative_excursion_is_over_the_mean_of_its_place() -> None:
    assert ladder().relative_excursion() == pytest.approx(0.5)
    ridged = ladder(RIDGES)
    crest = 1 + 0.3 * np.cos(8 * np.pi * ridged.grid(2).X).min()
    assert ridged.relative_excursion() == pytest.approx(0.3 / crest)


@pytest.fixture(scope="module")
def disc() -> Climb:
    return climb_to(ladder(HALF, "disc"), 1e-4)


def test_the_climb_ends_within_its_own_error_of_the_known_load(disc: Climb) -> None:
    # PHYSICS: W = 1.196820 for the disc at σ = 10, ε = 0.5, from the axisymmetric solver.
    assert disc.reached
    assert disc.best.errors[0] <= 1e-4 * disc.best.over_pressure
    assert abs(disc.best.over_pressure - 0.196820) <= disc.best.errors[0] + 5e-7
    # Newton's first step is never the last.
    assert disc.iterations > 4
    assert disc.fine.grid.rows in [2 * rung for rung in RUNGS[2:]]
    assert f"{disc.fine.grid.rows} × {disc.fine.grid.columns} nodes" in disc.status
    assert f"at {disc.fine.gas.shape[1]} times" in disc.status


def test_a_looser_climb_is_shorter_and_no_less_honest(disc: Climb) -> None:
    loose = climb_to(ladder(HALF, "disc"), 2e-2)
    assert loose.fine.grid.rows < disc.fine.grid.rows
    assert abs(loose.best.over_pressure - disc.best.over_pressure) <= loose.best.errors[0]
    assert loose.best.amplitudes[1:4] == pytest.approx(disc.best.amplitudes[1:4], abs=1.5e-3)


@pytest.mark.slow
def test_harmonics_left_out_are_corrected_for() -> None:
    # At 0.7 a few harmonics alone err by far more than the tolerance allows.
    climb = climb_to(ladder(PlanarGap(0.7), "disc"), 2e-3)
    fine = climb_to(ladder(PlanarGap(0.7), "disc"), 5e-5)
    assert climb.reached
    assert abs(climb.best.over_pressure - fine.best.over_pressure) <= climb.best.errors[0]
    assert climb.best.amplitudes == pytest.approx(fine.best.amplitudes, abs=2e-3)


def test_a_climb_stops_where_memory_or_rungs_end(monkeypatch: pytest.MonkeyPatch) -> None:
    made = ladder()

    def rows_held(rung: int, times: int) -> float:
        return 2 * rung * 8.0 * (2 * rung * times) ** 2

    def allow(most: float) -> None:
        monkeypatch.setattr(module, "PLANAR_MEMORY", dataclasses.replace(PLANAR_MEMORY, most=most))

    allow(rows_held(2, 30))
    times = climb_to(made, 1e-9).fine.gas.shape[1]
    allow(rows_held(4, times))
    stopped = climb_to(made, 1e-9)
    assert not stopped.reached
    assert stopped.fine.grid.rows == 8
    assert "more memory than allowed" in stopped.status
    assert "1e-09" in stopped.status
    known = stopped.best.lacking()
    assert f"known to {known:.2g} of" in stopped.status
    assert 1e-9 < known < 0.1
    allow(rows_held(4, times) - 1)
    assert climb_to(made, 1e-9).fine.grid.rows == 6
    allow(np.inf)
    monkeypatch.setattr(module, "RUNGS", (2, 3, 4))
    ended = climb_to(made, 1e-9)
    assert not ended.reached
    assert ended.status.endswith("of the over-pressure and the force only")
    assert ended.best.errors == pytest.approx(stopped.best.errors, rel=1e-3)


def test_too_few_harmonics_and_a_failed_newton_end_the_climb(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sharp = ladder(PlanarGap(0.8), "disc")
    with monkeypatch.context() as patch:
        patch.setattr(module, "_MOST_HARMONICS", 5)
        few = climb_to(sharp, 1e-5)
    assert not few.reached
    assert "harmonics in time are too few" in few.status
    assert few.fine.grid.rows == 4
    assert 0 < few.best.errors[0] < 0.1
    real = _solve_or_continue

    def failing(film: Any, grid: Any, *rest: Any) -> Balance:
        state = real(film, grid, *rest)
        return dataclasses.replace(state, converged=grid.rows < 6)

    monkeypatch.setattr(module, "_solve_or_continue", failing)
    failed = climb_to(ladder(HALF, "disc"), 1e-3)
    assert not failed.reached
    assert failed.status == "stopped: Newton's method failed on 6 × 3 nodes"
    assert failed.fine.grid.rows == 6


@pytest.fixture(scope="module")
def state() -> Balance:
    film = Film(HALF, 10.0, CompiledGas(1.0, 0.0, 0))
    return Balancer(film, ladder().grid(2), 5).solve(None, 1e-9)


def test_what_lacks_most_is_the_mean_or_a_harmonic_beside_the_largest() -> None:
    amplitudes = np.array([0.1, 0.5j, 0.2], dtype=complex)
    assert Extrapolated(amplitudes, np.array([0.01, 0.001, 0.0])).lacking() == pytest.approx(0.1)
    assert Extrapolated(amplitudes, np.array([0.01, 0.0, 0.1])).lacking() == pytest.approx(0.2)


def rungs_of(*loads: float) -> list[np.ndarray]:
    """An over-pressure and a harmonic twice as large."""
    return [np.array([load, 2j * load]) for load in loads]


def test_two_rungs_take_the_second_order_out() -> None:
    exact = [0.3 + 0.1 / rung**2 for rung in RUNGS[:5]]
    for count, chance in ((3, 0.06), (4, 0.03), (5, 0.03)):
        value, error = _richardson(rungs_of(*exact[:count]))
        assert value == pytest.approx([0.3, 0.6j])
        # Where the extrapolants agree, a part of the last step remains in doubt.
        left = chance * 0.1 / RUNGS[count - 1] ** 2
        assert error == pytest.approx([left, 2 * left], rel=1e-6)


@pytest.mark.parametrize("fourth", [1.0, -1.0, 0.3])
def test_the_error_of_two_rungs_bounds_a_fourth_order_rest(fourth: float) -> None:
    loads = [0.3 + 0.1 / rung**2 + fourth / rung**4 for rung in RUNGS]
    for count in (3, 4, 6):
        value, error = _richardson(rungs_of(*loads[:count]))
        off = np.abs(value - [0.3, 0.6j])
        assert np.all((off < error) & (error < 5 * off))


def test_extrapolants_that_agree_by_chance_are_not_believed() -> None:
    # From the rungs 2, 3, 4, 6: extrapolants 1, 2 and 2.
    third = (1.0 * (9 / 4 - 1) + 0.0) / (9 / 4)
    fourth = (2.0 * (16 / 9 - 1) + third) / (16 / 9)
    sixth = (2.0 * (9 / 4 - 1) + fourth) / (9 / 4)
    value, error = _richardson(rungs_of(0.0, third, fourth, sixth))
    assert value[0] == pytest.approx(2.0)
    assert error[0] == pytest.approx(0.2 * 1.0 + 0.03 * (2.0 - sixth))
    value, error = _richardson(rungs_of(0.0, third, fourth))
    assert error[0] == pytest.approx(0.8 * 1.0 + 0.06 * (2.0 - fourth))


def test_gas_moves_to_another_grid_with_its_pressure(state: Balance) -> None:
    """A line over the cells stays one between the old nodes, and is held beyond them."""
    gap = PlanarGap(0.4, 2.0)
    film = Film(gap, 10.0, CompiledGas(1.0, 0.0, 0))
    T = 2 * np.pi * np.arange(5) / 5
    old, new = ladder(gap, cells=(4, 6)).grid(2), ladder(gap, cells=(4, 6)).grid(3)

    def gas(grid: Any) -> np.ndarray:
        i, j = (
            np.clip((np.arange(now) + 0.5) / now, 0.5 / before, 1 - 0.5 / before)
            for now, before in ((grid.rows, old.rows), (grid.columns, old.columns))
        )
        place = (1.5 + 0.3 * i[:, None] - 0.2 * j).reshape(-1, 1)
        return place * gap(grid.X[:, None], T[None, :]) * (1 + 0.1 * np.cos(T))

    moved = _moved(film, dataclasses.replace(state, grid=old, gas=gas(old)), new)
    assert moved == pytest.approx(gas(new))


def test_newton_that_fails_is_led_there_through_smaller_motions(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen: list[tuple[float, float, int]] = []

    class Watched(Balancer):
        def solve(self, start: Any, tolerance: float, limit: int = 30) -> Balance:
            gap = float(self.film.gap(0.2, 0.0))
            done = super().solve(start, tolerance, limit)
            seen.append((gap, tolerance, done.iterations))
            return done

    monkeypatch.setattr(module, "Balancer", Watched)
    gap = PlanarGap(0.5, 2.0, 0.1, 3.0)
    film, grid = Film(gap, 10.0, CompiledGas(1.4, 0.05, 1)), ladder(gap).grid(2)
    nothing = np.full((grid.X.size, 7), np.nan)
    found = _solve_or_continue(film, grid, 7, nothing, 1e-9)
    mean, swing = 1 + 0.1 * np.cos(0.6), 0.5 * np.cos(0.4)
    parts = [1.0, 0.25, 0.5, 0.7, 0.85, 0.95, 1.0]
    assert [one[0] for one in seen] == pytest.approx([mean + part * swing for part in parts])
    assert [one[1] for one in seen] == [1e-9, *5 * [1e-3], 1e-9]
    assert found.iterations == sum(one[2] for one in seen)
    direct = _solve_or_continue(film, grid, 7, None, 1e-9)
    assert found.converged
    assert found.gas == pytest.approx(direct.gas, rel=1e-8)
    assert len(seen) == len(parts) + 1


@pytest.mark.parametrize("shape", ["ellipse", "disc"])
@pytest.mark.parametrize("wave_number", [1500.0, 6000.0])
def test_waves_that_no_memory_holds_are_refused_before_a_grid_is_made(
    shape: str, wave_number: float
) -> None:
    with pytest.raises(InputError, match=r"bytes of a film in the plane.*take fewer waves"):
        ladder(PlanarGap(0.5, wave_number), shape)


def test_more_times_than_memory_holds_are_refused_before_the_first_solve(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = ladder(PlanarGap(0.9))
    most = 4 * 8.0 * (4 * 9) ** 2
    monkeypatch.setattr(module, "PLANAR_MEMORY", dataclasses.replace(PLANAR_MEMORY, most=most))
    monkeypatch.setattr(module, "Balancer", None)
    with pytest.raises(InputError, match="bytes of a film in the plane"):
        climb_to(made, 1e-3)
