"""The one hash of all that computes: whatever is kept stands under it, and so is never out of date.

A finer key, of those modules only that take part in a result, would have to be kept true by hand.
"""

from __future__ import annotations

import functools
import os
import secrets
import time
from collections.abc import Iterator
from hashlib import blake2b
from importlib.metadata import version
from pathlib import Path

_LIBRARIES = ("numpy", "scipy", "numba")
_SOURCE = Path(__file__).parents[2]
_BEGAN = time.time()


@functools.cache
def computed_by() -> str:
    """The hash of every file of this package, source and data, and of the versions of the numerical
    libraries (hexadecimal); read once a process, some 20 ms.

    Where the source cannot be read, or changed while this process runs, it is of this process
    alone: nothing that another one kept is found.
    """
    try:
        return hash_of_source(_SOURCE, changed_before=_BEGAN)
    except OSError:
        return secrets.token_hex(16)


def hash_of_source(folder: Path, *, changed_before: float) -> str:
    """The hash of all files below a folder and of the libraries' versions.

    Raises `OSError` where one cannot be read, or was changed after a time (s since 1970).
    """
    digest = blake2b(digest_size=16)
    for library in _LIBRARIES:
        digest.update(f"{library} {version(library)}\n".encode())
    for name, path in _files(folder):
        # Without the objects of `open`: there are hundreds of files.
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
        try:
            known = os.fstat(handle)
            content = os.read(handle, known.st_size)
        finally:
            os.close(handle)
        if known.st_mtime > changed_before:
            raise OSError(f"{path} changed while it was in use")
        digest.update(f"{name} {len(content)}\n".encode())
        digest.update(content)
    return digest.hexdigest()


def _files(folder: str | Path, inside: str = "") -> Iterator[tuple[str, str]]:
    """The name from a folder on, and the path, of each file below it, in the order of their names;
    without what Python made of them."""
    with os.scandir(folder) as entries:
        every = sorted(entries, key=lambda entry: entry.name)
    for entry in every:
        if entry.is_dir():
            if entry.name != "__pycache__":
                yield from _files(entry.path, f"{inside}{entry.name}/")
        elif entry.is_file():
            yield f"{inside}{entry.name}", entry.path
