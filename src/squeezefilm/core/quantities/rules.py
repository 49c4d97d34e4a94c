"""Rules of arguments: what an annotation says of a value, and the check of a value by it."""

from __future__ import annotations

import cmath
import collections.abc
import math
import sys
import types
import typing
from dataclasses import dataclass, field, is_dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities.require import (
    HOLDS,
    ROWS,
    Limit,
    bounds_of,
    is_whole,
    require,
    require_one_of,
    shortened,
)
from squeezefilm.core.quantities.units import Unit, unit_of

_PURE = Unit("1")
_MOST_BITS = 64
_MOST = sys.float_info.max

_Numbers = Literal["number", "array", "either", "complex", "count", "row", "table", "container"]
Kind = Literal[_Numbers, "word", "part", "parts"]
_PLAIN_TYPES: dict[str, tuple[type, ...]] = {
    "number": (float,),
    "array": (np.ndarray,),
    "either": (float, np.ndarray),
    "complex": (complex,),
    "word": (str,),
}


@dataclass(frozen=True, slots=True)
class Rule:
    """The demand of an annotation on an argument: one number, an array, either, a count, a row (a
    tuple or list of numbers), a table (a tuple of rows), or numbers in another container, which is
    left as it is; or a word, one of `words`; or one of `records` (a part), or a tuple of those,
    whose class says as `WANTED` what to give. `length` is of a row, `bounds` as `require` takes
    them. One of `records`, which checked its own numbers, may stand in a number's place.
    `named_bounds` are others' values: word of `require`, name of the other."""

    kind: Kind
    unit: Unit = _PURE
    is_optional: bool = False
    bounds: dict[str, Any] = field(default_factory=dict)
    limits: tuple[Limit, ...] = ()
    length: int | None = None
    words: tuple[Any, ...] = ()
    records: tuple[Any, ...] = ()
    named_bounds: tuple[tuple[str, str], ...] = ()
    _plain_types: tuple[type, ...] = field(init=False, compare=False)
    _least: float = field(init=False, compare=False)
    _most: float = field(init=False, compare=False)

    def __post_init__(self) -> None:
        ends = {} if self.kind == "count" else self.bounds
        # A limit that does not say its ends is asked itself.
        least = max(
            -_MOST,
            ends.get("at_least", -_MOST),
            math.nextafter(ends.get("above", -math.inf), math.inf),
            *(getattr(limit, "least", math.inf) for limit in self.limits),
        )
        most = min(
            _MOST,
            ends.get("at_most", _MOST),
            math.nextafter(ends.get("below", math.inf), -math.inf),
            *(getattr(limit, "most", -math.inf) for limit in self.limits),
        )
        plain = _PLAIN_TYPES.get(self.kind, ())
        if self.kind == "complex" and self.limits:
            plain = ()
        object.__setattr__(self, "_least", least)
        object.__setattr__(self, "_most", most)
        object.__setattr__(
            self, "_plain_types", (*plain, type(None)) if self.is_optional else plain
        )

    def is_plain(self, value: Any) -> bool:
        """True for what is good as it is by a quick look: checks stand in front of every call, and
        nearly all are given a float or an array of floats within its bounds."""
        given = type(value)
        if given not in self._plain_types:
            return False
        if given is float:
            return bool(self._least <= value <= self._most)
        if given is np.ndarray:
            return _all_within(value, self._least, self._most)
        if given is complex:
            return cmath.isfinite(value)
        return value is None or value in self.words

    def checked(self, name: str, value: Any) -> Any:
        """The value as the call takes it, floats for numbers. Raises `InputError`."""
        if self.is_plain(value) or isinstance(value, self.records):
            return value
        if value is None and self.is_optional:
            return value
        if self.kind == "word":
            require_one_of(name, value, self.words)
        elif self.kind in ("part", "parts"):
            for part in value if self.kind == "parts" else (value,):
                if not isinstance(part, self.records):
                    wanted = self.records[0].WANTED
                    raise InputError(f"{name} = {part!r} is no {wanted}", quantity=name)
        elif self.kind == "count":
            self._require_count(name, value)
        elif self.kind == "complex":
            _require_complex(name, value)
        else:
            value = self._numbers(name, value)
        for limit in self.limits:
            limit.refuse_outside(value, name)
        return value

    def _numbers(self, name: str, value: Any) -> Any:
        """A number, or numbers in an array, a row, a table or another container."""
        if self.kind == "table" and isinstance(value, tuple | list):
            if not value:
                return value
            _require_even(name, value)
        axes = {"row": 1, "table": 2}.get(self.kind)
        require(name, value, self.unit, axes=axes, **self.bounds)
        if hasattr(value, "magnitude"):
            return value
        array = np.asarray(value, dtype=float)
        self._require_shape(name, array)
        if self.kind == "table":
            return tuple(map(tuple, value.tolist())) if isinstance(value, np.ndarray) else value
        if self.kind == "row":
            return tuple(value.tolist()) if isinstance(value, np.ndarray) else value
        if self.kind == "container":
            return value
        return array if array.ndim else float(array)

    def _require_shape(self, name: str, array: NDArray[Any]) -> None:
        wrong = None
        if self.kind == "number" and array.ndim:
            wrong = f"has the shape {array.shape}; one number is wanted"
        elif self.kind in ("array", "container") and not array.ndim:
            wrong = "is one number; an array of at least one sample is wanted"
        elif self.kind == "table" and self.length not in (None, array.shape[-1]):
            wrong = f"has rows of {array.shape[-1]} numbers; give {self.length} in each"
        elif self.kind == "row" and self.length not in (None, array.size):
            wrong = f"holds {array.size} numbers; give {self.length}"
        elif self.kind in ("array", "either") and not array.size:
            wrong = "is empty; at least one sample is wanted"
        if wrong is not None:
            raise InputError(f"{name} {wrong}", quantity=name)

    def _require_count(self, name: str, value: Any) -> None:
        is_count = is_whole(value) and int(value).bit_length() <= _MOST_BITS
        if is_count and all(HOLDS[word](value, bound) for word, bound in self.bounds.items()):
            return
        wanted = [f"{word.replace('_', ' ')} {bound:.0f}" for word, bound in self.bounds.items()]
        raise InputError(
            f"{name} = {value if is_count else shortened(value)} cannot be used: it must be a "
            f"whole number {' and '.join(wanted) or f'of at most {_MOST_BITS} bits'}",
            quantity=name,
        )


def rule_of(hint: Any, more: dict[str, Any]) -> Rule | None:
    """The rule of an annotation and of `more` bounds, None where it stands for no number."""
    members = _members(hint)
    plain = [member for member in members if member is not type(None)]
    is_optional = len(plain) < len(members)
    if plain and all(typing.get_origin(member) is Literal for member in plain):
        words = tuple(word for member in plain for word in typing.get_args(member))
        return Rule("word", is_optional=is_optional, words=words)
    is_tuple = typing.get_origin(hint) is tuple
    kinds = [kind for kind in typing.get_args(hint) if kind is not Ellipsis] if is_tuple else plain
    if kinds and all(hasattr(kind, "WANTED") for kind in kinds):
        return Rule("parts" if is_tuple else "part", is_optional=is_optional, records=tuple(kinds))
    unit = unit_of(hint)
    records = tuple(m for m in plain if unit and isinstance(m, type) and is_dataclass(m))
    numbers = [member for member in plain if member not in records]
    kind = _kind(numbers, unit)
    if kind is None:
        return None
    row = typing.get_args(numbers[0])[0] if kind == "table" else numbers[0]
    parts = typing.get_args(row) if typing.get_origin(row) is tuple else (Ellipsis,)
    has_length = kind in ("row", "table") and Ellipsis not in parts
    bounds, named_bounds, limits = bounds_of(hint)
    return Rule(
        kind,
        unit or _PURE,
        is_optional,
        bounds | more,
        limits,
        len(parts) if has_length else None,
        records=records,
        named_bounds=named_bounds,
    )


def _kind(members: list[Any], unit: Unit | None) -> Kind | None:
    """The kind of what several types allow, None where they stand for no number."""
    kinds = {_scalar(member) for member in members}
    by_types: dict[frozenset[Any], Kind] = {
        frozenset({float}): "number",
        frozenset({int}): "count",
        frozenset({float, np.float64}): "either",
        frozenset({np.float64}): "array",
        frozenset({complex}): "complex",
        frozenset({complex, np.complex128}): "complex",
        frozenset({np.complex128}): "complex",
    }
    if (known := by_types.get(frozenset(kinds))) is not None:
        return known
    if collections.abc.Callable in kinds:
        return None
    if len(members) == 1 and _is_row(members[0]):
        return "row"
    if len(members) == 1 and _is_table(members[0]):
        return "table"
    return None if unit is None else "container"


def _scalar(hint: Any) -> Any:
    """The type of an array's numbers, and of anything else its origin."""
    origin, inner = typing.get_origin(hint) or hint, typing.get_args(hint)
    return typing.get_args(inner[1])[0] if origin is np.ndarray and inner else origin


def _members(hint: Any) -> list[Any]:
    """The types that an annotation allows, without their units."""
    if typing.get_origin(hint) is typing.Annotated:
        return _members(hint.__origin__)
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        return [member for part in typing.get_args(hint) for member in _members(part)]
    return [hint]


def _is_row(hint: Any) -> bool:
    """True for a tuple, a list or a sequence of plain numbers."""
    parts = [part for part in typing.get_args(hint) if part is not Ellipsis]
    inner = {member for part in parts for member in _members(part)}
    return typing.get_origin(hint) in ROWS and bool(inner) and inner <= {int, float}


def _is_table(hint: Any) -> bool:
    """True for a tuple of any number of rows."""
    parts = typing.get_args(hint)
    is_open = typing.get_origin(hint) is tuple and len(parts) == 2 and parts[1] is Ellipsis
    return is_open and _is_row(parts[0])


def _all_within(array: NDArray[Any], least: float, most: float) -> bool:
    """True for an array of floats from `least` to `most`, at least one."""
    if array.dtype != float or not array.ndim or not array.size:
        return False
    return bool(least <= array.min() and array.max() <= most)


def _require_even(name: str, rows: tuple[Any, ...] | list[Any]) -> None:
    lengths = sorted({len(row) for row in rows if isinstance(row, tuple | list)})
    if len(lengths) > 1:
        raise InputError(
            f"{name} has rows of {', '.join(map(str, lengths))} numbers; give rows of one length",
            quantity=name,
        )


def _require_complex(name: str, value: Any) -> None:
    array = np.asarray(value)
    if array.dtype.kind not in "fiuc" or not np.all(np.isfinite(array)):
        raise InputError(
            f"{name} = {shortened(value)} cannot be used: it must be a finite number, real or "
            "complex, or an array of such numbers",
            quantity=name,
        )
