"""Textures as tiles: what is on them, and which cannot be."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, UnreachableError
from squeezefilm.core.quantities import FloatArray
from squeezefilm.instruments.device.machine.playing import Tile
from squeezefilm.instruments.session.loop.plan import LinearDrive
from squeezefilm.instruments.session.play.plan import tile_of
from squeezefilm.physics.render.program.inverse import FrictionInverse
from squeezefilm.physics.render.program.lowering import Program, lower
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.render.texture.coordinate import AlongDirection
from squeezefilm.physics.render.texture.gates import Decay, Periodic, SpeedGate
from squeezefilm.physics.render.texture.levels import Amplitude, RelativeFriction
from squeezefilm.physics.render.texture.noise import NoiseField
from squeezefilm.physics.render.texture.pattern import Pattern
from squeezefilm.physics.render.texture.shapes import Bump, SineWave, SquareWave


def _program(texture: Composable) -> Program:
    return lower(texture, largest_amplitude=1e-6)


def test_a_tile_holds_the_textures_own_amplitudes() -> None:
    sine = Amplitude(SineWave(4e-3), 0.0, 1e-6)
    tile = tile_of(_program(sine), -2e-3, 50e-6, 401)
    x = -2e-3 + 50e-6 * np.arange(401)
    np.testing.assert_allclose(tile.amplitude, sine(x, 0.0, 0.0, 0.0), atol=1e-18)


def test_a_device_reads_from_it_what_the_texture_wants() -> None:
    square = Amplitude(SquareWave(2e-3), 0.1e-6, 0.8e-6)
    tile = tile_of(_program(square), 0.0, 20e-6, 512)
    volts = tile.voltage(LinearDrive(1e-8, 100.0))
    device = Tile(0, 20, 512, [round(v * 1e6) for v in volts])
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
        tile_of(_program(Amplitude(pattern, 0.0, 1e-6)), 0.0, 50e-6, 100)


def test_the_devices_units_and_size_are_kept() -> None:
    program = _program(Amplitude(SquareWave(2e-3), 0.0, 1e-6))
    with pytest.raises(InputError, match="2 to 512"):
        tile_of(program, 0.0, 50e-6, 513)
    with pytest.raises(InputError, match="whole number of micrometres"):
        tile_of(program, 0.0, 50.5e-6, 100)
    with pytest.raises(InputError, match="pitch"):
        tile_of(program, 0.0, 0.0, 100)
    with pytest.raises(InputError, match="amplitude"):
        tile_of(program, 0.0, 50e-6, 100).voltage(LinearDrive(1e-8, 10.0))


def _law(amplitude: FloatArray, speed: FloatArray) -> FloatArray:
    """Friction that a faster finger keeps more of; speeds may stand in rows."""
    return np.asarray(np.exp(-amplitude / (1e-6 + 10e-6 * speed)))


def _inverse() -> FrictionInverse:
    return FrictionInverse.over_speeds(
        lambda a, v: _law(a, v[:, None]), 4e-6 * np.linspace(0, 1, 257), np.geomspace(1e-3, 2, 200),
        0.08,
    )  # fmt: skip


def test_a_tile_of_friction_is_made_for_one_speed_and_says_what_others_cost() -> None:
    texture = RelativeFriction(SineWave(4e-3), 0.5, 0.9)
    program = lower(texture, inverse=_inverse())
    assert program.wanted_depends_on == {"x"}
    for speed in (0.04, 0.16):
        tile = tile_of(program, 0.0, 50e-6, 201, speed=speed, law=_law)
        places = 50e-6 * np.arange(201)
        met = _law(tile.amplitude, np.full(201, speed))
        np.testing.assert_allclose(met, texture(places, 0.0, speed, 0.0), atol=1e-3)
        made = tile.made_for
        assert made is not None
        assert made.speed == speed
        least = np.max(tile.amplitude)
        for error, pace in ((made.error_at_half, speed / 2), (made.error_at_double, 2 * speed)):
            assert error == pytest.approx(float(_law(least, pace) - _law(least, speed)), rel=0.05)
    assert tile_of(program, 0.0, 50e-6, 201).made_for is None
    with pytest.raises(InputError, match="speed"):
        tile_of(program, 0.0, 50e-6, 201, speed=0.0)


def test_a_texture_that_asks_for_the_speed_is_no_tile_even_where_friction_does_too() -> None:
    gated = RelativeFriction(SpeedGate(above=0.01), 0.5, 0.9)
    with pytest.raises(InputError, match="depend on speed,"):
        tile_of(lower(gated, inverse=_inverse()), 0.0, 50e-6, 100)


def test_a_texture_out_of_reach_makes_no_tile() -> None:
    with pytest.raises(UnreachableError, match="100 of 100"):
        tile_of(_program(Amplitude.constant(2e-6)), 0.0, 50e-6, 100)
