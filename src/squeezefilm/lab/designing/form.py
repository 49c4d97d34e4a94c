"""A display's TOML as a form: every value with its unit, source and what it may be; and one edit.

Edits change the text with tomlkit, so that comments, order and sources stay as somebody wrote them.
"""

from __future__ import annotations

import dataclasses
import types
import typing
from typing import Any, Literal, Union

import tomlkit
from tomlkit.exceptions import TOMLKitError

from squeezefilm import config, presets
from squeezefilm import quantities as si
from squeezefilm.config.provenance import UNSTATED
from squeezefilm.config.stated import changed_from
from squeezefilm.display import Display
from squeezefilm.errors import InputError
from squeezefilm.report.kit.numbers import leaves

LONGEST_VALUE = 2000
"""Characters of one value in the form."""


def preset_text(name: str) -> str:
    """The TOML text of a preset display. Raises `ConfigError` for a name that is not known."""
    return presets.path(name).read_text(encoding="utf-8")


def display_of(text: str) -> Display:
    """The display that a TOML text describes. Raises `ConfigError` as `config.load_text` does."""
    return config.load_text(Display, text)


def name_of(text: str) -> str:
    """The name of the display that a TOML text describes. Raises as `display_of`."""
    return display_of(text).name


def form(text: str) -> list[dict[str, Any]]:
    """Every value of a display's text as the page shows it, in the text's order of tables.

    Each is a dict: `path` (dotted, members counted from 0), `section`, `name`, `unit` (symbol; ""
    for a number without, None for no quantity), `text` as it may be written, `value` (SI),
    `choices` (or None), `source`, `evidence`, `optional` (whether it may be left out).
    Raises `ConfigError` for a text that is no display.
    """
    display = display_of(text)
    rows = []
    for path, value, annotation, field in leaves(display):
        hint = stated(annotation)
        dotted = ".".join(str(part) for part in path)
        origin = display.provenance.get(dotted)
        unit = si.unit_of(hint)
        rows.append(
            {
                "path": dotted,
                "section": ".".join(str(part) for part in path[:-1]),
                "name": str(path[-1]),
                "unit": None if unit is None else ("" if unit.symbol == "1" else unit.symbol),
                "text": _text(value, unit),
                "value": value if isinstance(value, int | float) else None,
                "whole": isinstance(value, int) and not isinstance(value, bool),
                "choices": choices(hint),
                "source": "" if origin is None else origin.source,
                "evidence": "" if origin is None else origin.evidence,
                "optional": field.default is not dataclasses.MISSING,
            }
        )
    return rows


def edited(text: str, path: str, value: str) -> str:
    """The display's text with the value at a dotted path written anew.

    `value` is what a person typed: quantity text, a number, or a word. A source that stood beside
    the old value no longer vouches for the new one: it is kept with "changed from …" before it, and
    the evidence becomes unstated.

    Raises:
        InputError: a path that is not there, or a text that is no display with the new value, in
            the words of `config.load_text`.
    """
    if len(value) > LONGEST_VALUE:
        raise InputError(f"a value of {len(value)} characters; at most {LONGEST_VALUE} are taken")
    rows = {one["path"]: one for one in form(text)}
    row = rows.get(path)
    if row is None:
        raise InputError(f"the display has no value at '{path[:200]}'; open it again")
    written = _written(value.strip(), row)
    try:
        document = tomlkit.parse(text)
        owner: Any = document
        *heads, last = path.split(".")
        for depth, part in enumerate(heads, 1):
            if isinstance(owner, list):
                owner = owner[int(part)]
                continue
            if part not in owner:
                owner[part] = tomlkit.table()
                # A table that may be one of several kinds says which it is.
                if kind := rows.get(".".join([*heads[:depth], "type"])):
                    owner[part]["type"] = kind["text"]
            if isinstance(owner[part], str):
                # A part that is named by its material alone.
                alone = tomlkit.inline_table()
                alone["material"] = str(owner[part])
                owner[part] = alone
            owner = owner[part]
        old = owner.get(last) if hasattr(owner, "get") else None
        if isinstance(old, dict) and "value" in old:
            was, source = old["value"], str(old.get("source", ""))
            if was != written:
                old["value"] = written
                if source and not source.startswith("changed from"):
                    old["source"] = changed_from(str(was), source)
                old["evidence"] = UNSTATED
                for spread in ("uncertainty", "range"):
                    old.pop(spread, None)
        elif old is None and row["source"] and value.strip() == row["text"]:
            return text
        elif row["source"] and old != written:
            # Its table, or the library of materials, vouches for the old value only.
            changed = tomlkit.inline_table()
            was = row["text"] if old is None else str(old)
            changed.update(
                {
                    "value": written,
                    "source": changed_from(was, row["source"]),
                    "evidence": UNSTATED,
                }
            )
            owner[last] = changed
        else:
            owner[last] = written
        found = tomlkit.dumps(document)
    except (TOMLKitError, KeyError, IndexError, ValueError, TypeError) as error:
        raise InputError(
            f"'{path}' cannot be changed here ({error}); edit the TOML text"
        ) from error
    display_of(found)
    return found


def _written(value: str, row: dict[str, Any]) -> Any:
    if row["whole"]:
        try:
            return int(value)
        except ValueError as error:
            name = row["path"]
            raise InputError(f"{name}: '{value}' is no whole number; write one, like 8") from error
    if row["unit"] is None:
        return value == "true" if value in ("true", "false") else value
    if row["unit"] == "":
        try:
            return float(value)
        except ValueError:
            return value
    return value


def _text(value: Any, unit: si.Unit | None) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if unit is not None and isinstance(value, int | float):
        return (
            repr(value) if unit.symbol == "1" else si.format_quantity(float(value), unit, digits=6)
        )
    return str(value)


def stated(hint: Any) -> Any:
    """What a value may be where it is stated: `X` of ``X | None``; a quantity knows itself."""
    if typing.get_origin(hint) in (Union, types.UnionType) and si.unit_of(hint) is None:
        return next(one for one in typing.get_args(hint) if one is not type(None))
    return hint


def choices(hint: Any) -> list[str] | None:
    """The words that a value may be, where it is one of a few."""
    if typing.get_origin(hint) is Literal:
        return [str(one) for one in typing.get_args(hint)]
    if hint is bool:
        return ["true", "false"]
    return None
