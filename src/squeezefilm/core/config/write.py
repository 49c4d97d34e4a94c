"""A frozen dataclass to TOML text with units, such that `load_text` reads the same value back."""

from __future__ import annotations

import dataclasses
import json
import math
import typing
from collections.abc import Iterator, Mapping, Set
from decimal import Decimal
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance, read_only
from squeezefilm.core.config.schema import reads_from_file
from squeezefilm.core.config.syntax import DEEPEST
from squeezefilm.core.distributions import Normal
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import DESCRIPTION_BYTES, require_within

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
