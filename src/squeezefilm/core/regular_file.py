"""The reader of every file, those this program wrote too: a regular file of a limited size.

A pipe would be waited for without an end, and a device such as /dev/zero has none. What a file
holds may have been damaged or written by somebody else, so that JSON of any depth is refused too.
Who opens a file in another way stands in `tests/architecture/test_readers.py`, with the reason.
"""

from __future__ import annotations

import codecs
import contextlib
import json
import os
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from squeezefilm.core.errors import ConfigError
from squeezefilm.core.hard_limits import DESCRIPTION_BYTES, HardLimit

# Opening a pipe would wait for a writer, and a terminal would become this process's own.
_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0)
_FLAGS |= getattr(os, "O_BINARY", 0)


@contextlib.contextmanager
def opened(path: str | Path, limit: HardLimit, what: str) -> Iterator[int]:
    """The descriptor of a regular file, open for reading; `what` is what it should be ("a TOML
    file"). Raises as `read_regular` does."""
    try:
        handle = os.open(path, _FLAGS)
    except FileNotFoundError as error:
        raise ConfigError(
            f"cannot be read: it does not exist; give the path of {what}", file=path
        ) from error
    except (OSError, ValueError) as error:
        # Windows opens no folder, and a NUL in a path is no OSError.
        raise _refused(path, what, error) from error
    try:
        status = os.fstat(handle)
        _refuse_irregular(status.st_mode, path, what)
        if status.st_size > limit.most:
            raise ConfigError(
                f"is larger than {limit.most:,.0f} bytes ({limit.name}: {limit.reason}): it has "
                f"{status.st_size:,}; give {what} that is smaller".replace(",", " "),
                file=path,
            )
        yield handle
    finally:
        os.close(handle)


def require_regular(path: str | Path, what: str) -> None:
    """Refuse what `opened` would refuse as no regular file, without opening it.

    For files that another library opens, and whose locks a second opening would drop (SQLite's).
    Raises `ConfigError`; a path with nothing there is none of its concern.
    """
    try:
        mode = Path(path).stat().st_mode
    except FileNotFoundError:
        return
    except (OSError, ValueError) as error:
        raise _refused(path, what, error) from error
    _refuse_irregular(mode, path, what)


def _refuse_irregular(mode: int, path: str | Path, what: str) -> None:
    if stat.S_ISDIR(mode):
        raise ConfigError(f"cannot be read: it is a directory; give {what}", file=path)
    if not stat.S_ISREG(mode):
        raise ConfigError(
            "cannot be read: it is a pipe, a device or a socket, and no regular file; move it "
            f"away, or save what comes from it, and give {what}",
            file=path,
        )


def read_regular(path: str | Path, limit: HardLimit, what: str) -> bytes:
    """The bytes of a file; `what` is what it should be, for messages ("a TOML file").

    Raises `ConfigError` for a file that is not there, cannot be read, is no regular file (a
    directory, a pipe, a device) or has more bytes than `limit` allows.
    """
    with opened(path, limit, what) as handle:
        try:
            with os.fdopen(handle, "rb", closefd=False) as stream:
                # No more than was looked at, since a file may grow while it is read; and no more
                # memory than it needs, which a read of the limit would set aside whole.
                return stream.read(min(os.fstat(handle).st_size, int(limit.most)))
        except OSError as error:
            raise _refused(path, what, error) from error


def read_regular_text(path: str | Path, limit: HardLimit, what: str) -> str:
    """The UTF-8 text of a file (a byte order mark is dropped), with line ends as "\\n".

    Raises as `read_regular` does, and `ConfigError` for what is not UTF-8.
    """
    content = read_regular(path, limit, what)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise _no_text(content, error, path, what) from error
    return text.replace("\r\n", "\n").replace("\r", "\n")


def read_toml_text(path: str | Path) -> str:
    """The text of a TOML file. Raises as `read_regular_text` does."""
    return read_regular_text(path, DESCRIPTION_BYTES, "a TOML file")


def read_json(path: str | Path, limit: HardLimit, what: str) -> Any:
    """The value in a file of JSON. Raises as `read_regular_text`, and `ConfigError` for no JSON."""
    text = read_regular_text(path, limit, what)
    try:
        return parsed_json(text)
    except ValueError as error:
        raise ConfigError(f"is damaged, and so not {what}: {error}", file=path) from error


def parsed_json(text: str | bytes) -> Any:
    """The value of JSON text that a file held.

    Raises `ValueError` for no JSON, and for what is nested deeper than Python reads.
    """
    try:
        return json.loads(text)
    except RecursionError as error:
        raise ValueError("its brackets are nested too deep") from error


def _no_text(content: bytes, error: UnicodeDecodeError, path: str | Path, what: str) -> ConfigError:
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        why = "it is UTF-16, which some editors call Unicode"
    elif b"\0" in content[:1000]:
        why = f"it holds bytes that no text has, as pictures and archives do; give {what}"
        return ConfigError(f"is not UTF-8 text: {why}", file=path)
    else:
        why = f"the byte 0x{content[error.start]:02x} is of another encoding, perhaps Latin-1"
    line = content.count(b"\n", 0, error.start) + 1
    return ConfigError(
        f"is not UTF-8 text: {why}; save it with the encoding UTF-8, as {what}",
        file=path,
        line=line if error.start else None,
    )


def _refused(path: str | Path, what: str, error: OSError | ValueError) -> ConfigError:
    if isinstance(error, PermissionError) and Path(path).is_dir():
        return ConfigError(f"cannot be read: it is a directory; give {what}", file=path)
    why = error.strerror if isinstance(error, OSError) else str(error)
    return ConfigError(f"cannot be read: {why}; give the path of {what}", file=path)
