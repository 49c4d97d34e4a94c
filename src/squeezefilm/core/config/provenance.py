"""Source of a value: text beside the value in the TOML file, kept beside it in memory.

A value in TOML is either plain, ``thickness = "2 mm"``, or a table that says where it comes from:
``thickness = { value = "2 mm", source = "paper, section 3.1", evidence = "published" }``. How sure
it is may stand beside it: ``uncertainty = "0.05 mm"`` or ``"5 %"`` (a standard deviation), or
``range = ["1.9 mm", "2.1 mm"]`` (anywhere between).

A table may say it once for all numbers of its own that do not: ``source = "drawing 17"`` among its
keys. A number that nobody gave a source is `UNSTATED`, and so is one that was changed in a copy
while the words of its source stayed.
"""

from __future__ import annotations

import copyreg
import dataclasses
import types
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.distributions import Distribution, Normal, Uniform
from squeezefilm.core.errors import ConfigError, InputError


def read_only(values: Mapping[str, Any]) -> types.MappingProxyType[str, Any]:
    """A mapping that nobody can change, and that can be pickled with what holds it."""
    return types.MappingProxyType(dict(values))


copyreg.pickle(types.MappingProxyType, lambda mapping: (read_only, (dict(mapping),)))

UNSTATED = "unstated"
"""The evidence of a number whose file does not say where it is from."""
EVIDENCE = ("measured", "published", "derived", "assumed", UNSTATED)
_SPREADS = ("uncertainty", "range")
_OF_TABLES = ("source", "evidence")
_KEYS = {"value", *_OF_TABLES, *_SPREADS}


@dataclass(frozen=True)
class Provenance:
    """The source of one value and the kind of evidence behind it: measured, published, derived
    from published values, assumed, or unstated; and how it is distributed, where the file says
    so."""

    source: str
    evidence: str = "published"
    distribution: Distribution | None = None


Spread = str | tuple[str, str]
"""An uncertainty as it is written, before the unit of its value is known."""


class Split(NamedTuple):
    """A tree with plain values; by path (``"actuator.thickness"``) the sources of values, their
    spreads, and the sources that tables give for their own values."""

    plain: dict[str, Any]
    sources: dict[str, Provenance]
    spreads: dict[str, Spread]
    tables: dict[str, Provenance]


def split_provenance(tree: Mapping[str, Any], *, of_tables: bool = False) -> Split:
    """Separate values from their sources, and with `of_tables` tables from theirs. Raises
    `ConfigError` for a malformed source or spread."""
    split = Split({}, {}, {}, {})

    def walk(node: Any, path: str) -> Any:
        if isinstance(node, Mapping):
            if "value" in node and set(node) <= _KEYS:
                if set(node) > {"value"}:
                    split.sources[path] = _provenance(node, path)
                if (spread := _spread(node, path)) is not None:
                    split.spreads[path] = spread
                return node["value"]
            if of_tables and "source" in node:
                split.tables[path] = _provenance(node, path)
                node = {key: item for key, item in node.items() if key not in _OF_TABLES}
            return {key: walk(item, f"{path}.{key}" if path else key) for key, item in node.items()}
        if isinstance(node, list):
            return [walk(item, f"{path}.{index}") for index, item in enumerate(node)]
        return node

    split.plain.update(walk(tree, ""))
    return split


def _spread(node: Mapping[str, Any], path: str) -> Spread | None:
    given = [key for key in _SPREADS if key in node]
    if not given:
        return None
    if len(given) == 2:
        raise ConfigError("uncertainty and range are both given; give one of them", key=path)
    spread = node[given[0]]
    if given == ["uncertainty"]:
        if not isinstance(spread, str):
            raise ConfigError(
                f'uncertainty = {spread!r} is no text; write "5 %" or a quantity in the unit of '
                "the value",
                key=path,
            )
        return spread
    whole = isinstance(spread, list) and len(spread) == 2
    if not whole or not all(isinstance(item, str) for item in spread):
        raise ConfigError(
            f'range = {spread!r} is none; write two texts, like ["1.9 mm", "2.1 mm"]', key=path
        )
    return spread[0], spread[1]


def distribution_of(value: float, unit: si.Unit, spread: Spread) -> Distribution:
    """The distribution that a spread means for a value in a unit. Raises `InputError` for one that
    cannot be."""
    if isinstance(spread, tuple):
        low, high = (si.parse_quantity(text, unit) for text in spread)
        distribution: Distribution = Uniform(low, high)
        if not low <= value <= high:
            raise InputError(
                f"range = [{spread[0]}, {spread[1]}] leaves out the value "
                f"{si.format_quantity(value, unit)} itself; make it wider"
            )
    elif spread.strip().endswith("%"):
        share = si.parse_quantity(spread.strip().removesuffix("%").strip(), si.Unit("1")) / 100
        distribution = Normal(value, share * abs(value))
    else:
        distribution = Normal(value, si.parse_quantity(spread, unit))
    if value > 0 and distribution.support[0] <= 0:
        raise InputError(
            f"uncertainty = {spread!r} lets {si.format_quantity(value, unit)} become negative "
            "within three standard deviations; give a range instead"
        )
    return distribution


def _provenance(node: Mapping[str, Any], path: str) -> Provenance:
    source, evidence = node.get("source", ""), node.get("evidence", "published")
    if not isinstance(source, str):
        raise ConfigError(f"source = {source!r} is no text; write where it is from", key=path)
    if evidence not in EVIDENCE:
        raise ConfigError(
            f"evidence = {evidence!r} is not known; allowed: {', '.join(EVIDENCE)}", key=path
        )
    return Provenance(source, evidence)


def stated_sources(built: Any, split: Split, original: Any = None) -> dict[str, Provenance]:
    """The sources of the values that a file states, by their dotted path.

    A number without a source of its own takes its table's, and is `UNSTATED` without one. Where
    the file is a changed copy of an `original`, a value that is another now while its source still
    stands in the original's words has none either: that source is of the other value.
    """
    sources = dict(split.sources)
    for parts, _ in tree_values(described(type(built), split.plain)):
        path = ".".join(map(str, parts))
        if path not in sources and _is_number(built, path):
            table, _, _ = path.rpartition(".")
            sources[path] = split.tables.get(table, Provenance("", UNSTATED))
    if original is None:
        return sources
    return {path: _if_unchanged(built, original, path, source) for path, source in sources.items()}


def described(cls: type[Any], tree: Mapping[str, Any]) -> dict[str, Any]:
    """The part of a file's tree that somebody describes a thing by: all but what a program found
    and wrote, fields with ``metadata={"found": True}``, whose numbers need no source."""
    names = {field.name for field in dataclasses.fields(cls) if field.metadata.get("found")}
    return {key: item for key, item in tree.items() if key not in names}


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
    """True for a quantity or a count; a word, or one of a few, needs no source."""
    _, hint = value_at(built, path)
    return si.unit_of(hint) is not None or hint is int or int in typing.get_args(hint)[:1]


def value_at(built: Any, path: str) -> tuple[Any, Any]:
    """The value at a dotted path of what was built, and its annotation (None for a list's)."""
    value, hint = built, None
    for part in path.split("."):
        if isinstance(value, tuple):
            value, hint = value[int(part)], None
            continue
        hint = si.hints_of(type(value))[part]
        value = getattr(value, part)
    return value, hint


def _if_unchanged(built: Any, original: Any, path: str, provenance: Provenance) -> Provenance:
    theirs = original.provenance.get(path)
    if theirs is None or not provenance.source or theirs.source != provenance.source:
        return provenance
    (now, hint), (was, _) = value_at(built, path), value_at(original, path)
    if now == was:
        return provenance
    unit = si.unit_of(hint)
    shown = f"{was}" if unit is None else si.format_quantity(float(was), unit)
    return dataclasses.replace(
        provenance, source=changed_from(shown, provenance.source), evidence=UNSTATED
    )


def changed_from(was: str, source: str) -> str:
    """The source of a value that is another now: what it was, and whose that is."""
    return f"changed from {was} ({source})"


def unstated(provenance: Mapping[str, Provenance]) -> tuple[str, ...]:
    """The dotted paths of the numbers of a description that have no source."""
    return tuple(path for path, source in provenance.items() if source.evidence == UNSTATED)


def source_doubt(provenance: Mapping[str, Provenance]) -> str | None:
    """A sentence that counts what of a display has no source or is assumed; None for none."""
    if not provenance:
        return "Nothing says where the values of this display are from: it was read from no file."
    total, bare = len(provenance), len(unstated(provenance))
    assumed = sum(source.evidence == "assumed" for source in provenance.values())
    parts = []
    if bare:
        parts.append(f"{bare} of {total} values of this display have no source")
    if assumed:
        of = "" if bare else f" of {total} values of this display"
        parts.append(f"{assumed}{of} are assumed, not measured or published")
    return f"{', and '.join(parts)}: squeezefilm show lists them." if parts else None
