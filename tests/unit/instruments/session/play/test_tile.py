"""Textures as tiles: what is on them, and which cannot be."""

from __future__ import annotations

import numpy as np
import pytest
from tests.friction_tables import inverse_over_speeds

from squeezefilm.core.errors import InputError, UnreachableError
from squeezefilm.core.quantities import FloatArray
from squeezefilm.instruments.device.machine.playing import Tile
from squeezefilm.instruments.device.wire.messages import LONGEST_TILE
from squeezefilm.instruments.session.play.plan import TextureTile, tile_of
from squeezefilm.physics.contact.finger.fingertip import EXPLORING_SPEED
from squeezefilm.physics.render.program.inverse import FrictionInverse
from squeezefilm.physics.render.program.lowering import Program, lower
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.render.texture.image import NoiseField
from squeezefilm.physics.render.texture.levels import Amplitude, RelativeFriction
from squeezefilm.physics.render.texture.pattern import AlongDirection, Pattern
from squeezefilm.physics.render.texture.shapes import (
    Bump,
    Decay,
    Periodic,
    SineWave,
    SpeedGate,
    SquareWave,
)

WAY = (0.0, 5e-3)


def _law(amplitude: FloatArray, speed: FloatArray) -> FloatArray:
    """Friction that a faster finger keeps more of; speeds may stand in rows."""
    return np.asarray(np.exp(-amplitude / (1e-6 + 10e-6 * speed)))


def _tile(program: Program, way: tuple[float, float]) -> TextureTile:
    return tile_of(program, way, EXPLORING_SPEED, _law)


def _program(texture: Composable) -> Program:
    return lower(texture, largest_amplitude=1e-6)


def test_a_tile_holds_the_textures_own_amplitudes() -> None:
    sine = Amplitude(SineWave(4e-3), 0.0, 1e-6)
    tile = _tile(_program(sine), (-2e-3, 18e-3))
    assert tile.pitch == pytest.approx(40e-6)
    x = tile.origin + tile.pitch * np.arange(tile.amplitude.size)
    np.testing.assert_allclose(tile.amplitude, sine(x, 0.0, 0.0, 0.0), atol=1e-18)


def test_a_device_reads_from_it_what_the_texture_wants() -> None:
    square = Amplitude(SquareWave(2e-3), 0.1e-6, 0.8e-6)
    tile = _tile(_program(square), (0.0, 10e-3))
    volts = tile.amplitude / 1e-8
    device = Tile(0, 20, volts.size, [round(v * 1e6) for v in volts])
    for x in range(0, 10_000, 20):
        wanted = float(square(x * 1e-6 + 1e-9, 0.0, 0.0, 0.0))
        assert device.level(x) == pytest.approx(wanted * 1e14, rel=1e-9)


@pytest.mark.parametrize(
    ("pattern", "words"),
    [
        (SquareWave(2e-3, along=AlongDirection(0.3)), "depend on y,"),
        (NoiseField(1e-3, 7), "depend on y,"),
        (Periodic(5.0), "depend on time,"),
        (SpeedGate(above=0.01), "depend on speed,"),
        (Bump(0.01, 2e-3), "depend on direction,"),
        (SineWave(2e-3).scaled_by_speed(0.1) * Decay(0.1), "depend on speed, time,"),
    ],
)
def test_what_is_not_steady_along_x_is_refused(pattern: Pattern, words: str) -> None:
    with pytest.raises(InputError, match=words):
        _tile(_program(Amplitude(pattern, 0.0, 1e-6)), WAY)


@pytest.mark.parametrize(
    "way", [(0.0, 0.1), (0.0204, 0.0306), (-0.05, 0.05), (0.01, 0.010001), (1e-3, 1.51e-3)]
)
def test_a_tile_covers_the_way_as_finely_as_it_can(way: tuple[float, float]) -> None:
    first, last = way
    tile = _tile(_program(Amplitude(SquareWave(2e-3), 0.0, 1e-6)), way)
    origin, pitch, size = tile.origin, tile.pitch, tile.amplitude.size
    for length in (origin, pitch):
        assert length * 1e6 == pytest.approx(round(length * 1e6))
    assert first - 1e-6 < origin <= first + 1e-12
    assert 2 <= size <= LONGEST_TILE
    # Up to the last micrometre, and no finer pitch would reach it.
    assert last - 1e-6 <= origin + (size - 1) * pitch + 1e-12
    assert origin + (size - 2) * pitch < last + 1e-9
    assert pitch <= 1.001e-6 or (LONGEST_TILE - 1) * (pitch - 1e-6) < last - first


@pytest.mark.parametrize("way", [(0.1, 0.0), (0.02, 0.02)])
def test_a_way_to_nowhere_has_no_tile(way: tuple[float, float]) -> None:
    with pytest.raises(InputError, match="covers nothing"):
        _tile(_program(Amplitude(SquareWave(2e-3), 0.0, 1e-6)), way)


def _inverse() -> FrictionInverse:
    return inverse_over_speeds(
        lambda a, v: _law(a, v[:, None]), 4e-6 * np.linspace(0, 1, 257), np.geomspace(1e-3, 2, 200),
        0.08,
    )  # fmt: skip


def test_a_tile_of_friction_is_made_for_one_speed_and_says_what_others_cost() -> None:
    texture = RelativeFriction(SineWave(4e-3), 0.5, 0.9)
    program = lower(texture, inverse=_inverse())
    assert program.wanted_depends_on == {"x"}
    for speed in (0.04, 0.16):
        tile = tile_of(program, WAY, speed, _law)
        places = tile.pitch * np.arange(tile.amplitude.size)
        met = _law(tile.amplitude, np.full(places.size, speed))
        np.testing.assert_allclose(met, texture(places, 0.0, speed, 0.0), atol=1e-3)
        made = tile.made_for
        assert made.speed == speed
        least = np.max(tile.amplitude)
        for error, pace in ((made.error_at_half, speed / 2), (made.error_at_double, 2 * speed)):
            assert error == pytest.approx(float(_law(least, pace) - _law(least, speed)), rel=0.05)
    with pytest.raises(InputError, match="speed"):
        tile_of(program, WAY, 0.0, _law)


def test_a_texture_that_asks_for_the_speed_is_no_tile_even_where_friction_does_too() -> None:
    gated = RelativeFriction(SpeedGate(above=0.01), 0.5, 0.9)
    with pytest.raises(InputError, match="depend on speed,"):
        _tile(lower(gated, inverse=_inverse()), WAY)


def test_a_texture_out_of_reach_makes_no_tile() -> None:
    with pytest.raises(UnreachableError, match=r"at (50\d) of \1"):
        _tile(_program(Amplitude.constant(2e-6)), WAY)
