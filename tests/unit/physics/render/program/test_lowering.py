"""A program that an interpreter could not run safely is refused, one spoilt number at a time."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from tests.friction_tables import inverse_over_speeds

from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities import FloatArray
from squeezefilm.physics.render import opcodes as op
from squeezefilm.physics.render.program import layout as at
from squeezefilm.physics.render.program.inverse import FrictionInverse, WaveCompensation
from squeezefilm.physics.render.program.lowering import Program, checked, lower
from squeezefilm.physics.render.texture.levels import FrictionReduction, RelativeFriction
from squeezefilm.physics.render.texture.shapes import SineWave

CURVE = FrictionInverse.from_function(lambda a: 0.3 + 0.7 * np.exp(-((a / 2e-6) ** 2)), 4e-6)
_PLACES = np.arange(8) * 10e-3 / 8
WAVE = WaveCompensation.from_ripple(_PLACES, np.full(8, 0.7), CURVE, 10e-3)


def program() -> FloatArray:
    """One with every part: code, an inverse and a wave."""
    texture = FrictionReduction(SineWave(2e-3), 0.1, 0.4)
    made = lower(texture, inverse=CURVE, friction_coefficient=0.8, compensation=WAVE)
    return np.array(made.array)


Spoil = Callable[[FloatArray], None]


def header(place: int, value: float) -> Spoil:
    def spoil(array: FloatArray) -> None:
        array[place] = value

    return spoil


def swap_amplitudes(array: FloatArray) -> None:
    start = int(array[at.H_INVERSE])
    array[start : start + 2] = array[start : start + 2][::-1].copy()


def swap_frictions(array: FloatArray) -> None:
    start = int(array[at.H_INVERSE] + array[at.H_INVERSE_COUNT])
    array[start : start + 2] = array[start : start + 2][::-1].copy()


def first_amplitude_below_zero(array: FloatArray) -> None:
    array[int(array[at.H_INVERSE])] = -1e-9


def a_factor_of_zero(array: FloatArray) -> None:
    array[-1] = 0.0


def an_unknown_opcode(array: FloatArray) -> None:
    array[int(array[at.H_CODE])] = len(op.SHAPES)


def no_end(array: FloatArray) -> None:
    array[int(array[at.H_TABLES]) - 1] = op.TIME


SPOILT: list[tuple[Spoil, str]] = [
    (header(at.H_MAGIC, 1.0), "no program of version"),
    (header(at.H_VERSION, op.VERSION + 1), "no program of version"),
    (header(at.H_HOLD, math.nan), "must be finite"),
    (header(at.H_LENGTH, 7.0), "and should be 7"),
    (header(at.H_STACK, 1.5), "no whole numbers"),
    (header(at.H_FADE, -1.0), "no whole numbers"),
    (header(at.H_CODE, at.HEADER + 1), "do not follow one another"),
    (header(at.H_WAVE_COUNT, 0.0), "do not follow one another"),
    (header(at.H_QUANTITY, 3.0), "unknown quantity"),
    (header(at.H_QUANTITY, 0.0), "an inverse that does not belong to it"),
    (header(at.H_FRICTION, 0.0), "a friction coefficient that is not above 0"),
    (header(at.H_LARGEST, 0.0), "largest amplitude"),
    (header(at.H_LARGEST, 2e-3), "largest amplitude"),
    (header(at.H_FARTHEST, 0.0), "farthest place"),
    (header(at.H_STACK, 0.0), "stack = 0"),
    (header(at.H_FADE, 0.0), "fade ticks"),
    (header(at.H_WAVE_PERIOD, 0.0), "wave period"),
    (header(at.H_WAVE_P, 1.5), "wave direction"),
    (header(at.H_WAVE_R, 11.0), "wave start"),
    (swap_amplitudes, "inverse that is not monotone"),
    (swap_frictions, "inverse that is not monotone"),
    (first_amplitude_below_zero, "negative amplitude"),
    (a_factor_of_zero, "wave factors"),
    (header(at.H_INVERSE_SPEEDS, 1.5), "no whole numbers"),
    (header(at.H_INVERSE_SPEEDS, 2.0), "do not follow one another"),
    (an_unknown_opcode, "unknown opcode"),
    (no_end, "does not end with its last instruction"),
]


def test_what_was_lowered_is_a_program_and_is_not_changed() -> None:
    array = program()
    assert np.array_equal(checked(array), array)
    assert not checked(array).flags.writeable


@pytest.mark.parametrize(("spoil", "says"), SPOILT)
def test_one_spoilt_number_is_refused(spoil: Spoil, says: str) -> None:
    array = program()
    spoil(array)
    with pytest.raises(InputError, match=says):
        checked(array)


def with_speeds() -> FloatArray:
    """One with a row of friction for each of three speeds."""
    curve = inverse_over_speeds(
        lambda a, v: 1.0 - a / (4e-6 + 1e-6 * v[:, None]),
        0.5e-6 * np.arange(5),
        np.array([0.01, 0.1, 1]),
        0.1,
    )
    return np.array(lower(RelativeFriction.constant(0.7), inverse=curve).array)


def last_speed(value: float) -> Spoil:
    def spoil(array: FloatArray) -> None:
        array[-1] = value

    return spoil


def last_friction(value: float) -> Spoil:
    def spoil(array: FloatArray) -> None:
        array[-4] = value

    return spoil


def test_rows_over_speeds_are_a_program() -> None:
    made = Program(with_speeds())
    assert made.array[at.H_INVERSE_SPEEDS] == 3
    assert made.wanted_depends_on == set()


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (header(at.H_INVERSE_SPEEDS, 0.0), "do not follow one another"),
        (header(at.H_INVERSE_SPEEDS, 2.0), "do not follow one another"),
        (header(at.H_INVERSE_SPEEDS, 1e300), "do not follow one another"),
        (header(at.H_QUANTITY, 0.0), "an inverse that does not belong to it"),
        (last_speed(0.05), "do not rise"),
        (last_speed(0.1), "do not rise"),
        (last_speed(1e4), "inverse speed"),
        (last_speed(math.nan), "must be finite"),
        (last_friction(0.9), "not monotone"),
        (last_friction(-0.1), "inverse friction"),
    ],
)
def test_one_spoilt_number_of_the_speeds_is_refused(spoil: Spoil, says: str) -> None:
    array = with_speeds()
    spoil(array)
    with pytest.raises(InputError, match=says):
        checked(array)


def test_an_inverse_of_one_speed_only_is_none() -> None:
    # As long as it says: two knots, one row, and a speed that says nothing.
    array = with_speeds()
    start = int(array[at.H_INVERSE])
    short = np.concatenate([array[:start], [0.0, 1e-6, 1.0, 0.5, 0.1]])
    short[[at.H_LENGTH, at.H_WAVE]] = short.size
    short[[at.H_INVERSE_COUNT, at.H_INVERSE_SPEEDS]] = 2, 1
    with pytest.raises(InputError, match="do not rise"):
        checked(short)


@pytest.mark.parametrize("array", [np.zeros(at.HEADER), np.zeros((2, 40))])
def test_what_is_too_short_or_no_row_is_no_program(array: FloatArray) -> None:
    with pytest.raises(InputError, match="is no program"):
        checked(array)
