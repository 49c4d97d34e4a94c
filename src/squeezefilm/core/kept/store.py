"""Results of one kind, kept on disk under what was asked and the hash of all that computes.

What cannot be read, was damaged, or is no regular file counts as not there.
"""

from __future__ import annotations

import functools
import json
import math
import os
import re
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import fields, is_dataclass
from hashlib import blake2b
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Generic, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core.errors import ConfigError
from squeezefilm.core.hard_limits import KEPT_BYTES
from squeezefilm.core.kept.computed_by import computed_by
from squeezefilm.core.private_folder import is_shared
from squeezefilm.core.regular_file import read_regular

# A file holds numbers, texts and arrays in their order, and no name of a class or a function: what
# is made of them says the type that the reader asks for, down to the annotations of its fields. So
# a file can give a wrong number, and run nothing.
_DTYPES = {name: np.dtype(name) for name in ("<f8", "<c16", "<i8", "|b1")}


def packed(value: Any, given: Sequence[Any] = ()) -> bytes:
    """A value as bytes: None, numbers, texts, arrays, and tuples, lists, mappings of texts and
    dataclasses of such. A record that stands in it several times is written once, and those that
    whoever reads it has anyway, the `given`, are not.

    Raises `TypeError` for anything else.
    """
    writer = _Writer(given)
    head = json.dumps(writer.plain(value), separators=(",", ":")).encode()
    return b"\n".join([head, b"".join(writer.arrays)])


def unpacked(data: bytes, kind: Any, given: Sequence[Any] = ()) -> Any:
    """The value of type `kind` that `packed` made bytes of, with the same `given`.

    Raises `ValueError`, `TypeError`, `IndexError` or `RecursionError` where bytes are of nothing of
    that type, and what its dataclasses raise of values that they refuse.
    """
    head, _, arrays = data.partition(b"\n")
    return _Reader(arrays, given).value(json.loads(head), kind)


class _Writer:
    def __init__(self, given: Sequence[Any]) -> None:
        self.arrays: list[bytes] = []
        self._given = given
        # The records themselves, too: a number is another's once its own is gone.
        self._known = {id(record): (number, record) for number, record in enumerate(given)}

    def plain(self, value: Any) -> Any:
        """A value as JSON has it; arrays go to `arrays`."""
        if value is None or isinstance(value, bool | int | float | str):
            return value
        if isinstance(value, np.ndarray):
            return self._array(value)
        if isinstance(value, tuple | list):
            return [self.plain(part) for part in value]
        if isinstance(value, Mapping):
            return {key: self.plain(part) for key, part in value.items()}
        if is_dataclass(value) and not isinstance(value, type):
            return self._record(value)
        raise TypeError(f"a {type(value).__name__} is no number, text, array or record of such")

    def _array(self, value: NDArray[Any]) -> list[Any]:
        dtype = value.dtype.newbyteorder("<")
        if dtype.str not in _DTYPES:
            raise TypeError(f"an array of {value.dtype} is not kept")
        # The order in memory decides the last digit of a product.
        order: Literal["C", "F"] = "C" if value.flags.c_contiguous else "F"
        self.arrays.append(value.astype(dtype).tobytes(order))
        return [dtype.str, list(value.shape), order]

    def _record(self, value: Any) -> Any:
        for record in self._given:
            if type(record) is type(value) and record == value:
                return self._known[id(record)][0]
        if id(value) not in self._known:
            told = [self.plain(getattr(value, field.name)) for field in fields(value)]
            self._known[id(value)] = len(self._known), value
            return told
        return self._known[id(value)][0]


class _Reader:
    def __init__(self, arrays: bytes, given: Sequence[Any]) -> None:
        self._arrays, self._at = arrays, 0
        self._known = list(given)

    def value(self, told: Any, kind: Any) -> Any:
        """A value of a type from what JSON has."""
        origin, args = get_origin(kind), get_args(kind)
        if origin in (Union, UnionType):
            if told is None and NoneType in args:
                return None
            (kind,) = (argument for argument in args if argument is not NoneType)
            return self.value(told, kind)
        if origin is Literal and told in args:
            return told
        if origin is np.ndarray:
            return self._array(told, get_args(args[1])[0])
        if origin in (tuple, list) and isinstance(told, list):
            if origin is list or args[1:] == (...,):
                args = (args[0],) * len(told)
            return origin(
                self.value(part, argument) for part, argument in zip(told, args, strict=True)
            )
        if origin in (dict, Counter) and isinstance(told, dict):
            inner = args[1] if origin is dict else int
            return origin({key: self.value(part, inner) for key, part in told.items()})
        if is_dataclass(kind) and isinstance(kind, type):
            return self._record(told, kind)
        if type(told) is kind:
            return told
        if kind is float and type(told) is int:
            return float(told)
        raise TypeError(f"{told!r:.40} is no {kind}")

    def _array(self, told: Any, scalar: type) -> NDArray[Any]:
        name, shape, order = told
        dtype = _DTYPES[name]
        if not np.issubdtype(dtype, scalar) or any(size < 0 for size in shape):
            raise TypeError(f"an array of {name} and shape {shape} is not asked for")
        count = math.prod(shape)
        array = np.frombuffer(self._arrays, dtype, count, self._at)
        self._at += count * dtype.itemsize
        # Of this machine's own byte order, and in memory that is aligned and can be written to.
        return np.array(array.reshape(shape, order=order), dtype.newbyteorder("="), order="K")

    def _record(self, told: Any, kind: type) -> Any:
        if type(told) is int:
            known = self._known[told]
            if type(known) is not kind:
                raise TypeError(f"record {told} is no {kind.__name__}")
            return known
        wanted = _fields(kind)
        parts = zip(wanted.items(), told, strict=True)
        record = kind(**{name: self.value(part, one) for (name, one), part in parts})
        self._known.append(record)
        return record


@functools.cache
def _fields(kind: type) -> dict[str, Any]:
    """The types of a dataclass's fields by name, in order."""
    hints = get_type_hints(kind)
    return {field.name: hints[field.name] for field in fields(kind)}


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
            # For this user alone, as what they lie in.
            file.parent.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            file.parent.mkdir(mode=0o700, exist_ok=True)
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
