"""References of a file in place of writing it out: the file that it was copied from, and materials.

Both are resolved in the tree that TOML gave, before anything is checked: what comes after sees one
file with everything in it, and every value with its own source.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from squeezefilm.core.errors import ConfigError, InputError

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
