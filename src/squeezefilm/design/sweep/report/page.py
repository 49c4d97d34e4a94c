"""A sweep in files: its table, its JSON, its pictures and their page."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.traces import parquet_of_columns
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import csv_text, json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.page_style import (
    Pictures,
    bullets,
    links,
    page,
    picture_files,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.design.sweep.answers import FOLLOWED
from squeezefilm.design.sweep.report.figures import (
    effects_figure,
    sweep_figure,
    tradeoffs_figure,
)
from squeezefilm.design.sweep.report.terminal import cells, name_of
from squeezefilm.design.sweep.swept import (
    Effects,
    Sweep,
    SweptColumn,
    counted,
    effects_of,
    varied_values,
)
from squeezefilm.design.sweep.tradeoffs import non_dominated

_MOST_ROWS = 20


def wishes(
    asked: Sequence[tuple[str, si.Unit]], less: Sequence[str], more: Sequence[str]
) -> tuple[tuple[str, int], ...]:
    """Directions, less is better (1) or more is (-1), of answers by their columns' names; `asked`
    are those there are, with their units.

    Raises `InputError` for one that was not asked for, is named twice, or is of followed modes.
    """
    asked = [(name, unit) for name, unit in asked if name.partition(".")[0] != FOLLOWED]
    by_name = {key: name for name, unit in asked for key in (name, name.removesuffix(unit.suffix))}
    directions: dict[str, int] = {}
    for option, texts, sign in (("less", less, 1), ("more", more, -1)):
        for name in (part.strip() for text in texts for part in text.split(",")):
            if name.partition(".")[0] == FOLLOWED:
                raise InputError(
                    f"--{option} {name} is of modes that have names only once they are solved, so "
                    "that nothing can be wished of them; name another number, like "
                    "resonance_frequency, and ask for it",
                    quantity=option,
                )
            if name not in by_name:
                raise InputError(
                    f"--{option} {name} was not asked for.{si.did_you_mean(name, by_name)} There "
                    f"are: {', '.join(name for name, _ in asked)}",
                    quantity=option,
                )
            if by_name[name] in directions:
                raise InputError(f"{name} is wished for twice; say it once, as less or as more")
            directions[by_name[name]] = sign
    return tuple(directions.items())


def sweep_page(
    sweep: Sweep, files: Sequence[str], better: tuple[tuple[str, int], ...] = ()
) -> dict[str, str | bytes]:
    """The page index.html and its pictures by name; `better` as of `wishes`."""
    varied, effects = varied_values(sweep), effects_of(sweep)
    figures: Pictures = {}
    if not any(axis.sampled for axis in sweep.axes):
        figures["sweep"] = ("The sweep", sweep_figure(sweep))
    figures["effects"] = ("Main effects", effects_figure(sweep))
    if len(sweep.columns) > 1:
        figures["tradeoffs"] = ("Trade-offs", tradeoffs_figure(sweep, better))
    title = escape(printable(sweep.title))
    unanswered = counted(reason for reason in sweep.reasons if reason)
    return {
        **picture_files(figures),
        "index.html": page(
            f"{title}: a sweep",
            f"{title}: a sweep of {len(sweep.reasons)} points",
            f"asked of {escape(', '.join(sweep.verbs))}, by squeezefilm; "
            f"finger: {escape(printable(sweep.provenance['finger']))}",
            picture_sections(figures)
            + _decisive(effects, varied)
            + _best(sweep, better)
            + section(
                "Points without an answer",
                bullets(f"{reason} ({count} points)" for reason, count in unanswered),
            )
            + section(
                "Warnings", bullets(f"{text} (at {count} points)" for text, count in sweep.warnings)
            ),
            f"{stamped(sweep.provenance, 'SHA-256 of the display')}. Beside this page: "
            f"{links(files)}.",
        ),
    }


def _decisive(effects: Sequence[Effects], varied: Sequence[SweptColumn]) -> str:
    """Tables of the shares, and of the pairs, of every answer."""
    out = ""
    for effect in effects:
        rows = [
            (name_of(value), _share(*first), _share(*total))
            for value, first, total in zip(varied, effect.first, effect.total, strict=True)
        ]
        pairs = [
            (f"{name_of(varied[i])} and {name_of(varied[j])}", _share(share, error))
            for (i, j), (share, error) in sorted(effect.pairs.items(), key=lambda p: -p[1][0])[:10]
        ]
        told = (
            "Exact for the points of this grid; a finer grid may say otherwise."
            if effect.explained is None
            else f"From a fit to {effect.points} points, which explains {effect.explained:.0%} of "
            "the variance of points left out of it; errors are one standard error, from drawing "
            "the points again."
        )
        table = text_table(told, ("Varied", "Share alone", "Share with interactions"), rows)
        if pairs:
            table += text_table("Only both together", ("Pair", "Share"), pairs)
        out += section(f"What decides: {escape(name_of(effect.column))}", table)
    return out


def _share(share: float, error: float) -> str:
    return f"{share:.1%}" if error == 0 else f"{share:.1%} ± {error:.1%}"


def _best(sweep: Sweep, better: tuple[tuple[str, int], ...]) -> str:
    """The rows that no other beats in what is wished for."""
    if not better:
        return section(
            "Points that no other beats",
            "<p>Say of which answers less is better and of which more, as in "
            "<code>--less relative_friction --more amplitude_per_volt</code>, and they are marked "
            "and listed here.</p>",
        )
    wanted = dict(better)
    columns = [c for c in sweep.columns if c.name in wanted]
    values = np.column_stack([wanted[c.name] * c.values for c in columns])
    rows = np.flatnonzero(non_dominated(values))
    rows = rows[np.argsort(values[rows, 0], kind="stable")]
    table = [cells(column) for column in (*varied_values(sweep), *columns)]
    head = ["Row", *(label for label, _ in table)]
    lines = [
        [str(row + 1), *(words[row] for _, words in table)] for row in rows[:_MOST_ROWS].tolist()
    ]
    caption = f"{len(rows)} of {len(sweep.reasons)} points; rows are those of the table, from 1"
    return section("Points that no other beats", text_table(caption, head, lines))


KINDS = ("csv", "parquet")


def sweep_csv(sweep: Sweep) -> str:
    """The table as CSV: a header with units, a row for each point, empty where there is nothing."""
    columns = sweep.table()
    return csv_text(list(columns), zip(*columns.values(), strict=True))


def require_kind(table: str) -> None:
    """Refuse a kind of table that is none, before any work. Raises `InputError`."""
    if table not in KINDS:
        raise InputError(f"a table cannot be '{table}'; it may be csv or parquet")


def write_sweep(
    sweep: Sweep,
    folder: Path,
    *,
    table: str = "csv",
    less: Sequence[str] = (),
    more: Sequence[str] = (),
) -> Path:
    """Write index.html with its pictures, sweep.csv (or sweep.parquet), sweep.json and sweep.png
    into `folder`; the page's path. `less` and `more` name answers of which less or more is better.

    Raises `InputError` for another kind of table, for a name that was not asked for, and where the
    folder cannot be written to.
    """
    require_kind(table)
    better = wishes([(column.name, column.unit) for column in sweep.columns], less, more)
    folder = require_folder(folder)
    name = f"sweep.{table}"
    summary = sweep.summary()
    files: dict[str, str | bytes] = {
        name: sweep_csv(sweep)
        if table == "csv"
        else parquet_of_columns(sweep.table(), summary["provenance"]),
        "sweep.json": json_text(summary),
    }
    page_files = sweep_page(sweep, list(files), better)
    if "sweep.png" not in page_files:
        files["sweep.png"] = style.png(sweep_figure(sweep))
    return write_folder(folder, files | page_files)
