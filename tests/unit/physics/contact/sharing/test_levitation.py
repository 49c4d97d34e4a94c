"""The levitation of 2016 against its balance, its limits, and what was read of three people."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import Gas
from squeezefilm.physics.contact.sharing.gas_table import FilmTable, film_table
from squeezefilm.physics.contact.sharing.levitation import levitation_friction, ridge_friction
from squeezefilm.physics.film.gap import squeeze_number
from squeezefilm.physics.film.periodic.batch import solve_films

AIR = Gas(1.85e-5, 1e5, 1.2, 67e-9)


@pytest.fixture(scope="module")
def films() -> FilmTable:
    return film_table(30e3, 250e-6, AIR)


def test_a_solved_film_carries_what_the_contact_of_a_ridge_does_not(films: FilmTable) -> None:
    """The film of each gap solved anew, by itself."""
    amplitude, pressure, length = np.geomspace(0.2e-6, 5e-6, 7), 7e3, 2e-6
    friction = ridge_friction(films, amplitude, pressure, length)
    gap = -length * np.log(friction)
    sigma = squeeze_number(30e3, 250e-6, gap, AIR.viscosity, AIR.ambient_pressure)
    solved = solve_films(sigma, amplitude / gap, knudsen_number=67e-9 / gap, slip="first")
    carried = AIR.ambient_pressure * solved.over_pressure
    assert carried == pytest.approx(pressure * (1 - friction), rel=5e-3)


def test_a_ridge_s_friction_falls_with_the_amplitude_from_one_to_nothing(films: FilmTable) -> None:
    amplitude = np.append(0.0, np.geomspace(1e-12, 100e-6, 300))
    friction = ridge_friction(films, amplitude, 7e3, 2e-6)
    assert friction[0] == 1
    assert np.all(np.diff(friction) <= 0)
    assert friction[-1] < 1e-4
    # Where the film ends and below its table there is no step.
    assert np.max(np.abs(np.diff(friction))) < 0.04


def test_a_longer_contact_and_a_heavier_finger_keep_more_friction(films: FilmTable) -> None:
    amplitude = np.array([0.5e-6, 2e-6])
    usual = ridge_friction(films, amplitude, 7e3, 2e-6)
    assert np.all(ridge_friction(films, amplitude, 7e3, 3e-6) > usual)
    assert np.all(ridge_friction(films, amplitude, 14e3, 2e-6) > usual)


def test_narrow_films_know_the_frequency(films: FilmTable) -> None:
    amplitude = np.array([1e-6])
    faster = ridge_friction(film_table(60e3, 250e-6, AIR), amplitude, 7e3, 2e-6)
    assert faster < ridge_friction(films, amplitude, 7e3, 2e-6) - 0.02


@pytest.mark.parametrize("rest_gap", [0.0, 0.3, 4.0])
def test_film_and_contact_carry_the_finger_between_them(rest_gap: float) -> None:
    amplitude = np.geomspace(1e-4, 30.0, 50)
    friction = levitation_friction(amplitude, rest_gap)
    lift = (rest_gap - np.log(friction)) ** 2 * (1 - friction)
    # A friction near one has lost the digits of what is lifted.
    assert lift == pytest.approx(amplitude**2, rel=1e-6, abs=1e-13)
    assert np.all(np.diff(friction) < 0)


def test_at_rest_it_is_that_of_dry_contact() -> None:
    assert levitation_friction(np.zeros(2), 1.0) == pytest.approx(1.0, abs=1e-12)


def test_a_small_amplitude_lifts_a_finger_with_a_gap_at_rest_as_a_gaussian_says() -> None:
    amplitude = np.array([0.01, 0.03])
    assert 1 - levitation_friction(amplitude, 2.0) == pytest.approx(amplitude**2 / 4, rel=2e-3)


def test_without_a_gap_at_rest_the_fall_is_steepest_at_the_smallest_amplitudes() -> None:
    amplitude = np.array([1e-4, 1e-3])
    assert 1 - levitation_friction(amplitude) == pytest.approx(amplitude ** (2 / 3), rel=1e-2)


def test_what_is_no_amplitude_is_refused() -> None:
    with pytest.raises(InputError):
        levitation_friction(np.array([-1.0]))
