"""Output of a sweep in the terminal, and the names, units and values that its page shows too."""

from __future__ import annotations

import csv
import itertools
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import TABLE_BYTES
from squeezefilm.core.kit.numbers import printable, shown
from squeezefilm.core.kit.terminal import heading, say, table
from squeezefilm.core.regular_file import read_regular_text
from squeezefilm.design.sweep.answers import FOLLOWED, catalogue, unit_in, without_units
from squeezefilm.design.sweep.axes import Axis
from squeezefilm.design.sweep.swept import NOT_YET, Sweep, SweptColumn, counted


def name_of(column: Axis | SweptColumn) -> str:
    """A name without its unit, words apart: ``resonance frequency``."""
    if isinstance(column, Axis):
        return ", ".join(name.replace("_", " ") for name in column.names)
    mode = mode_of(column)
    return quantity_of(column) if mode is None else f"{mode} {quantity_of(column)}"


def mode_of(column: SweptColumn) -> str | None:
    """The label of the mode that was followed; None of any other number."""
    parts = column.name.split(".")
    return parts[1] if parts[0] == FOLLOWED else None


def quantity_of(column: SweptColumn) -> str:
    """Quantity of a column, without the mode."""
    name = without_units(column.name)
    return (name if mode_of(column) is None else name.rpartition(".")[2]).replace("_", " ")


def step_words(axis: Axis, number: int) -> str:
    """Words for a step of an axis: ``1.5 mm``."""
    return ", ".join(map(_value_words, axis.steps[number], axis.units))


def _value_words(value: float | str, unit: si.Unit | None) -> str:
    return str(value) if unit is None else shown(float(value), unit)


def read_easily(column: SweptColumn, more: str = "") -> tuple[si.FloatArray, str]:
    """The values of a column in a unit in which they are read easily, and its label: the name,
    `more` behind it, and that unit."""
    factor, symbol = scaled(column.values, column.unit)
    return factor * column.values, labelled(f"{name_of(column)}{more}", symbol)


def cells(column: SweptColumn) -> tuple[str, list[str]]:
    """The label of a column, and its values as a table has them; a dash where there is none."""
    values, label = read_easily(column)
    if column.words:
        return label, [column.words[int(value)] for value in values]
    return label, ["–" if np.isnan(value) else f"{value:.4g}" for value in values.tolist()]


def labelled(name: str, symbol: str) -> str:
    """A name with its unit behind it, where it has one."""
    return f"{name} ({symbol})" if symbol else name


def scaled(values: si.FloatArray, unit: si.Unit | None) -> tuple[float, str]:
    """A factor and a unit in which all of the values are read easily."""
    known = np.abs(values[np.isfinite(values)])
    most = float(known.max()) if known.size else 0.0
    if unit is None or unit.symbol == "1" or most == 0:
        return 1.0, "" if unit is None or unit.symbol == "1" else unit.symbol
    number, _, symbol = si.format_quantity(most, unit, 17).partition(" ")
    return float(number) / most, symbol


MOST_ROWS = 40
"""A longer sweep shows its first and last rows."""
MOST_COLUMNS = 7
_TOLD = 3
_HEAD = 9
_ALIKE = 0.6  # below it another mode may have taken its place


def sweep_columns(sweep: Sweep) -> list[tuple[str, list[str]]]:
    """Columns of what was varied and what was asked for: a heading with the unit, and a cell for
    each point."""
    every = list(itertools.product(*(range(len(axis)) for axis in sweep.axes)))
    columns = []
    for number, axis in enumerate(sweep.axes):
        for k, (name, unit) in enumerate(zip(axis.names, axis.units, strict=True)):
            steps = [_value_words(step[k], unit) for step in axis.steps]
            columns.append((name.replace("_", " "), [steps[point[number]] for point in every]))
    return [*columns, *map(cells, sweep.columns)]


def in_lines(name: str) -> str:
    """A column's name in lines, broken before underscores and after dots and blanks, so that a
    terminal of 80 columns breaks no word."""
    lines = [""]
    for part in re.findall(r"_?[^._ ]+[. ]*|[._ ]+", name):
        if lines[-1] and len(lines[-1]) + len(part.rstrip()) > _HEAD:
            lines.append("")
        lines[-1] += part
    return "\n".join(line.rstrip() for line in lines)


def show_sweep(sweep: Sweep) -> None:
    """Print a sweep."""
    points = len(sweep.reasons)
    heading(f"{sweep.title}: {points} points")
    columns = sweep_columns(sweep)
    head = [name for name, _ in columns]
    rows = list(zip(*(words for _, words in columns), strict=True))
    if len(head) > MOST_COLUMNS and len(rows) <= MOST_COLUMNS:
        # Few points and many numbers: a row for each number.
        table(
            ("", *(("",) * len(rows))),
            zip(head, *rows, strict=True),
            fixed=range(1, len(rows) + 1),
        )
    else:
        if len(rows) > MOST_ROWS:
            cut = ("…",) * len(head)
            rows = [*rows[: MOST_ROWS // 2], cut, *rows[-MOST_ROWS // 2 :]]
        shown = [row[:MOST_COLUMNS] for row in rows]
        several = [in_lines(name) for name in head[:MOST_COLUMNS]]
        table(several, shown, fixed=range(len(sweep.axes)))
        if len(head) > MOST_COLUMNS:
            say(f"{len(head) - MOST_COLUMNS} more columns stand in the files of --out")
    reasons = counted(reason for reason in sweep.reasons if reason)
    for reason, count in reasons[:_TOLD]:
        said = "were not computed yet" if reason == NOT_YET else f"have no answer: {reason}"
        say(f"! {count} of {points} points {said}")
    if len(reasons) > _TOLD:
        say(f"! {len(reasons) - _TOLD} more reasons stand in the table's last column")
    if sweep.follows:
        lost = sum(follow.lost for follow in sweep.follows)
        least = min(follow.least_likeness for follow in sweep.follows)
        say(
            f"{len(sweep.follows)} modes followed by their shapes, {lost or 'none'} of them lost "
            f"on the way; least likeness from one point to the next {least:.2f}"
            + (
                '; smaller steps, or a wider band (--vary "band=20 kHz:50 kHz"), follow further'
                if lost or least < _ALIKE
                else ""
            )
        )
    # First what is so at some of the points only: that is what the points differ by.
    for text, count in sorted(sweep.warnings, key=lambda warning: warning[1] == points)[:_TOLD]:
        say(f"! {printable(text)} (at {count} of {points} points, numbers as at one of them)")
    if len(sweep.warnings) > _TOLD:
        say(f"! {len(sweep.warnings) - _TOLD} more warnings stand in sweep.json")
    say(f"Finger: {printable(sweep.provenance['finger'])}")
    say(f"{sweep.computed} answers computed, {sweep.kept} taken from before")


def show_answers() -> None:
    """Print every name that a sweep can ask for, by verb."""
    for verb, keys in catalogue().items():
        heading(f"{verb} (or {verb}.NAME where another verb has the same)")
        for key in keys:
            say(f"  {without_units(key).replace('*', 'N')}")


Row = tuple[str, str, str, str]
"""A name with its unit, both values as they stand in the table, and the second over the first."""


def compared_rows(folder: Path | None, rows: str) -> tuple[Row, ...]:
    """Rows of what differs between two rows of ``sweep.csv`` in a folder, from 1 (``"3,17"``).

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
    heading("What differs")
    if not rows:
        say("nothing: both rows say the same")
        return
    lines = [
        (without_units(name), _with_unit(first, name), _with_unit(second, name), ratio)
        for name, first, second, ratio in rows
    ]
    table(("", "first", "second", "second / first"), lines)


def _with_unit(text: str, name: str) -> str:
    """A cell with the unit that its column's name says; a dash for an empty one."""
    try:
        return shown(float(text), unit_in(name), 5)
    except ValueError:
        return text or "–"
