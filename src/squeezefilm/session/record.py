"""The record of a session: an append-only trace that survives the program's death.

`TraceWriter` hands every block to the operating system before it counts it as acknowledged: a
killed program (kill -9) loses nothing that was acknowledged. What a power cut may take is what
came after the last `synced`. `read_trace` recovers every whole block from whatever is left of the
file and says what is missing.
"""

from __future__ import annotations

import contextlib
import json
import math
import mmap
import os
import threading
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from squeezefilm.errors import InputError, RecordError
from squeezefilm.hard_limits import TRACE_BYTES
from squeezefilm.quantities import FloatArray, Second, Unit, require
from squeezefilm.regular_file import opened
from squeezefilm.results import to_json
from squeezefilm.session import trace_file as file

SYNC_PERIOD: Second = 1.0
"""How often the trace is forced onto the disk unless asked otherwise."""


@dataclass(frozen=True, slots=True)
class TraceEvent:
    """Something that happened: its kind, its fields, and how many rows stood before it."""

    kind: str
    fields: Mapping[str, Any]
    row: int


@dataclass(frozen=True, slots=True)
class Damage:
    """What is missing of a trace.

    `lost_bytes` belong to no whole block, `lost_blocks` are missing by their numbers, `closed`
    says whether the writer came to its end, `sentences` say all of it for a person.
    """

    lost_bytes: int
    lost_blocks: int
    closed: bool
    sentences: tuple[str, ...]

    @property
    def whole(self) -> bool:
        """Whether the trace is all that was written, to the end."""
        return self.closed and not self.lost_bytes and not self.lost_blocks


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """A recorded session: `rows` of shape (n, columns) with NaN for none, events, metadata.

    The columns' names carry their units.
    """

    columns: tuple[str, ...]
    rows: FloatArray
    events: tuple[TraceEvent, ...]
    metadata: Mapping[str, Any]
    damage: Damage

    def column(self, name: str) -> FloatArray:
        """The column of that name, shape (n,). Raises `InputError` if there is none."""
        if name not in self.columns:
            raise InputError(f"there is no column '{name}'; there are {', '.join(self.columns)}")
        return self.rows[:, self.columns.index(name)]


class TraceWriter:
    """Writes a trace. Not thread-safe; one writer a file.

    Args:
        path: the file, which must not exist (a record is never written over).
        columns: names of the columns, with their units.
        metadata: where the record is from, as `results.stamp` gives it; anything with a JSON form.
        sync_period: how often rows are forced onto the disk (s), by a thread, since a disk may
            take longer than a real-time caller can wait; 0: before `append` returns.
        replace: write over a file that exists.

    Raises:
        InputError: no columns, metadata with no JSON form.
        RecordError: a file that exists or cannot be written.
    """

    def __init__(
        self,
        path: str | Path,
        columns: Sequence[str],
        metadata: Mapping[str, Any],
        *,
        sync_period: Second = SYNC_PERIOD,
        replace: bool = False,
    ) -> None:
        require("sync_period", sync_period, Unit("s"), at_least=0.0)
        if not columns or len(set(columns)) < len(columns):
            raise InputError(f"columns {list(columns)} are no table; name each once, at least one")
        self.path = Path(path)
        self.columns = tuple(columns)
        self._sync_period = sync_period
        self._blocks = self._rows = self._synced = self._size = 0
        self._last_sync = -math.inf
        self._syncing: threading.Thread | None = None
        self._sync_error: OSError | None = None
        self._metadata = _json_bytes({**metadata, "columns": list(columns)})
        mode = os.O_WRONLY | os.O_CREAT | os.O_APPEND | getattr(os, "O_BINARY", 0)
        mode |= os.O_TRUNC if replace else os.O_EXCL
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._file = os.open(self.path, mode, 0o644)
        except FileExistsError as error:
            raise RecordError(
                f"{self.path} exists; a record is never written over: give another name"
            ) from error
        except OSError as error:
            raise RecordError(
                f"cannot write {self.path}: {error.strerror}; choose another folder"
            ) from error
        self._closed = False
        try:
            self._write(file.file_header())
            self._block(file.BlockKind.METADATA, self._metadata)
            self.sync()
        except RecordError:
            self._closed = True
            os.close(self._file)
            raise

    @property
    def acknowledged(self) -> int:
        """Rows that the operating system has: no death of this program loses them."""
        return self._rows

    @property
    def synced(self) -> int:
        """Rows that are on the disk: no power cut loses them."""
        return self._synced

    def append(self, rows: FloatArray) -> int:
        """Write rows of shape (n, columns); returns how many are acknowledged in all.

        Raises:
            InputError: rows of another shape, or a writer that is closed.
            RecordError: what cannot be written (a full disk), or what a thread could not force
                onto the disk before. No row of a block that failed is acknowledged, the file ends
                with the last whole block, and writing may go on.
        """
        table = np.ascontiguousarray(rows, dtype="<f8")
        if table.ndim != 2 or table.shape[1] != len(self.columns):
            raise InputError(
                f"rows of shape {table.shape}; give (n, {len(self.columns)}), one value a column"
            )
        self._require_open()
        most = (file.LONGEST_PAYLOAD - file.ROW_HEAD.size) // (8 * table.shape[1])
        for first in range(0, len(table), most):
            part = table[first : first + most]
            head = file.ROW_HEAD.pack(table.shape[1])
            self._block(file.BlockKind.ROWS, head + part.tobytes())
            self._rows += len(part)
        if self._sync_period == 0.0:
            self.sync()
        elif time.monotonic() - self._last_sync >= self._sync_period:
            self._begin_sync()
        return self._rows

    def event(self, kind: str, fields: Mapping[str, Any] | None = None) -> None:
        """Write something that happened. Raises as `append`, and `InputError` without JSON form."""
        self._require_open()
        said = {"kind": kind, "row": self._rows, "fields": dict(fields or {})}
        self._block(file.BlockKind.EVENT, _json_bytes(said))

    def sync(self) -> None:
        """Force what is written onto the disk. Raises `RecordError` where that fails."""
        self._require_open()
        if self._syncing is not None:
            self._syncing.join()
        self._last_sync = time.monotonic()
        self._sync(self._rows)
        self._raise_if_not_synced()

    def close(self) -> None:
        """Write the closing block and force all onto the disk; closing twice is no mistake.

        Raises `RecordError` where the closing block does not fit any more; the rows stay.
        """
        if self._closed:
            return
        try:
            # A second copy: the columns' names must not hang on one block at the very beginning.
            self._block(file.BlockKind.METADATA, self._metadata)
            counts = file.CLOSING.pack(self._blocks, self._rows)
            self._block(file.BlockKind.CLOSING, counts)
            self.sync()
        finally:
            self._closed = True
            if self._syncing is not None:
                self._syncing.join()
            os.close(self._file)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        if error is None:
            self.close()
        else:
            # What went wrong first is what the caller must see.
            with contextlib.suppress(RecordError):
                self.close()

    def _begin_sync(self) -> None:
        self._raise_if_not_synced()
        if self._syncing is not None and self._syncing.is_alive():
            return
        self._last_sync = time.monotonic()
        self._syncing = threading.Thread(target=self._sync, args=(self._rows,), daemon=True)
        self._syncing.start()

    def _sync(self, rows: int) -> None:
        try:
            os.fsync(self._file)
        except OSError as error:
            self._sync_error = error
        else:
            self._synced = rows

    def _raise_if_not_synced(self) -> None:
        if self._sync_error is not None:
            error, self._sync_error = self._sync_error, None
            raise self._failed(error) from error

    def _require_open(self) -> None:
        if self._closed:
            raise InputError(f"the record {self.path} is closed; begin another")

    def _block(self, kind: file.BlockKind, payload: bytes) -> None:
        if len(payload) > file.LONGEST_PAYLOAD:
            raise InputError(
                f"a {kind.name.lower()} of {len(payload)} bytes; one block holds "
                f"{file.LONGEST_PAYLOAD}; record less of it"
            )
        self._write(file.block_bytes(kind, self._blocks, payload))
        self._blocks += 1

    def _write(self, data: bytes) -> None:
        written = 0
        try:
            while written < len(data):
                written += os.write(self._file, data[written:])
        except OSError as error:
            # Half a block would be a gap before whatever is written once there is room again.
            with contextlib.suppress(OSError):
                os.ftruncate(self._file, self._size)
            raise self._failed(error) from error
        self._size += written

    def _failed(self, error: OSError) -> RecordError:
        return RecordError(
            f"cannot write {self.path}: {error.strerror}; {self._rows} rows are acknowledged and "
            "stay; free space, or record to another disk"
        )


def read_trace(path: str | Path) -> Trace:
    """The trace in a file: every whole block of it, and what is missing.

    Content that is cut, damaged or no trace at all raises nothing; `Trace.damage` says so.

    Raises:
        InputError: a file that cannot be opened.
    """
    try:
        with opened(path, TRACE_BYTES, "a trace") as handle:
            if os.fstat(handle).st_size == 0:
                return _trace(b"")
            with mmap.mmap(handle, 0, access=mmap.ACCESS_READ) as data:
                return _trace(data)
    except OSError as error:
        raise InputError(f"the trace {path} cannot be read: {error.strerror}") from error


@dataclass(slots=True)
class _Found:
    """What was found so far in a file."""

    metadata: dict[str, Any] | None = None
    events: list[TraceEvent] = field(default_factory=list)
    tables: list[tuple[int, int, int]] = field(default_factory=list)
    rows: int = 0
    next_number: int = 0
    lost_blocks: int = 0
    lost_bytes: int = 0
    closed: bool = False
    gaps: list[file.Gap] = field(default_factory=list)
    misread: int = 0


def _trace(data: bytes | mmap.mmap) -> Trace:
    found = _Found()
    for part in file.blocks(data):
        if isinstance(part, file.Gap):
            found.lost_bytes += part.end - part.start
            found.gaps.append(part)
        elif part.number < found.next_number:
            found.misread += 1
        else:
            found.lost_blocks += part.number - found.next_number
            found.next_number = part.number + 1
            _take(found, part, data)
    metadata = found.metadata or {}
    columns = _columns(metadata, found)
    kept = [table for table in found.tables if table[2] == len(columns)]
    found.misread += len(found.tables) - len(kept)
    rows = np.empty((sum(count for _, count, _ in kept), len(columns)))
    at = 0
    for start, count, width in kept:
        values = np.frombuffer(data[start : start + 8 * count * width], dtype="<f8")
        rows[at : at + count] = values.reshape(count, width)
        at += count
    return Trace(columns, rows, tuple(found.events), metadata, _damage(found, data))


def _take(found: _Found, block: file.Block, data: bytes | mmap.mmap) -> None:
    payload = data[block.start : block.start + block.length]
    match block.kind:
        case file.BlockKind.ROWS:
            width = file.ROW_HEAD.unpack_from(payload)[0] if block.length >= 4 else 0
            count, rest = divmod(block.length - 4, 8 * width) if width else (0, 1)
            if rest:
                found.misread += 1
                return
            found.tables.append((block.start + file.ROW_HEAD.size, count, width))
            found.rows += count
        case file.BlockKind.CLOSING:
            found.closed = True
        case _:
            said = _json_object(payload)
            if said is None:
                found.misread += 1
            elif block.kind is file.BlockKind.METADATA:
                found.metadata = said
            else:
                row, fields = said.get("row"), said.get("fields")
                found.events.append(
                    TraceEvent(
                        str(said.get("kind", "")),
                        fields if isinstance(fields, dict) else {},
                        row if isinstance(row, int) else found.rows,
                    )
                )


def _columns(metadata: Mapping[str, Any], found: _Found) -> tuple[str, ...]:
    named = metadata.get("columns")
    if isinstance(named, list) and named:
        return tuple(str(name) for name in named)
    # The names went with the metadata; the values did not.
    width = found.tables[0][2] if found.tables else 0
    return tuple(f"column_{number + 1}" for number in range(width))


def _damage(found: _Found, data: bytes | mmap.mmap) -> Damage:
    said = []
    version = file.header_version(data)
    if version is None:
        said.append("the file's header is missing or damaged")
    elif version != file.VERSION:
        said.append(f"the file is of version {version}; this program reads {file.VERSION}")
    if found.metadata is None:
        said.append("the metadata are lost, and with them the columns' names")
    if found.lost_blocks:
        said.append(f"{found.lost_blocks} blocks are missing by their numbers")
    for gap in found.gaps[:5]:
        said.append(f"bytes {gap.start} to {gap.end - 1} belong to no whole block")
    if len(found.gaps) > 5:
        said.append(f"and {len(found.gaps) - 5} more such places")
    if found.misread:
        said.append(f"{found.misread} blocks are whole but say nothing this program understands")
    if not found.closed:
        said.append(
            "the record was not closed: the program ended before; all that was acknowledged and "
            "not damaged since is here"
        )
    return Damage(found.lost_bytes, found.lost_blocks, found.closed, tuple(said))


def _json_bytes(value: Mapping[str, Any]) -> bytes:
    try:
        return json.dumps(to_json(value), allow_nan=False).encode()
    except TypeError as error:
        raise InputError(f"{error}; record only what has one") from error


def _json_object(payload: bytes) -> dict[str, Any] | None:
    try:
        value = json.loads(payload)
    except (ValueError, RecursionError):
        return None
    return value if isinstance(value, dict) else None
