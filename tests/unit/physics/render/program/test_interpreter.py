"""Every instruction: what a texture says in numpy, the compiled interpreter says of its program.

Places lie on and beside every edge that a pattern has; hypothesis asks at random, elsewhere.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.numpy_textures import numpy_values

from squeezefilm.physics.render.program.inverse import FrictionInverse
from squeezefilm.physics.render.program.lowering import Program, lower
from squeezefilm.physics.render.program.renderer import Renderer, evaluate
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.render.texture.image import Image, Noise, NoiseField
from squeezefilm.physics.render.texture.levels import Amplitude, FrictionReduction, RelativeFriction
from squeezefilm.physics.render.texture.pattern import AlongDirection, AlongY, FromPoint, Pattern
from squeezefilm.physics.render.texture.shapes import (
    Attack,
    Band,
    Bump,
    Constant,
    Decay,
    Periodic,
    Pulse,
    Ramp,
    SineWave,
    SpeedGate,
    SquareWave,
)

INVERSE = FrictionInverse.from_function(lambda a: 1 - 0.5 * a / 4e-6, 4e-6)
# Quarters of a millimetre and places off them, speeds both ways, and times.
X = np.concatenate([np.arange(-24, 49) * 0.25e-3, np.linspace(-5.3e-3, 11.7e-3, 31)])
Y = np.roll(X, 17)
V = np.where(np.arange(X.size) % 3 == 0, -0.05, 0.02 + 1e-3 * np.arange(X.size))
T = np.linspace(0.0, 3.0, X.size)
PICTURE = ((0.1, 0.9, 0.4), (0.7, 0.2, 1.0))
DIAGONAL = AlongDirection(0.7)
MILD = Amplitude.constant(0.8e-6)


@pytest.mark.parametrize(
    "pattern",
    [
        Constant(0.3),
        SquareWave(2e-3, 0.25, 0.4),
        SquareWave(2e-3, 0.25, -1.0, AlongY()),
        SineWave(3e-3, 0.6, DIAGONAL),
        Pulse(1e-3, 2e-3, along=DIAGONAL),
        Pulse(1e-3, 2e-3, "raised_cosine", FromPoint(1e-3, 2e-3)),
        Ramp(-1e-3, 3e-3),
        Ramp(3e-3, -1e-3, "smooth", AlongY()),
        Band(-1e-3, 2e-3),
        Band(-1e-3, 2e-3, 0.5e-3, DIAGONAL),
        Band.disc(1e-3, -1e-3, 2e-3),
        Band.disc(1e-3, -1e-3, 2e-3, 1e-3),
        Bump(1e-3, 1e-3),
        Bump(1e-3, 1e-3, "hole", AlongY()),
        Noise(0.7e-3, 12345),
        Noise(0.7e-3, 5, along=FromPoint()),
        NoiseField(0.7e-3, 77),
        *[
            Image(PICTURE, 1e-3, -0.5e-3, 0.25e-3, outside)  # type: ignore[arg-type]
            for outside in ("hold", "repeat", "zero")
        ],
        Attack(1.5, 0.5),
        Decay(0.4, 1.0),
        Periodic(1.7, "sine", phase=0.3),
        Periodic(1.7, duty=0.3, phase=-0.3),
        SpeedGate(above=0.04),
        SpeedGate(above=0.03, below=0.07),
        SquareWave(2e-3, 0.3).scaled_by_speed(0.05, slowest=0.03, fastest=0.08),
        ~SquareWave(2e-3),
        SquareWave(2e-3) * Ramp(0.0, 4e-3),
        SquareWave(2e-3) & SineWave(3e-3),
        SquareWave(2e-3) | SineWave(3e-3),
    ],
    ids=lambda one: type(one).__name__,
)
def test_patterns_are_lowered_as_they_are_called(pattern: Pattern) -> None:
    wanted = numpy_values(pattern, X, Y, V, T)
    texture = Amplitude(pattern, 0.0, 1e-6)
    program = lower(texture, largest_amplitude=1e-6)
    assert evaluate(program, X, Y, V, T) == pytest.approx(1e-6 * wanted, rel=1e-9, abs=1e-17)
    assert evaluate(program, X.reshape(8, 13), 0.0, 0.1, 0.0).shape == (8, 13)


def test_a_picture_is_zero_outside_and_its_frame_belongs_to_it() -> None:
    program = lower(
        Amplitude(Image(((0.5, 0.5),), 1e-3, outside="zero"), 0.0, 1e-6), largest_amplitude=1e-6
    )
    x = np.array([-1e-9, 0.0, 1e-3, 2e-3, 2e-3 + 1e-9, 1e-3, 1e-3, 1e-3])
    y = np.array([0.5e-3] * 5 + [-1e-9, 1e-3, 1e-3 + 1e-9])
    assert evaluate(program, x, y, 0.1, 0.0) * 2e6 == pytest.approx([0, 1, 1, 1, 0, 0, 1, 0])


def played(program: Program) -> np.ndarray:
    """The amplitude at each sample by itself."""
    return np.array([Renderer(program).tick(*one) for one in zip(X, Y, V, T, strict=True)])


@pytest.mark.parametrize(
    "texture",
    [
        Amplitude(SquareWave(2e-3, 0.3, 0.7), 0.2e-6, 0.9e-6),
        Amplitude(SineWave(2e-3, 0.7), 0.2e-6, 0.9e-6),
        Amplitude(SquareWave(2e-3), 0.1e-6, 0.6e-6) + Amplitude(SineWave(3e-3), 0.0, 0.3e-6),
        Amplitude(SquareWave(2e-3), 0.1e-6, 0.6e-6) * 0.7,
        Amplitude(SquareWave(2e-3), 0.1e-6, 0.6e-6) * SineWave(3e-3),
        Amplitude.constant(0.4e-6).then(Amplitude(SquareWave(2e-3), 0.0, 1e-6), 2e-3),
        Amplitude.constant(0.4e-6).then(MILD, 2e-3, fade=1e-3, along=DIAGONAL),
        Amplitude.constant(0.4e-6).then(MILD, 1e-3).then(
            Amplitude.constant(0.1e-6), 4e-3
        ),
    ],
)  # fmt: skip
def test_textures_of_amplitude_are_lowered_as_they_are_called(texture: Composable) -> None:
    program = lower(texture, largest_amplitude=1e-6)
    wanted = numpy_values(texture, X, Y, V, T)
    assert evaluate(program, X, Y, V, T) == pytest.approx(wanted, rel=1e-9, abs=1e-17)
    assert played(program) == pytest.approx(wanted, rel=1e-9, abs=1e-17)


def test_friction_is_played_as_the_amplitude_that_makes_it() -> None:
    friction = RelativeFriction(SineWave(3e-3), 0.6, 0.95).when(Band(0.0, 5e-3, 1e-3))
    program = lower(friction, inverse=INVERSE)
    wanted = numpy_values(friction, X, Y, V, T)
    assert evaluate(program, X, Y, V, T) == pytest.approx(wanted)
    # 1 − µ′/µ goes with the amplitude, half of it at 4 µm.
    assert played(program) == pytest.approx(8e-6 * (1 - wanted), abs=1e-15)
    reduction = FrictionReduction(Ramp(0.0, 8e-3), 0.05, 0.2).when(SquareWave(2e-3))
    program = lower(reduction, inverse=INVERSE, friction_coefficient=0.5)
    wanted = numpy_values(reduction, X, Y, V, T)
    assert evaluate(program, X, Y, V, T) == pytest.approx(wanted, abs=1e-12)
    assert played(program) == pytest.approx(8e-6 * wanted / 0.5, abs=1e-15)


@pytest.mark.parametrize("away", [1.0, -1.0])
def test_each_number_of_a_place_is_looked_at_by_itself(away: float) -> None:
    program = lower(Amplitude.constant(1e-6), largest_amplitude=1e-6)
    for place in ((10.1, 0.0, 0.1), (0.0, 10.1, 0.1), (0.0, 0.0, 1001.0)):
        renderer = Renderer(program)
        assert renderer.tick(*(away * one for one in place), 0.0) == 0.0
        assert renderer.flags == 1
    assert Renderer(program).tick(away * 10.0, -away * 10.0, away * 1000.0, 0.0) == 1e-6


def test_faults_are_counted_once_each() -> None:
    renderer = Renderer(lower(Amplitude.constant(1e-6), largest_amplitude=1e-6))
    for x, t in ((0.0, 1.0), (0.0, 0.5), (0.0, 0.7), (0.0, 1.0), (math.nan, 0.2), (0.0, math.nan)):
        renderer.tick(x, 0.0, 0.1, t)
    counters = renderer.counters
    assert (counters.ticks, counters.backwards, counters.repeated) == (6, 3, 1)
    assert (counters.bad_place, counters.bad_time) == (1, 1)
    assert renderer.state[0] == 1.0
