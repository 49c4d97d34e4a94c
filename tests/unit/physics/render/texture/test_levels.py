"""Gratings of amplitude: values at chosen places, shapes, and every refusal."""

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.texture.composition import Texture
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.pattern import AlongY
from squeezefilm.physics.render.texture.shapes import SineWave, SquareWave

LOW, HIGH = 0.5e-6, 2e-6


def along(texture: Texture, x: object) -> np.ndarray:
    return texture(np.asarray(x, dtype=float), 0.0, 0.1, 0.0)


def test_square_is_high_first_and_low_after_its_duty() -> None:
    square = Amplitude(SquareWave(4e-3, duty=0.25), LOW, HIGH)
    values = along(square, [0.0, 0.9e-3, 1.1e-3, 3.9e-3, 4.1e-3, -0.1e-3])
    assert values.tolist() == [HIGH, HIGH, LOW, LOW, HIGH, LOW]


def test_phase_of_half_a_turn_exchanges_the_halves() -> None:
    values = along(Amplitude(SquareWave(4e-3, phase=math.pi), LOW, HIGH), [1e-3, 3e-3])
    assert values.tolist() == [LOW, HIGH]


def test_a_grating_along_x_has_a_period_and_nothing_else_has() -> None:
    assert Amplitude(SineWave(4e-3), LOW, HIGH).spatial_period == 4e-3
    assert Amplitude(SquareWave(4e-3, along=AlongY()), LOW, HIGH).spatial_period is None
    assert Amplitude.constant(LOW).spatial_period is None


def test_sine_at_its_quarters() -> None:
    values = along(Amplitude(SineWave(4e-3), LOW, HIGH), [0.0, 1e-3, 2e-3, 3e-3])
    middle = (LOW + HIGH) / 2
    assert values == pytest.approx([middle, HIGH, middle, LOW], rel=1e-12)


@pytest.mark.parametrize(
    "texture", [Amplitude(SquareWave(1e-3), LOW, HIGH), Amplitude(SineWave(1e-3), LOW, HIGH)]
)
def test_arguments_broadcast(texture: Texture) -> None:
    assert texture(0.0, 0.0, 0.1, 0.0).shape == ()
    x, y = np.linspace(0, 1e-2, 5), np.zeros((3, 1))
    assert texture(x, y, 0.1, 0.0).shape == (3, 5)
    assert np.array_equal(texture(x, y, 0.1, 0.0)[2], texture(x, 0.0, 0.1, 0.0))


@pytest.mark.parametrize("make", [SquareWave, SineWave])
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((0.0, LOW, HIGH), "spatial_period = 0 m"),
        ((-1e-3, LOW, HIGH), "spatial_period = -1 mm"),
        ((400.0, LOW, HIGH), "at most 500 mm"),
        ((math.nan, LOW, HIGH), "spatial_period = nan"),
        ((1e-3, -1e-9, HIGH), "low = -1 nm"),
        ((1e-3, math.nan, HIGH), "low = nan"),
        ((1e-3, 0.0, 2.0), "at most 1 mm"),
        ((1e-3, HIGH, LOW), "low = 2 µm lies above high = 500 nm"),
    ],
)
def test_a_grating_out_of_range_is_refused(make: type, arguments: tuple, said: str) -> None:
    with pytest.raises(InputError, match=said):
        Amplitude(make(arguments[0]), *arguments[1:])
    with pytest.raises(InputError, match="phase = inf"):
        make(1e-3, phase=math.inf)


@pytest.mark.parametrize("duty", [0.0, 1.0, -0.1, math.nan])
def test_a_duty_that_leaves_no_grating_is_refused(duty: float) -> None:
    with pytest.raises(InputError, match="duty"):
        Amplitude(SquareWave(1e-3, duty=duty), LOW, HIGH)


@pytest.mark.parametrize(
    "texture", [Amplitude(SquareWave(1e-3), LOW, HIGH), Amplitude(SineWave(1e-3), LOW, HIGH)]
)
def test_a_position_that_is_not_finite_is_refused(texture: Texture) -> None:
    with pytest.raises(InputError, match="position x = nan"):
        along(texture, [0.0, math.nan])
    with pytest.raises(InputError, match="do not broadcast"):
        texture(np.zeros(3), np.zeros(2), 0.1, 0.0)
