"""Sound of small sources: areas, sums, levels over all directions, and the guidance's bands."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.solid.working import SolidMode
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

F = 30e3
WAVE = 343.2 / F


def points(places: list[tuple[float, float]], velocity: list[complex]) -> RadiatingSurface:
    """Small pistons of 1 mm² each."""
    return RadiatingSurface(
        F, np.array(places), np.full(len(places), 1e-6), np.array(velocity, dtype=complex)
    )


@pytest.mark.parametrize(
    ("frequency", "audience", "level"),
    [
        (17.7e3, "public", None),
        (17.8e3, "public", 70.0),
        (22.3e3, "public", 70.0),
        (22.4e3, "public", 100.0),
        (111e3, "public", 100.0),
        (112e3, "public", None),
        (17.7e3, "occupational", None),
        (22.3e3, "occupational", 75.0),
        (22.4e3, "occupational", 110.0),
        (55e3, "occupational", 110.0),
        (56e3, "occupational", None),
    ],
)
def test_a_tone_is_compared_with_the_band_that_it_lies_in(
    frequency: float, audience: str, level: float | None
) -> None:
    found = exposure_guidance(frequency, audience)  # type: ignore[arg-type]
    assert (None if found is None else found.level_dB) == level


def test_bands_are_third_octaves_that_meet_and_name_their_source() -> None:
    public = [one for one in GUIDANCE if one.audience == "public"]
    assert public[0].high == public[1].low
    assert all(one.source and one.evidence and one.low < one.high for one in GUIDANCE)


@pytest.mark.parametrize("inner", [0.0, 2e-3])
def test_a_rings_weights_make_its_area_and_its_harmonics_cancel(inner: float) -> None:
    radius = np.array([inner, 2.5e-3, 3.5e-3, 5e-3])
    # ∫ r · r dr dθ over the ring, for a velocity that is linear in r.
    found = ring_surface(radius, radius, 0, F)
    assert found.area.sum() == pytest.approx(math.pi * (25e-6 - inner**2))
    assert (found.velocity @ found.area).real == pytest.approx(
        2 * math.pi / 3 * (125e-9 - inner**3)
    )
    for harmonic in (1, 3, 5):
        wavy = ring_surface(radius, np.ones(4), harmonic, F)
        assert abs(wavy.velocity @ wavy.area) < 1e-18
        angle = np.arctan2(wavy.position[:, 1], wavy.position[:, 0])
        away = np.hypot(*wavy.position.T) > 0
        assert wavy.velocity[away].real == pytest.approx(np.cos(harmonic * angle[away]), abs=1e-9)
    assert found.extent == pytest.approx(5e-3)


def test_a_ring_has_points_enough_around_for_its_waves_and_its_harmonic() -> None:
    small = ring_surface(np.array([1e-3, 2e-3]), np.ones(2), 0, F)
    assert small.area.size == 2 * 32
    wavy = ring_surface(np.array([1e-3, 2e-3]), np.ones(2), 9, F)
    assert wavy.area.size == 2 * 72
    # 2π · 40 mm are 21.97 waves of 11.44 mm.
    radius = np.linspace(38e-3, 40e-3, 2)
    assert ring_surface(radius, np.ones(2), 0, F).area.size == 2 * 8 * 22


def test_pressure_is_the_sum_of_what_each_point_sends() -> None:
    places = [(0.0, 0.0), (4e-3, -1e-3), (-3e-3, 2e-3)]
    velocity = [0.3, -0.2j, 0.1 + 0.4j]
    field = np.array([[[0.1, 0.0, 0.2], [0.0, -0.05, 0.3]]])
    expected = np.zeros((1, 2), dtype=complex)
    for i in range(2):
        for (x, y), v in zip(places, velocity, strict=True):
            far = math.dist((x, y, 0.0), field[0, i])
            wave = np.exp(-2j * math.pi * far / WAVE)
            expected[0, i] += 1j * F * 1.204 * v * 1e-6 * wave / far
    found = sound_pressure(points(places, velocity), field)
    assert found.shape == (1, 2)
    assert found == pytest.approx(expected, rel=1e-9)


def test_what_no_sound_can_be_computed_of_is_refused() -> None:
    one = points([(0.0, 0.0)], [1.0])
    with pytest.raises(InputError, match="last axis must be x, y and z"):
        sound_pressure(one, np.zeros((3, 2)))
    with pytest.raises(InputError, match="height of the point"):
        sound_pressure(one, np.array([0.1, 0.0, -1e-9]))
    with pytest.raises(InputError, match="distance"):
        sound_pressure(one, np.zeros(3))
    with pytest.raises(InputError, match="name at least one") as caught:
        sound_field(one, ())
    assert caught.value.quantity == "distances"
    for radius, velocity, said in (
        (np.array([1e-3]), np.ones(1), "at least 2"),
        (np.array([1e-3, 1e-3]), np.ones(2), "must rise"),
        (np.array([1e-3, 2e-3]), np.ones(3), "equal length"),
    ):
        with pytest.raises(InputError, match=said):
            ring_surface(radius, velocity, 0, F)


def test_steps_may_be_a_quarter_of_the_wave_and_no_more() -> None:
    for share, fine in ((0.999, True), (1.001, False)):
        line = np.array([0.0, share * WAVE / 4])
        if fine:
            ring_surface(line, np.ones(2), 0, F)
        else:
            with pytest.raises(InputError, match="a quarter of the wave"):
                ring_surface(line, np.ones(2), 0, F)


def test_levels_are_of_the_effective_pressure_and_silence_has_one() -> None:
    level = pressure_level(np.array([math.sqrt(2) * 20e-6, 0.0]))
    assert level[0] == pytest.approx(0.0, abs=1e-9)
    assert np.isfinite(level[1])
    assert level[1] < -400


def test_two_points_in_step_beam_upward_and_in_turn_along_the_line_between_them() -> None:
    # Half a wave apart: in phase they add straight up, and in opposite phase along x.
    places = [(-WAVE / 4, 0.0), (WAVE / 4, 0.0)]
    up, along = (loudest(points(places, [1.0, side]), 2.0) for side in (1.0, -1.0))
    assert up.polar == pytest.approx(0.0, abs=2e-3)
    assert along.polar == pytest.approx(math.pi / 2, abs=1e-3)
    assert math.sin(along.azimuth) == pytest.approx(0.0, abs=1e-2)
    single = 20 * math.log10(1.204 * F * 1e-6 / 2.0 / math.sqrt(2) / 20e-6)
    for loud in (up, along):
        assert loud.level_dB == pytest.approx(single + 6.0206, abs=0.01)
    field = sound_field(points(places, [1.0, 1.0]), (1.0, 2.0))
    assert field.sound_pressure_level_dB[1] == up.level_dB
    # 6 dB from 1 m to 2 m.
    assert np.diff(field.sound_pressure_level_dB)[0] == pytest.approx(-6.0206, abs=0.01)
    assert field.guidance is GUIDANCE[1]


def test_no_narrow_lobe_is_missed() -> None:
    # Forty waves apart they beam by a fortieth of a radian, straight up among others.
    wide = loudest(points([(20 * WAVE, 0.0), (-20 * WAVE, 0.0)], [1.0, 1.0]), 200.0)
    single = 20 * math.log10(1.204 * F * 1e-6 / 200.0 / math.sqrt(2) / 20e-6)
    assert wide.level_dB == pytest.approx(single + 6.0206, abs=0.01)


def test_few_points_of_a_smooth_surface_do_what_many_of_a_grid_do() -> None:
    """Of a free plate's flexural wave along x, whose shape is known everywhere."""
    sides, wave = (0.11, 0.03), 0.018

    def velocity(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        along = np.cos(2 * np.pi * x / wave + 0.4) + np.exp(-2 * np.pi * x / wave)
        return along[:, None] * (1 + 0.1j - 4 * (y / sides[1] - 0.5) ** 2)

    few = smooth_surface(sides, velocity, F, wave)
    x, y = (np.linspace(0, side, round(side / 2e-4) + 1) for side in sides)
    middles = [(line[1:] + line[:-1]) / 2 for line in (x, y)]
    grid = np.stack(np.meshgrid(*middles, indexing="ij"), axis=-1).reshape(-1, 2)
    cell = (x[1] - x[0]) * (y[1] - y[0])
    many = RadiatingSurface(
        F, grid - np.array(sides) / 2, np.full(len(grid), cell), velocity(*middles).ravel()
    )
    assert few.area.sum() == pytest.approx(math.prod(sides), rel=1e-12)
    assert few.area.size < many.area.size / 50
    up = np.linspace(0.0, math.pi / 2, 40)
    for distance in (0.1, 0.5):
        places = distance * np.stack([np.sin(up), np.zeros(40), np.cos(up)], axis=-1)
        here, there = sound_pressure(few, places), sound_pressure(many, places)
        assert np.abs(here - there).max() < 2e-3 * np.abs(there).max()
    with pytest.raises(InputError, match="for these lines"):
        smooth_surface(sides, lambda x, y: velocity(x, y).T, F, wave)
    with pytest.raises(InputError, match=r"wave = 30 pm .*at least 220 µm"):
        smooth_surface(sides, velocity, F, 3e-11)


def test_a_solved_face_sounds_as_it_moves_at_its_resonance() -> None:
    """Of a plate that moves as a known wave, at the second of two frequencies."""

    def motion(at: int, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        wave = np.outer(np.cos(4 * np.pi * x / 60e-3), 1 + 0 * y)
        return (1e-9, -20e-9j)[at] * wave

    solved: Any = SimpleNamespace(
        modes=SimpleNamespace(plate=SimpleNamespace(extent=(60e-3, 30e-3))),
        response=SimpleNamespace(motion=motion), resonance=1, half_wavelength=15e-3,
    )  # fmt: skip
    found, louder = (SolidMode.radiating(solved, volts, F) for volts in (15.0, 30.0))
    x, y = found.position.T + np.array([[30e-3], [15e-3]])
    velocity = 2j * np.pi * F * 15 * -20e-9j * np.cos(4 * np.pi * x / 60e-3)
    assert found.velocity == pytest.approx(velocity)
    assert (found.frequency, found.area.sum()) == (F, pytest.approx(60e-3 * 30e-3))
    assert y.min() > 0
    assert y.max() < 30e-3
    # Twice the voltage is 6 dB.
    levels = [loudest(surface, 0.5).level_dB for surface in (found, louder)]
    assert levels[1] == pytest.approx(levels[0] + 20 * np.log10(2), abs=1e-6)
