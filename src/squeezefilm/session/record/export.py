"""A recorded trace as a table that other programs read: CSV or Parquet, with its metadata."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from squeezefilm.errors import InputError
from squeezefilm.formats.traces import Table, csv_text, parquet_bytes
from squeezefilm.results import write_whole
from squeezefilm.session.record.trace import Trace, read_trace

FORMATS = {".csv": "csv", ".parquet": "parquet"}


@dataclass(frozen=True, slots=True)
class TraceExport:
    """What was exported: files, format, counts, and what the trace had lost before (`damage`)."""

    trace: str
    to: str
    format: str
    rows: int
    columns: tuple[str, ...]
    events: int
    not_finite: int
    closed: bool
    damage: tuple[str, ...]


def trace_table(trace: Trace) -> Table:
    """The trace as a table: units in its columns' names, events and damage in its metadata.

    Infinities, which no table keeps, become NaN; the metadata's `infinities` counts them.

    Raises:
        InputError: a trace of which no row and no metadata is left.
    """
    if not trace.columns:
        raise InputError(f"no block of the trace is whole: {'; '.join(trace.damage.sentences)}")
    rows = np.where(np.isinf(trace.rows), np.nan, trace.rows)
    metadata = {
        **trace.metadata,
        "events": [
            {"kind": event.kind, "row": event.row, "fields": dict(event.fields)}
            for event in trace.events
        ],
        "damage": list(trace.damage.sentences),
        "infinities": int(np.count_nonzero(np.isinf(trace.rows))),
    }
    return Table({name: rows[:, k].copy() for k, name in enumerate(trace.columns)}, metadata)


def export_trace(trace_path: Path, to: Path) -> TraceExport:
    """Write a trace as CSV or Parquet, by the ending of `to`, whole or not at all.

    Raises:
        InputError: an ending that is not known, a trace that cannot be read or of which nothing
            is left, a file that cannot be written, Parquet without pyarrow.
    """
    kind = FORMATS.get(to.suffix.lower())
    if kind is None:
        raise InputError(f"{to} ends with neither .csv nor .parquet; name the file so")
    if to.resolve() == trace_path.resolve():
        raise InputError(f"{to} is the trace itself; give another name")
    trace = read_trace(trace_path)
    table = trace_table(trace)
    write_whole(to, csv_text(table) if kind == "csv" else parquet_bytes(table))
    return TraceExport(
        trace=str(trace_path),
        to=str(to),
        format=kind,
        rows=len(trace.rows),
        columns=trace.columns,
        events=len(trace.events),
        not_finite=int(np.count_nonzero(~np.isfinite(trace.rows))),
        closed=trace.damage.closed,
        damage=trace.damage.sentences,
    )
