"""Materials by name: substrates, ceramics, glues of `materials.toml`, each value with its source.

Trees of TOML only: what a value means is known to whoever reads it (`config`, `materials`).
"""

from __future__ import annotations

import copy
import functools
import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

Kind = Literal["substrate", "ceramic", "glue"]
KINDS: tuple[Kind, ...] = get_args(Kind)
_FILE = Path(__file__).with_suffix(".toml")


@dataclass(frozen=True)
class Material:
    """A material of the library: what it is for, what else it is called, how far it spreads.

    `values` is its table as a file may have it: texts with units, each with its source.
    """

    name: str
    kind: Kind
    title: str
    also: tuple[str, ...]
    spread: str
    values: dict[str, Any]

    def leaves(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """Each value with its source, by its dotted path within the table."""
        for key, value in self.values.items():
            if "value" in value:
                yield key, value
            else:
                yield from ((f"{key}.{name}", below) for name, below in value.items())


@functools.cache
def materials() -> tuple[Material, ...]:
    """All materials, in the order of the file."""
    tree = tomllib.loads(_FILE.read_text(encoding="utf-8"))
    return tuple(
        Material(
            name, item["kind"], item["title"], tuple(item["also"]), item["spread"], item["values"]
        )
        for name, item in tree.items()
    )


def named(name: str, kind: Kind | None = None) -> Material:
    """The material of a name. Capitals, blanks and hyphens do not matter, nor whether aluminium is
    written aluminum.

    Raises:
        InputError: a name that is not known, or a material of another kind than the one wanted.
    """
    wanted = _plain(name)
    found = next(
        (
            material
            for material in materials()
            if wanted in {_plain(word) for word in (material.name, *material.also)}
        ),
        None,
    )
    of_kind = ", ".join(material.name for material in materials() if kind in (None, material.kind))
    known = f"The library has{'' if kind is None else f', as {kind}'}: {of_kind}"
    if found is None:
        words = [word for material in materials() for word in (material.name, *material.also)]
        hint = si.did_you_mean(name, words) or si.did_you_mean(name.lower(), words)
        # "aluminium" or "PZT" is part of several names: to propose one of them would be chance.
        if wanted and sum(wanted in _plain(material.name) for material in materials()) > 1:
            hint = " Several names contain it: write one of them."
        raise InputError(f"there is no material '{name[:100]}'.{hint} {known}")
    if kind not in (None, found.kind):
        raise InputError(f"'{found.name}' is a {found.kind}, and a {kind} is wanted here. {known}")
    return found


def table(name: str, kind: Kind) -> dict[str, Any]:
    """The values of a material as the table of a part, with their sources; a copy of its own.

    Raises `InputError` as `named` does.
    """
    material = named(name, kind)
    values = copy.deepcopy(material.values)
    # The glue has no name of its own: there is one.
    return values if kind == "glue" else {"name": material.name, **values}


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower()).replace("aluminum", "aluminium")
