"""Marching to the periodic state: what is handed back is the finest of what was computed."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.film.transient.settling import FilmSettled, settle_to_periodic


def gap(X: np.ndarray, T: float) -> np.ndarray:
    return 1.0 + 0.5 * np.cos(T) + 0.0 * X


def settled_on(cells: int, steps: int) -> FilmSettled:
    return settle_to_periodic(gap, 10.0, cells=cells, steps=steps, tolerance=None)


def test_the_finest_resolution_is_returned_extrapolated() -> None:
    found = settle_to_periodic(gap, 10.0, cells=6, steps=8, tolerance=0.02)
    assert found.cells > 6
    assert found.steps * 6 == found.cells * 8
    assert found.position.size == found.pressure.size == found.cells
    assert found.load.size == found.time.size == found.steps
    coarse, fine = (
        settled_on(found.cells // 2, found.steps // 2),
        settled_on(found.cells, found.steps),
    )
    assert found.mean_load == pytest.approx(
        fine.mean_load + (fine.mean_load - coarse.mean_load) / 3, rel=1e-7
    )
    # PHYSICS: W = 1.160251 for the strip at σ = 10, ε = 0.5.
    assert abs(found.mean_load - 1.160251) <= found.over_pressure_error


def test_the_best_is_carried_where_cells_do_not_suffice() -> None:
    with pytest.raises(ConvergenceError, match="12 cells") as caught:
        settle_to_periodic(gap, 10.0, cells=6, steps=8, tolerance=1e-6, max_cells=12)
    assert caught.value.partial.cells == 12
