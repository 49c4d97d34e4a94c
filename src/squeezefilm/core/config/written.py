"""The values of a file as somebody wrote them, materials written out: to be shown."""

from __future__ import annotations

import dataclasses
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from squeezefilm.core.config.load import load_text
from squeezefilm.core.config.provenance import Provenance, split_provenance
from squeezefilm.core.config.references import References
from squeezefilm.core.config.stated import described, tree_values


@dataclasses.dataclass(frozen=True)
class WrittenValue:
    """One value of a file: the parts of its path (members of lists from 0), its text as it was
    typed, and where it is from (None for a word that needs no source)."""

    path: tuple[str | int, ...]
    text: str
    provenance: Provenance | None


class _Typed(str):
    """A number of a TOML file as it was typed: 0.30 does not become 0.3."""

    __slots__ = ()


def written_values(
    cls: type[Any], text: str, *, file: str | Path | None = None
) -> tuple[WrittenValue, ...]:
    """Every value that a text states of a dataclass with `provenance`, in the text's order, but for
    what a program found and wrote.

    Raises `ConfigError` as `load_text` does: what is shown can be built.
    """
    built = load_text(cls, text, file=file)
    tree: Mapping[str, Any] = tomllib.loads(text, parse_float=_Typed)
    references: References | None = getattr(cls, "references", None)
    if references is not None:
        tree, _ = references.written_out(tree)
    plain = split_provenance(tree, of_tables=references is not None).plain
    found: Mapping[str, Provenance] = built.provenance
    return tuple(
        WrittenValue(path, str(value), found.get(".".join(map(str, path))))
        for path, value in tree_values(described(cls, plain))
    )
