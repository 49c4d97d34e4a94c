"""A pydantic model for every frozen dataclass that a room owns, built from its annotations.

The rooms stay free of pydantic: a field annotated `Metre` becomes one that reads quantity text
with a dimension of length; unknown keys are refused.
"""

from __future__ import annotations

import dataclasses
import types
import typing
from collections.abc import Callable, Iterator
from typing import Annotated, Any, Literal, NamedTuple, Union

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, create_model

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import QuantityError


def _reads(unit: si.Unit) -> Callable[[Any], Any]:
    def read(value: Any) -> float:
        if isinstance(value, str):
            return si.parse_quantity(value, unit)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise QuantityError(
                f'{value!r} is no quantity; write a text like "{si.format_quantity(2.0, unit)}"'
            )
        # Only a number without dimension may stand bare; parse_quantity says so otherwise.
        return si.parse_quantity(repr(value), unit)

    return read


def _field_type(annotation: Any) -> Any:
    if isinstance(annotation, str):
        raise TypeError("annotations must be resolved before they are translated")
    origin, parts = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is tuple and len(parts) == 2 and parts[1] is Ellipsis:
        return list[_field_type(parts[0])]  # type: ignore[misc]
    if (unit := si.unit_of(annotation)) is not None:
        optional = type(None) in typing.get_args(annotation)
        number = Annotated[float, BeforeValidator(_reads(unit))]
        return (number | None) if optional else number
    if origin in (Union, types.UnionType):
        models = tuple(_field_type(part) for part in parts)
        if all(dataclasses.is_dataclass(part) for part in parts):
            return Annotated[Union[models], Field(discriminator="type")]  # noqa: UP007
        return Union[models]  # noqa: UP007
    if dataclasses.is_dataclass(annotation):
        return _reference(typing.cast(type, annotation))
    if members := family(annotation):
        kinds = tuple(_reference(member) for member in members)
        return Annotated[Union[kinds], Field(discriminator="type")]  # noqa: UP007
    return annotation


def family(annotation: Any) -> tuple[type[Any], ...]:
    """The dataclasses that a field annotated with their common base may hold, told apart by the
    key ``type``; empty for an annotation that is no such base.

    A base is a class that is no dataclass itself. Its members are the dataclasses below it with a
    ``type``; whoever reads a file imports the modules that define them first.
    """
    if not isinstance(annotation, type) or dataclasses.is_dataclass(annotation):
        return ()
    members: dict[tuple[str, str], type[Any]] = {}
    todo: list[type[Any]] = list(annotation.__subclasses__())
    while todo:
        cls = todo.pop(0)
        todo += cls.__subclasses__()
        if dataclasses.is_dataclass(cls) and "type" in {f.name for f in dataclasses.fields(cls)}:
            # A class with slots replaces itself; the later one is the one in use.
            members[cls.__module__, cls.__qualname__] = cls
    return tuple(members.values())


def reads_from_file(field: dataclasses.Field[Any]) -> bool:
    """True for a field that is the user's to write (and not filled in by the loader)."""
    return bool(field.init and not field.metadata.get("loader", False))


def model_of(cls: type[Any]) -> type[BaseModel]:
    """The pydantic model that reads the dataclass `cls`, built once.

    Dataclasses may hold one another, or themselves, in a circle.
    """
    if cls not in _MODELS:
        model: type[BaseModel] = _build_model(cls)
        _MODELS[cls] = model
        # What was in the making when it was referred to is made now, unless this is within it.
        if not _IN_THE_MAKING:
            names = {_name(one): made for one, made in _MODELS.items()}
            for made in _UNFINISHED:
                made.model_rebuild(force=True, _types_namespace=names)
            _UNFINISHED.clear()
        return model
    return _MODELS[cls]


_MODELS: dict[type[Any], type[BaseModel]] = {}
OWNERS: dict[type[BaseModel], type[Any]] = {}
"""The dataclass that each model reads."""
_IN_THE_MAKING: list[type[Any]] = []
_UNFINISHED: list[type[BaseModel]] = []


def _name(cls: type[Any]) -> str:
    return f"{cls.__module__}_{cls.__qualname__}".replace(".", "_").replace("<locals>", "local")


def _reference(cls: type[Any]) -> Any:
    """The model of a dataclass, or its name while it is being built further up."""
    return typing.ForwardRef(_name(cls)) if cls in _IN_THE_MAKING else model_of(cls)


def _build_model(cls: type[Any]) -> type[BaseModel]:
    hints = si.hints_of(cls)
    fields: dict[str, Any] = {}
    _IN_THE_MAKING.append(cls)
    try:
        for field in dataclasses.fields(cls):
            if not reads_from_file(field):
                continue
            default: Any = ...
            if field.default is not dataclasses.MISSING:
                default = field.default
            # A discriminator must be written by the user, whatever default the dataclass has.
            if typing.get_origin(hints[field.name]) is Literal and field.name == "type":
                default = ...
            fields[field.name] = (_field_type(hints[field.name]), default)
        model: type[BaseModel] = create_model(
            cls.__name__,
            __config__=ConfigDict(extra="forbid", strict=True, frozen=True),
            __doc__=cls.__doc__,
            **fields,
        )
    finally:
        _IN_THE_MAKING.pop()
    _UNFINISHED.append(model)
    OWNERS[model] = cls
    return model


class Leaf(NamedTuple):
    """A value of a description: where it stands, its annotation, its field."""

    path: tuple[str | int, ...]
    value: Any
    hint: Any
    field: dataclasses.Field[Any]


def leaves(node: Any, path: tuple[str | int, ...] = ()) -> Iterator[Leaf]:
    """Every value below a dataclass that a file may describe it by, in order; none for one left
    out."""
    hints = si.hints_of(type(node))
    for field in dataclasses.fields(node):
        if field.metadata.get("loader") or field.metadata.get("found"):
            continue
        value, here = getattr(node, field.name), (*path, field.name)
        if dataclasses.is_dataclass(value):
            yield from leaves(value, here)
        elif isinstance(value, tuple):
            for index, item in enumerate(value):
                yield from leaves(item, (*here, index))
        elif value is not None:
            yield Leaf(here, value, hints[field.name], field)
