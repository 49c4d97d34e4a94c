"""Erasing files: plain ones with one name, in the folder they lie in, never what a link points to.

A file that is a link, a pipe, a folder, or that has a second name elsewhere, is somebody's own.
"""

from __future__ import annotations

import contextlib
import errno
import os
import stat
from collections.abc import Iterator
from pathlib import Path

from squeezefilm.core.errors import InputError, RecordError

_PIECE = 1 << 20
_PLAIN = (
    getattr(os, "O_NOFOLLOW", 0)
    # Opening a pipe must not wait for who writes into it.
    | getattr(os, "O_NONBLOCK", 0)
    | getattr(os, "O_BINARY", 0)
)
_IN_FOLDER = {os.open, os.unlink} <= os.supports_dir_fd


@contextlib.contextmanager
def plain_file(path: Path, flags: int = os.O_RDONLY) -> Iterator[int]:
    """The descriptor of a plain file: no link, no pipe, one name; its folder no link either.

    Raises `InputError` for anything else, and for a file that cannot be opened so.
    """
    with _folder(path.parent) as folder, _opened(path, folder, flags) as handle:
        yield handle


def read_plain(path: Path) -> bytes:
    """The bytes of a plain file. Raises what `plain_file` raises."""
    with plain_file(path) as handle, os.fdopen(os.dup(handle), "rb") as file:
        return file.read()


def require_own_folder(folder: Path) -> None:
    """Refuse a link or a file in the place of a folder to write to. Raises `InputError`; a folder
    that is not there yet is made by who writes."""
    if folder.is_symlink() or (os.path.lexists(folder) and not folder.is_dir()):
        what = "a link" if folder.is_symlink() else "a file"
        raise InputError(
            f"{folder} is {what}, and nothing is written to where it leads; replace it by a folder"
        )


def require_plain(path: Path) -> None:
    """Refuse a file that `erase_file` would refuse. Raises what `plain_file` raises."""
    with plain_file(path, os.O_RDWR):
        pass


def erase_file(path: Path) -> None:
    """Overwrite a file with zeros, as far as the disk lets us, and remove it.

    Raises:
        InputError: not a plain file; nothing was done to it.
        RecordError: the disk refused.
    """
    with _folder(path.parent) as folder:
        with _opened(path, folder, os.O_RDWR) as handle:
            overwrite(handle, path)
        try:
            os.unlink(path if folder is None else path.name, dir_fd=folder)
        except OSError as error:
            raise RecordError(f"{path} is empty but cannot be removed: {error.strerror}") from error


def overwrite(handle: int, path: Path) -> None:
    """Write zeros over all of an open file. Raises `RecordError` where the disk refuses."""
    try:
        left = os.lseek(handle, 0, os.SEEK_END)
        os.lseek(handle, 0, os.SEEK_SET)
        while left:
            left -= os.write(handle, b"\x00" * min(left, _PIECE))
        os.fsync(handle)
    except OSError as error:
        raise RecordError(f"{path} could not be overwritten: {error.strerror}") from error


@contextlib.contextmanager
def _folder(path: Path) -> Iterator[int | None]:
    """The folder held open, so that nobody puts another in its place; None on Windows."""
    if not _IN_FOLDER:
        yield None
        return
    try:
        handle = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    except OSError as error:
        raise _refused(path, error) from error
    try:
        yield handle
    finally:
        os.close(handle)


@contextlib.contextmanager
def _opened(path: Path, folder: int | None, flags: int) -> Iterator[int]:
    if folder is None and path.is_symlink():
        raise _not_plain(path, "a link")
    try:
        handle = os.open(path if folder is None else path.name, flags | _PLAIN, dir_fd=folder)
    except OSError as error:
        raise _refused(path, error) from error
    try:
        status = os.fstat(handle)
        if not stat.S_ISREG(status.st_mode):
            raise _not_plain(path, "no file")
        if status.st_nlink != 1:
            raise _not_plain(path, f"one of {status.st_nlink} names of the same file")
        yield handle
    finally:
        os.close(handle)


def _refused(path: Path, error: OSError) -> InputError:
    if error.errno in (errno.ELOOP, errno.ENOTDIR, errno.ENXIO, errno.EISDIR):
        return _not_plain(path, "a link" if path.is_symlink() else "no file")
    return InputError(f"{path} cannot be opened: {error.strerror}; see to it, then try again")


def _not_plain(path: Path, what: str) -> InputError:
    return InputError(
        f"{path} is {what}, which this program neither reads nor erases: what it leads to is "
        "somebody's own. Move it away, or put a file of its own in its place"
    )
