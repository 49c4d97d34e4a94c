"""The film's load under a finger: each reading of a finger against a closed form or a limit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from squeezefilm.contact.sharing.film_load import (
    FILM_MODELS,
    film_load,
    is_still,
    line_film,
    ridge_positions,
)
from squeezefilm.errors import InputError
from squeezefilm.film.closed.limits import contact_mean_pressure
from squeezefilm.film.closed.linear import relative_stiffness
from squeezefilm.film.gap import PaperGap
from squeezefilm.film.periodic.film import solve_uniform
from squeezefilm.materials import Gas

# A free path so short that it does not show; and one of the size of the gap.
DENSE = Gas(viscosity=1.8e-5, ambient_pressure=1e5, density=1.2, mean_free_path=1e-15)
RARE = dataclasses.replace(DENSE, mean_free_path=2e-7)
# Ridges of 0.5 mm under a contact of 5 mm, on a wave much longer than the contact.
GAP = PaperGap(2e-6, 0.4e-6, 6e-6, 0.5e-3, 10.0, 5e-3)


def sigma(frequency: float, length: float, thickness: float) -> float:
    """12 η ω l²/(p0 h²) in numbers."""
    return 12 * 1.8e-5 * 2 * np.pi * frequency * length**2 / (1e5 * thickness**2)


def test_the_asymptote_is_the_papers_closed_form() -> None:
    found = film_load(GAP, 30e3, DENSE, "paper2008")
    assert found.over_pressure == pytest.approx(float(contact_mean_pressure(GAP)) - 1)
    assert found.over_pressure > 0
    assert (found.model, found.error, found.status) == ("paper2008", 0.0, "closed form")
    assert found.squeeze_number == pytest.approx(sigma(30e3, 5e-3, 8.4e-6))


def test_a_smooth_finger_is_the_strip_at_the_gap_over_its_crests() -> None:
    found = film_load(GAP, 3e3, DENSE, "film-smooth")
    number = sigma(3e3, 5e-3, 2.4e-6)
    assert found.squeeze_number == pytest.approx(number)
    strip = solve_uniform(number, 0.4 / 2.4, tolerance=1e-5)
    assert abs(found.over_pressure - strip.over_pressure) <= found.error + strip.over_pressure_error
    assert 0 < found.error <= 1e-3 * found.over_pressure
    assert found.model == "film-smooth"
    # Without ridges there is nothing to tell the sealed film from the smooth one.
    bare = dataclasses.replace(GAP, ridge_amplitude=0.0)
    assert film_load(bare, 3e3, DENSE).over_pressure == pytest.approx(found.over_pressure)


def test_slip_and_tolerance_reach_the_solver() -> None:
    number, kn = sigma(3e3, 5e-3, 2.4e-6), 0.2 / 2.4
    for slip in ("first", "second"):
        strip = solve_uniform(number, 0.4 / 2.4, knudsen_number=kn, slip=slip, tolerance=1e-4)
        found = film_load(GAP, 3e3, RARE, "film-smooth", slip=slip, tolerance=1e-2)
        assert found.over_pressure == pytest.approx(strip.over_pressure, rel=1e-2)
        assert found.over_pressure == pytest.approx(
            film_load(GAP, 3e3, RARE, "film-smooth", slip=slip).over_pressure, rel=1e-2
        )
        crests = film_load(GAP, 1e3, RARE, "film-plateau", slip=slip)
        plateau = solve_uniform(
            sigma(1e3, 250e-6, 2.4e-6), 0.4 / 2.4, knudsen_number=kn, slip=slip, tolerance=1e-4
        )
        assert crests.over_pressure == pytest.approx(plateau.over_pressure / 2, rel=2e-3)
    sealed = [film_load(GAP, 300.0, gas, slip="veijola").over_pressure for gas in (DENSE, RARE)]
    assert sealed[1] < 0.99 * sealed[0]
    opened = [film_load(GAP, 300.0, gas, "film-open").over_pressure for gas in (DENSE, RARE)]
    assert opened[1] < 0.99 * opened[0]


def test_sealed_grooves_reach_the_asymptote_when_no_gas_escapes() -> None:
    fast = film_load(GAP, 3e6, DENSE)
    assert fast.model == "film-sealed"
    assert fast.squeeze_number == pytest.approx(sigma(3e6, 5e-3, 8.4e-6))
    asymptote = film_load(GAP, 3e6, DENSE, "paper2008").over_pressure
    assert fast.over_pressure == pytest.approx(asymptote, rel=0.1)
    assert film_load(GAP, 3.0, DENSE).over_pressure < 0.5 * asymptote


def test_open_grooves_carry_less_than_sealed_ones() -> None:
    short = dataclasses.replace(GAP, contact_length=1.5e-3, ridge_amplitude=1e-6)
    opened = film_load(short, 30e3, DENSE, "film-open")
    sealed = film_load(short, 30e3, DENSE)
    assert 0.05 * sealed.over_pressure < opened.over_pressure < 0.95 * sealed.over_pressure
    assert opened.model == "film-open"
    assert opened.squeeze_number == pytest.approx(sigma(30e3, 1.5e-3, 3.4e-6))
    # In the plane a per cent is enough, whatever finer is asked for.
    assert 0 < opened.error <= 1e-2 * opened.over_pressure
    # Without ridges it is the square, at small motion known in closed form.
    flat = dataclasses.replace(short, ridge_amplitude=0.0, vibration_amplitude=0.2e-6)
    number = sigma(300.0, 1.5e-3, 2.2e-6)
    square = 1.25 * (0.2 / 2.2) ** 2 * relative_stiffness(number, "rectangle")
    found = film_load(flat, 300.0, DENSE, "film-open")
    assert found.over_pressure == pytest.approx(square, rel=0.05)


def test_plateaus_carry_their_share_and_least_at_a_node() -> None:
    # Small motion: each plateau answers with the square of the wave over it.
    still = dataclasses.replace(GAP, vibration_amplitude=0.02e-6)
    number = sigma(5e3, 200e-6, 2.02e-6)
    one = 1.25 * (0.02 / 2.02) ** 2 * relative_stiffness(number)
    found = film_load(still, 5e3, DENSE, "film-plateau", plateau_width=200e-6)
    assert found.over_pressure == pytest.approx(0.4 * one, rel=2e-3)
    assert found.squeeze_number == pytest.approx(number)
    assert 0 < found.error <= 2e-3 * found.over_pressure
    assert found.status == "10 plateaus of 200 µm, each solved as a strip"
    waved = dataclasses.replace(still, wavelength=9e-3)
    wave = np.cos(2 * np.pi * np.arange(0.25e-3, 2.5e-3, 0.5e-3) / 9e-3)
    shared = film_load(waved, 5e3, DENSE, "film-plateau", plateau_width=200e-6)
    assert shared.over_pressure == pytest.approx(0.4 * one * np.mean(wave**2), rel=2e-3)
    # The width is 250 µm unless it is given.
    usual = film_load(GAP, 5e3, DENSE, "film-plateau")
    given = film_load(GAP, 5e3, DENSE, "film-plateau", plateau_width=250e-6)
    assert usual == given


def test_crests_lie_half_a_period_from_the_groove_in_the_middle() -> None:
    crests = np.sort(ridge_positions(GAP))
    assert crests == pytest.approx((np.arange(10) - 4.5) * 0.5e-3)
    # The last crest counts while it lies on the contact.
    assert len(ridge_positions(dataclasses.replace(GAP, contact_length=1.52e-3))) == 4
    assert len(ridge_positions(dataclasses.replace(GAP, contact_length=1.48e-3))) == 2
    assert ridge_positions(dataclasses.replace(GAP, contact_length=0.4e-3)) == ()


def test_what_hardly_moves_carries_nothing() -> None:
    edge = 1e-4 * 2e-6
    moving, quiet = (GAP.with_amplitude(part * edge) for part in (1.001, 0.999))
    assert is_still(quiet)
    assert not is_still(moving)
    assert not is_still(GAP.with_amplitude(edge))
    found = film_load(quiet, 30e3, DENSE, "film-plateau")
    assert (found.over_pressure, found.model) == (0.0, "film-plateau")
    assert found.status == "too still for a pressure"
    # No film carries more than it would if no gas escaped.
    assert found.error == pytest.approx(1.25 * (0.999 * edge / (2e-6 + 0.999 * edge)) ** 2)
    assert found.squeeze_number == pytest.approx(sigma(30e3, 5e-3, 8e-6), rel=1e-3)
    assert film_load(moving, 30e3, DENSE, "paper2008").over_pressure > 0


def test_the_film_along_the_contact_has_its_field_and_gap() -> None:
    film = line_film(GAP, 3e3, DENSE)
    x, t = film.position[:, None], film.time[None, :]
    # Both gaps in metres: H0 is that over the grooves' middle, or that over the crests.
    ridges = 6e-6 * (1 + np.cos(2 * np.pi * 10 * x))
    assert 8.4e-6 * film.gap == pytest.approx(2.4e-6 + 0.4e-6 * np.cos(t) + ridges, rel=1e-5)
    smooth = line_film(GAP, 3e3, DENSE, ridges=False, slip="second", tolerance=1e-2)
    flat = 2.4e-6 + 0.4e-6 * np.cos(smooth.time) + 0.0 * smooth.position[:, None]
    assert 2.4e-6 * smooth.gap == pytest.approx(flat, rel=1e-5)
    assert (smooth.slip, smooth.tolerance, film.tolerance) == ("second", 1e-2, 1e-3)
    assert line_film(GAP, 3e3, DENSE, field=False).pressure.size == 0


def test_what_cannot_be_solved_is_refused() -> None:
    with pytest.raises(InputError, match=r"Did you mean 'film-open'\?") as refused:
        film_load(GAP, 3e3, DENSE, "film-opn")  # type: ignore[arg-type]
    assert all(model in str(refused.value) for model in FILM_MODELS)
    with pytest.raises(InputError, match="single vibration amplitude"):
        film_load(GAP.with_amplitude(np.array([1e-6, 2e-6])), 3e3, DENSE)
    with pytest.raises(InputError, match="plateau_width"):
        film_load(GAP, 3e3, DENSE, "film-plateau", plateau_width=0.51e-3)
    with pytest.raises(InputError, match="plateau_width"):
        film_load(GAP, 3e3, DENSE, "film-plateau", plateau_width=0.0)
    short = dataclasses.replace(GAP, contact_length=0.4e-3)
    with pytest.raises(InputError, match=r"0\.4 mm holds no ridge of period 0\.5 mm"):
        film_load(short, 3e3, DENSE, "film-plateau")
