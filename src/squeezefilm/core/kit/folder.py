"""A report's files, put into its folder together: all of them, or what was there before; and pages
of the documentation that the program writes."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import TABLE_BYTES
from squeezefilm.core.regular_file import read_regular
from squeezefilm.core.results import to_json, write_whole

_NUMBER = re.compile(r"[-+]?[0-9.]+(e[-+]?[0-9]+)?")


def require_folder(folder: str | Path) -> Path:
    """The path of a folder that is there or can be made; asked before long work is done for it.

    Raises `InputError` for a file.
    """
    path = Path(folder)
    if path.exists() and not path.is_dir():
        raise InputError(f"{path} is a file, not a folder; choose another folder")
    return path


def json_text(values: Any) -> str:
    """Values as the text of a JSON file; what JSON cannot carry is as in `to_json`."""
    return json.dumps(to_json(values), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def csv_text(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table as the text of a CSV file; cells are empty where there is nothing (None)."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(head)
    for row in rows:
        writer.writerow([_cell(value) for value in row])
    return stream.getvalue()


def _cell(value: object) -> str:
    if value is None:
        return ""
    text = repr(value) if isinstance(value, float) else str(value)
    # A spreadsheet must not take a text for a formula; a negative number is none.
    risky = isinstance(value, str) and text[:1] in ("=", "+", "-", "@")
    return f"'{text}" if risky and not _NUMBER.fullmatch(text) else text


def write_folder(folder: Path, files: Mapping[str, str | bytes]) -> Path:
    """Write files by name, each whole; the path of the last, which is the page of the others.

    If one cannot be written, those before it are as they were. Raises `InputError` where the
    folder cannot be written to.
    """
    before: dict[Path, bytes | None] = {}
    try:
        for name, content in files.items():
            file = folder / name
            old = read_regular(file, TABLE_BYTES, "a file") if file.is_file() else None
            write_whole(file, content)
            before[file] = old
    except InputError:
        for file, old in before.items():
            if old is None:
                file.unlink(missing_ok=True)
            else:
                write_whole(file, old)
        raise
    return file


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
