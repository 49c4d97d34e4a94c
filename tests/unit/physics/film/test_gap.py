"""The paper's gap: what oscillates, what closes, what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from squeezefilm.core.errors import InputError
from squeezefilm.physics.film.gap import PaperGap, film_thickness

micrometres = st.floats(1e-8, 1e-4)
GAP = PaperGap(0.6e-6, 2e-6, 50e-6, 350e-6, 18.7e-3, 10e-3)


@given(micrometres, micrometres, micrometres, st.floats(-0.01, 0.01), st.floats(0, 1))
def test_corrected_gap_never_closes_below_the_roughness(h_r, h_vib, h_e, x, cycle) -> None:
    h = film_thickness(x, cycle / 4e4, 4e4, h_r, h_vib, h_e, 350e-6, 18.7e-3)
    assert h >= h_r * (1 - 1e-9)
    assert h <= (h_r + 2 * h_vib + 2 * h_e) * (1 + 1e-9)


def test_the_roughness_does_not_oscillate() -> None:
    # At an antinode and, half a wave on, a ridge crest: λ = 2 L puts both at x = L/2 … 3L/2.
    crest, half_cycle = 350e-6, 0.5 / 4e4
    arguments = (4e4, 0.6e-6, 2e-6, 50e-6, 700e-6, 350e-6)
    assert film_thickness(crest, half_cycle, *arguments) == pytest.approx(0.6e-6)
    quiet = (4e4, 0.6e-6, 0.0, 50e-6, 350e-6, 18.7e-3)
    times = np.linspace(0, 1 / 4e4, 9)
    assert np.ptp(film_thickness(0.0, times, *quiet)) == 0


def test_gap_is_its_dimensionless_numbers() -> None:
    # Paper eq 2: h = H0 (1 + ε cos T cos k1X + δ cos k2X).
    x, t, f = np.linspace(-5e-3, 5e-3, 11), 3e-6, 40.5e3
    h = film_thickness(x, t, f, 0.6e-6, 2e-6, 50e-6, 350e-6, 18.7e-3)
    X, T = x / GAP.contact_length, 2 * np.pi * f * t
    H = (
        1
        + GAP.amplitude_ratio * np.cos(T) * np.cos(GAP.wave_number * X)
        + GAP.ridge_ratio * np.cos(GAP.ridge_number * X)
    )
    np.testing.assert_allclose(GAP.reference_thickness * H, h, rtol=1e-12)
    assert GAP.amplitude_ratio_printed + GAP.ridge_ratio == pytest.approx(1)


def test_amplitude_broadcasts_through_the_properties() -> None:
    many = GAP.with_amplitude(np.array([0.0, 2e-6]))
    np.testing.assert_allclose(many.amplitude_ratio, [0, GAP.amplitude_ratio])
    np.testing.assert_allclose(many.crest_thickness, [0.6e-6, 2.6e-6])


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("roughness", 0.0, "roughness = 0 m"),
        ("vibration_amplitude", -1e-6, "vibration_amplitude = -1 µm"),
        ("vibration_amplitude", np.array([1e-6, np.nan]), "nan"),
        ("vibration_amplitude", np.ones((2, 2)) * 1e-6, "2 dimensions"),
        ("wavelength", float("inf"), "wavelength = inf"),
    ],
)
def test_refuses_what_is_no_gap(field, value, message) -> None:
    fields = {
        "roughness": 0.6e-6, "vibration_amplitude": 2e-6, "ridge_amplitude": 50e-6,
        "ridge_period": 350e-6, "wavelength": 18.7e-3, "contact_length": 10e-3,
    }  # fmt: skip
    with pytest.raises(InputError, match=message):
        PaperGap(**(fields | {field: value}))
