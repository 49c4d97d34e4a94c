"""Bounds in the type: ``Annotated[Metre, Above(0)]``, ``Annotated[float, AtLeast(0)]``."""

from __future__ import annotations

import collections.abc
import types
import typing
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

__all__ = ["Above", "AtLeast", "AtMost", "Below", "Limit", "bounds_of"]

ROWS = (tuple, list, collections.abc.Sequence)


@dataclass(frozen=True, slots=True)
class Above:
    """In an annotation: the number, or every number, is above this (SI)."""

    above: float


@dataclass(frozen=True, slots=True)
class AtLeast:
    """In an annotation: the number, or every number, is at least this (SI)."""

    at_least: float


@dataclass(frozen=True, slots=True)
class Below:
    """In an annotation: the number, or every number, is below this (SI)."""

    below: float


@dataclass(frozen=True, slots=True)
class AtMost:
    """In an annotation: the number, or every number, is at most this (SI)."""

    at_most: float


@runtime_checkable
class Limit(Protocol):
    """In an annotation: whatever refuses what is outside of it in its own words."""

    def refuse_outside(self, asked: Any, quantity: str) -> None:
        """Raise `InputError` that names the quantity."""


_BOUNDS = (Above, AtLeast, Below, AtMost)


def bounds_of(hint: Any) -> tuple[dict[str, Any], tuple[Limit, ...]]:
    """The bounds in an annotation, as `require` takes them, and its other limits."""
    found = list(_beside(hint))
    bounds = {
        name: float(getattr(one, name))
        for one in found
        if isinstance(one, _BOUNDS)
        for name in one.__slots__
    }
    return bounds, tuple(one for one in found if isinstance(one, Limit))


def _beside(hint: Any) -> Iterator[Any]:
    """What stands in an annotation beside its type, and beside those of a row's numbers."""
    if typing.get_origin(hint) is typing.Annotated:
        yield from hint.__metadata__
        yield from _beside(hint.__origin__)
    elif typing.get_origin(hint) in (typing.Union, types.UnionType, *ROWS):
        for part in typing.get_args(hint):
            yield from _beside(part)
