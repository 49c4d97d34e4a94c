"""A pressed plate and the stress of its vibration against limits that are known."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.physics.plate.laminate import (
    bending_stress,
    pressed_deflection,
    pressed_disc_deflection,
)


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.2, 0.33])
def test_a_narrow_plate_is_a_beam(poisson_ratio: float) -> None:
    span, width, stiffness, force = 0.06, 1e-4, 20.0, 5.0
    beam = force * span**3 / (48 * stiffness * (1 - poisson_ratio**2) * width)
    found = pressed_deflection(force, span, width, stiffness, poisson_ratio)
    assert found == pytest.approx(beam, rel=2e-3)


def test_a_wide_plate_is_an_infinite_strip() -> None:
    """0.01695 F a²/D: Timoshenko and Woinowsky-Krieger, table of section 36."""
    found = pressed_deflection(1.0, 1.0, 30.0, 1.0, 0.3)
    assert found == pytest.approx(0.01695, rel=1e-3)
    # Its exact value, by the series of Nadai that converges to 7 ζ(3) / (16 π³).
    assert found == pytest.approx(7 * 1.2020569031595942 / (16 * np.pi**3), rel=1e-4)


def test_deflection_is_linear_and_falls_with_the_width_and_a_spread_force() -> None:
    args = 0.06, 0.05, 20.0, 0.3
    assert pressed_deflection(10.0, *args) == pytest.approx(2 * pressed_deflection(5.0, *args))
    widths = [pressed_deflection(5.0, 0.06, w, 20.0) for w in (0.005, 0.02, 0.05, 0.2)]
    assert np.all(np.diff(widths) < 0)
    assert pressed_deflection(5.0, *args, 0.02) < pressed_deflection(5.0, *args)


def test_the_moment_of_a_spread_force_on_a_beam() -> None:
    """A load over a length c of a beam: F (8 a³ − 4 a c² + c³)/(384 EI)."""
    a, c, width = 0.06, 0.03, 1e-4
    found = pressed_deflection(5.0, a, width, 20.0, 0.0, c)
    assert found == pytest.approx(
        5.0 * (8 * a**3 - 4 * a * c**2 + c**3) / (384 * 20.0 * width), rel=2e-3
    )


def test_a_pressed_disc_deflects_as_one_of_its_radius() -> None:
    """Simply supported, ν = 0.3: 0.0505 F r²/D."""
    assert pressed_disc_deflection(1.0, 1.0, 1.0, 0.3) == pytest.approx(0.0505, rel=2e-3)


def test_bending_stress_is_that_of_the_curvature() -> None:
    half, amplitude, z = 11e-3, 2e-6, 1.7e-3
    x = np.linspace(0, half, 20001)
    w = amplitude * np.cos(np.pi * x / half)
    curvature = np.gradient(np.gradient(w, x), x)[10:-10]
    strain = z * np.max(np.abs(curvature))
    assert bending_stress(amplitude, half, z, 68e9) == pytest.approx(68e9 * strain, rel=1e-4)
