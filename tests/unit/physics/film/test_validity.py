"""What the film says about its own assumptions."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, OutOfRangeError, OutOfRangeWarning
from squeezefilm.core.materials import Gas
from squeezefilm.physics.film import validity
from squeezefilm.physics.film.gap import PaperGap, film_thickness, squeeze_number

AIR = Gas(viscosity=1.85e-5, ambient_pressure=1e5, density=1.2, mean_free_path=66e-9)
STATOR = PaperGap(0.6e-6, 2e-6, 50e-6, 350e-6, 18.7e-3, 10e-3)


def of(gap: PaperGap, frequency: float = 40.5e3) -> validity.FilmValidity:
    with pytest.warns(OutOfRangeWarning):
        return validity.film_validity(gap, frequency, AIR)


def named(found: validity.FilmValidity) -> dict[str, validity.ValidityCheck]:
    return {check.name: check for check in found.checks}


def test_reduced_reynolds_number_over_the_range_of_gaps() -> None:
    re = validity.reduced_reynolds_number(1.2, 40e3, np.array([1e-6, 10e-6, 50e-6]), 1.85e-5)
    np.testing.assert_allclose(re, [0.016, 1.63, 41], rtol=0.03)
    assert re[1] < validity.INERTIA_LIMIT < re[2]


def test_slip_counts_below_three_micrometres() -> None:
    kn = validity.knudsen_number(66e-9, np.array([2.9e-6, 3.5e-6]))
    assert kn[0] > validity.SLIP_LIMIT > kn[1]


def test_sigma_ten_is_not_enough() -> None:
    assert 0.40 < validity.asymptotic_fraction(10.0) < 0.45
    assert 0.62 < validity.asymptotic_fraction(20.418) < 0.68
    reached = validity.asymptotic_fraction(validity.ASYMPTOTE_SQUEEZE_NUMBER)
    assert reached == pytest.approx(0.9, abs=1e-3)


def test_crest_squeeze_number_is_built_on_the_width_at_twice_the_gap() -> None:
    # ℓ: where the sinusoidal ridge has doubled the gap, in the limit of a thin film.
    h = 1e-9
    fine = PaperGap(h, 0.0, 50e-6, 350e-6, 18.7e-3, 10e-3)
    x = np.linspace(0, 2e-6, 400001) + 175e-6
    thickness = film_thickness(x, 0.0, 4e4, h, 0.0, 50e-6, 350e-6, 18.7e-3)
    half_width = np.interp(2 * h, thickness, x - 175e-6)
    expected = squeeze_number(4e4, half_width, h, 1.85e-5, 1e5)
    crest = validity.crest_squeeze_number(
        4e4, fine.ridge_amplitude, fine.ridge_period, h, 1.85e-5, 1e5
    )
    assert crest == pytest.approx(expected, rel=1e-3)


def test_the_papers_stator_is_far_from_the_asymptote() -> None:
    result = of(STATOR)
    assert {check.name for check in result.failed} == {"slip", "asymptote", "crest"}
    assert named(result)["crest"].value == pytest.approx(0.03, rel=0.15)
    assert result.squeeze_number == pytest.approx(20.418, abs=1e-3)
    assert "66 %" in named(result)["asymptote"].sentence
    assert "leaks into the grooves" in named(result)["crest"].sentence


def test_each_failure_warns_once_and_strict_refuses() -> None:
    with pytest.warns(OutOfRangeWarning) as caught:
        validity.film_validity(STATOR, 40.5e3, AIR)
    assert len(caught) == 3
    with pytest.raises(OutOfRangeError, match="strict=False"):
        validity.film_validity(STATOR, 40.5e3, AIR, strict=True)


def test_a_trapped_smooth_film_holds_without_a_word() -> None:
    film = dataclasses.replace(STATOR, roughness=4e-6, ridge_amplitude=0.0)
    result = validity.film_validity(film, 40.5e3, AIR)
    assert not result.failed
    assert [check.name for check in result.checks] == ["inertia", "slip", "asymptote"]


def test_a_thick_film_has_inertia() -> None:
    thick = dataclasses.replace(STATOR, roughness=30e-6, ridge_amplitude=0.0)
    assert not named(of(thick))["inertia"].holds
    assert "fails" in named(of(thick))["inertia"].sentence


def test_an_array_of_amplitudes_is_refused() -> None:
    with pytest.raises(InputError, match="single vibration amplitude"):
        validity.film_validity(STATOR.with_amplitude(np.array([1e-6, 2e-6])), 4e4, AIR)
