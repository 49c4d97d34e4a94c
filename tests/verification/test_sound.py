"""Airborne sound against closed forms of baffled sources: piston, simple source, plane waves."""

import math

import numpy as np
import pytest
from scipy import special

from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.sound import (
    GUIDANCE,
    RadiatingSurface,
    exposure_guidance,
    loudest,
    pressure_level,
    ring_surface,
    smooth_surface,
    sound_field,
    sound_pressure,
)

RHO, C = 1.204, 343.2
F = 33e3
K = 2 * math.pi * F / C


def piston(radius: float, points: int = 200, velocity: complex = 0.4) -> object:
    r = np.linspace(0, radius, points)
    return ring_surface(r, np.full(points, velocity), 0, F)


def test_piston_on_its_axis() -> None:
    """|p| = 2 ρ c v |sin(k (√(R² + a²) − R)/2)| (Kinsler, eq 7.4.5), near field and far."""
    a, v = 20e-3, 0.4
    height = np.array([3e-3, 10e-3, 33e-3, 0.1, 0.3, 1.0])
    points = np.stack([0 * height, 0 * height, height], axis=-1)
    exact = 2 * RHO * C * v * np.abs(np.sin(K / 2 * (np.hypot(height, a) - height)))
    got = np.abs(sound_pressure(piston(a), points))
    assert got == pytest.approx(exact, rel=1e-3, abs=1e-3 * RHO * C * v)


def test_error_of_the_radial_rule_is_of_second_order() -> None:
    a, height = 20e-3, 0.05
    exact = 2 * RHO * C * 0.4 * abs(math.sin(K / 2 * (math.hypot(height, a) - height)))
    errors = [
        abs(abs(sound_pressure(piston(a, n), np.array([0, 0, height]))) / exact - 1)
        for n in (17, 33, 65)
    ]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.2)
    assert math.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.2)


def test_piston_in_the_far_field() -> None:
    """p = ρ f v π a²/R × 2 J1(ka sin θ)/(ka sin θ) (Kinsler, eq 7.4.17)."""
    a, v, distance = 15e-3, 0.4, 300.0
    theta = np.radians([1e-3, 10, 17, 30, 50, 80])
    points = distance * np.stack([np.sin(theta), 0 * theta, np.cos(theta)], axis=-1)
    x = K * a * np.sin(theta)
    exact = RHO * F * v * math.pi * a**2 / distance * 2 * special.j1(x) / x
    got = np.abs(sound_pressure(piston(a), points))
    assert got == pytest.approx(np.abs(exact), rel=2e-3)


def test_simple_source() -> None:
    """Much smaller than a wave: p = ρ f Q/R for a baffled volume velocity Q, any direction."""
    small = ring_surface(np.linspace(0, 0.2e-3, 9), np.full(9, 0.5), 0, F)
    field = sound_field(small)
    volume = 0.5 * math.pi * 0.2e-3**2
    exact = [20 * math.log10(RHO * F * volume / r / math.sqrt(2) / 20e-6) for r in field.distances]
    assert field.sound_pressure_level_dB == pytest.approx(exact, abs=0.01)
    # Phase: i ρ f Q exp(−ikR)/R.
    p = sound_pressure(small, np.array([0, 0, 0.5]))
    assert p == pytest.approx(1j * RHO * F * volume / 0.5 * np.exp(-1j * K * 0.5), rel=1e-3)


@pytest.mark.slow
def test_a_supersonic_wave_on_a_plate_radiates_at_its_coincidence_angle() -> None:
    """A standing wave cos k_B x beams to sin θ = k_B/k; a subsonic one hardly radiates."""

    def standing(wave: float) -> RadiatingSurface:
        def moving(x: np.ndarray, y: np.ndarray) -> np.ndarray:
            return np.cos(2 * math.pi * (x - 0.11) / wave)[:, None] * np.ones(y.size)

        return smooth_surface((0.22, 0.06), moving, F, wave)

    wave = 22e-3
    loud = loudest(standing(wave), 30.0)
    assert math.sin(loud.polar) == pytest.approx(2 * math.pi / wave / K, abs=0.02)
    assert math.sin(loud.azimuth) == pytest.approx(0, abs=1e-2)
    quiet = loudest(standing(8e-3), 30.0)
    assert quiet.level_dB < loud.level_dB - 15


def test_rectangle_and_ring_agree_on_a_disc_mode() -> None:
    """The same velocity field, v = cos 2θ (r/a)², on both grids."""
    a = 25e-3
    line = np.linspace(-a, a, 301)
    X, Y = np.meshgrid(line, line, indexing="ij")
    inside = np.hypot(X, Y) <= a
    velocity = np.where(inside, (X**2 - Y**2) / a**2, 0).ravel()
    places = np.stack([X.ravel(), Y.ravel()], axis=1)
    square = RadiatingSurface(F, places, np.full(X.size, (line[1] - line[0]) ** 2), velocity + 0j)
    r = np.linspace(0, a, 80)
    ring = ring_surface(r, (r / a) ** 2, 2, F)
    points = np.array([[0.1, 0.0, 0.3], [0.2, 0.05, 0.2], [0.0, 0.3, 0.4]])
    assert np.abs(sound_pressure(square, points)) == pytest.approx(
        np.abs(sound_pressure(ring, points)), rel=2e-2
    )


@pytest.mark.slow
def test_the_papers_plate_is_loud() -> None:
    """83 × 49 mm, 2 µm, 33 kHz in (8,0): 127 dB at 0.5 m in a lobe near 30°."""
    kl = 7.5 * math.pi  # free–free beam: the root of cosh kl cos kl = 1 to nine digits
    ratio = (math.cosh(kl) - math.cos(kl)) / (math.sinh(kl) - math.sin(kl))

    def beam(x: np.ndarray) -> np.ndarray:
        u = kl * x / 83e-3
        return np.cosh(u) + np.cos(u) - ratio * (np.sinh(u) + np.sin(u))

    middle = abs(beam(np.linspace(36.5e-3, 46.5e-3, 201))).max()  # 2 µm at the middle antinode
    rate = 2j * math.pi * F * 2e-6 / middle
    surface = smooth_surface(
        (83e-3, 49e-3), lambda x, y: rate * beam(x)[:, None] * np.ones(y.size), F, 22e-3
    )
    loud = loudest(surface, 0.5)
    assert loud.level_dB == pytest.approx(126.9, abs=0.3)
    assert math.degrees(loud.polar) == pytest.approx(29, abs=1)


def test_level_of_a_known_pressure() -> None:
    assert pressure_level(np.array([math.sqrt(2) + 0j])) == pytest.approx(93.9794, abs=1e-4)


def test_guidance_is_labelled() -> None:
    guidance = exposure_guidance(33e3)
    assert guidance is not None
    assert guidance.level_dB == 100
    assert all("to be checked" in entry.evidence for entry in GUIDANCE)
    assert exposure_guidance(1e6) is None
    # A band has its lower end, and the next one its upper end.
    ends = {17.7999e3: None, 17.8e3: 70, 22.3999e3: 70, 22.4e3: 100, 111.9e3: 100, 112e3: None}
    for frequency, level in ends.items():
        found = exposure_guidance(frequency)
        assert (found and found.level_dB) == level
    assert exposure_guidance(20e3).level_dB == 70  # type: ignore[union-attr]


def test_bad_surfaces_are_refused() -> None:
    x = np.linspace(0, 0.08, 9)
    with pytest.raises(InputError, match="quarter of the wave"):
        ring_surface(x, np.ones(9), 0, F)
    with pytest.raises(InputError, match="shape"):
        smooth_surface((0.01, 0.01), lambda x, y: np.ones((9, 8)), F, 0.01)
    with pytest.raises(InputError, match="distance = 10 mm"):
        sound_field(piston(0.02), (0.01,))
    with pytest.raises(InputError, match="height"):
        sound_pressure(piston(0.02), np.array([0.0, 0.0, -0.1]))
