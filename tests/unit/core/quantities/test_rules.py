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
from squeezefilm.core.quantities.rules import Kind, Rule


def rule(kind: Kind, least: float = -1, most: float = 2, *, is_optional: bool = False) -> Rule:
    bounds = {"at_least": least, "at_most": most}
    return Rule(kind, is_optional=is_optional, bounds=bounds, words=("own",))


NUMBERS = st.one_of(
    st.floats(allow_nan=True, allow_infinity=True), st.integers(-3, 3), st.booleans(), st.none()
)


@given(value=NUMBERS)
def test_one_number_is_plain_where_it_is_a_float_within_its_bounds(value: object) -> None:
    wanted = type(value) is float and -1 <= value <= 2
    assert rule("number").is_plain(value) == wanted
    assert rule("number", is_optional=True).is_plain(value) == (wanted or value is None)


@given(
    values=st.lists(st.floats(allow_nan=True, allow_infinity=True), max_size=70),
    rows=st.booleans(),
)
def test_an_array_is_plain_where_all_of_it_is(values: list[float], rows: bool) -> None:
    array = np.array(values)
    array = array[None, :] if rows else array
    wanted = bool(values) and all(-1 <= one <= 2 for one in values)
    assert rule("array").is_plain(array) == wanted
    assert rule("either").is_plain(array) == wanted


@pytest.mark.parametrize("size", [3, 200])
@pytest.mark.parametrize("at", [0, 1, -1])
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_never_plain(size: int, at: int, bad: float) -> None:
    array = np.linspace(0.0, 1.0, size)
    assert rule("array", -1e300, 1e300).is_plain(array)
    array[at] = bad
    assert not rule("array", -1e300, 1e300).is_plain(array)


def test_other_arrays_are_looked_at_in_full() -> None:
    look = rule("array").is_plain
    for other in (np.zeros(3, dtype=int), np.zeros(3, dtype=np.float32), np.float64(1), [0.0], 0.0):
        assert not look(other)


def test_words_and_complex_numbers() -> None:
    assert rule("word").is_plain("own")
    assert not rule("word").is_plain("other")
    assert rule("complex").is_plain(1 + 2j)
    assert not rule("complex").is_plain(complex(math.nan, 0))
    assert not rule("complex").is_plain(1.0)
    assert not rule("count").is_plain(1)


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
