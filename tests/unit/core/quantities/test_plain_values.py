"""The quick look at an argument never passes what the check in full would refuse or change."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities.plain_values import (
    never_plain,
    or_none,
    plainly_array,
    plainly_complex,
    plainly_either,
    plainly_number,
    plainly_one_of,
)

NUMBERS = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True), st.integers(-3, 3), st.booleans(), st.none()
)


@given(value=NUMBERS)
def test_one_number_is_plain_where_it_is_a_float_within_its_bounds(value: object) -> None:
    wanted = type(value) is float and -1 <= value <= 2
    assert plainly_number(-1, 2)(value) == wanted
    assert or_none(plainly_number(-1, 2))(value) == (wanted or value is None)


@given(
    values=st.lists(st.floats(allow_nan=True, allow_infinity=True), max_size=70),
    rows=st.booleans(),
)
def test_an_array_is_plain_where_all_of_it_is(values: list[float], rows: bool) -> None:
    array = np.array(values)
    array = array[None, :] if rows else array
    wanted = bool(values) and all(-1 <= one <= 2 for one in values)
    assert plainly_array(-1, 2)(array) == wanted
    assert plainly_either(-1, 2)(array) == wanted


@pytest.mark.parametrize("size", [3, 200])
@pytest.mark.parametrize("at", [0, 1, -1])
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_never_plain(size: int, at: int, bad: float) -> None:
    array = np.linspace(0.0, 1.0, size)
    assert plainly_array(-1e300, 1e300)(array)
    array[at] = bad
    assert not plainly_array(-1e300, 1e300)(array)


def test_other_arrays_are_looked_at_in_full() -> None:
    look = plainly_array(-1, 2)
    for other in (np.zeros(3, dtype=int), np.zeros(3, dtype=np.float32), np.float64(1), [0.0], 0.0):
        assert not look(other)


def test_words_and_complex_numbers() -> None:
    assert plainly_one_of(("own",))("own")
    assert not plainly_one_of(("own",))("other")
    assert plainly_complex(1 + 2j)
    assert not plainly_complex(complex(math.nan, 0))
    assert not plainly_complex(1.0)
    assert not never_plain(1.0)


@si.checked_numbers
def doubled(
    one: Annotated[si.MetreLike, si.AtLeast(0.0)], other: si.MetreLike = 0.0
) -> si.MetreLike:
    """Twice a length."""
    return 2 * one + 0 * other


def test_a_call_of_plain_values_is_checked_as_any_other() -> None:
    assert doubled(1.0) == 2.0
    with pytest.raises(InputError, match="at least"):
        doubled(-1.0)
    with pytest.raises(InputError, match="do not broadcast"):
        doubled(np.zeros(2), np.zeros(3))
    assert isinstance(doubled(1), float)
