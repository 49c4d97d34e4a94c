"""Where only the outermost of calls within calls looks at its numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.quantities.checks import _WITHIN, outermost_checked


@si.checked_numbers
def inner(length: Annotated[si.Metre, si.Above(0.0)]) -> si.Metre:
    return 1.0 / (length - 2.0) if length > 0 else length


@si.checked_numbers
def outer(length: Annotated[si.Metre, si.AtLeast(0.0)]) -> si.Metre:
    return inner(length)


@si.checked_numbers
@dataclass(frozen=True)
class Rod:
    length: Annotated[si.Metre, si.Above(0.0)]


def test_each_call_looks_at_its_numbers_elsewhere() -> None:
    with pytest.raises(InputError, match="length"):
        outer(0.0)


def test_only_the_outermost_looks_within() -> None:
    with outermost_checked():
        assert outer(0.0) == 0.0
        with pytest.raises(InputError, match="length"):
            outer(-1.0)
        with pytest.raises(InputError, match="length"):
            inner(0.0)


def test_the_outermost_answers_for_arithmetic_within_it() -> None:
    with outermost_checked():
        with pytest.raises(OutOfRangeError, match="outer leaves the range of a float"):
            outer(2.0)
        # Not left behind by what was refused.
        assert not _WITHIN.get()
        assert outer(3.0) == 1.0


def test_a_dataclass_looks_at_its_numbers_in_any_case() -> None:
    @si.checked_numbers
    def make(length: si.Metre) -> si.Metre:
        return Rod(length).length

    with outermost_checked(), pytest.raises(InputError, match="length"):
        make(0.0)
