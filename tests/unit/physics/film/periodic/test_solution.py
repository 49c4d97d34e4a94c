"""How a solution is put together from the pressure on two grids."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.film.periodic.solution import (
    NO_FIELD,
    FilmQuestion,
    FilmSolution,
    Found,
    assembled,
    extrapolated_field,
)

TIMES = 9
T = 2 * np.pi * np.arange(TIMES) / TIMES


HARMONICS = np.array([0.07, -0.2 - 0.1j, 0.03, 0, 0, 0, 0, 0, 0], dtype=complex)
ERRORS = np.array([1e-5, 2e-5, 1e-4, 0, 0, 0, 0, 0, 0])


def put_together(*, met: bool, later: bool = False, closed: bool = False) -> FilmSolution:
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
    eps = -0.5 if later else 0.5
    asked = FilmQuestion("strip", 10.0, eps, 1.0, 0.0, "first", 1e-3, None)
    force = (0.3 + 0.1j, 1e-9) if closed else None
    found = Found(0.07, 1e-5, met, 7, 1e-9, 2, TIMES, HARMONICS, ERRORS, force)
    field = extrapolated_field(levels, x, harmonics, 1.0, mirrored=True)
    if later:
        found, field = found.later(), field.later()
    return assembled(asked, found, field)


def test_the_half_is_mirrored_and_extrapolated_where_both_grids_have_a_node() -> None:
    solution = put_together(met=True)
    assert solution.position.tolist() == [-1.0, -0.5, 0.0, 0.5, 1.0]
    np.testing.assert_allclose(solution.gap[0], 1 + 0.5 * np.cos(solution.time))
    middle = 1 + 0.1 / (1 + 0.5 * np.cos(solution.time))
    np.testing.assert_allclose(solution.pressure[2], middle, rtol=1e-12)
    np.testing.assert_allclose(solution.pressure[[0, -1]], 1.0)
    np.testing.assert_allclose(solution.pressure, solution.pressure[::-1])
    assert solution.mean_load == 1.07
    assert solution.stiffness_relative == pytest.approx(0.4)
    assert solution.damping_relative == pytest.approx(0.2)
    assert solution.force_error == pytest.approx(4e-5)
    assert solution.force_harmonics_error is ERRORS
    # The worst harmonic, relative to the largest.
    said = "converged: over-pressure 0.07 within 1e-05, the force's harmonics within 0.0004 of"
    assert solution.status.startswith(said)
    assert "with 2 cells and 9 times" in solution.status


def test_a_closed_form_says_so_and_gives_its_own_force() -> None:
    solution = put_together(met=True, closed=True)
    assert (solution.stiffness_relative, solution.damping_relative) == (0.3, 0.1)
    assert solution.force_error == 1e-9
    assert solution.status.endswith("the closed form of a small vibration")
    assert "closed form" in solution.model


def test_the_load_alone_has_neither_field_nor_harmonics() -> None:
    asked = FilmQuestion("strip", 10.0, 0.5, 1.0, 0.0, "first", 1e-3, None)
    unknown = np.full(9, np.nan)
    found = Found(0.07, 1e-5, True, 7, 1e-9, 2, TIMES, unknown.astype(complex), unknown)
    solution = assembled(asked, found, NO_FIELD)
    assert solution.force_harmonics[0] == 0.07
    assert np.isnan([solution.stiffness_relative, solution.force_error]).all()
    assert solution.pressure.shape == (0, 0)
    assert solution.mean_pressure.shape == (0,)
    assert "harmonics" not in solution.status


def test_half_a_period_later_is_the_same_film_with_its_excursion_turned_round() -> None:
    first, later = put_together(met=True), put_together(met=True, later=True)
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
