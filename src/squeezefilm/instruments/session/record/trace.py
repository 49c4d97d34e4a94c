"""Reading a trace: every whole block of whatever is left of its file, and what is missing.

And the trace as a table that other programs read: CSV or Parquet, with its metadata.
"""

from __future__ import annotations

import mmap
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.traces import Table, csv_text, parquet_bytes
from squeezefilm.core.hard_limits import TRACE_BYTES
from squeezefilm.core.progress import SayProgress, ShareProgress, said_with_time_left
from squeezefilm.core.regular_file import opened, parsed_json
from squeezefilm.core.results import Result, write_whole
from squeezefilm.instruments.session.record import trace_file as file

_TOLD = 100_000_000
"""Bytes of a trace after which it is told again how far its reading is."""

FORMATS = {".csv": "csv", ".parquet": "parquet"}


@dataclass(frozen=True, slots=True)
class TraceEvent:
    """Something that happened: its kind, its fields, and how many rows stood before it."""

    kind: str
    fields: Mapping[str, Any]
    row: int


@dataclass(frozen=True, slots=True)
class Damage:
    """Parts that a trace lacks.

    `lost_bytes` belong to no whole block, `lost_blocks` are missing by their numbers, `closed`
    says whether the writer came to its end, `sentences` say all of it for a person.
    """

    lost_bytes: int
    lost_blocks: int
    closed: bool
    sentences: tuple[str, ...]

    @property
    def whole(self) -> bool:
        """True where the trace is all that was written, to the end."""
        return self.closed and not self.lost_bytes and not self.lost_blocks


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Trace(Result):
    """A recorded session: `rows` of shape (n, columns) with NaN for none, events, metadata.

    The columns' names carry their units.
    """

    columns: tuple[str, ...]
    rows: si.FloatArray
    events: tuple[TraceEvent, ...]
    metadata: Mapping[str, Any]
    damage: Damage
    _shown: ClassVar[str] = "display texture row_count duration damage.sentences"

    def column(self, name: str) -> si.FloatArray:
        """The column of that name, shape (n,). Raises `InputError` if there is none."""
        if name not in self.columns:
            raise InputError(f"there is no column '{name}'; there are {', '.join(self.columns)}")
        return self.rows[:, self.columns.index(name)]

    @property
    def display(self) -> str:
        """Name of the display, by the record's own word; empty where it says nothing."""
        return str(self.metadata.get("display", ""))

    @property
    def texture(self) -> str:
        """Name of the texture, by the record's own word; empty where it says nothing."""
        return str(self.metadata.get("texture", ""))

    @property
    def row_count(self) -> int:
        """Number of rows."""
        return len(self.rows)

    @property
    def duration(self) -> si.Second:
        """Time from the first row to the last (s); 0 without a column of times."""
        if "time_s" not in self.columns or not len(self.rows):
            return 0.0
        return float(np.ptp(self.column("time_s")))

    def summary(self) -> dict[str, Any]:
        """Mapping of where it is from, how much there is, and what is missing."""
        return {
            "columns": list(self.columns),
            "rows": len(self.rows),
            "duration_s": self.duration,
            "events": [
                {"kind": event.kind, "row": event.row, **event.fields} for event in self.events
            ],
            "damage": list(self.damage.sentences),
            "metadata": dict(self.metadata),
        }

    def _table(self) -> Any:
        return {name: self.rows[:, at] for at, name in enumerate(self.columns)}


def read_trace(path: str | Path, tell: ShareProgress | None = None) -> Trace:
    """The trace in a file: every whole block of it, and what is missing.

    Content that is cut, damaged or no trace at all raises nothing; `Trace.damage` says so. `tell`
    is told which share of the file is read.

    Raises:
        InputError: a file that cannot be opened, or what is no file (a pipe has no end).
    """
    try:
        with opened(path, TRACE_BYTES, "a trace") as handle:
            if os.fstat(handle).st_size == 0:
                return _trace(b"", tell)
            with mmap.mmap(handle, 0, access=mmap.ACCESS_READ) as data:
                return _trace(data, tell)
    except InputError:
        raise
    except (OSError, ValueError) as error:
        raise InputError(f"cannot read the trace {path}: {error}") from error


@dataclass(slots=True)
class _Found:
    """Content of a file as found so far."""

    metadata: dict[str, Any] | None = None
    events: list[TraceEvent] = field(default_factory=list)
    tables: list[tuple[int, int, int]] = field(default_factory=list)
    rows: int = 0
    next_number: int = 0
    lost_blocks: int = 0
    lost_bytes: int = 0
    closed: bool = False
    gaps: list[file.TraceGap] = field(default_factory=list)
    misread: int = 0


def _trace(data: bytes | mmap.mmap, tell: ShareProgress | None) -> Trace:
    content, told = _Found(), 0

    def looked_at(place: int) -> None:
        nonlocal told
        if tell is not None and place >= told:
            tell(f"reading the trace, {len(data) / 1e9:.3g} GB", place / len(data))
            told = place + max(len(data) // 50, _TOLD)

    for part in file.blocks(data, looked_at):
        if isinstance(part, file.TraceGap):
            content.lost_bytes += part.end - part.start
            content.gaps.append(part)
        elif part.number < content.next_number:
            content.misread += 1
        else:
            content.lost_blocks += part.number - content.next_number
            content.next_number = part.number + 1
            _take(content, part, data)
    metadata = content.metadata or {}
    columns = _columns(metadata, content)
    kept = [table for table in content.tables if table[2] == len(columns)]
    content.misread += len(content.tables) - len(kept)
    rows = np.empty((sum(count for _, count, _ in kept), len(columns)))
    at = 0
    for start, count, width in kept:
        values = np.frombuffer(data[start : start + 8 * count * width], dtype="<f8")
        rows[at : at + count] = values.reshape(count, width)
        at += count
    return Trace(columns, rows, tuple(content.events), metadata, _damage(content, data))


def _take(content: _Found, block: file.Block, data: bytes | mmap.mmap) -> None:
    payload = data[block.start : block.start + block.length]
    match block.kind:
        case file.BlockKind.ROWS:
            width = file.ROW_HEAD.unpack_from(payload)[0] if block.length >= 4 else 0
            count, rest = divmod(block.length - 4, 8 * width) if width else (0, 1)
            if rest or not count:
                content.misread += 1
                return
            content.tables.append((block.start + file.ROW_HEAD.size, count, width))
            content.rows += count
        case file.BlockKind.CLOSING:
            content.closed = True
        case _:
            said = _json_object(payload)
            if said is None:
                content.misread += 1
            elif block.kind is file.BlockKind.METADATA:
                content.metadata = said
            else:
                row, fields = said.get("row"), said.get("fields")
                content.events.append(
                    TraceEvent(
                        str(said.get("kind", "")),
                        fields if isinstance(fields, dict) else {},
                        row if isinstance(row, int) else content.rows,
                    )
                )


def _columns(metadata: Mapping[str, Any], content: _Found) -> tuple[str, ...]:
    named = metadata.get("columns")
    if isinstance(named, list) and named:
        return tuple(str(name) for name in named)
    # The names went with the metadata; the values did not.
    width = content.tables[0][2] if content.tables else 0
    return tuple(f"column_{number + 1}" for number in range(width))


def _damage(content: _Found, data: bytes | mmap.mmap) -> Damage:
    said = []
    version = file.header_version(data)
    if version is None:
        said.append("the file's header is missing or damaged")
    elif version != file.VERSION:
        said.append(f"the file is of version {version}; this program reads {file.VERSION}")
    if content.metadata is None:
        said.append("the metadata are lost, and with them the columns' names")
    if content.lost_blocks:
        said.append(f"{content.lost_blocks} blocks are missing by their numbers")
    for gap in content.gaps[:5]:
        said.append(f"bytes {gap.start} to {gap.end - 1} belong to no whole block")
    if len(content.gaps) > 5:
        said.append(f"and {len(content.gaps) - 5} more such places")
    if content.misread:
        said.append(f"{content.misread} blocks are whole but say nothing this program understands")
    if not content.closed:
        said.append(
            "the record was not closed: the program ended before; all that was acknowledged and "
            "not damaged since is here"
        )
    return Damage(content.lost_bytes, content.lost_blocks, content.closed, tuple(said))


def _json_object(payload: bytes) -> dict[str, Any] | None:
    try:
        value = parsed_json(payload)
    except ValueError:
        return None
    return value if isinstance(value, dict) else None


@dataclass(frozen=True, slots=True)
class TraceExport:
    """Export of a trace: files, format, counts, and what the trace had lost before (`damage`)."""

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


def export_trace(trace_path: Path, to: Path, progress: SayProgress | None = None) -> TraceExport:
    """Write a trace as CSV or Parquet, by the ending of `to`, whole or not at all; `progress` is
    told how far it is, and how long it takes.

    Raises:
        InputError: an ending that is not known, a trace that cannot be read or of which nothing
            is left, a file that cannot be written, Parquet without pyarrow.
    """
    kind = FORMATS.get(to.suffix.lower())
    if kind is None:
        raise InputError(f"{to} ends with neither .csv nor .parquet; name the file so")
    if to.resolve() == trace_path.resolve():
        raise InputError(f"{to} is the trace itself; give another name")
    say = progress or (lambda _: None)
    trace = read_trace(trace_path, said_with_time_left(say))
    table = trace_table(trace)
    say(f"writing {len(trace.rows)} rows")
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
