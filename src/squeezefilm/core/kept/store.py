"""Results of one kind, kept on disk under what was asked and the hash of all that computes.

What cannot be read, was damaged, or is no regular file counts as not there.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from hashlib import blake2b
from pathlib import Path
from typing import Any, Generic, TypeVar

from squeezefilm.core.errors import ConfigError
from squeezefilm.core.hard_limits import KEPT_BYTES
from squeezefilm.core.kept.computed_by import computed_by
from squeezefilm.core.kept.folder import DIGEST_BYTES, folder_of, make_private, tidy
from squeezefilm.core.kept.records import packed, unpacked
from squeezefilm.core.regular_file import read_regular

T = TypeVar("T")

MOST_SMALL, MOST_LARGE = 20_000, 32
"""Of more the older half is deleted: small ones of some 4 kB, and large ones of some 5 MB."""

_IN_PASSING: ContextVar[bool] = ContextVar("in_passing", default=False)


@contextmanager
def in_passing() -> Iterator[None]:
    """While results are computed that nobody asks for again: no large one is written, so that a
    hundred of them do not push out the few that somebody works on. What is there is read."""
    before = _IN_PASSING.set(True)
    try:
        yield
    finally:
        _IN_PASSING.reset(before)


class Kept(Generic[T]):
    """Results of a `kind`, the name of their folder, each of the type `of`: an array, a number, a
    text, or tuples and dataclasses of such (`unpacked`). `large` are those of megabytes."""

    def __init__(self, kind: str, of: Any, *, large: bool = False) -> None:
        self.kind, self._of, self._large = kind, of, large
        self._tidied: Path | None = None

    def get(self, asked: str, given: Sequence[Any] = ()) -> T | None:
        """The result kept under what was `asked`; None if there is none. `given` are records that
        the caller has and the file lacks, see `packed`."""
        file = self._file(asked)
        if file is None:
            return None
        with suppress(ConfigError):
            data = read_regular(file, KEPT_BYTES, "a result that was kept")
            if _digest(data[DIGEST_BYTES:]) == data[:DIGEST_BYTES]:
                # A file that somebody made may raise whatever its records raise.
                with suppress(Exception):
                    result: T = unpacked(data[DIGEST_BYTES:], self._of, given)
                    return result
        return None

    def found(self, asked: str, make: Callable[[], T]) -> T:
        """The result kept under what was `asked`, or else what `make` makes, which is then kept."""
        result = self.get(asked)
        if result is None:
            result = make()
            self.put(asked, result)
        return result

    def put(self, asked: str, result: T, given: Sequence[Any] = ()) -> None:
        """Keep a result; no large one `in_passing`. Where the folder cannot be written to nothing
        is kept. Raises `TypeError` for what is no plain record."""
        file = None if self._large and _IN_PASSING.get() else self._file(asked)
        if file is None:
            return
        data = packed(result, given)
        if len(data) > KEPT_BYTES.most:
            return
        with suppress(OSError):
            make_private(file.parent)
            # Of many small files once a process.
            if self._large or self._tidied != file.parent:
                self._tidied = file.parent
                tidy(file.parent, MOST_LARGE if self._large else MOST_SMALL)
            with tempfile.NamedTemporaryFile(dir=file.parent, delete=False) as part:
                try:
                    part.write(_digest(data) + data)
                    part.close()
                    # Others see all of it or nothing.
                    Path(part.name).replace(file)
                except OSError:
                    Path(part.name).unlink()
                    raise

    def _file(self, asked: str) -> Path | None:
        folder = folder_of(self.kind)
        if folder is None:
            return None
        return folder / _digest(f"{computed_by()} {asked}".encode()).hex()


def _digest(data: bytes) -> bytes:
    return blake2b(data, digest_size=DIGEST_BYTES).digest()
