"""`load(type, path)`: read, check and build, with errors that name file, line, key and value."""

from __future__ import annotations

import dataclasses
import tomllib
import types
import typing
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar, Union

from pydantic import BaseModel, ValidationError

from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import (
    Provenance,
    References,
    Spread,
    described,
    distribution_of,
    read_only,
    split_provenance,
    stated_sources,
    tree_values,
    value_at,
)
from squeezefilm.core.config.schema import OWNERS, family, model_of, reads_from_file
from squeezefilm.core.config.syntax import DEEPEST, explained, locate, require_quick_toml
from squeezefilm.core.distributions import Distribution
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.regular_file import read_toml_text

T = TypeVar("T")
_Path = tuple[str | int, ...]
MOST_ERRORS = 20
"""Errors of one file that are told; each is looked for in the text."""


@dataclasses.dataclass(frozen=True)
class _Source:
    """The TOML text that is read, and the file it is from, for messages."""

    text: str
    file: str | Path | None
    plain: Any = None

    def typed(self, path: Sequence[str | int]) -> Any:
        """The value at a path of the text, None where nothing does."""
        value = self.plain
        for part in path:
            try:
                value = value[part]
            except (KeyError, IndexError, TypeError):
                return None
        return value

    def error(self, message: str, path: Sequence[str | int]) -> ConfigError:
        """An error at a key, with its line."""
        key = ".".join(str(part + 1) if isinstance(part, int) else part for part in path)
        return ConfigError(message, file=self.file, line=locate(self.text, path), key=key or None)


def load(cls: type[T], path: str | Path) -> T:
    """The dataclass `cls` read from a TOML file.

    A field of `cls` named ``provenance`` (with ``metadata={"loader": True}``) receives the sources
    of the values by their dotted path. Raises `ConfigError` for anything that is not right, with
    file, line, key, what is allowed and a did-you-mean; it reports every error it can see at once.
    """
    text = read_toml_text(path)
    return load_text(cls, text, file=Path(path))


def load_text(cls: type[T], text: str, *, file: str | Path | None = None) -> T:
    """The dataclass `cls` read from TOML text; `file` is what messages name. See `load`."""
    require_quick_toml(text, file)
    try:
        raw = tomllib.loads(text)
    except ValueError as error:
        # Beside TOMLDecodeError: a whole number of more digits than Python takes.
        raise explained(text, error, file) from error
    except RecursionError as error:
        raise ConfigError("is nested too deeply to be read; nest less", file=file) from error
    if (depth := _depth(raw)) > DEEPEST:
        raise ConfigError(f"is nested {depth} deep; at most {DEEPEST} are read", file=file)
    fields = [field for field in dataclasses.fields(cls) if reads_from_file(field)]  # type: ignore[arg-type]
    if not raw and _needed(fields):
        raise ConfigError(f"is empty; {_keys_of(cls, fields)}", file=file)
    source = _Source(text, file)
    references: References | None = getattr(cls, "references", None)
    original = None
    try:
        if references is not None:
            raw, original = references.written_out(raw)
        split = split_provenance(raw, of_tables=references is not None)
    except ConfigError as error:
        place = locate(text, (error.key or "").split("."))
        raise ConfigError(error.message, file=file, line=place, key=error.key) from error
    source = dataclasses.replace(source, plain=split.plain)
    try:
        model = model_of(cls).model_validate(split.plain)
    except ValidationError as error:
        raise _all_errors(cls, error, source) from error
    built = _build(model, (), source)
    if any(field.name == "provenance" for field in dataclasses.fields(cls)):  # type: ignore[arg-type]
        for key, spread in split.spreads.items():
            distribution = _distribution(built, key, spread, source)
            split.sources[key] = dataclasses.replace(split.sources[key], distribution=distribution)
        sources = split.sources if references is None else stated_sources(built, split, original)
        built = dataclasses.replace(built, provenance=read_only(sources))
    return typing.cast(T, built)


def _depth(tree: Any) -> int:
    """The depth to which tables and lists are nested, with no recursion that a file could
    exhaust."""
    deepest, todo = 0, [(tree, 1)]
    while todo:
        node, depth = todo.pop()
        deepest = max(deepest, depth)
        inner = node.values() if isinstance(node, dict) else node
        todo += [(item, depth + 1) for item in inner if isinstance(item, dict | list)]
    return deepest


def _distribution(built: Any, key: str, spread: Spread, source: _Source) -> Distribution:
    """The distribution of the value at a dotted path of what was built."""
    value, hint = value_at(built, key)
    try:
        unit = si.unit_of(hint)
        if unit is None:
            raise InputError("this is no quantity and has no uncertainty; leave it out")
        return distribution_of(value, unit, spread)
    except InputError as error:
        place = [int(part) if part.isdigit() else part for part in key.split(".")]
        raise source.error(str(error), place) from error


def _build(model: BaseModel, path: _Path, source: _Source) -> Any:
    cls = OWNERS[type(model)]
    values = {
        name: _built_value(getattr(model, name), (*path, name), source)
        for name in type(model).model_fields
    }
    try:
        return cls(**values)
    except ConfigError:
        raise
    except InputError as error:
        key = getattr(error, "quantity", None)
        at = (*path, key) if key in values else path
        raise source.error(_as_typed(error, si.hints_of(cls), at, source), at) from error


def _as_typed(error: InputError, hints: dict[str, Any], at: _Path, source: _Source) -> str:
    """An error's message, in the unit that was typed where that is none of SI's."""
    if at and isinstance(typed := source.typed(at), str) and at[-1] in hints:
        try:
            si.require_typed(str(at[-1]), typed, hints[str(at[-1])])
        except InputError as in_the_unit:
            return str(in_the_unit)
    return str(error)


def _built_value(value: Any, path: _Path, source: _Source) -> Any:
    if isinstance(value, BaseModel):
        return _build(value, path, source)
    if isinstance(value, list):
        items = enumerate(value)
        return tuple(_built_value(item, (*path, index), source) for index, item in items)
    return value


def _options(hint: Any) -> list[Any]:
    """The dataclasses that a union or a family allows; none for any other hint."""
    if typing.get_origin(hint) in (Union, types.UnionType):
        parts = typing.get_args(hint)
        return [
            member
            for part in parts
            for member in ((part,) if dataclasses.is_dataclass(part) else family(part))
        ]
    return list(family(hint))


def _all_errors(cls: type[Any], error: ValidationError, source: _Source) -> ConfigError:
    problems: list[ConfigError] = []
    count = error.error_count()
    for item in error.errors()[:MOST_ERRORS]:
        path, owner = _path_and_owner(cls, item["loc"])
        problems.append(source.error(_message(item, path, owner), path))
    if count == 1:
        return problems[0]
    lines = "\n".join(
        f"  {slip.key}: {slip.message}" + ("" if slip.line is None else f" (line {slip.line})")
        for slip in problems
    )
    more = f"\n  and {count - len(problems)} more" if count > len(problems) else ""
    return ConfigError(f"{count} things are not right:\n{lines}{more}", file=source.file)


def _path_and_owner(cls: type[Any], location: Sequence[str | int]) -> tuple[_Path, type[Any]]:
    """Strip the union tags that pydantic puts into a location; find the dataclass that owns the
    last key."""
    path: list[str | int] = []
    owner, hint = cls, typing.cast(Any, cls)
    for part in location:
        options = _options(hint)
        tagged = [option for option in options if _tag(option) == part]
        if tagged:
            hint = tagged[0]
            continue
        path.append(part)
        if isinstance(part, int):
            hint = typing.get_args(hint)[0]
            continue
        # A table that may be left out: `GlueLayer | None` owns its keys like `GlueLayer`.
        if len(options) == 1 and not dataclasses.is_dataclass(hint):
            hint = options[0]
        if dataclasses.is_dataclass(hint):
            owner = typing.cast("type[Any]", hint)
            hints = si.hints_of(owner)
            hint = hints.get(str(part), Any)
    return tuple(path), owner


def _tag(cls: Any) -> Any:
    return next((f.default for f in dataclasses.fields(cls) if f.name == "type"), None)


def _keys_of(owner: type[Any], fields: list[dataclasses.Field[Any]]) -> str:
    """The keys that an owner needs, and those that may be left out."""
    needed = _needed(fields)
    optional = [field.name for field in fields if field.name not in needed]
    article = "an" if owner.__name__[0] in "AEIO" else "a"
    words = f"{article} {owner.__name__} needs {', '.join(needed)}"
    return f"{words}; it may also have {', '.join(optional)}" if optional else words


def _needed(fields: list[dataclasses.Field[Any]]) -> list[str]:
    """The keys that may not be left out."""
    missing = dataclasses.MISSING
    return [field.name for field in fields if field.default is field.default_factory is missing]


def _message(item: Any, path: Sequence[str | int], owner: type[Any]) -> str:
    fields = [field for field in dataclasses.fields(owner) if reads_from_file(field)]
    known = [field.name for field in fields]
    kind = item["type"]
    if kind == "extra_forbidden":
        hint = si.did_you_mean(str(path[-1]), known)
        return f"unknown key '{path[-1]}'.{hint} Allowed here: {', '.join(known)}"
    if kind == "missing":
        return f"the key '{path[-1]}' is missing; {_keys_of(owner, fields)}"
    if kind == "union_tag_invalid":
        tag = str(item["ctx"]["tag"])
        allowed = [part.strip(" '") for part in str(item["ctx"]["expected_tags"]).split(",")]
        return f"type = '{tag}' is not known.{si.did_you_mean(tag, allowed)} Allowed: " + ", ".join(
            allowed
        )
    if kind == "union_tag_not_found":
        return "the key 'type' is missing; it says which kind of thing this is"
    if kind in ("model_type", "model_attributes_type"):
        return f"{item['input']!r} is no table; write it as [table] with keys"
    if kind == "literal_error":
        return f"{item['input']!r} is not allowed; allowed: {item['ctx']['expected']}"
    if kind in ("int_type", "int_from_float"):
        return f"{item['input']!r} is no whole number; write one without quotation marks, like 8"
    if kind == "string_type":
        return f"{item['input']!r} is no text; write it between quotation marks"
    if kind == "list_type":
        key = str(path[-1])
        return (
            f"{key} is a list; write each of its members below a header [[{key}]], or all between "
            "brackets"
        )
    if kind == "bool_type":
        return f"{item['input']!r} is neither true nor false; write one of them, without quotes"
    message = str(item["msg"]).removeprefix("Value error, ")
    return message if kind == "value_error" else f"{item['input']!r}: {message}"


class _Typed(str):
    """A number of a TOML file as it was typed: 0.30 does not become 0.3."""

    __slots__ = ()


def written_values(
    cls: type[Any], text: str, *, file: str | Path | None = None
) -> list[tuple[_Path, str, Provenance | None]]:
    """Every value that a text states of a dataclass with `provenance`, in the text's order, but for
    what a program found and wrote: the parts of its path (members of lists from 0), its text as it
    was typed, and where it is from (None for a word that needs no source).

    Raises `ConfigError` as `load_text` does: what is shown can be built.
    """
    built = load_text(cls, text, file=file)
    tree: Mapping[str, Any] = tomllib.loads(text, parse_float=_Typed)
    references: References | None = getattr(cls, "references", None)
    if references is not None:
        tree, _ = references.written_out(tree)
    plain = split_provenance(tree, of_tables=references is not None).plain
    found: Mapping[str, Provenance] = built.provenance
    return [
        (path, str(value), found.get(".".join(map(str, path))))
        for path, value in tree_values(described(cls, plain))
    ]
