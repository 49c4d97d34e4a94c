"""The one check of numbers: what public calls take, and that what they give is finite.

`checked_numbers` reads the annotations of a function, a method or a dataclass and refuses what is
no such number before anything is computed with it; `closed_form` does the same for a formula and
registers it. Both refuse to give a number that is not finite: arguments so extreme that a float
cannot hold what comes of them raise `OutOfRangeError`.

Bounds stand in the annotation too (`squeezefilm.core.quantities.bounds`), or a hard limit
(`squeezefilm.core.hard_limits`): ``Annotated[Metre, SIDE]``. What depends on other values, or is
refused in another way, stands with `require`.
"""

from __future__ import annotations

import collections.abc
import functools
import inspect
import math
import sys
import types
import typing
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, is_dataclass
from typing import Any, Literal, ParamSpec, TypeVar

import numpy as np

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.quantities import outermost
from squeezefilm.core.quantities.bounds import ROWS, Limit, bounds_of
from squeezefilm.core.quantities.plain_values import (
    IsPlain,
    never_plain,
    or_none,
    plainly_array,
    plainly_complex,
    plainly_either,
    plainly_number,
    plainly_one_of,
)
from squeezefilm.core.quantities.require import (
    HOLDS,
    is_whole,
    require,
    require_one_of,
    shortened,
)
from squeezefilm.core.quantities.units import Unit, unit_of

__all__ = ["CLOSED_FORMS", "checked_numbers", "closed_form"]

_PURE = Unit("1")
_MOST_BITS = 64
_MOST = sys.float_info.max

_Kind = Literal[
    "number", "array", "either", "complex", "count", "row", "table", "container", "word"
]


@dataclass(frozen=True, slots=True)
class _Rule:
    """What an annotation says of an argument: one number, an array, either, a count, a row (a
    tuple or list of numbers), a table (a tuple of rows), or numbers in another container, which is
    left as it is; or a word, one of `words`. `length` is of a row, `bounds` as `require` takes
    them. One of `records`, which checked its own numbers, may stand in a number's place."""

    kind: _Kind
    unit: Unit
    optional: bool
    bounds: dict[str, Any]
    limits: tuple[Limit, ...]
    length: int | None = None
    words: tuple[Any, ...] = ()
    records: tuple[type, ...] = ()

    is_plain: IsPlain = field(init=False, compare=False)

    def __post_init__(self) -> None:
        # Both ends within, and no float beyond: what most calls give is checked by two comparisons.
        ends = {word: bound for word, bound in self.bounds.items() if self.kind != "count"}
        lows = [
            ends.get("at_least", -_MOST),
            math.nextafter(ends.get("above", -math.inf), math.inf),
        ]
        highs = [ends.get("at_most", _MOST), math.nextafter(ends.get("below", math.inf), -math.inf)]
        for limit in self.limits:
            # A limit that does not say its ends is asked itself.
            lows.append(getattr(limit, "least", math.inf))
            highs.append(getattr(limit, "most", -math.inf))
        reach = max(-_MOST, *lows), min(_MOST, *highs)
        look: IsPlain = {
            "number": plainly_number(*reach),
            "array": plainly_array(*reach),
            "either": plainly_either(*reach),
            "complex": plainly_complex if not self.limits else never_plain,
            "word": plainly_one_of(self.words),
        }.get(self.kind, never_plain)
        object.__setattr__(self, "is_plain", or_none(look) if self.optional else look)

    def within(self, value: Any) -> bool:
        """Whether a number is within the bounds."""
        return all(HOLDS[word](value, bound) for word, bound in self.bounds.items())


def _members(hint: Any) -> list[Any]:
    """The types that an annotation allows, without their units."""
    if typing.get_origin(hint) is typing.Annotated:
        return _members(hint.__origin__)
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        return [member for part in typing.get_args(hint) for member in _members(part)]
    return [hint]


def _rule(hint: Any, more: dict[str, Any]) -> _Rule | None:
    """The rule of an annotation and of `more` bounds, None where it stands for no number."""
    members = _members(hint)
    plain = [member for member in members if member is not type(None)]
    if all(typing.get_origin(member) is Literal for member in plain) and plain:
        words = tuple(word for member in plain for word in typing.get_args(member))
        return _Rule("word", _PURE, len(plain) < len(members), {}, (), words=words)
    unit = unit_of(hint)
    records = tuple(m for m in plain if unit and isinstance(m, type) and is_dataclass(m))
    plain = [member for member in plain if member not in records]
    kinds = {typing.get_origin(member) or member for member in plain}
    kind: _Kind
    if kinds == {float}:
        kind = "number"
    elif kinds == {int}:
        kind = "count"
    elif kinds == {float, np.ndarray}:
        kind = "either"
    elif kinds in ({complex}, {complex, np.ndarray}):
        kind = "complex"
    elif kinds == {np.ndarray} and "float64" in str(plain[0]):
        kind = "array"
    elif kinds == {np.ndarray} and "complex128" in str(plain[0]):
        kind = "complex"
    elif collections.abc.Callable in kinds:
        return None
    elif len(plain) == 1 and _is_row(plain[0]):
        kind = "row"
    elif len(plain) == 1 and (rows := _rows_of(plain[0])) is not None:
        kind = "table"
        plain = [rows]
    elif unit is not None:
        kind = "container"
    else:
        return None
    is_tuple = typing.get_origin(plain[0]) is tuple
    parts = typing.get_args(plain[0]) if kind in ("row", "table") and is_tuple else (Ellipsis,)
    length = None if Ellipsis in parts else len(parts)
    bounds, limits = bounds_of(hint)
    optional = type(None) in members
    return _Rule(kind, unit or _PURE, optional, bounds | more, limits, length, records=records)


def _is_row(hint: Any) -> bool:
    """Whether an annotation is a tuple, a list or a sequence of plain numbers."""
    parts = [part for part in typing.get_args(hint) if part is not Ellipsis]
    inner = {member for part in parts for member in _members(part)}
    return typing.get_origin(hint) in ROWS and bool(inner) and inner <= {int, float}


def _rows_of(hint: Any) -> Any:
    """The annotation of the rows of a tuple of any number of rows; None for anything else."""
    parts = typing.get_args(hint)
    is_table = typing.get_origin(hint) is tuple and len(parts) == 2 and parts[1] is Ellipsis
    return parts[0] if is_table and _is_row(parts[0]) else None


def _checked_value(name: str, value: Any, rule: _Rule) -> Any:
    """The value as the call takes it, floats for numbers. Raises `InputError`."""
    if rule.is_plain(value) or isinstance(value, rule.records):
        return value
    if value is None and rule.optional:
        return value
    value = _in_kind(name, value, rule)
    for limit in rule.limits:
        limit.refuse_outside(value, name)
    return value


def _in_kind(name: str, value: Any, rule: _Rule) -> Any:
    if rule.kind == "word":
        require_one_of(name, value, rule.words)
        return value
    if rule.kind == "count":
        return _count(name, value, rule)
    if rule.kind == "complex":
        return _complex_value(name, value)
    if rule.kind == "table" and isinstance(value, tuple | list):
        if not value:
            return value
        lengths = sorted({len(row) for row in value if isinstance(row, tuple | list)})
        if len(lengths) > 1:
            raise InputError(
                f"{name} has rows of {', '.join(map(str, lengths))} numbers; give rows of one "
                "length",
                quantity=name,
            )
    axes = {"row": 1, "table": 2}.get(rule.kind)
    require(name, value, rule.unit, axes=axes, **rule.bounds)
    if hasattr(value, "magnitude"):
        return value
    array = np.asarray(value, dtype=float)
    if rule.kind == "number" and array.ndim:
        raise InputError(f"{name} has the shape {array.shape}; one number is wanted", quantity=name)
    if rule.kind in ("array", "container") and not array.ndim:
        raise InputError(
            f"{name} is one number; an array of at least one sample is wanted", quantity=name
        )
    if rule.kind == "table":
        if rule.length not in (None, array.shape[1]):
            raise InputError(
                f"{name} has rows of {array.shape[1]} numbers; give {rule.length} in each",
                quantity=name,
            )
        return tuple(map(tuple, value.tolist())) if isinstance(value, np.ndarray) else value
    if rule.length not in (None, array.size):
        raise InputError(f"{name} holds {array.size} numbers; give {rule.length}", quantity=name)
    if rule.kind == "row":
        return tuple(value.tolist()) if isinstance(value, np.ndarray) else value
    if rule.kind == "container":
        return value
    if not array.size:
        raise InputError(f"{name} is empty; at least one sample is wanted", quantity=name)
    return array if array.ndim else float(array)


def _count(name: str, value: Any, rule: _Rule) -> Any:
    counted = is_whole(value) and int(value).bit_length() <= _MOST_BITS
    if counted and rule.within(value):
        return value
    wanted = [f"{word.replace('_', ' ')} {bound:.0f}" for word, bound in rule.bounds.items()]
    raise InputError(
        f"{name} = {value if counted else shortened(value)} cannot be used: it must be a whole "
        f"number {' and '.join(wanted) or f'of at most {_MOST_BITS} bits'}",
        quantity=name,
    )


def _complex_value(name: str, value: Any) -> Any:
    array = np.asarray(value)
    if array.dtype.kind not in "fiuc" or not np.all(np.isfinite(array)):
        raise InputError(
            f"{name} = {shortened(value)} cannot be used: it must be a finite number, real or "
            "complex, or an array of such numbers",
            quantity=name,
        )
    return value


def _finite(result: Any) -> bool:
    """Whether the floats, and arrays of floats, of a result are all finite."""
    if isinstance(result, float):
        return math.isfinite(result)
    if isinstance(result, tuple):
        return all(map(_finite, result))
    if isinstance(result, complex | np.ndarray) or hasattr(result, "magnitude"):
        array = np.asarray(getattr(result, "magnitude", result))
        return array.dtype.kind not in "fc" or bool(np.isfinite(array).all())
    return True


def _beyond(function: Callable[..., Any], arguments: dict[str, Any], why: str) -> OutOfRangeError:
    shown = [f"{k} = {v:.4g}" for k, v in arguments.items() if isinstance(v, float)]
    what = function.__qualname__.removesuffix(".__init__")
    return OutOfRangeError(
        f"{what} leaves the range of a float ({why})"
        + (f" at {', '.join(shown)} in SI units" if shown else "")
        + "; take values of a size that occurs"
    )


def _require_broadcast(shapes: list[tuple[str, tuple[int, ...]]]) -> None:
    try:
        np.broadcast_shapes(*(shape for _, shape in shapes))
    except ValueError:
        of = ", ".join(f"{name} {shape}" for name, shape in shapes)
        raise InputError(f"the shapes of {of} do not broadcast") from None


_P = ParamSpec("_P")
_R = TypeVar("_R")
_T = TypeVar("_T", bound=Callable[..., Any])

CLOSED_FORMS: dict[str, Callable[..., Any]] = {}
"""Every closed form by its dotted name, so that one test can call them all with pint quantities."""


def _guarded(
    function: Callable[_P, _R],
    strictly: frozenset[str] = frozenset(),
    weakly: frozenset[str] = frozenset(),
    module: str | None = None,
) -> Callable[_P, _R]:
    """The function, its arguments checked before and its result after; `module` is where names of
    its annotations are looked up, unless in its own globals."""
    names = list(inspect.signature(function).parameters)
    ruled: list[tuple[int, str, _Rule]] = []
    looks: list[tuple[int, str, IsPlain, bool]] = []
    unknown = (strictly | weakly) - set(names)
    if unknown:
        raise TypeError(f"{function.__qualname__} has no argument {sorted(unknown)}")
    rules: dict[str, _Rule] = {}
    ready: list[bool] = []
    makes = function.__name__ in ("__init__", "__new__")

    def read_annotations() -> None:
        # The result's annotation may be imported for type checking only.
        taken = types.SimpleNamespace(__annotations__=dict(inspect.get_annotations(function)))
        taken.__annotations__.pop("return", None)
        its_own = getattr(inspect.unwrap(function), "__globals__", {})
        names_there = its_own if module is None else vars(sys.modules[module])
        hints = typing.get_type_hints(taken, names_there, include_extras=True)
        for name, hint in hints.items():
            more = {"above": 0.0} if name in strictly else {}
            more |= {"at_least": 0.0} if name in weakly else {}
            if (rule := _rule(hint, more)) is not None:
                rules[name] = rule
            elif any(bounds_of(hint)):
                raise TypeError(f"{function.__qualname__}: {name} is bounded and is no number")
        ruled.extend((at, name, rules[name]) for at, name in enumerate(names) if name in rules)
        looks.extend((at, name, rule.is_plain, rule.kind == "either") for at, name, rule in ruled)
        ready.append(True)

    def is_plain(args: tuple[Any, ...], kwargs: dict[str, Any]) -> bool:
        """Whether all is plainly good as it is, with one shape at most to broadcast."""
        count, shapes = len(args), 0
        for at, name, look, broadcasts in looks:
            if at < count:
                value = args[at]
            elif name in kwargs:
                value = kwargs[name]
            else:
                continue
            if not look(value):
                return False
            if broadcasts and type(value) is np.ndarray:
                shapes += 1
        return shapes < 2

    def check(args: list[Any], kwargs: dict[str, Any]) -> None:
        """Check arguments and put what the call takes in their place."""
        shapes: list[tuple[str, tuple[int, ...]]] = []
        count = len(args)
        for at, name, rule in ruled:
            if at < count:
                args[at] = good = _checked_value(name, args[at], rule)
            elif name in kwargs:
                kwargs[name] = good = _checked_value(name, kwargs[name], rule)
            else:
                continue
            if rule.kind == "either" and isinstance(good, np.ndarray):
                shapes.append((name, good.shape))
        if len(shapes) > 1:
            _require_broadcast(shapes)

    @functools.wraps(function)
    def guarded(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        if outermost.WITHIN.get() and not makes:
            return function(*args, **kwargs)
        if not ready:
            read_annotations()
        if len(args) > len(names):
            return function(*args, **kwargs)  # which says how many arguments it takes
        given: Sequence[Any] = args
        if not is_plain(args, kwargs):
            given = list(args)
            check(given, kwargs)
        token = outermost.WITHIN.set(True) if outermost.ONLY.get() and not makes else None
        try:
            with np.errstate(over="raise", divide="raise", invalid="raise"):
                result = function(*given, **kwargs)
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            asked = dict(zip(names, given, strict=False)) | kwargs
            raise _beyond(function, asked, str(error)) from error
        finally:
            if token is not None:
                outermost.WITHIN.reset(token)
        if result is None or _finite(result):
            return result
        asked = dict(zip(names, given, strict=False)) | kwargs
        raise _beyond(function, asked, "the result is not finite")

    return guarded


def checked_numbers(item: _T) -> _T:
    """Check what a function, a method, a dataclass or a `NamedTuple` takes against its annotations,
    and what it gives.

    An argument annotated as a number (`Metre`, `float`, `int`) is one finite number, one annotated
    as an array (`MetreArray`) a finite array, one that may be either (`MetreLike`) broadcasts with
    the others; whole numbers and arrays of them arrive as floats. The call raises `InputError` for
    anything else, and `OutOfRangeError` where the arithmetic overflows, divides by zero or gives a
    number that is not finite.
    """
    if isinstance(item, type):
        made = typing.cast(Any, item)
        if issubclass(item, tuple):
            made.__new__ = _guarded(made.__new__, module=item.__module__)
        else:
            made.__init__ = _guarded(made.__init__)
        return typing.cast(_T, item)
    return typing.cast(_T, _guarded(item))


def closed_form(
    *, positive: str = "", nonnegative: str = ""
) -> Callable[[Callable[_P, _R]], Callable[_P, _R]]:
    """Mark a formula: it enters `CLOSED_FORMS`, and is `checked_numbers`.

    `positive` and `nonnegative` name arguments (separated by blanks). The formula itself must use
    only arithmetic and NumPy functions, so that it can be called with pint quantities.
    """

    def mark(function: Callable[_P, _R]) -> Callable[_P, _R]:
        guarded = _guarded(function, frozenset(positive.split()), frozenset(nonnegative.split()))
        CLOSED_FORMS[f"{function.__module__}.{function.__qualname__}"] = guarded
        return guarded

    return mark
