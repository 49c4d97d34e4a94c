"""Two rows of a sweep's table side by side: what differs between them, and what both answer."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from pathlib import Path

from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import TABLE_BYTES
from squeezefilm.core.kit.numbers import shown
from squeezefilm.core.kit.terminal import heading, plain_console, table
from squeezefilm.core.regular_file import read_regular_text
from squeezefilm.design.sweep.answers import unit_in, without_units

Row = tuple[str, str, str, str]
"""A name with its unit, both values as they stand in the table, and the second over the first."""


def compared_rows(folder: Path | None, rows: str) -> tuple[Row, ...]:
    """What differs between two rows of ``sweep.csv`` in a folder, counted from 1 (``"3,17"``).

    Raises `InputError` for a folder without a sweep, and for rows that it does not have.
    """
    file = None if folder is None else folder / "sweep.csv"
    if file is None or not file.is_file():
        raise InputError(
            "rows are compared of a sweep's table; name the folder that has its sweep.csv as `out`",
            quantity="compare",
        )
    lines = read_regular_text(file, TABLE_BYTES, "a sweep's table").splitlines()
    try:
        head, *body = list(csv.reader(lines))
        if any(len(row) != len(head) for row in body):
            raise ValueError("its rows have different numbers of cells")
    except (csv.Error, ValueError) as error:
        raise InputError(f"{file} is no table of a sweep: {error}; make it again") from error
    numbers = re.fullmatch(r"\s*(\d{1,9})\s*,\s*(\d{1,9})\s*", rows)
    places = [int(group) for group in numbers.groups()] if numbers else []
    if not places or not all(1 <= place <= len(body) for place in places):
        raise InputError(
            f"compare {rows:.40} names no two rows of {file}; write two numbers from 1 to "
            f"{len(body)}, as in compare = 1,2",
            quantity="compare",
        )
    first, second = (body[place - 1] for place in places)
    pairs = zip(head, first, second, strict=True)
    return tuple((name, a, b, _ratio(a, b)) for name, a, b in pairs if a != b)


def _ratio(first: str, second: str) -> str:
    try:
        return f"{float(second) / float(first):.4g}"
    except (ValueError, ZeroDivisionError):
        return ""


def show_comparison(rows: Sequence[Row]) -> None:
    """Print what differs, each number with its unit."""
    console = plain_console()
    heading(console, "What differs")
    if not rows:
        console.print("nothing: both rows say the same")
        return
    lines = [
        (without_units(name), _with_unit(first, name), _with_unit(second, name), ratio)
        for name, first, second, ratio in rows
    ]
    table(console, ("", "first", "second", "second / first"), lines)


def _with_unit(text: str, name: str) -> str:
    """A cell with the unit that its column's name says; a dash for an empty one."""
    try:
        return shown(float(text), unit_in(name), 5)
    except ValueError:
        return text or "–"
