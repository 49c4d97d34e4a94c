"""Where a profile puts its points: by what it says, and with the slope that it says."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson

from squeezefilm.core.errors import InputError
from squeezefilm.physics.film.periodic.profile import (
    GapProfile,
    profile_from_function,
    sampled_grid,
)

XI = np.linspace(-1, 1, 4001)


class Wavy:
    """A mean gap with crests, whose first harmonic is the same everywhere."""

    def __call__(self, x: np.ndarray) -> np.ndarray:
        mean = 1 + 0.55 * np.cos(2 * np.pi * 3 * x) + 0.2 * x
        return np.stack([mean + 0j, np.full(x.size, 0.1 + 0j)])


PROFILE = GapProfile(Wavy(), "waves")


@pytest.mark.parametrize("grading", [0.0, 0.4])
def test_points_go_to_where_the_gap_is_small_and_to_the_edges(grading: float) -> None:
    x, slope = PROFILE.grid(XI, grading)
    assert (x[0], x[-1]) == (pytest.approx(-0.5), pytest.approx(0.5))
    assert np.all(np.diff(x) > 0)
    assert slope[1:-1] == pytest.approx(np.gradient(x, XI)[1:-1], rel=2e-3, abs=1e-5)
    # Two fifths of the points evenly, three by 1/H: so many lie before each place.
    place = np.linspace(-0.5, 0.5, 20001)
    inverse = 1 / PROFILE.harmonics(place)[0].real
    before = cumulative_simpson(inverse, x=place, initial=0.0)
    share = 0.4 * (place + 0.5) + 0.6 * before / before[-1]
    expected = 0.5 + 0.5 * XI * (1 + grading * (1 - XI**2))
    assert np.interp(x, place, share) == pytest.approx(expected, abs=1e-7)


def test_an_even_gap_is_graded_to_its_edges_alone() -> None:
    even = GapProfile(lambda x: np.ones((1, x.size), dtype=complex), "an even gap")
    x, slope = even.grid(XI, 0.25)
    assert x == pytest.approx(0.5 * XI * (1 + 0.25 * (1 - XI**2)), abs=1e-12)
    assert slope == pytest.approx(0.5 * (1.25 - 0.75 * XI**2), abs=1e-9)


def test_a_sampled_grid_is_from_the_middle_or_from_edge_to_edge() -> None:
    for closed, first in ((True, 0.0), (False, -1.0)):
        x, slope, harmonics = sampled_grid(PROFILE, 8, closed, 0.4)
        expected, rise = PROFILE.grid(np.linspace(first, 1.0, 17), 0.4)
        assert x == pytest.approx(expected, abs=0)
        assert slope == pytest.approx(rise, abs=0)
        assert harmonics == pytest.approx(np.asarray(PROFILE.harmonics(x)), abs=0)
        for one in (x, slope, harmonics):
            assert not one.flags.writeable


def test_a_function_s_harmonics_are_counted_over_one_period_and_the_contact() -> None:
    def gap(X: np.ndarray, T: np.ndarray) -> np.ndarray:
        # Beside the contact there is none.
        inside = np.where(np.abs(X) <= 0.5, 1.0, np.nan)
        return inside + 0.2 * X * np.cos(T) + 0.1 * np.sin(3 * T)

    found = profile_from_function(gap, "three waves")
    assert (found.orders, found.description) == (4, "three waves")
    h = found.harmonics(np.array([-0.4, 0.0, 0.5]))
    assert h == pytest.approx(
        np.array([[1, 1, 1], [-0.08, 0, 0.1], [0, 0, 0], [-0.1j, -0.1j, -0.1j]]), abs=1e-12
    )
    still = profile_from_function(lambda X, T: 1.0 + 0.1 * X + 0 * T)
    assert still.orders == 1
    with pytest.raises(InputError, match="not periodic"):
        profile_from_function(lambda X, T: 1.0 + 0.01 * T + 0 * X)
    with pytest.raises(InputError, match="not finite"):
        profile_from_function(lambda X, T: np.where(T > 9, np.inf, 1.0) + 0 * X)
