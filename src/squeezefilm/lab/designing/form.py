"""A display's TOML as a form: every value with its unit, source and what it may be; and one edit.

Edits change the text with tomlkit, so that comments, order and sources stay as somebody wrote them.
"""

from __future__ import annotations

import dataclasses
import tomllib
import types
import typing
from typing import Any, Literal, Union

import tomlkit
from tomlkit.exceptions import TOMLKitError

from squeezefilm.core import config, presets
from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import UNSTATED, changed_from
from squeezefilm.core.config.schema import leaves
from squeezefilm.core.errors import InputError
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import Actuator, RectangularPlate

LONGEST_VALUE = 2000
"""Characters of one value in the form."""
EDITED = ", edited"
"""Suffix behind the name of a preset that was edited."""
OWN_VALUES = "values of its own"
"""Name of a material where the text names none."""


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
    rows = _material_rows(text, display)
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


def _material_rows(text: str, display: Display) -> list[dict[str, Any]]:
    """A row for each part whose values the library of materials may give."""
    actuator = tomllib.loads(text).get("actuator", {})
    rows = []
    for kind in presets.materials.KINDS:
        if getattr(display.actuator, kind, None) is None:
            continue
        here = actuator.get(kind)
        name = here.get("material") if isinstance(here, dict) else here
        name = name.get("value") if isinstance(name, dict) else name
        known = [
            material.name for material in presets.materials.materials() if material.kind == kind
        ]
        chosen = OWN_VALUES if name is None else presets.materials.named(name, kind).name
        rows.append(
            {
                "path": f"actuator.{kind}.material",
                "section": f"actuator.{kind}",
                "name": "material",
                "unit": None,
                "text": chosen,
                "value": None,
                "whole": False,
                "choices": [OWN_VALUES, *known] if name is None else known,
                "source": "",
                "evidence": "",
                "optional": True,
            }
        )
    return rows


def _with_material(document: Any, kind: str, name: str) -> None:
    """Let the library give a part's values; of its own table stays what the library does not say.

    Of a ceramic nothing stays: its constants belong together. Raises `InputError` for a name that
    is not in the library.
    """
    library = presets.materials.table(name, kind)  # type: ignore[arg-type]
    old = document["actuator"].get(kind)
    if not isinstance(old, dict):
        document["actuator"][kind] = name
        return
    for key in list(old):
        if key in library or key in ("material", "name", "source", "evidence") or kind == "ceramic":
            del old[key]
    old["material"] = name


def edited(text: str, path: str, value: str) -> str:
    """The display's text with the value at a dotted path written anew.

    `value` is what a person typed: quantity text, a number, or a word. A source that stood beside
    the old value no longer vouches for the new one: it is kept with "changed from …" before it, and
    the evidence becomes unstated. A display that has a preset's name is called "NAME, edited".

    Raises:
        InputError: a path that is not there, or a text that is no display with the new value, in
            the words of `config.load_text`.
    """
    if len(value) > LONGEST_VALUE:
        raise InputError(f"a value of {len(value)} characters; at most {LONGEST_VALUE} are taken")
    rows = {field["path"]: field for field in form(text)}
    row = rows.get(path)
    if row is None:
        raise InputError(f"the display has no value at '{path[:200]}'; open it again")
    written = _written(value.strip(), row)
    try:
        document = tomlkit.parse(text)
        if path.endswith(".material"):
            _with_material(document, path.split(".")[-2], value.strip())
        else:
            write_value(document, rows, path, written)
        name = str(document["name"])
        if path != "name" and tomlkit.dumps(document) != text and name in presets.display_names():
            document["name"] = name + EDITED
        written_text = tomlkit.dumps(document)
    except InputError:
        raise
    except (TOMLKitError, KeyError, IndexError, ValueError, TypeError) as error:
        raise InputError(
            f"'{path}' cannot be changed here ({error}); edit the TOML text"
        ) from error
    display_of(written_text)
    return written_text


def write_value(document: Any, rows: dict[str, dict[str, Any]], path: str, written: Any) -> None:
    """Write a value at a dotted path of a document, and what is left of its source.

    What was measured was measured of a display with the old body: it goes where that changes.
    """
    owner, row = document, rows[path]
    if path.startswith("actuator.") and written != row["text"]:
        document.pop("measured", None)
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
    elif old is None and row["source"] and written == row["text"]:
        return
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
            repr(value) if unit.symbol == "1" else si.typed_quantity(float(value), unit, digits=6)
        )
    return str(value)


def stated(hint: Any) -> Any:
    """Type of a value where it is stated: `X` of ``X | None``; a quantity knows itself."""
    if typing.get_origin(hint) in (Union, types.UnionType) and si.unit_of(hint) is None:
        return next(member for member in typing.get_args(hint) if member is not type(None))
    return hint


def choices(hint: Any) -> list[str] | None:
    """The words that a value may be, where it is one of a few."""
    if typing.get_origin(hint) is Literal:
        return [str(word) for word in typing.get_args(hint)]
    if hint is bool:
        return ["true", "false"]
    return None


_METRE = si.Unit("m")
_LEAST_SHARE: si.Dimensionless = 1e-3
"""Least share of a side: ceramics that end so near the edge cover it."""
_SIDES = {"actuator.length": ("x", "length"), "actuator.width": ("y", "width")}


def covered(actuator: Actuator) -> dict[str, str]:
    """Words for what the ceramics cover, for each side that they leave partly bare, by its path."""
    if not isinstance(actuator, RectangularPlate) or not actuator.patches:
        return {}
    said = {}
    for path, (axis, size) in _SIDES.items():
        side = getattr(actuator, size)
        first, last = _ends(actuator, axis, size)
        if last - first < side * (1.0 - _LEAST_SHARE):
            ends = " to ".join(si.format_quantity(end, _METRE) for end in (first, last))
            whole = si.format_quantity(side, _METRE)
            said[path] = f"the ceramics cover {axis} = {ends} of {whole}"
    return said


def stretched(text: str, path: str) -> str:
    """The display's text with its ceramics stretched over a side, their gaps with them.

    `path` is the side's, "actuator.length" or "actuator.width".
    Raises `InputError` for another path, a display without ceramics there, or one that does not
    fit stretched; `ConfigError` for a text that is no display.
    """
    actuator = display_of(text).actuator
    if path not in _SIDES or not isinstance(actuator, RectangularPlate) or not actuator.patches:
        raise InputError(f"there are no ceramics to stretch along '{path[:200]}'")
    axis, size = _SIDES[path]
    first, last = _ends(actuator, axis, size)
    scale = getattr(actuator, size) / (last - first)
    document, rows = tomlkit.parse(text), {row["path"]: row for row in form(text)}
    for number, patch in enumerate(actuator.patches):
        start, end = (scale * (place - first) for place in _edges(patch, axis, size))
        for name, value in ((axis, start), (size, end - start)):
            written = si.typed_quantity(value, _METRE, digits=9)
            write_value(document, rows, f"actuator.patches.{number}.{name}", written)
    stretched_text = tomlkit.dumps(document)
    display_of(stretched_text)
    return stretched_text


def _edges(patch: object, axis: str, size: str) -> tuple[si.Metre, si.Metre]:
    start: float = getattr(patch, axis)
    return start, start + float(getattr(patch, size))


def _ends(actuator: RectangularPlate, axis: str, size: str) -> tuple[si.Metre, si.Metre]:
    edges = [_edges(patch, axis, size) for patch in actuator.patches]
    return min(start for start, _ in edges), max(end for _, end in edges)
