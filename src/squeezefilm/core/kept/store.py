"""Results of one kind, kept on disk under what was asked and the hash of all that computes.

What cannot be read, was damaged, or is no regular file counts as not there.
"""

from __future__ import annotations

import os
import re
import sys
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
from squeezefilm.core.kept.records import packed, unpacked
from squeezefilm.core.private_folder import is_shared
from squeezefilm.core.regular_file import read_regular

CACHE_VARIABLE = "SQUEEZEFILM_CACHE"
DIGEST_BYTES = 16
_NAME = re.compile(rf"[0-9a-f]{{{2 * DIGEST_BYTES}}}")


def cache_folder() -> Path | None:
    """The folder of what is kept; None where nothing is."""
    said = os.environ.get(CACHE_VARIABLE, "")
    if said:
        return None if said == "off" else Path(said)
    try:
        home = Path.home()
    except RuntimeError:
        return None
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or home / "AppData" / "Local") / "squeezefilm"
    if sys.platform == "darwin":
        return home / "Library" / "Caches" / "squeezefilm"
    return Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache") / "squeezefilm"


def folder_of(kind: str) -> Path | None:
    """The folder of a kind of result, which may not be there yet; None where nothing is kept, or
    somebody else could write there, which is said once (`is_shared`)."""
    folder = cache_folder()
    if folder is None:
        return None
    both = folder, folder / kind
    return None if any(is_shared(place, CACHE_VARIABLE) for place in both) else both[1]


def make_private(folder: Path) -> None:
    """Make a kind's folder, and what it lies in, for this user alone. Raises `OSError`."""
    folder.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    folder.mkdir(mode=0o700, exist_ok=True)


def kept_sizes() -> dict[str, tuple[int, int]]:
    """The number of files that are kept, and their bytes, by kind."""
    sizes: dict[str, tuple[int, int]] = {}
    for kind in _kinds():
        files = []
        for file in _ours(kind):
            # Another process may be tidying up.
            with suppress(OSError):
                files.append(file.stat().st_size)
        if files:
            sizes[kind.name] = len(files), sum(files)
    return sizes


def clear_kept() -> int:
    """Delete all that is kept; returns how many files. What is needed again is computed again."""
    count = 0
    for kind in _kinds():
        for file in _ours(kind):
            with suppress(OSError):
                file.unlink()
                count += 1
    return count


def tidy(folder: Path, most: int) -> None:
    """Delete the older half of the files of a kind where there are more than `most`; another
    process may be doing so too."""
    with os.scandir(folder) as entries:
        files = [entry for entry in entries if entry.is_file()]
    if len(files) <= most:
        return
    aged = []
    for entry in files:
        with suppress(OSError):
            aged.append((entry.stat().st_mtime, entry.path))
    for _, path in sorted(aged)[: len(aged) - most // 2]:
        with suppress(OSError):
            Path(path).unlink()


def _kinds() -> list[Path]:
    folder = cache_folder()
    if folder is None or not folder.is_dir():
        return []
    return sorted(kind for kind in folder.iterdir() if kind.is_dir())


def _ours(folder: Path) -> list[Path]:
    """Files that are named as only this program names them: a folder may have others in it."""
    return [file for file in folder.iterdir() if _NAME.fullmatch(file.name) and file.is_file()]


T = TypeVar("T")

MOST_SMALL, MOST_LARGE = 20_000, 32
"""Counts above which the older half is deleted: of small ones (4 kB) and large ones (5 MB)."""

_IN_PASSING: ContextVar[bool] = ContextVar("in_passing", default=False)


@contextmanager
def in_passing() -> Iterator[None]:
    """Compute what nobody asks for again: no large result is written, so that a hundred of them do
    not push out the few that somebody works on. What is there is read."""
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
