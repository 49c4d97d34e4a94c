"""What is packed comes back to the bit, and a file can give numbers only."""

from __future__ import annotations

import contextlib
import json
import pickle
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from squeezefilm.core import quantities as si
from squeezefilm.core.kept.store import packed, unpacked


@dataclass(frozen=True, eq=False)
class Inner:
    """A part that several records share."""

    values: si.MetreArray
    sides: tuple[Literal["S", "A"] | None, Literal["S", "A"] | None] = ("S", None)


@dataclass(frozen=True, eq=False)
class Outer:
    """All that may be in a record."""

    name: str
    size: si.Metre
    count: int
    is_open: bool
    nothing: float | None
    first: Inner
    parts: list[Inner]
    pairs: tuple[tuple[Inner, si.ComplexArray], ...]
    marks: si.IntArray
    reasons: Counter[str] = field(default_factory=Counter)
    again: Callable[[], float] | None = None


def outer() -> Outer:
    """A record in which a part stands three times, and an array is not C-contiguous."""
    shared = Inner(np.asfortranarray(np.linspace(0, 1, 12).reshape(3, 4)))
    other = Inner(np.zeros((0, 2)), ("A", "S"))
    pairs = ((shared, np.array([1 + 2j, np.nan])), (other, np.array([], complex)))
    return Outer(
        "ü\n", 0.1 + 0.2, 3, True, None, shared, [shared, other], pairs, np.array([[1], [2]]),
        Counter({"why": 2}),
    )  # fmt: skip


def test_a_record_comes_back_to_the_bit() -> None:
    whole = outer()
    back = unpacked(packed(whole), Outer)
    assert type(back) is Outer
    assert (back.name, back.size, back.count, back.is_open) == ("ü\n", 0.1 + 0.2, 3, True)
    assert back.nothing is None
    assert back.reasons.most_common() == [("why", 2)]
    # What was one thing is one again.
    assert back.first is back.parts[0] is back.pairs[0][0]
    assert back.parts[1].sides == ("A", "S")
    for ours, theirs in (
        (back.first.values, whole.first.values),
        (back.pairs[0][1], whole.pairs[0][1]),
        (back.pairs[1][1], whole.pairs[1][1]),
        (back.marks, whole.marks),
    ):
        assert ours.dtype == theirs.dtype
        assert ours.shape == theirs.shape
        assert ours.tobytes() == theirs.tobytes()
        assert ours.flags.f_contiguous == theirs.flags.f_contiguous
        assert ours.flags.writeable


def test_what_the_reader_has_is_not_written() -> None:
    large = Inner(np.zeros(10_000))
    data = packed((large, 2.0), [large])
    assert len(data) < 100
    assert unpacked(data, tuple[Inner, float], [large]) == (large, 2.0)


@pytest.mark.parametrize("value", [object(), {1}, print, np.array(["a"]), np.array([None]), 1j])
def test_what_is_no_plain_record_is_refused(value: Any) -> None:
    with pytest.raises(TypeError):
        packed((1.0, value))


def test_a_file_that_says_another_type_is_refused() -> None:
    for value, kind in [
        ("text", float),
        (1.5, int),
        (True, float),
        ((1.0, 2.0), tuple[float]),
        (np.zeros(3), si.ComplexArray),
        (np.zeros(3, complex), si.FloatArray),
        (None, float),
        ("B", Literal["S", "A"]),
        ({"a": 1}, Inner),
    ]:
        with pytest.raises((TypeError, ValueError)):
            unpacked(packed(value), kind)


@pytest.mark.parametrize(
    "head",
    [
        ["<f8", [10**15], "C"],
        ["<f8", [-1], "C"],
        ["|O", [1], "C"],
        ["<f8", [2**70, 2**70], "C"],
        ["<f8", "ab", "C"],
        "x",
    ],
)
def test_an_array_that_is_not_there_is_refused_without_memory_for_it(head: Any) -> None:
    with pytest.raises((TypeError, ValueError, KeyError, OverflowError)):
        unpacked(json.dumps(head).encode() + b"\n" + bytes(8), si.FloatArray)


class _Runs:
    """What a pickle would run."""

    def __reduce__(self) -> tuple[Any, ...]:
        return pytest.fail, ("a kept file was run",)


@pytest.mark.parametrize("data", [pickle.dumps(_Runs()), b"[" * 200_000, b"", b"\n", b"\xff"])
def test_nothing_in_a_file_is_run(data: bytes) -> None:
    with pytest.raises((ValueError, RecursionError)):
        unpacked(data, Outer)


@settings(max_examples=200)
@given(st.data())
def test_a_damaged_record_gives_values_of_its_types_or_an_error(data: st.DataObject) -> None:
    whole = bytearray(packed(outer()))
    at = data.draw(st.integers(0, len(whole) - 1))
    whole[at] = data.draw(st.integers(0, 255))
    with contextlib.suppress(ValueError, TypeError, LookupError, OverflowError):
        back = unpacked(bytes(whole), Outer)
        assert type(back) is Outer
        assert back.again is None
        assert all(type(part) is Inner for part in back.parts)
