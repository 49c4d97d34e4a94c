"""Which numbers of a description have a source: by themselves, by their table, or no longer."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Iterator, Mapping
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import UNSTATED, Provenance, Split


def stated_sources(built: Any, split: Split, original: Any = None) -> dict[str, Provenance]:
    """The sources of the values that a file states, by their dotted path.

    A number without a source of its own takes its table's, and is `UNSTATED` without one. Where
    the file is a changed copy of an `original`, a value that is another now while its source still
    stands in the original's words has none either: that source is of the other value.
    """
    found = dict(split.sources)
    for parts, _ in tree_values(described(type(built), split.plain)):
        path = ".".join(map(str, parts))
        if path not in found and _is_number(built, path):
            table, _, _ = path.rpartition(".")
            found[path] = split.tables.get(table, Provenance("", UNSTATED))
    if original is None:
        return found
    return {path: _if_unchanged(built, original, path, one) for path, one in found.items()}


def described(cls: type[Any], tree: Mapping[str, Any]) -> dict[str, Any]:
    """The part of a file's tree that somebody describes a thing by: all but what a program found
    and wrote, fields with ``metadata={"found": True}``, whose numbers need no source."""
    found = {one.name for one in dataclasses.fields(cls) if one.metadata.get("found")}
    return {key: item for key, item in tree.items() if key not in found}


def tree_values(
    node: Any, path: tuple[str | int, ...] = ()
) -> Iterator[tuple[tuple[str | int, ...], Any]]:
    """The values of a tree with the parts of their paths, in order; members of lists from 0."""
    inner = node.items() if isinstance(node, Mapping) else enumerate(node)
    for key, item in inner:
        if isinstance(item, Mapping | list):
            yield from tree_values(item, (*path, key))
        else:
            yield (*path, key), item


def _is_number(built: Any, path: str) -> bool:
    """Whether a value is a quantity or a count; a word, or one of a few, needs no source."""
    _, hint = _value(built, path)
    return si.unit_of(hint) is not None or hint is int or int in typing.get_args(hint)[:1]


def _value(built: Any, path: str) -> tuple[Any, Any]:
    """The value at a dotted path of what was built, and its annotation (None for a list's)."""
    value, hint = built, None
    for part in path.split("."):
        if isinstance(value, tuple):
            value, hint = value[int(part)], None
            continue
        hint = si.hints_of(type(value))[part]
        value = getattr(value, part)
    return value, hint


def _if_unchanged(built: Any, original: Any, path: str, one: Provenance) -> Provenance:
    theirs = original.provenance.get(path)
    if theirs is None or not one.source or theirs.source != one.source:
        return one
    (now, hint), (was, _) = _value(built, path), _value(original, path)
    if now == was:
        return one
    unit = si.unit_of(hint)
    shown = f"{was}" if unit is None else si.format_quantity(float(was), unit)
    return dataclasses.replace(one, source=changed_from(shown, one.source), evidence=UNSTATED)


def changed_from(was: str, source: str) -> str:
    """What stands for the source of a value that is another now: what it was, and whose that is."""
    return f"changed from {was} ({source})"


def unstated(provenance: Mapping[str, Provenance]) -> tuple[str, ...]:
    """The dotted paths of the numbers of a description that have no source."""
    return tuple(path for path, one in provenance.items() if one.evidence == UNSTATED)


def source_doubt(provenance: Mapping[str, Provenance]) -> str | None:
    """A sentence that counts what of a display has no source or is assumed; None for none."""
    if not provenance:
        return "Nothing says where the values of this display are from: it was read from no file."
    total, bare = len(provenance), len(unstated(provenance))
    assumed = sum(one.evidence == "assumed" for one in provenance.values())
    parts = []
    if bare:
        parts.append(f"{bare} of {total} values of this display have no source")
    if assumed:
        of = "" if bare else f" of {total} values of this display"
        parts.append(f"{assumed}{of} are assumed, not measured or published")
    return f"{', and '.join(parts)}: squeezefilm show lists them." if parts else None
