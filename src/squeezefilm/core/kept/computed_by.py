"""The one hash of all that computes: whatever is kept stands under it, and so is never out of date.

A finer key, of those modules only that take part in a result, would have to be kept true by hand.
"""

from __future__ import annotations

import functools
import os
import secrets
import time
from hashlib import blake2b
from importlib.metadata import version
from pathlib import Path
from typing import NoReturn

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
    for place, folders, names in os.walk(folder, onerror=_not_read):
        folders[:] = sorted(set(folders) - {"__pycache__"})
        # What an editor keeps beside a file is hidden.
        for name in sorted(name for name in names if not name.startswith(".")):
            file = f"{place}{os.sep}{name}"
            # There are hundreds of files, and a `Path` of each takes a fifth longer.
            with open(file, "rb", buffering=0) as stream:  # noqa: PTH123
                known, content = os.fstat(stream.fileno()), stream.read()
            if known.st_mtime > changed_before:
                raise OSError(f"{file} changed while it was in use")
            digest.update(f"{file.removeprefix(str(folder))} {len(content)}\n".encode())
            digest.update(content)
    return digest.hexdigest()


def _not_read(error: OSError) -> NoReturn:
    raise error
