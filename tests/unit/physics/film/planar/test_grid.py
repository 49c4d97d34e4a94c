"""Lines of a planar grid: how they are graded to an edge and to where the gap is small."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.physics.film.planar.grid import edge_graded, edge_layer, refined_line


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
