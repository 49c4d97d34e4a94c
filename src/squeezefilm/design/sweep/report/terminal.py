"""What the terminal shows of a sweep: its table, what failed, what was warned of."""

from __future__ import annotations

import itertools
import re

from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.terminal import heading, plain_console, table
from squeezefilm.design.sweep.answers import catalogue, without_units
from squeezefilm.design.sweep.report.words import cells, each_name, labelled, name_of, step_words
from squeezefilm.design.sweep.swept import NOT_YET, Sweep, counted

MOST_ROWS = 40
"""A longer sweep shows its first and last rows."""
MOST_COLUMNS = 7
_TOLD = 3
_HEAD = 9
_ALIKE = 0.6  # below it another mode may have taken its place


def sweep_columns(found: Sweep) -> list[tuple[str, list[str]]]:
    """What was varied and what was asked for as columns: a heading with the unit, and a cell for
    each point."""
    every = list(itertools.product(*(range(len(axis)) for axis in found.axes)))
    columns = []
    for number, axis in enumerate(found.axes):
        for one in each_name(axis):
            steps = [step_words(one, k) for k in range(len(one))]
            columns.append((name_of(one), [steps[point[number]] for point in every]))
    for column in found.columns:
        symbol, words = cells(column.values, column.unit)
        columns.append((labelled(name_of(column), symbol), words))
    return columns


def in_lines(name: str) -> str:
    """A column's name in lines, broken before underscores and after dots and blanks, so that a
    terminal of 80 columns breaks no word."""
    lines = [""]
    for part in re.findall(r"_?[^._ ]+[. ]*|[._ ]+", name):
        if lines[-1] and len(lines[-1]) + len(part.rstrip()) > _HEAD:
            lines.append("")
        lines[-1] += part
    return "\n".join(line.rstrip() for line in lines)


def show_sweep(found: Sweep) -> None:
    """Print a sweep."""
    console = plain_console()
    points = len(found.reasons)
    heading(console, f"{found.title}: {points} points")
    columns = sweep_columns(found)
    head = [name for name, _ in columns]
    rows = list(zip(*(words for _, words in columns), strict=True))
    if len(head) > MOST_COLUMNS and len(rows) <= MOST_COLUMNS:
        # Few points and many numbers: a row for each number.
        table(
            console,
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
        table(console, several, shown, fixed=range(len(found.axes)))
        if len(head) > MOST_COLUMNS:
            console.print(f"{len(head) - MOST_COLUMNS} more columns stand in the files of --out")
    reasons = counted(reason for reason in found.reasons if reason)
    for reason, count in reasons[:_TOLD]:
        said = "were not computed yet" if reason == NOT_YET else f"have no answer: {reason}"
        console.print(f"! {count} of {points} points {said}")
    if len(reasons) > _TOLD:
        console.print(f"! {len(reasons) - _TOLD} more reasons stand in the table's last column")
    if found.follows:
        lost = sum(follow.lost for follow in found.follows)
        least = min(follow.least_likeness for follow in found.follows)
        console.print(
            f"{len(found.follows)} modes followed by their shapes, {lost or 'none'} of them lost "
            f"on the way; least likeness from one point to the next {least:.2f}"
            + (
                '; smaller steps, or a wider band (--vary "band=20 kHz:50 kHz"), follow further'
                if lost or least < _ALIKE
                else ""
            )
        )
    # First what is so at some of the points only: that is what the points differ by.
    for text, count in sorted(found.warnings, key=lambda warning: warning[1] == points)[:_TOLD]:
        console.print(
            f"! {printable(text)} (at {count} of {points} points, numbers as at one of them)"
        )
    if len(found.warnings) > _TOLD:
        console.print(f"! {len(found.warnings) - _TOLD} more warnings stand in sweep.json")
    console.print(f"Finger: {printable(found.provenance['finger'])}")
    console.print(f"{found.computed} answers computed, {found.kept} taken from before")


def show_answers() -> None:
    """Print every name that a sweep can ask for, by verb."""
    console = plain_console()
    for verb, keys in catalogue().items():
        heading(console, f"{verb} (or {verb}.NAME where another verb has the same)")
        for key in keys:
            console.print(f"  {without_units(key).replace('*', 'N')}")
