"""Arguments of public calls: texts in place of numbers."""

from __future__ import annotations

import functools
import inspect
import typing
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import PurePath
from typing import Annotated, Any, TypeVar

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import QuantityError

_Callable = TypeVar("_Callable", bound=Callable[..., Any])
_Reader = Callable[[str, Any], Any]
_TEXTUAL = (str, list, tuple, PurePath)


@dataclass(frozen=True)
class ReadBy:
    """Function that reads such a value from text or a path, to stand beside its type."""

    read: Callable[[Any], Any]


def reads_text(target: _Callable) -> _Callable:
    """Let a function, or a class by its constructor, take text where its annotations have a unit
    or a reader.

    The signature stays. Lists and tuples of texts are read where their elements have a unit. The
    decorated raises `QuantityError` that names the argument for a text that is no quantity or of
    another dimension, and what a reader raises.
    """
    if isinstance(target, type):
        constructor: Any = target
        constructor.__init__ = _reading(constructor.__init__, target)
        return target
    return typing.cast(_Callable, _reading(target, target))


def _reading(function: Callable[..., Any], annotated: Any) -> Callable[..., Any]:
    readers: dict[str, _Reader] = {}

    @functools.wraps(function)
    def reading(*args: Any, **kwargs: Any) -> Any:
        if not any(isinstance(value, _TEXTUAL) for value in (*args, *kwargs.values())):
            return function(*args, **kwargs)
        if not readers:
            own = getattr(annotated, "record", annotated)
            hints = typing.get_type_hints(own, include_extras=True)
            readers.update((name, _reader(hint)) for name, hint in hints.items())
        try:
            bound = inspect.signature(function).bind(*args, **kwargs)
        except TypeError:
            # Python's own words for missing and unknown arguments are the better ones.
            return function(*args, **kwargs)
        for name, value in bound.arguments.items():
            if name in readers and isinstance(value, _TEXTUAL):
                bound.arguments[name] = readers[name](name, value)
        return function(*bound.args, **bound.kwargs)

    return reading


def _reader(annotation: Any) -> _Reader:
    mark = next(_marks(annotation), None)
    if isinstance(mark, ReadBy):
        return functools.partial(_named, mark)
    return functools.partial(_quantities, mark)


def _marks(annotation: Any) -> Iterator[si.Unit | ReadBy]:
    """The units and readers in an annotation, within unions and sequences too."""
    if typing.get_origin(annotation) is Annotated:
        yield from (mark for mark in annotation.__metadata__ if isinstance(mark, si.Unit | ReadBy))
    for part in typing.get_args(annotation):
        yield from _marks(part)


def _named(by: ReadBy, _: str, value: Any) -> Any:
    return by.read(value) if isinstance(value, str | PurePath) else value


def _quantities(unit: si.Unit | None, name: str, value: Any) -> Any:
    if unit is None:
        return value
    if isinstance(value, list | tuple):
        if not any(isinstance(item, str) for item in value):
            return value
        return type(value)(_quantities(unit, name, item) for item in value)
    if not isinstance(value, str):
        return value
    try:
        return si.parse_quantity(value, unit)
    except QuantityError as error:
        raise QuantityError(f"{name}: {error}", quantity=name) from error
