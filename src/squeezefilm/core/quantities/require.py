"""Bounds in the type, ``Annotated[Metre, Above(0)]``; and refusing a value in words: no real
number, not within its bounds, not among the words allowed."""

from __future__ import annotations

import collections.abc
import operator
import re
import types
import typing
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities.units import (
    FloatArray,
    Unit,
    did_you_mean,
    format_quantity,
    parse_quantity,
    unit_of,
)

__all__ = [
    "Above",
    "AtLeast",
    "AtMost",
    "Below",
    "Limit",
    "Rising",
    "bounds_of",
    "real_numbers",
    "require",
    "require_alike",
    "require_one_of",
    "require_typed",
    "returned",
]

ROWS = (tuple, list, collections.abc.Sequence)


@dataclass(frozen=True, slots=True)
class _Bound:
    """Bound in an annotation: how a number, or every number, lies to a value (SI); or to another
    argument or field by its name ("voltage", "limits.voltage"), where both are given."""

    value: float | str


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


@dataclass(frozen=True, slots=True)
class Rising:
    """Limit in an annotation: a row of at least `count` numbers, each above the one before."""

    count: int = 1

    def refuse_outside(self, asked: Any, quantity: str) -> None:
        """Raise `InputError` for any other array."""
        shape = np.shape(asked)
        if len(shape) != 1 or shape[0] < self.count or np.any(np.diff(asked) <= 0):
            raise InputError(
                f"{quantity} of shape {shape} must rise from each number to the next, and be one "
                f"row of at least {self.count}; sort it, and leave out what is there twice",
                quantity=quantity,
            )


def bounds_of(
    hint: Any,
) -> tuple[dict[str, Any], tuple[tuple[str, str], ...], tuple[Limit, ...]]:
    """The bounds of an annotation as `require` takes them: numbers, and names of others whose
    values they are; and its other limits."""
    parts = list(_beside(hint))
    given = [(_WORDS[type(part)], part.value) for part in parts if isinstance(part, _Bound)]
    numbers = {word: float(bound) for word, bound in given if not isinstance(bound, str)}
    named = tuple((word, bound) for word, bound in given if isinstance(bound, str))
    return numbers, named, tuple(bound for bound in parts if hasattr(bound, "refuse_outside"))


def _beside(hint: Any) -> Iterator[Any]:
    """The marks in an annotation beside its type, and beside those of a row's numbers."""
    if typing.get_origin(hint) is typing.Annotated:
        yield from hint.__metadata__
        yield from _beside(hint.__origin__)
    elif typing.get_origin(hint) in (typing.Union, types.UnionType, *ROWS):
        for part in typing.get_args(hint):
            yield from _beside(part)


_PURE = Unit("1")
_TYPED = re.compile(r"\s*(?P<number>[-+\d.eE]+)\s*(?P<unit>\S.*?)\s*")

HOLDS: dict[str, Callable[[Any, Any], Any]] = {
    "above": operator.gt,
    "at_least": operator.ge,
    "below": operator.lt,
    "at_most": operator.le,
}


def real_numbers(name: str, value: Any) -> FloatArray:
    """A value as an array of floats. Raises `InputError` for what is no real number or array."""
    try:
        array = np.asarray(getattr(value, "magnitude", value))
        if array.dtype.kind in "fiu" or (array.dtype.kind == "O" and is_whole(value)):
            return np.asarray(array, dtype=float)
    except (OverflowError, ValueError):
        # A whole number above every float, or rows of unequal length.
        pass
    raise InputError(
        f"{name} = {shortened(value)} cannot be used: it must be a real number, or an array of "
        "real numbers, that a float can hold",
        quantity=name,
    )


def is_whole(value: Any) -> bool:
    """True for a whole number, and no truth value."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def shortened(value: Any) -> str:
    """A value as a message shows it, however long it is."""
    if is_whole(value):
        return f"a whole number of {int(value).bit_length()} bits"
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def require(
    name: str,
    value: Any,
    unit: Unit = _PURE,
    *,
    above: float | None = None,
    at_least: float | None = None,
    below: float | None = None,
    at_most: float | None = None,
    axes: int | None = None,
) -> None:
    """Refuse a value (scalar or array) that is no number, not finite or not within the bounds (SI),
    or an array of another number of axes.

    Raises `InputError` that names the quantity, the offending value with its unit and the bound.
    """
    array = real_numbers(name, value)
    if axes is not None and array.ndim != axes:
        raise InputError(
            f"{name} has the shape {array.shape}; an array of {axes} axes is wanted", quantity=name
        )
    bounds = {"above": above, "at_least": at_least, "below": below, "at_most": at_most}
    given = {word: bound for word, bound in bounds.items() if bound is not None}
    good = np.isfinite(array)
    for word, bound in given.items():
        good = good & HOLDS[word](array, bound)
    if good.all():
        return
    offender = float(array.ravel()[np.flatnonzero(~good)[0]])
    wanted = [f"{word.replace('_', ' ')} {format_quantity(given[word], unit)}" for word in given]
    raise InputError(
        f"{name} = {format_quantity(offender, unit)} cannot be used: it must be "
        + " and ".join(["finite", *wanted])
        + _as_percentage(offender, unit, given),
        quantity=name,
    )


def _as_percentage(value: float, unit: Unit, bounds: dict[str, float]) -> str:
    """Advice where a number of percent probably stands for a share; empty for any other."""
    most = min((bounds[word] for word in ("below", "at_most") if word in bounds), default=np.inf)
    share = value / 100
    held = all(HOLDS[word](share, bound) for word, bound in bounds.items())
    if unit != _PURE or most > 1 or value <= 1 or not held:
        return ""
    return f'; if {value:g} % is meant, write "{value:g} %" or {share:.6g}'


def require_alike(**series: Any) -> None:
    """Refuse series, by their names, that are no rows of values or not of one length (None: left
    out). Raises `InputError` that says how many values each has."""
    given = {name: values for name, values in series.items() if values is not None}
    try:
        shapes = {name: np.shape(values) for name, values in given.items()}
    except ValueError as error:
        raise InputError(f"{', '.join(given)} must be rows of numbers: {error}") from error
    if all(len(shape) == 1 for shape in shapes.values()) and len(set(shapes.values())) < 2:
        return
    shown = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
    raise InputError(f"the shapes of {shown} differ; give arrays of equal length")


def require_one_of(name: str, value: Any, allowed: Iterable[Any]) -> None:
    """Refuse a word that is not among those allowed. Raises `InputError` that lists them."""
    allowed = tuple(allowed)
    if not isinstance(value, str | int) or value not in allowed:
        words = [str(word) for word in allowed]
        hint = did_you_mean(value, words) if isinstance(value, str) else ""
        raise InputError(
            f"{name} = {shortened(value)} is not known.{hint} Allowed: {', '.join(words)}",
            quantity=name,
        )


def returned(name: str, values: Any, given: Any, what: str) -> FloatArray:
    """The floats that a callable `name` returned where an array was `given`.

    Raises `InputError` unless it has the shape of that array: `what` says what must be returned.
    """
    array = np.asarray(values, dtype=float)
    if array.shape != given.shape:
        raise InputError(
            f"{name} returned values of shape {array.shape} where {given.shape} was given; it must "
            f"return {what}"
        )
    return array


def require_typed(name: str, text: str, hint: Any) -> None:
    """Refuse a quantity text that is not within the bounds of an annotation, in the text's unit:
    degC, deg or %, where K, rad or a number would be another person's words.

    Nothing is refused where that is the annotation's own unit or a multiple of it with a prefix,
    which `require` says as well. Raises `InputError` that names the quantity, what was typed and
    the bounds, and `QuantityError` for a text that is no such quantity.
    """
    unit, (bounds, *_) = unit_of(hint), bounds_of(hint)
    match = _TYPED.fullmatch(text)
    if unit is None or match is None or match["unit"].endswith(unit.symbol):
        return
    value, symbol = parse_quantity(text, unit), match["unit"]
    if all(HOLDS[word](value, bound) for word, bound in bounds.items()):
        return
    # A unit may have a zero of its own, as degC has.
    place = parse_quantity(f"100 {symbol}", unit)
    step = (parse_quantity(f"200 {symbol}", unit) - place) / 100
    wanted = " and ".join(
        f"{word.replace('_', ' ')} {100 + (bound - place) / step:.4g} {symbol}"
        for word, bound in bounds.items()
    )
    raise InputError(f"{name} = {text} cannot be used: it must be {wanted}", quantity=name)
