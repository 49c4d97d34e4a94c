"""The one check of numbers: what public calls take, and that what they give is finite.

`checked_numbers` reads the annotations of a function, a method or a dataclass and refuses what is
no such number before anything is computed with it; `closed_form` does the same for a formula and
registers it. Both refuse to give a number that is not finite: arguments so extreme that a float
cannot hold what comes of them raise `OutOfRangeError`.

Bounds stand in the annotation too (`squeezefilm.core.quantities.require`), or a hard limit
(`squeezefilm.core.hard_limits`): ``Annotated[Metre, SIDE]``; another argument or field may be the
bound: ``Annotated[Metre, Above("inner_radius")]``. What depends on more, or is refused in another
way, stands with `require`.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import inspect
import math
import types
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextvars import ContextVar
from typing import Any, ParamSpec, TypeVar

import numpy as np

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.quantities.require import bounds_of, require
from squeezefilm.core.quantities.rules import Rule, rule_of
from squeezefilm.core.quantities.units import hints_of

__all__ = ["CLOSED_FORMS", "checked_numbers", "closed_form", "outermost_checked"]

_P = ParamSpec("_P")
_R = TypeVar("_R")
_T = TypeVar("_T", bound=Callable[..., Any])

CLOSED_FORMS: dict[str, Callable[..., Any]] = {}
"""Every closed form by its dotted name, so that one test can call them all with pint quantities."""

_ONLY: ContextVar[bool] = ContextVar("only the outermost is checked", default=False)
_WITHIN: ContextVar[bool] = ContextVar("within a call that was checked", default=False)


@contextlib.contextmanager
def outermost_checked() -> Iterator[None]:
    """Check only the outermost of functions that call each other: for calls made hundreds of
    thousands of times, a third of whose time went into such looks.

    The outermost answers for all within it that what comes of them is finite, and what a dataclass
    takes is checked as ever; what a function within another refuses by its annotations alone is not
    refused.
    """
    token = _ONLY.set(True)
    try:
        yield
    finally:
        _ONLY.reset(token)


class _Arguments:
    """The arguments of a function and their rules, read from its annotations at the first call.

    `more` are further bounds by name; annotations are those of the fields of `made`, without one
    those of the function.
    """

    def __init__(
        self,
        function: Callable[..., Any],
        more: Mapping[str, dict[str, float]],
        made: type[Any] | None,
    ) -> None:
        parameters = inspect.signature(function).parameters
        self.names = list(parameters)
        self._defaults = {
            name: p.default for name, p in parameters.items() if p.default is not p.empty
        }
        self._function, self._more, self._made = function, more, made
        if unknown := set(more) - set(self.names):
            raise TypeError(f"{function.__qualname__} has no argument {sorted(unknown)}")

    @functools.cached_property
    def rules(self) -> tuple[tuple[int, str, Rule, bool], ...]:
        """Place, name and rule of each argument that is checked; True for those that broadcast."""
        function, rules = self._function, []
        if self._made is not None:
            hints = hints_of(self._made)
        else:
            # The result's annotation may be imported for type checking only.
            taken = types.SimpleNamespace(__annotations__=dict(inspect.get_annotations(function)))
            taken.__annotations__.pop("return", None)
            names_there = getattr(inspect.unwrap(function), "__globals__", {})
            hints = typing.get_type_hints(taken, names_there, include_extras=True)
        for place, name in enumerate(self.names):
            if name not in hints:
                continue
            rule = rule_of(hints[name], self._more.get(name, {}))
            if rule is not None:
                rules.append((place, name, rule, rule.kind == "either"))
            elif any(bounds_of(hints[name])):
                raise TypeError(f"{function.__qualname__}: {name} is bounded and is no number")
        return tuple(rules)

    @functools.cached_property
    def between(self) -> tuple[tuple[str, Rule], ...]:
        """Name and rule of each argument that another one bounds."""
        return tuple((name, rule) for _, name, rule, _ in self.rules if rule.named_bounds)

    def checked(self, args: tuple[Any, ...], kwargs: dict[str, Any]) -> Sequence[Any]:
        """The arguments by place as the call takes them; those by name are put into `kwargs`.

        Raises `InputError`.
        """
        given: Sequence[Any] = args
        shapes: list[tuple[str, tuple[int, ...]]] = []
        for place, name, rule, broadcasts in self.rules:
            by_place = place < len(args)
            if not by_place and name not in kwargs:
                continue
            value = args[place] if by_place else kwargs[name]
            # Nearly all are good as they are.
            if not rule.is_plain(value):
                value = rule.checked(name, value)
                if by_place:
                    given = [*given[:place], value, *given[place + 1 :]]
                else:
                    kwargs[name] = value
            if broadcasts and isinstance(value, np.ndarray):
                shapes.append((name, value.shape))
        if len(shapes) > 1:
            _require_broadcast(shapes)
        if self.between:
            asked = self._defaults | dict(zip(self.names, given, strict=False)) | kwargs
            for name, rule in self.between:
                _require_between(name, asked.get(name), rule, asked)
        return given

    def beyond(self, args: Sequence[Any], kwargs: Mapping[str, Any], why: str) -> OutOfRangeError:
        """The error of a call whose arguments leave the range of a float."""
        asked = dict(zip(self.names, args, strict=False)) | dict(kwargs)
        shown = [f"{k} = {v:.4g}" for k, v in asked.items() if isinstance(v, float)]
        return OutOfRangeError(
            f"{self._function.__qualname__.removesuffix('.__init__')} leaves the range of a float "
            f"({why})"
            + (f" at {', '.join(shown)} in SI units" if shown else "")
            + "; take values of a size that occurs"
        )


def _guarded(
    function: Callable[_P, _R],
    more: Mapping[str, dict[str, float]] | None = None,
    made: type[Any] | None = None,
) -> Callable[_P, _R]:
    """The function, its arguments checked before and its result after."""
    arguments = _Arguments(function, more or {}, made)
    makes = function.__name__ in ("__init__", "__new__")

    @functools.wraps(function)
    def guarded(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        if _WITHIN.get() and not makes:
            return function(*args, **kwargs)
        if len(args) > len(arguments.names):
            return function(*args, **kwargs)  # which says how many arguments it takes
        given = arguments.checked(args, kwargs)
        token = _WITHIN.set(True) if _ONLY.get() and not makes else None
        try:
            with np.errstate(over="raise", divide="raise", invalid="raise"):
                result = function(*given, **kwargs)
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            raise arguments.beyond(given, kwargs, str(error)) from error
        finally:
            if token is not None:
                _WITHIN.reset(token)
        if result is None or _finite(result):
            return result
        raise arguments.beyond(given, kwargs, "the result is not finite")

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
            made.__new__ = _guarded(made.__new__, made=item)
        else:
            fields = item if dataclasses.is_dataclass(item) else None
            made.__init__ = _guarded(made.__init__, made=fields)
        return typing.cast(_T, item)
    return typing.cast(_T, _guarded(item))


def closed_form(
    *, positive: str = "", nonnegative: str = ""
) -> Callable[[Callable[_P, _R]], Callable[_P, _R]]:
    """Mark a formula: it enters `CLOSED_FORMS`, and is `checked_numbers`.

    `positive` and `nonnegative` name arguments (separated by blanks). The formula itself must use
    only arithmetic and NumPy functions, so that it can be called with pint quantities.
    """
    more = {name: {"at_least": 0.0} for name in nonnegative.split()}
    more |= {name: {"above": 0.0} for name in positive.split()}

    def mark(function: Callable[_P, _R]) -> Callable[_P, _R]:
        guarded = _guarded(function, more)
        CLOSED_FORMS[f"{function.__module__}.{function.__qualname__}"] = guarded
        return guarded

    return mark


def _finite(result: Any) -> bool:
    """True where the floats, and arrays of floats, of a result are all finite."""
    if isinstance(result, float):
        return math.isfinite(result)
    if isinstance(result, tuple):
        return all(map(_finite, result))
    if isinstance(result, complex | np.ndarray) or hasattr(result, "magnitude"):
        array = np.asarray(getattr(result, "magnitude", result))
        return array.dtype.kind not in "fc" or bool(np.isfinite(array).all())
    return True


def _require_between(name: str, value: Any, rule: Rule, asked: Mapping[str, Any]) -> None:
    for word, other in rule.named_bounds:
        first, *rest = other.split(".")
        bound = asked.get(first)
        for part in rest:
            bound = getattr(bound, part, None)
        if value is None or bound is None:
            continue
        try:
            require(name, value, rule.unit, **{word: bound})
        except InputError as error:
            raise InputError(f"{error}, which is {other}", quantity=name) from None


def _require_broadcast(shapes: list[tuple[str, tuple[int, ...]]]) -> None:
    try:
        np.broadcast_shapes(*(shape for _, shape in shapes))
    except ValueError:
        of = ", ".join(f"{name} {shape}" for name, shape in shapes)
        raise InputError(f"the shapes of {of} do not broadcast") from None
