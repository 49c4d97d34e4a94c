"""The file of a session's trace, append-only: blocks that are whole or not there, and its writer.

A file begins with `SQFTRACE`, a version (u32) and the CRC-32 of both. Then come blocks, each
``marker, kind u32, number u32, length u32, payload, CRC-32 u32``, little-endian; the CRC covers
kind, number, length and payload. Numbers count up from 0, so that a reader knows what is missing,
and the marker lets it find the next block behind a damaged one. Block 0 is the metadata.

Payloads: metadata and events are UTF-8 JSON; rows are a u32, the count of columns, and float64
after float64, row by row; the closing block is two u64, the counts of blocks and of rows.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import struct
import threading
import time
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from mmap import mmap
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.core.results import sync_folder, to_json

MAGIC = b"SQFTRACE"
VERSION = 1
MARKER = b"\xabSQ\x1a"
LONGEST_PAYLOAD = 1 << 20
"""Bytes of one block; longer rows are cut into several, so that a damaged one costs little."""

_PIECE = 1 << 26
"""Bytes that are searched at once: some hundredths of a second."""

_HEADER = struct.Struct("<8sII")
_BLOCK = struct.Struct("<4sIII")
_CRC = struct.Struct("<I")
ROW_HEAD = struct.Struct("<I")
CLOSING = struct.Struct("<QQ")
HEADER_SIZE = _HEADER.size


class BlockKind(IntEnum):
    """Kind of what a block carries."""

    METADATA = 1
    ROWS = 2
    EVENT = 3
    CLOSING = 4


@dataclass(frozen=True, slots=True)
class Block:
    """A whole block: what it carries, its number, and where its payload lies in the file."""

    kind: BlockKind
    number: int
    start: int
    length: int


@dataclass(frozen=True, slots=True)
class TraceGap:
    """Bytes of a file, from `start` to before `end`, that belong to no whole block."""

    start: int
    end: int


def file_header() -> bytes:
    """The first bytes of a trace."""
    head = struct.pack("<8sI", MAGIC, VERSION)
    return head + _CRC.pack(zlib.crc32(head))


def block_bytes(kind: BlockKind, number: int, payload: bytes) -> bytes:
    """Bytes of a block as it stands in the file. `payload` has at most `LONGEST_PAYLOAD` bytes."""
    head = _BLOCK.pack(MARKER, kind, number & 0xFFFFFFFF, len(payload))
    crc = zlib.crc32(payload, zlib.crc32(head[len(MARKER) :]))
    return head + payload + _CRC.pack(crc)


def header_version(data: bytes | mmap) -> int | None:
    """The version that a file's header gives, or None where the header is missing or damaged."""
    if len(data) < HEADER_SIZE:
        return None
    magic, version, crc = _HEADER.unpack(data[:HEADER_SIZE])
    if magic != MAGIC or zlib.crc32(data[: HEADER_SIZE - _CRC.size]) != crc:
        return None
    return int(version)


def blocks(
    data: bytes | mmap, looked_at: Callable[[int], object] = lambda _: None
) -> Iterator[Block | TraceGap]:
    """Every whole block in the order of the file, and the gaps between them. Raises nothing.

    A block is believed only by its CRC, so it does not matter what the bytes before it were.
    `looked_at` is told, time and again, how many bytes were gone through.
    """
    at = HEADER_SIZE if header_version(data) is not None else 0
    lost_from = at
    while True:
        marker = _marker(data, at, looked_at)
        if marker < 0:
            break
        block = _block_at(data, marker)
        if block is None:
            at = marker + 1
            continue
        if marker > lost_from:
            yield TraceGap(lost_from, marker)
        yield block
        at = lost_from = block.start + block.length + _CRC.size
    if len(data) > lost_from:
        yield TraceGap(lost_from, len(data))


def _marker(data: bytes | mmap, at: int, looked_at: Callable[[int], object]) -> int:
    """The place of the next marker from `at` on; -1 for none. In pieces, between which Ctrl-C is
    heard: a file may have any length without one."""
    while at < len(data):
        looked_at(at)
        place = data.find(MARKER, at, at + _PIECE + len(MARKER) - 1)
        if place >= 0:
            return place
        at += _PIECE
    return -1


def _block_at(data: bytes | mmap, at: int) -> Block | None:
    start = at + _BLOCK.size
    if start > len(data):
        return None
    _, kind, number, length = _BLOCK.unpack(data[at:start])
    end = start + length
    if length > LONGEST_PAYLOAD or end + _CRC.size > len(data) or kind not in _KINDS:
        return None
    (crc,) = _CRC.unpack(data[end : end + _CRC.size])
    if zlib.crc32(data[at + len(MARKER) : end]) != crc:
        return None
    return Block(BlockKind(kind), number, start, length)


_KINDS = frozenset(int(kind) for kind in BlockKind)


SYNC_PERIOD: si.Second = 1.0
"""Time after which the trace is forced onto the disk: by a thread, since a disk may take longer
than a real-time caller can wait."""


class TraceWriter:
    """Writer of a trace that survives the program's death. Not thread-safe; one writer a file.

    It hands every block to the operating system before it counts it as acknowledged: a killed
    program (kill -9) loses nothing of that. What a power cut may take is what came after the last
    `synced`. `trace.read_trace` recovers every whole block from whatever is left of the file.

    Args:
        path: the file, which must not exist (a record is never written over).
        columns: names of the columns, with their units.
        metadata: where the record is from, as `core.results.stamp` gives it; anything with a JSON
            form.

    Raises:
        InputError: no columns, metadata with no JSON form.
        RecordError: a file that exists or cannot be written.
    """

    def __init__(
        self, path: str | Path, columns: Sequence[str], metadata: Mapping[str, Any]
    ) -> None:
        if not columns or len(set(columns)) < len(columns):
            raise InputError(f"columns {list(columns)} are no table; name each once, at least one")
        self.path = Path(path)
        self.columns = tuple(columns)
        self._blocks = self._rows = self._synced = self._size = 0
        self._last_sync = -math.inf
        self._syncing: threading.Thread | None = None
        self._sync_error: OSError | None = None
        self._sync_failed = False
        self._metadata = _json_bytes({**metadata, "columns": list(columns)})
        mode = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND | getattr(os, "O_BINARY", 0)
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._file = os.open(self.path, mode, 0o644)
        except OSError as error:
            if isinstance(error, FileExistsError) and os.path.lexists(self.path):
                raise RecordError(
                    f"{self.path} exists; a record is never written over: give another name"
                ) from error
            raise RecordError(
                f"cannot write {self.path}: {error.strerror}; choose another folder"
            ) from error
        self._closed = False
        try:
            self._write(file_header())
            self._block(BlockKind.METADATA, self._metadata)
            self.sync()
            self._sync_name()
        except RecordError:
            self._closed = True
            if os.path.samestat(os.fstat(self._file), self.path.stat()):
                # Nothing was acknowledged in it, and it would keep its name from a next one.
                with contextlib.suppress(OSError):
                    self.path.unlink()
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

    def append(self, rows: si.FloatArray) -> int:
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
        most = (LONGEST_PAYLOAD - ROW_HEAD.size) // (8 * table.shape[1])
        for first in range(0, len(table), most):
            part = table[first : first + most]
            head = ROW_HEAD.pack(table.shape[1])
            self._block(BlockKind.ROWS, head + part.tobytes())
            self._rows += len(part)
        if time.monotonic() - self._last_sync >= SYNC_PERIOD:
            self._begin_sync()
        return self._rows

    def event(self, kind: str, fields: Mapping[str, Any] | None = None) -> None:
        """Write something that happened. Raises as `append`, and `InputError` without JSON form."""
        self._require_open()
        said = {"kind": kind, "row": self._rows, "fields": dict(fields or {})}
        self._block(BlockKind.EVENT, _json_bytes(said))

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
            self._block(BlockKind.METADATA, self._metadata)
            counts = CLOSING.pack(self._blocks, self._rows)
            self._block(BlockKind.CLOSING, counts)
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
            self._sync_error, self._sync_failed = error, True
        else:
            # What a sync failed on may be gone for good: no later one answers for those rows.
            if not self._sync_failed:
                self._synced = rows

    def _sync_name(self) -> None:
        try:
            sync_folder(self.path.parent)
        except OSError as error:
            raise self._failed(error) from error

    def _raise_if_not_synced(self) -> None:
        if self._sync_error is not None:
            error, self._sync_error = self._sync_error, None
            raise self._failed(error) from error

    def _require_open(self) -> None:
        if self._closed:
            raise InputError(f"the record {self.path} is closed; begin another")

    def _block(self, kind: BlockKind, payload: bytes) -> None:
        if len(payload) > LONGEST_PAYLOAD:
            raise InputError(
                f"a {kind.name.lower()} of {len(payload)} bytes; one block holds "
                f"{LONGEST_PAYLOAD}; record less of it"
            )
        self._write(block_bytes(kind, self._blocks, payload))
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


def _json_bytes(value: Mapping[str, Any]) -> bytes:
    try:
        return json.dumps(to_json(value), allow_nan=False).encode()
    except TypeError as error:
        raise InputError(f"{error}; record only what has one") from error
