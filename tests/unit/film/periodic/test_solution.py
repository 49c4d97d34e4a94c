"""How a solution is put together from the pressure on two grids."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.errors import ConvergenceError
from squeezefilm.film.periodic.solution import Asked, FilmSolution, Found, assembled

TIMES = 9
T = 2 * np.pi * np.arange(TIMES) / TIMES


def put_together(*, met: bool, shift: float = 0.0) -> FilmSolution:
    """Half a strip of two cells under H = 1 + 0.5 cos T, from gas that follows as Ψ = P H.

    Ψ − H = 0.1 (1 − x²) on the finer grid and, by an error of second order, 4 times as far off on
    the coarser one.
    """
    x = np.array([0.0, 0.5, 1.0])
    H = 1 + 0.5 * np.cos(T)
    rise = 0.1 * (1 - x**2)[:, None] / H
    fine = rise * 1.01
    coarse = (rise * 1.04)[::2]
    levels = [(coarse, np.array([0.5, 0.5])), (fine, np.array([0.25, 0.5, 0.25]))]
    harmonics = np.ones((2, 3), dtype=complex)
    harmonics[1] = 0.5
    asked = Asked("strip", 10.0, -0.5 if shift else 0.5, 1.0, 0.0, "first", 1e-3, None)
    found = Found(0.07, 1e-5, met, 7, 1e-9, 2, TIMES)
    return assembled(asked, found, levels, harmonics, x, shift, True, 0.5)


def test_the_half_is_mirrored_and_extrapolated_where_both_grids_have_a_node() -> None:
    solution = put_together(met=True)
    assert solution.position.tolist() == [-1.0, -0.5, 0.0, 0.5, 1.0]
    np.testing.assert_allclose(solution.gap[0], 1 + 0.5 * np.cos(solution.time))
    middle = 1 + 0.1 / (1 + 0.5 * np.cos(solution.time))
    np.testing.assert_allclose(solution.pressure[2], middle, rtol=1e-12)
    np.testing.assert_allclose(solution.pressure[[0, -1]], 1.0)
    np.testing.assert_allclose(solution.pressure, solution.pressure[::-1])
    assert solution.mean_load == 1.07
    assert "converged: over-pressure 0.07 within 1e-05 with 2 cells and 9 times" in solution.status


def test_half_a_period_later_is_the_same_film_with_its_excursion_turned_round() -> None:
    first, later = put_together(met=True), put_together(met=True, shift=np.pi)
    half = len(first.time) // 2
    np.testing.assert_allclose(later.gap, np.roll(first.gap, -half, axis=1))
    np.testing.assert_allclose(later.pressure, np.roll(first.pressure, -half, axis=1))
    signs = (-1.0) ** np.arange(len(first.force_harmonics))
    np.testing.assert_allclose(later.force_harmonics, signs * first.force_harmonics, atol=1e-15)


def test_what_did_not_converge_is_raised_with_what_there_is() -> None:
    with pytest.raises(ConvergenceError, match="did not converge: not converged") as raised:
        put_together(met=False)
    assert isinstance(raised.value.partial, FilmSolution)
    assert raised.value.iterations == 7
    assert raised.value.partial.over_pressure_error == 1e-5
