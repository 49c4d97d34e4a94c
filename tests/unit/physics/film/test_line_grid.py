"""Finite volumes on a line: where the cells lie, what they hold, and gaps that are refused."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import GeometryError, InputError
from squeezefilm.physics.film.line_grid import (
    edge_graded,
    edge_layer,
    gap_table,
    line_grid,
    mean_over,
    refined_line,
    uniform_gap,
)


@pytest.mark.parametrize("layer", [0.02, 0.2, 0.45])
def test_half_of_the_points_lie_in_the_layer(layer: float) -> None:
    points = edge_graded(40, layer)
    assert (points[0], points[-1]) == (pytest.approx(0.0, abs=1e-12), pytest.approx(1.0))
    assert np.all(np.diff(points, 2) < 0)
    assert points[20] == pytest.approx(1 - layer)


def test_a_layer_of_half_the_way_leaves_the_points_even() -> None:
    assert edge_graded(10, 0.5) == pytest.approx(np.linspace(0, 1, 11))


def test_the_layer_goes_with_the_root_of_the_squeeze_number() -> None:
    assert edge_layer(1e4) == pytest.approx(0.04)
    assert edge_layer(10.0) == 0.5
    assert edge_layer(1e9) == 2e-3
    assert edge_layer(1e9, 0.15) == 0.15


def test_points_are_drawn_to_a_crest_by_the_root_of_the_gap() -> None:
    line = edge_graded(50, 0.2)

    def gap(X: np.ndarray) -> np.ndarray:
        return np.asarray(0.1 + (X - 0.4) ** 2)

    placed = refined_line(line, gap)
    assert (placed[0], placed[-1], placed.size) == (line[0], line[-1], line.size)
    assert np.all(np.diff(placed) > 0)
    # Three tenths of the points by the line, seven by 1/√H: ∫ 1/√(0.1 + (x − 0.4)²) is arsinh.
    root = np.arcsinh((placed - 0.4) / np.sqrt(0.1))
    crest = (root - root[0]) / (root[-1] - root[0])
    crowd = np.interp(placed, line, np.linspace(0, 1, line.size))
    assert 0.3 * crowd + 0.7 * crest == pytest.approx(np.linspace(0, 1, line.size), abs=2e-4)


@pytest.mark.parametrize(("swing", "moved"), [(0.49, False), (0.51, True)])
def test_a_gap_that_hardly_varies_leaves_the_line(swing: float, moved: bool) -> None:
    line = np.linspace(0.0, 1.0, 9)
    placed = refined_line(line, lambda X: 1 + swing * X)
    assert (placed is not line) == moved


@pytest.mark.parametrize("squeeze_number", [1.0, 4000.0])
def test_cells_fill_the_strip_and_the_disc(squeeze_number: float) -> None:
    strip = line_grid("strip", 20, squeeze_number)
    assert strip.face[[0, -1]] == pytest.approx([-0.5, 0.5])
    assert strip.face == pytest.approx(-strip.face[::-1])
    assert strip.volume == pytest.approx(np.diff(strip.face))
    assert strip.volume.sum() == pytest.approx(1.0)
    nodes = np.concatenate([[-0.5], strip.centre, [0.5]])
    assert strip.conductance * np.diff(nodes) == pytest.approx(np.ones(21))
    disc = line_grid("disc", 20, squeeze_number)
    assert disc.face[[0, -1]] == pytest.approx([0.0, 1.0], abs=1e-12)
    assert disc.volume.sum() == pytest.approx(0.5)
    nodes = np.concatenate([[0.0], disc.centre, [1.0]])
    assert disc.conductance * np.diff(nodes) == pytest.approx(disc.face)
    for grid in (strip, disc):
        assert np.all((grid.face[:-1] < grid.centre) & (grid.centre < grid.face[1:]))
    if squeeze_number > 1:
        # Half of the cells within four lengths σ^−½ of the edge, on a half width of 1.
        assert disc.face[10] == pytest.approx(1 - 4 / np.sqrt(4000), rel=1e-6)
        assert 2 * strip.face[15] == pytest.approx(1 - 4 / np.sqrt(1000), rel=1e-6)


def test_cells_are_drawn_to_where_the_mean_gap_is_small() -> None:
    for shape in ("strip", "disc"):
        plain = line_grid(shape, 20, 10.0)  # type: ignore[arg-type]
        drawn = line_grid(shape, 20, 10.0, lambda X: 0.1 + (X - 0.25) ** 2)  # type: ignore[arg-type]
        at = np.abs(plain.centre - 0.25).argmin()
        here = np.abs(drawn.centre - 0.25).argmin()
        assert np.diff(drawn.face)[here] < 0.8 * np.diff(plain.face)[at]
        assert drawn.face[[0, -1]] == pytest.approx(plain.face[[0, -1]], abs=1e-12)


def test_a_table_is_of_times_and_places() -> None:
    X, T = np.linspace(-0.5, 0.5, 4), np.linspace(0, 6, 3)
    table = gap_table(lambda X, T: 2 + X + 0.1 * T, X, T)
    assert table == pytest.approx(2 + X[None, :] + 0.1 * T[:, None])
    assert gap_table(lambda X, T: np.float64(2.0), X, T) == pytest.approx(np.full((3, 4), 2.0))
    assert gap_table(uniform_gap(0.3), X, T) == pytest.approx(
        np.repeat(1 + 0.3 * np.cos(T)[:, None], 4, axis=1)
    )
    mean = mean_over(lambda X, T: 2 + X * np.cos(T), np.pi / 4 * np.arange(8.0))
    assert mean(X) == pytest.approx(np.full(4, 2.0))


def test_gaps_that_cannot_be_are_refused_with_their_place() -> None:
    X, T = np.array([-0.5, 0.25]), np.array([0.0, 1.5, 3.0])
    with pytest.raises(InputError, match=r"broadcasts to \(3, 2\)"):
        gap_table(lambda X, T: np.ones(5), X, T)
    with pytest.raises(InputError, match=r"gap = inf at X = 0\.25, T = 1\.5 cannot be used"):
        gap_table(lambda X, T: np.where((X > 0) & (T > 1), np.inf, 1.0), X, T)
    with pytest.raises(GeometryError, match=r"H = -0\.5 at X = 0\.25, T = 3;"):
        gap_table(lambda X, T: 1 - np.where(X > 0, T / 2, 0.0), X, T)
    with pytest.raises(GeometryError, match="closes: H = 0 at"):
        gap_table(lambda X, T: np.abs(X) + T - T - 0.25, X, T)
    for excursion in (0.0, 1.0):
        with pytest.raises(InputError, match="excursion_ratio"):
            uniform_gap(excursion)
