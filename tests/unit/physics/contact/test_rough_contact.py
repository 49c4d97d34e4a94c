"""Persson's contact: its own identities, the limits it is known for, and what it refuses."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erf

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.contact.asperity_kernel import asperity_mean
from squeezefilm.physics.contact.rough_contact import LEAST_GAP, RoughContact, Spectrum

SHAPES = [(0.8, 100.0), (0.5, 1000.0), (1.0, 20.0), (0.95, 3.0)]
CONTACT = RoughContact(roughness=1.1e-6, modulus=2e6, shortest_wavelength=4e-6)


def spectrum(hurst: float, magnification: float) -> Spectrum:
    shortest = 250e-6 / magnification
    return RoughContact(hurst_exponent=hurst, shortest_wavelength=shortest).spectrum


def density(q: float, hurst: float, magnification: float) -> float:
    """C(q) of unit h_rms and q0."""
    level = hurst / math.pi / (1 - magnification ** (-2 * hurst))
    return level * q ** (-2 - 2 * hurst)


def separation(p: float, hurst: float, magnification: float) -> float:
    """ū(p) by adaptive quadrature of the two nested integrals, as they stand in the paper."""

    def inner(s0: float) -> float:
        part = lambda s: (0.45 + 1.65 * erf(s) ** 2) * math.exp(-s * s) / s  # noqa: E731
        near = quad(part, s0, max(s0, 1e-3) * 2, epsrel=1e-10, limit=200)[0] if s0 < 8 else 0.0
        far = quad(part, max(s0, 1e-3) * 2, 9, epsrel=1e-10, limit=200)[0] if s0 < 4 else 0.0
        return float(near + far)

    def outer(y: float) -> float:
        q = math.exp(y * y)
        rise = 2 - 2 * hurst
        grown = y * y if rise == 0 else math.expm1(rise * y * y) / rise
        w = 1 / math.sqrt(math.pi * density(1.0, hurst, magnification) * grown)
        return q * q * density(q, hurst, magnification) * w * inner(w * p) * q * 2 * y

    end = math.sqrt(math.log(magnification))
    return math.sqrt(math.pi) * float(quad(outer, 1e-6, end, epsrel=1e-7, limit=200)[0])


@pytest.mark.parametrize(("hurst", "magnification"), SHAPES)
def test_moments_of_the_spectrum(hurst: float, magnification: float) -> None:
    shape = spectrum(hurst, magnification)
    slope = quad(lambda q: 2 * math.pi * q**3 * density(q, hurst, magnification), 1, magnification)
    energy = quad(lambda q: q**2 * density(q, hurst, magnification), 1, magnification)
    assert shape.slope == pytest.approx(math.sqrt(slope[0]), rel=1e-7)
    assert shape.energy == pytest.approx(math.pi / 2 * energy[0], rel=1e-7)


@pytest.mark.parametrize("p", [1e-4, 0.02, 0.3])
def test_the_gap_is_that_of_the_integral(p: float) -> None:
    hurst, magnification = 0.8, 100.0
    shape = spectrum(hurst, magnification)
    gap = separation(p, hurst, magnification)
    at = LEAST_GAP + 0.025 * np.arange(shape.logarithm.size)
    assert np.interp(gap, at, shape.logarithm) == pytest.approx(math.log(p), abs=2e-4)


@pytest.mark.parametrize(("hurst", "magnification"), SHAPES)
def test_far_apart_the_law_is_exponential(hurst: float, magnification: float) -> None:
    shape = spectrum(hurst, magnification)
    at = LEAST_GAP + 0.025 * np.arange(shape.logarithm.size)
    exponential = math.log(shape.strength) - at / shape.decay
    assert shape.logarithm[-1] == pytest.approx(exponential[-1], abs=1e-5)
    assert shape.steepness[-1] == pytest.approx(-1 / shape.decay, rel=1e-4)
    # u0/h_rms: 0.4 to 0.5 for the surfaces of the papers.
    assert 0.35 < shape.decay < 0.6


@pytest.mark.parametrize(("hurst", "magnification"), SHAPES)
def test_pressed_hard_it_is_stiffer_than_its_exponential_law(
    hurst: float, magnification: float
) -> None:
    """An exponential law has a finite strength at zero gap; this one needs more and more."""
    shape = spectrum(hurst, magnification)
    assert -shape.steepness[0] > 2 / shape.decay
    assert np.all(shape.steepness < 0)


def test_work_done_is_the_elastic_energy() -> None:
    """∫ p dū from contact's beginning to its fullness stores the energy of full contact."""
    shape = spectrum(0.8, 100.0)
    at = LEAST_GAP + 0.025 * np.arange(shape.logarithm.size)
    inside = float(np.trapezoid(np.exp(shape.logarithm), at))
    # What is left below the table: between its first pressure and that of full contact.
    full = shape.slope / math.sqrt(2)
    assert inside < shape.energy < inside + LEAST_GAP * 3 * full
    assert inside == pytest.approx(shape.energy, rel=0.2)


def test_real_contact() -> None:
    full = CONTACT.modulus * CONTACT.rms_slope
    small = 1e-4 * full
    assert CONTACT.contact_ratio(small) == pytest.approx(math.sqrt(8 / math.pi) * small / full)
    assert CONTACT.contact_ratio(np.array([0.0, 3 * full])) == pytest.approx([0.0, 1.0], abs=1e-7)


def test_scales() -> None:
    """Heights scale the gap and the pressure, the modulus the pressure alone."""
    twice = replace(CONTACT, roughness=2 * CONTACT.roughness)
    assert twice.pressure(4e-6) == pytest.approx(2 * CONTACT.pressure(2e-6))
    stiffer = replace(CONTACT, modulus=3 * CONTACT.modulus)
    assert stiffer.pressure(2e-6) == pytest.approx(3 * float(CONTACT.pressure(2e-6)))
    assert CONTACT.rms_slope == pytest.approx(
        CONTACT.spectrum.slope * 2 * math.pi / 250e-6 * 1.1e-6
    )


def test_far_away_nothing_is_carried() -> None:
    assert CONTACT.pressure(13.3e-6) == 0.0


def test_compiled_code_has_the_same_law() -> None:
    compiled = CONTACT.compiled()
    for gap in np.linspace(0.06e-6, 13e-6, 200):
        # Hardly anything vibrates: the first harmonic is stiffness times amplitude.
        mean, first = asperity_mean(compiled, gap, 1e-11)
        assert mean == pytest.approx(float(CONTACT.pressure(gap)), rel=1e-4)
        around = [float(CONTACT.pressure(gap + step)) for step in (-1e-11, 1e-11)]
        assert first == pytest.approx((around[0] - around[1]) / 2, rel=1e-3)
    for u, a in ((2.0e-6, 1.2e-6), (6e-6, 5.5e-6), (20e-6, 19e-6), (60e-6, 59e-6)):
        mean, first = asperity_mean(compiled, u, a)
        turn = np.cos(2 * np.pi * np.arange(4096) / 4096)
        exact = np.asarray(CONTACT.pressure(u - a * turn))
        assert mean == pytest.approx(float(exact.mean()), rel=1e-6)
        assert first == pytest.approx(2 * float((exact * turn).mean()), rel=1e-6)


def test_what_is_refused() -> None:
    with pytest.raises(OutOfRangeError, match="nearly in full contact"):
        CONTACT.pressure(0.05e-6)
    with pytest.raises(InputError, match="longest must be"):
        RoughContact(longest_wavelength=1e-6)


def test_the_largest_pressure_is_that_of_the_least_gap() -> None:
    most = CONTACT.largest_pressure
    assert most == pytest.approx(float(CONTACT.pressure(LEAST_GAP * CONTACT.roughness)), rel=1e-9)


def test_the_scale_of_pressure_is_that_of_the_longest_wave() -> None:
    q0 = 2 * math.pi / CONTACT.longest_wavelength
    assert CONTACT.pressure_scale == pytest.approx(2e6 * q0 * 1.1e-6)
    assert CONTACT.least_gap == pytest.approx(LEAST_GAP * 1.1e-6)
    assert CONTACT.decay_length == pytest.approx(CONTACT.spectrum.decay * 1.1e-6)
    pressed = CONTACT.pressure(np.array([CONTACT.least_gap]))[0]
    assert pressed == pytest.approx(CONTACT.largest_pressure, rel=1e-6)
