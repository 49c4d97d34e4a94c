"""The record of a session: an append-only trace that survives the program's death.

`TraceWriter` hands every block to the operating system before it counts it as acknowledged: a
killed program (kill -9) loses nothing that was acknowledged. What a power cut may take is what
came after the last `synced`. `trace` recovers every whole block from whatever is left of
the file.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.core.results import sync_folder, to_json
from squeezefilm.instruments.session.record import trace_file as file

SYNC_PERIOD: si.Second = 1.0
"""Time after which the trace is forced onto the disk unless asked otherwise."""


class TraceWriter:
    """Writer of a trace. Not thread-safe; one writer a file.

    Args:
        path: the file, which must not exist (a record is never written over).
        columns: names of the columns, with their units.
        metadata: where the record is from, as `core.results.stamp` gives it; anything with a JSON
        form. sync_period: how often rows are forced onto the disk (s), by a thread, since a disk
        may
            take longer than a real-time caller can wait; 0: before `append` returns.

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
        sync_period: si.Second = SYNC_PERIOD,
    ) -> None:
        si.require("sync_period", sync_period, si.Unit("s"), at_least=0.0)
        if not columns or len(set(columns)) < len(columns):
            raise InputError(f"columns {list(columns)} are no table; name each once, at least one")
        self.path = Path(path)
        self.columns = tuple(columns)
        self._sync_period = sync_period
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
            self._write(file.file_header())
            self._block(file.BlockKind.METADATA, self._metadata)
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


def _json_bytes(value: Mapping[str, Any]) -> bytes:
    try:
        return json.dumps(to_json(value), allow_nan=False).encode()
    except TypeError as error:
        raise InputError(f"{error}; record only what has one") from error
