"""Pages of the documentation that the program writes: where they go, and tables in Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from squeezefilm.core.errors import InputError


def checkout(root: Path | None = None) -> Path:
    """The checkout that this package runs from, or `root`. Raises `InputError` if it is none."""
    top = root or Path(__file__).parents[4]
    if not (top / "docs").is_dir() or not (top / "pyproject.toml").is_file():
        raise InputError(
            "write_docs needs a checkout of the source, and this is an installed package; "
            "clone the repository and run it there"
        )
    return top


def markdown_table(table: tuple[Sequence[str], Sequence[Sequence[str]]]) -> list[str]:
    """A table as lines of Markdown."""
    head, rows = table
    return [
        "| " + " | ".join(head) + " |",
        "|" + "---|" * len(head),
        *("| " + " | ".join(row) + " |" for row in rows),
    ]
