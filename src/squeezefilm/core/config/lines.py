"""The line of a TOML file on which a key stands, for messages. tomllib does not tell."""

from __future__ import annotations

import re
from collections.abc import Sequence

_HEADER = re.compile(r"\s*(\[\[?)([^\]]+)\]")
_KEY = re.compile(r"\s*((?:[A-Za-z0-9_-]+|\"[^\"]*\"|'[^']*')(?:\s*\.\s*[A-Za-z0-9_\"'-]+)*)\s*=")


def _split(dotted: str) -> list[str]:
    return [part.strip().strip("\"'") for part in dotted.split(".")]


def locate(text: str, path: Sequence[str | int]) -> int | None:
    """The 1-based line of the key at `path` (e.g. ``("actuator", "patches", 3, "x")``), or of its
    nearest ancestor that stands on a line of its own; None where none does."""
    wanted = [str(part) for part in path]
    table: list[str] = []
    counts: dict[str, int] = {}
    best, best_depth = None, 0
    for number, line in enumerate(text.splitlines(), 1):
        if header := _HEADER.match(line):
            table = _split(header.group(2))
            if header.group(1) == "[[":
                name = ".".join(table)
                counts[name] = counts.get(name, -1) + 1
                table = [*table, str(counts[name])]
            else:
                table = _with_indices(table, counts)
            here = table
        elif key := _KEY.match(line):
            here = [*table, *_split(key.group(1))]
        else:
            continue
        depth = len(here)
        if depth > best_depth and here == wanted[:depth]:
            best, best_depth = number, depth
    return best


def _with_indices(table: list[str], counts: dict[str, int]) -> list[str]:
    """[a.b.c] below the last [[a.b]] belongs to that element."""
    for cut in range(len(table), 0, -1):
        name = ".".join(table[:cut])
        if name in counts:
            return [*table[:cut], str(counts[name]), *table[cut:]]
    return table
