"""A sweep in files: its table as CSV or Parquet, its JSON, its picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.traces import parquet_of_columns
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import csv_text, json_text, require_folder, write_folder
from squeezefilm.design.sweep.report.figures import sweep_figure
from squeezefilm.design.sweep.report.page import sweep_page, wishes
from squeezefilm.design.sweep.swept import Sweep

KINDS = ("csv", "parquet")


def sweep_csv(found: Sweep) -> str:
    """The table as CSV: a header with units, a row for each point, empty where there is nothing."""
    columns = found.table()
    return csv_text(list(columns), zip(*columns.values(), strict=True))


def require_kind(table: str) -> None:
    """Refuse a kind of table that is none, before any work. Raises `InputError`."""
    if table not in KINDS:
        raise InputError(f"a table cannot be '{table}'; it may be csv or parquet")


def write_sweep(
    found: Sweep,
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
    better = wishes([(one.name, one.unit) for one in found.columns], less, more)
    folder = require_folder(folder)
    name = f"sweep.{table}"
    summary = found.summary()
    files: dict[str, str | bytes] = {
        name: sweep_csv(found)
        if table == "csv"
        else parquet_of_columns(found.table(), summary["provenance"]),
        "sweep.json": json_text(summary),
    }
    files |= sweep_page(found, list(files), better)
    files.setdefault("sweep.png", style.png(sweep_figure(found)))
    write_folder(folder, files)
    return folder / "index.html"
