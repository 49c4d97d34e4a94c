"""Origin of a file's values: text beside each, and names in place of what is not written out.

A value in TOML is either plain, ``thickness = "2 mm"``, or a table that says where it comes from:
``thickness = { value = "2 mm", source = "paper, section 3.1", evidence = "published" }``. How sure
it is may stand beside it: ``uncertainty = "0.05 mm"`` or ``"5 %"`` (a standard deviation), or
``range = ["1.9 mm", "2.1 mm"]`` (anywhere between).

A table may say it once for all numbers of its own that do not: ``source = "drawing 17"`` among its
keys. A number that nobody gave a source is `UNSTATED`, and so is one that was changed in a copy
while the words of its source stayed.

A name may stand for a material, and one says of which file this is a changed copy. Both are
resolved in the tree that TOML gave, before anything is checked: what comes after sees one file with
everything in it, and every value with its own source.
"""

from __future__ import annotations

import copyreg
import dataclasses
import types
import typing
from collections.abc import Callable, Iterator, Mapping
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


COPIED_FROM = "copied_from"
"""The key of a file that says of which one it is a changed copy."""
MATERIAL = "material"
"""The key of a table that takes its values from the library."""


@dataclass(frozen=True)
class References:
    """Names that the files of one kind of dataclass may have; the class has one as `references`.

    Attributes:
        original: what a file was copied from, built, by the name that ``copied_from`` gives.
        parts: by the dotted path of a table, the table that a name there stands for, each value
            with its source. Both raise `InputError` for a name that is not known.
    """

    original: Callable[[str], Any]
    parts: Mapping[str, Callable[[str], Mapping[str, Any]]]

    def written_out(self, tree: Mapping[str, Any]) -> tuple[dict[str, Any], Any]:
        """The tree with its materials in place of their names, and what it was copied from, built;
        None where it is no copy.

        A table that names a material may state single values of its own beside it: they stand in
        place of the library's. A name may have a source, as a value has one: where that says that
        the material is assumed, every value that it brings is. Raises `ConfigError`, with the key,
        for a name that is not known.
        """
        whole, original = dict(tree), None
        copied_from = whole.pop(COPIED_FROM, None)
        if copied_from is not None:
            if not isinstance(copied_from, str):
                raise ConfigError(
                    f"{copied_from!r} is no name; write the preset that this file was copied from, "
                    "or delete the line",
                    key=COPIED_FROM,
                )
            try:
                original = self.original(copied_from)
            except InputError as error:
                raise ConfigError(str(error), key=COPIED_FROM) from error
        for path, table in self.parts.items():
            whole = _with_material(whole, path.split("."), path, table)
        return whole, original


def _with_material(
    tree: dict[str, Any], path: list[str], whole: str, table: Callable[[str], Mapping[str, Any]]
) -> dict[str, Any]:
    head, *rest = path
    here = tree.get(head)
    if rest:
        if not isinstance(here, dict):
            return tree
        return {**tree, head: _with_material(here, rest, whole, table)}
    own = {MATERIAL: here} if isinstance(here, str) else here
    if not isinstance(own, dict) or MATERIAL not in own:
        return tree
    choice = own[MATERIAL]
    name = choice.get("value") if isinstance(choice, dict) else choice
    key = whole if isinstance(here, str) else f"{whole}.{MATERIAL}"
    if not isinstance(name, str):
        raise ConfigError(f"{name!r} is no name of a material; write one as text", key=key)
    try:
        library = table(name)
    except InputError as error:
        raise ConfigError(str(error), key=key) from error
    if isinstance(choice, dict) and choice.get("evidence") == "assumed":
        library = _as_assumed(library, str(choice.get("source", "")))
    return {**tree, head: _over(library, {k: v for k, v in own.items() if k != MATERIAL})}


def _as_assumed(library: Mapping[str, Any], source: str) -> dict[str, Any]:
    """The values of a material that is only taken to be the one: each is assumed, however well the
    material itself is known."""
    values: dict[str, Any] = {}
    for key, value in library.items():
        if not isinstance(value, dict):
            values[key] = value
        elif "value" in value:
            because = "; ".join(text for text in (source, str(value.get("source", ""))) if text)
            values[key] = {**value, "source": because, "evidence": "assumed"}
        else:
            values[key] = _as_assumed(value, source)
    return values


def _over(library: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """The library's table with one's own values in place of its; tables within likewise."""
    table = dict(library)
    for key, value in own.items():
        there: Any = table.get(key)
        both = isinstance(value, dict) and isinstance(there, dict) and "value" not in value
        table[key] = _over(there, value) if both and "value" not in there else value
    return table
