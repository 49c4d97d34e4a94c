"""What the terminal shows of a sweep: its table, what failed, what was warned of."""

from __future__ import annotations

import collections
import itertools

from squeezefilm.report.kit.terminal import heading, plain_console, table
from squeezefilm.report.sweep.words import name_of, step_words, value_words
from squeezefilm.search.answers import catalogue, without_units
from squeezefilm.search.swept import NOT_YET, Sweep

MOST_ROWS = 40
"""A longer sweep shows its first and last rows."""
_TOLD = 3


def sweep_rows(found: Sweep) -> list[tuple[str, ...]]:
    """A row of words for each point: what was varied, what was asked for."""
    rows = []
    for at, numbers in enumerate(itertools.product(*(range(len(a)) for a in found.axes))):
        steps = (step_words(axis, k) for axis, k in zip(found.axes, numbers, strict=True))
        values = (value_words(float(c.values[at]), c.unit) for c in found.columns)
        rows.append((*steps, *values))
    return rows


def show_sweep(found: Sweep) -> None:
    """Print a sweep."""
    console = plain_console()
    points = len(found.reasons)
    heading(console, f"{found.title}: {points} points")
    rows = sweep_rows(found)
    if len(rows) > MOST_ROWS:
        cut = ("…",) * len(rows[0])
        rows = [*rows[: MOST_ROWS // 2], cut, *rows[-MOST_ROWS // 2 :]]
    head = [*map(name_of, found.axes), *map(name_of, found.columns)]
    table(console, head, rows, fixed=range(len(found.axes)))
    counts = collections.Counter(reason for reason in found.reasons if reason)
    for reason, count in counts.most_common(_TOLD):
        said = "were not computed yet" if reason == NOT_YET else f"have no answer: {reason}"
        console.print(f"! {count} of {points} points {said}")
    if len(counts) > _TOLD:
        console.print(f"! {len(counts) - _TOLD} more reasons stand in the table's last column")
    least = [float(one.likeness[one.likeness == one.likeness].min()) for one in found.follows]
    if least:
        console.print(
            f"{len(least)} modes followed by their shapes; least likeness from one point to the "
            f"next {min(least):.2f}" + ("; take smaller steps" if min(least) < 0.6 else "")
        )
    for text, count in found.warnings[:_TOLD]:
        console.print(f"! {text} (at {count} of {points} points, numbers as at one of them)")
    if len(found.warnings) > _TOLD:
        console.print(f"! {len(found.warnings) - _TOLD} more warnings stand in sweep.json")
    console.print(f"{found.computed} answers computed, {found.kept} taken from before")


def show_answers() -> None:
    """Print every name that a sweep can ask for, by verb."""
    console = plain_console()
    for verb, keys in catalogue().items():
        heading(console, f"{verb} (or {verb}.NAME where another verb has the same)")
        for key in keys:
            console.print(f"  {without_units(key).replace('*', 'N')}")
