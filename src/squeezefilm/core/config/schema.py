"""Frozen dataclasses from and to TOML: a pydantic model for each that a room owns, built from its
annotations, and text with units, such that `load_text` reads the same value back.

The rooms stay free of pydantic: a field annotated `Metre` becomes one that reads quantity text
with a dimension of length; unknown keys are refused.
"""

from __future__ import annotations

import dataclasses
import json
import math
import types
import typing
from collections.abc import Callable, Iterator, Mapping, Set
from decimal import Decimal
from typing import Annotated, Any, Literal, NamedTuple, Union

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, create_model

from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance, read_only
from squeezefilm.core.config.syntax import DEEPEST
from squeezefilm.core.distributions import Normal
from squeezefilm.core.errors import InputError, QuantityError
from squeezefilm.core.hard_limits import DESCRIPTION_BYTES, require_within


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


_Path = tuple[str, ...]
_NO_SOURCES: Mapping[str, Provenance] = read_only({})


def text_of(value: Any, sources: Mapping[str, Provenance] = _NO_SOURCES) -> str:
    """The TOML text of a frozen dataclass: `load_text(type(value), text_of(value)) == value`.

    Quantities are written with a readable unit and every digit they have ("0.4 mm"); keys at
    their default are left out, but for a union's `type`. Where values are from is written for those
    in `sources`, by dotted path as `provenance` has them, with their spread.

    Raises:
        InputError: a value that has no place in a file: no dataclass, a number that is not finite,
            or more text than a file may have.
    """
    lines: list[str] = []
    _table(value, (), lines, sources, "")
    text = "\n".join(lines).strip("\n") + "\n"
    try:
        size = len(text.encode("utf-8"))
    except UnicodeEncodeError as error:
        raise InputError(f"half a character cannot be written: {error}") from error
    require_within(DESCRIPTION_BYTES, size, enough="give an image fewer pixels")
    return text


def _table(
    value: Any, path: _Path, lines: list[str], sources: Mapping[str, Provenance], at: str
) -> None:
    """The keys of a dataclass, then its tables, each below its own header; `at` is the dotted path
    of its keys, with a dot at its end."""
    if not dataclasses.is_dataclass(value) or isinstance(value, type):
        raise InputError(f"{value!r} is no dataclass and cannot be written")
    # A name may stand for a list and the table in it; a line holds up to four more.
    if 2 * len(path) + 4 > DEEPEST:
        raise InputError(f"it is nested {len(path)} tables deep, too deep to be read; nest less")
    tables: list[tuple[str, Any]] = []
    stated = {source.removeprefix(at) for source in sources if source.startswith(at)}
    for name, item, hint in _written(value, stated):
        if _holds_tables(item) and not _fits_a_line(item):
            tables.append((name, item))
        else:
            text = _inline(item, hint)
            if name in stated:
                text = _with_source(text, item, hint, sources[at + name])
            lines.append(f"{name} = {text}")
    for name, item in tables:
        here = (*path, name)
        if isinstance(item, tuple):
            for number, entry in enumerate(item):
                lines.extend(["", f"[[{'.'.join(here)}]]"])
                _table(entry, here, lines, sources, f"{at}{name}.{number}.")
        else:
            lines.extend(["", f"[{'.'.join(here)}]"])
            _table(item, here, lines, sources, f"{at}{name}.")


def _with_source(text: str, value: Any, hint: Any, source: Provenance) -> str:
    """The inline table of a value that says where it is from and how sure it is."""
    pairs = [f"value = {text}"]
    if source.source:
        pairs.append(f"source = {_inline(source.source, str)}")
    pairs.append(f'evidence = "{source.evidence}"')
    unit = si.unit_of(hint)
    if source.distribution is not None and unit is not None:
        if isinstance(source.distribution, Normal) and source.distribution.mean == value:
            spread = _as_text(source.distribution.standard_deviation, unit)
            pairs.append(f"uncertainty = {spread}")
        else:
            low, high = (_as_text(end, unit) for end in source.distribution.support)
            pairs.append(f"range = [{low}, {high}]")
    return "{ " + ", ".join(pairs) + " }"


def _as_text(value: float, unit: si.Unit) -> str:
    """A quantity as a text, one without a unit too."""
    text = _quantity(value, unit)
    return text if text.startswith('"') else f'"{text}"'


def _written(value: Any, stated: Set[str] = frozenset()) -> Iterator[tuple[str, Any, Any]]:
    """Name, value and annotation of the fields that are written, the `type` first; those with a
    `stated` source even at their default."""
    hints = si.hints_of(type(value))
    for field in sorted(dataclasses.fields(value), key=lambda one: one.name != "type"):
        item = getattr(value, field.name)
        kept = field.name == "type" or field.name in stated or not _is_default(field, item)
        if reads_from_file(field) and kept and item is not None:
            yield field.name, item, hints[field.name]


def _is_default(field: dataclasses.Field[Any], item: Any) -> bool:
    # 0.0 equals -0.0, which must not be lost.
    same = type(item) is type(field.default) and repr(item) == repr(field.default)
    return item is None or (same and item == field.default)


def _holds_tables(item: Any) -> bool:
    if isinstance(item, tuple):
        return any(_holds_tables(item_of_list) for item_of_list in item)
    return dataclasses.is_dataclass(item)


def _fits_a_line(item: Any) -> bool:
    """A table of plain values, like a coordinate, stands on the line of its key."""
    if isinstance(item, tuple):
        return False
    values = [getattr(item, field.name) for field in dataclasses.fields(item)]
    return len(values) <= 3 and not any(
        isinstance(value, tuple) or _holds_tables(value) for value in values
    )


def _inline(item: Any, hint: Any) -> str:
    if isinstance(item, tuple):
        inner = typing.get_args(hint)[0]
        return "[" + ", ".join(_inline(value, inner) for value in item) + "]"
    if dataclasses.is_dataclass(item):
        pairs = [f"{name} = {_inline(part, hint)}" for name, part, hint in _written(item)]
        return "{ " + ", ".join(pairs) + " }"
    if isinstance(item, bool):
        return "true" if item else "false"
    if isinstance(item, str):
        return json.dumps(item, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(item, int | float) and (unit := si.unit_of(hint)) is not None:
        return _quantity(float(item), unit)
    if isinstance(item, int):
        return str(item)
    raise InputError(f"{item!r} has no unit or no place in a TOML file and cannot be written")


def _quantity(value: float, unit: si.Unit) -> str:
    if not math.isfinite(value):
        raise InputError(f"{value!r} is not finite and cannot be written")
    if unit.symbol == "1":
        return repr(value)
    # The shortest digits that mean this float mean it in any decimal multiple of its unit too;
    # but a unit that is not scaled is rounded from the float itself, which may round elsewhere.
    digits = len(Decimal(repr(value)).as_tuple().digits)
    text = si.typed_quantity(value, unit, digits=digits)
    if si.parse_quantity(text, unit) != value:
        text = f"{value!r} {unit.symbol}"
    return f'"{text}"'
