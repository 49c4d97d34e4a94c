"""What is dear to compute and small to keep, on disk from one process to the next.

Each is a file in the user's cache folder, named by a hash of all that it comes from: what was
asked, the source of the modules that compute it, and the versions of this package, NumPy and numba.
So nothing kept can be out of date, and the folder may be deleted at any time. What cannot be read
or was damaged counts as not there. ``SQUEEZEFILM_CACHE=off`` keeps nothing; any other value is the
folder to keep it in.
"""

from __future__ import annotations

import functools
import os
import pickle
import re
import sys
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from hashlib import blake2b
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

CACHE_VARIABLE = "SQUEEZEFILM_CACHE"
MOST_FILES, MOST_RESULTS = 20_000, 32
"""Of more the older half is deleted: arrays of some 4 kB each, and results of some 5 MB."""

_IN_PASSING: ContextVar[bool] = ContextVar("in_passing", default=False)
_DIGEST = 16
_NAME = re.compile(rf"[0-9a-f]{{{2 * _DIGEST}}}")
_DTYPE = np.dtype("<f8")


def cache_folder() -> Path | None:
    """Where arrays are kept; None where they are not."""
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


def kept_sizes() -> dict[str, tuple[int, int]]:
    """What is kept, by kind: how many files, and their bytes."""
    folder = cache_folder()
    found: dict[str, tuple[int, int]] = {}
    if folder is None or not folder.is_dir():
        return found
    for kind in sorted(one for one in folder.iterdir() if one.is_dir()):
        sizes = []
        for file in _ours(kind):
            # Another process may be tidying up.
            with suppress(OSError):
                sizes.append(file.stat().st_size)
        if sizes:
            found[kind.name] = len(sizes), sum(sizes)
    return found


def clear_kept() -> int:
    """Delete all that is kept; how many files. What is needed again is computed again."""
    folder, count = cache_folder(), 0
    if folder is None or not folder.is_dir():
        return 0
    for kind in [one for one in folder.iterdir() if one.is_dir()]:
        for file in _ours(kind):
            with suppress(OSError):
                file.unlink()
                count += 1
    return count


def _ours(folder: Path) -> list[Path]:
    """Files that are named as only this module names them: a folder may have others in it."""
    return [one for one in folder.iterdir() if _NAME.fullmatch(one.name) and one.is_file()]


@contextmanager
def in_passing() -> Iterator[None]:
    """While results are computed that nobody asks for again: no `KeptResults` is written, so that a
    hundred of them do not push out the few that somebody works on. What is there is read."""
    before = _IN_PASSING.set(True)
    try:
        yield
    finally:
        _IN_PASSING.reset(before)


class _Kept:
    """Files of one kind; `sources` are the files and folders of modules that compute them."""

    def __init__(self, kind: str, sources: Iterable[Path]) -> None:
        self.kind, self.sources = kind, tuple(sources)
        self._tidied: Path | None = None

    @functools.cached_property
    def _made_by(self) -> str | None:
        """A hash of what computes them; None where the source cannot be read."""
        from squeezefilm import __version__

        said = [__version__, version("numpy"), version("numba"), _DTYPE.str]
        try:
            for one in self.sources:
                files = sorted(one.rglob("*.py")) if one.is_dir() else [one]
                said += [blake2b(file.read_bytes()).hexdigest() for file in files]
        except OSError:
            return None
        return repr(said)

    def _file(self, asked: str) -> Path | None:
        folder = cache_folder()
        if folder is None or self._made_by is None:
            return None
        name = blake2b(f"{self._made_by} {asked}".encode(), digest_size=_DIGEST).hexdigest()
        return folder / self.kind / name

    def _read(self, asked: str) -> bytes | None:
        """What is kept under what was `asked`; None if there is nothing, or it was damaged."""
        file = self._file(asked)
        if file is None:
            return None
        try:
            data = file.read_bytes()
        except OSError:
            return None
        return data[_DIGEST:] if _digest(data[_DIGEST:]) == data[:_DIGEST] else None

    def _write(self, asked: str, data: bytes, most_files: int) -> None:
        """Keep it; where the folder cannot be written to nothing is kept."""
        file = self._file(asked)
        if file is None:
            return
        with suppress(OSError):
            file.parent.mkdir(parents=True, exist_ok=True)
            # Of many small files once a process.
            if self._tidied != file.parent or most_files < MOST_FILES:
                self._tidied = file.parent
                _tidy(file.parent, most_files)
            with tempfile.NamedTemporaryFile(dir=file.parent, delete=False) as part:
                try:
                    part.write(_digest(data) + data)
                    part.close()
                    # Others see all of it or nothing.
                    Path(part.name).replace(file)
                except OSError:
                    Path(part.name).unlink()
                    raise


class KeptArrays(_Kept):
    """Arrays of one kind."""

    def get(self, asked: str, size: int) -> NDArray[np.float64] | None:
        """The array of so many numbers kept under what was `asked`; None if there is none."""
        data = self._read(asked)
        if data is None or len(data) != size * _DTYPE.itemsize:
            return None
        return np.frombuffer(data, _DTYPE).astype(np.float64)

    def put(self, asked: str, values: NDArray[np.float64]) -> None:
        """Keep an array; where the folder cannot be written to nothing is kept."""
        self._write(asked, np.asarray(values, _DTYPE).tobytes(), MOST_FILES)


class KeptResults(_Kept):
    """Results of one kind, as pickles. Like what numba keeps beside them they are code of the user
    whose folder it is: whoever can write there can already do all that this user can."""

    def get(self, asked: str) -> Any:
        """The result kept under what was `asked`; None if there is none."""
        data = self._read(asked)
        if data is None:
            return None
        # What another version of a library wrote may not be readable; it is then computed anew.
        with suppress(Exception):
            return pickle.loads(data)
        return None

    def put(self, asked: str, result: object) -> None:
        """Keep a result; none `in_passing`, or where the folder cannot be written to."""
        if not _IN_PASSING.get() and self._file(asked) is not None:
            self._write(asked, pickle.dumps(result, protocol=5), MOST_RESULTS)


def _digest(data: bytes) -> bytes:
    return blake2b(data, digest_size=_DIGEST).digest()


def _tidy(folder: Path, most: int) -> None:
    """Delete the older half of too many files; another process may be doing so too."""
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
