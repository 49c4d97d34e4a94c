"""Numbers that a host may send: what is taken, and in which words the rest is refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.drive_limits import HIGHEST_VOLTAGE
from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities import Unit
from squeezefilm.instruments.device.wire.frames import (
    amplitudes,
    binary32_below,
    number,
    whole_number,
)

SECOND = Unit("s")


@pytest.mark.parametrize("value", [1, 2.0, 1.5, np.float32(1.25), np.array(2), np.int16(1), True])
def test_a_number_between_its_bounds_is_taken(value: Any) -> None:
    found = number("period", value, SECOND, 1.0, 2.0)
    assert isinstance(found, float)
    assert found == float(value)


@pytest.mark.parametrize(
    ("value", "says"),
    [
        (0.999, "period = 999 ms"),
        (2.001, "period = 2.001 s"),
        (math.nan, "period"),
        (math.inf, "period"),
        (-math.inf, "period"),
        ("1", "period is '1'; give one number in "),
        (None, "period is None; give one number in "),
        (1 + 0j, "give one number in "),
        ([1.5], r"period is \[1.5\]; give one number in "),
        ([[1.0], [1.0, 2.0]], "give one number in "),
    ],
)
def test_anything_else_is_refused_by_name(value: Any, says: str) -> None:
    with pytest.raises(InputError, match=says) as refused:
        number("period", value, SECOND, 1.0, 2.0)
    assert refused.value.quantity == "period"


def test_what_is_refused_is_quoted_in_short() -> None:
    with pytest.raises(InputError) as refused:
        number("period", "x" * 1000, SECOND, 1.0, 2.0)
    assert str(refused.value).startswith(f"period is '{'x' * 59}; give one number in ")


def test_a_whole_number_is_not_rounded() -> None:
    assert whole_number("seed", 7) == 7
    assert whole_number("seed", np.uint8(255)) == 255
    assert type(whole_number("seed", np.uint8(255))) is int
    for value in (7.0, "7", None, [7]):
        with pytest.raises(InputError) as refused:
            whole_number("seed", value)
        assert str(refused.value) == f"seed is {value!r}; give a whole number"
        assert refused.value.quantity == "seed"


def test_a_row_of_amplitudes_reaches_from_zero_to_the_highest() -> None:
    found = amplitudes([0, 1, 10], at_most=10.0)
    assert (found.dtype, found.tolist()) == (float, [0.0, 1.0, 10.0])
    assert amplitudes([HIGHEST_VOLTAGE]).tolist() == [HIGHEST_VOLTAGE]
    for row in ([0.0, -0.1], [10.1, 0.0], [math.nan], [1.0, math.inf]):
        with pytest.raises(InputError, match="levels"):
            amplitudes(row, at_most=10.0)
    with pytest.raises(InputError, match="levels"):
        amplitudes([1.001 * HIGHEST_VOLTAGE])


@pytest.mark.parametrize("levels", [1.0, [[1.0]], ["1"], [[1.0], [1.0, 2.0]], None])
def test_what_is_no_row_is_refused(levels: Any) -> None:
    with pytest.raises(InputError, match="give a row of amplitudes in V") as refused:
        amplitudes(levels)
    assert refused.value.quantity == "levels"


def test_binary32_is_rounded_down() -> None:
    # Each as near as 24 bits go, and never above: a limit that is sent is not exceeded.
    rng = np.random.default_rng(2)
    exact = np.concatenate(
        [[0.0, 0.1, 1 / 3, 16777217.0, 1e-45, 9e37], 10 ** rng.uniform(-30, 37, 500)]
    )
    found = binary32_below(exact)
    assert found.dtype == np.float32
    assert np.all(found.astype(float) <= exact)
    assert np.all(np.nextafter(found, np.float32(np.inf)).astype(float) > exact)
    assert found[3] == 16777216.0
    # What is a binary32 already stays.
    np.testing.assert_array_equal(binary32_below(found), found)
    assert binary32_below(0.5) == 0.5


def test_the_unit_is_said_by_its_symbol() -> None:
    with pytest.raises(InputError) as refused:
        number("period", "1", Unit("s"), 1.0, 2.0)
    assert str(refused.value) == "period is '1'; give one number in s"
