"""The harmonics of a force on nested grids, and how their errors decide when it is refined."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.physics.film.periodic.batch import ROUNDS
from squeezefilm.physics.film.periodic.nested import (
    UNIFORM_MARGINS,
    Kind,
    Level,
    Nested,
    force_harmonics,
    load_times,
    refine,
    steadied,
)
from squeezefilm.physics.film.periodic.resolution import FilmResolution
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
)


@pytest.mark.parametrize("n", [1.0, 1.4])
@pytest.mark.parametrize("eps", [0.1, 0.9, 0.98])
def test_the_harmonics_are_those_of_a_film_whose_storage_the_times_resolve(
    eps: float, n: float
) -> None:
    T = 2 * np.pi * np.arange(9) / 9
    every = 2 * np.pi * np.arange(4096) / 4096

    def over(t: np.ndarray) -> np.ndarray:
        # (P − 1) Hⁿ has two harmonics, P − 1 many.
        return np.asarray(
            (0.3 + 0.2 * np.cos(t) - 0.1 * np.sin(2 * t)) / (1 + eps * np.cos(t)) ** n
        )

    gap = np.repeat(np.array([[1.0], [eps]], dtype=complex), 5, axis=1)
    level = Level(np.array([over(T), 2 * over(T), 0 * T]), np.array([0.25, 0.5, 0.25]))
    (found,) = force_harmonics([level], gap, n, eps)
    exact = 1.25 * np.fft.rfft(over(every))[:9] / 4096
    exact[1:] *= 2
    assert found == pytest.approx(exact, rel=1e-7, abs=1e-8)


def test_a_deeper_excursion_needs_more_times_of_its_load() -> None:
    assert load_times(9, 0.5) < load_times(9, 0.9) < load_times(9, 0.98)
    assert load_times(19, 0.5) == load_times(9, 0.5) + 5


def test_no_error_is_small_by_accident() -> None:
    size = np.array([0.1, 1.0, 0.5, 0.1, 0.0])
    steady = steadied(np.array([0.0, 1e-2, 0.0, 0.0, 0.0]), size)
    # The mean by half of the first's error relative to it, then 1.5 × relative, then two fifths.
    assert steady == pytest.approx([5e-4, 1e-2, 7.5e-3, 3e-3, 1.2e-3])
    assert steadied(np.array([0.0, 0.0, 1e-2]), np.array([1.0, 1.0, 1.0]))[1] == pytest.approx(2e-4)
    large = np.array([3.0, 2.0, 4.0])
    assert steadied(large, np.array([0.1, 1.0, 0.1])) == pytest.approx(large)


KIND = Kind(10.0, 0.5, 1, 0, UNIFORM_MARGINS, 1.0, 10.0)


def film_of(resolution: FilmResolution, first: float, *, levels: bool = True) -> Nested:
    """A film without error in its mean, of which the first harmonic is off by `first`/cells²."""
    cells, row = resolution.cells, np.zeros(COLUMNS)
    row[[OVER, COARSE, MIDDLE, FINE, CHECK]] = 0.1
    row[[ERROR, SPACE, TIME]] = 1e-9
    row[ITERATIONS], row[RESIDUAL] = 5, 1e-12
    gap = np.repeat(np.array([[1.0], [0.0]], dtype=complex), 9, axis=1)
    found = []
    for m, times in (
        (cells // 4, resolution.check.number),
        (cells // 4, resolution.times.number),
        (cells // 2, resolution.times.number),
        (cells, resolution.times.number),
    ):
        T = 2 * np.pi * np.arange(times) / times
        p = 0.1 + (1.0 + first * (1.0 + (m % 3)) / m**2) * np.cos(T)
        found.append(Level(np.tile(p, (2, 1)), np.array([0.5, 0.5])))
    return Nested(resolution, np.zeros(9), gap, row, found if levels else [])


def test_a_harmonic_alone_is_reason_enough_to_refine() -> None:
    asked: list[int] = []

    def solve(resolution: FilmResolution) -> Nested:
        asked.append(resolution.cells)
        return film_of(resolution, 1.0)

    _, found = refine(solve, KIND, (16, 3), 1e-3, 768)
    assert found.met
    assert len(asked) > 1
    assert np.all(np.diff(asked) > 0)
    assert found.cells == asked[-1]
    assert found.iterations == 5 * len(asked)
    assert found.harmonics_error[1:].max() <= 1e-3 * abs(found.harmonics[1])
    assert found.harmonics[0] == 0.1
    # Without the field the mean is enough.
    _, alone = refine(lambda r: film_of(r, 1.0, levels=False), KIND, (16, 3), 1e-3, 768)
    assert alone.met
    assert alone.cells == 16
    assert np.isnan(alone.harmonics_error[1:]).all()


def test_what_never_converges_stops_and_says_so() -> None:
    _, found = refine(lambda r: film_of(r, float(r.cells) ** 2), KIND, (16, 3), 1e-3, 10**9)
    assert not found.met
    assert found.iterations <= 5 * ROUNDS


def test_where_rounding_is_more_than_what_is_allowed_one_solve_is_enough() -> None:
    asked: list[int] = []

    def solve(resolution: FilmResolution) -> Nested:
        asked.append(resolution.cells)
        film = film_of(resolution, 0.0)
        film.row[[OVER, COARSE, MIDDLE, FINE, CHECK]] = 1e-12
        film.row[[ERROR, SPACE]] = 1e-13
        return film

    _, found = refine(solve, KIND._replace(squeeze_number=1e6), (16, 3), 1e-3, 768)
    assert not found.met
    assert asked == [16]
