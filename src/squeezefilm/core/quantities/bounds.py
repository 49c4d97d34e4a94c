"""Bounds in the type: ``Annotated[Metre, Above(0)]``, ``Annotated[float, AtLeast(0)]``."""

from __future__ import annotations

import collections.abc
import types
import typing
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Protocol

__all__ = ["Above", "AtLeast", "AtMost", "Below", "Limit", "bounds_of"]

ROWS = (tuple, list, collections.abc.Sequence)


@dataclass(frozen=True, slots=True)
class _Bound:
    """Bound in an annotation: how a number, or every number, lies to a value (SI)."""

    value: float


class Above(_Bound):
    """Bound in an annotation: the number, or every number, is above this (SI)."""


class AtLeast(_Bound):
    """Bound in an annotation: the number, or every number, is at least this (SI)."""


class Below(_Bound):
    """Bound in an annotation: the number, or every number, is below this (SI)."""


class AtMost(_Bound):
    """Bound in an annotation: the number, or every number, is at most this (SI)."""


_WORDS = {Above: "above", AtLeast: "at_least", Below: "below", AtMost: "at_most"}
"""The bounds as `require` calls them."""


class Limit(Protocol):
    """Bound in an annotation: whatever refuses what is outside of it in its own words."""

    def refuse_outside(self, asked: Any, quantity: str) -> None:
        """Raise `InputError` that names the quantity."""


def bounds_of(hint: Any) -> tuple[dict[str, Any], tuple[Limit, ...]]:
    """The bounds in an annotation, as `require` takes them, and its other limits."""
    parts = list(_beside(hint))
    bounds = {_WORDS[type(part)]: float(part.value) for part in parts if isinstance(part, _Bound)}
    return bounds, tuple(bound for bound in parts if hasattr(bound, "refuse_outside"))


def _beside(hint: Any) -> Iterator[Any]:
    """The marks in an annotation beside its type, and beside those of a row's numbers."""
    if typing.get_origin(hint) is typing.Annotated:
        yield from hint.__metadata__
        yield from _beside(hint.__origin__)
    elif typing.get_origin(hint) in (typing.Union, types.UnionType, *ROWS):
        for part in typing.get_args(hint):
            yield from _beside(part)
