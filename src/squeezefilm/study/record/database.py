"""A study's database on the disk: made exclusively, looked at before anything of it is changed.

SQLite goes on writing into a file that was removed or replaced behind it. So the places of the
file, its log and the log's index are known by device and inode, and what does not lie there any
more acknowledges nothing.
"""

from __future__ import annotations

import contextlib
import glob
import os
import sqlite3
from collections.abc import Iterator
from pathlib import Path

from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.core.regular_file import require_regular
from squeezefilm.study.record.schema import APPLICATION_ID, VERSION

_PATIENCE = 5000
"""Longest wait of a write for another program's (ms)."""
_PARTS = ("", "-wal", "-shm")
_LEFT_BEHIND = ("-wal", "-shm", "-journal")

FAILURES = (sqlite3.Error, UnicodeDecodeError)
"""Errors that `sqlite3` raises; the last where it cannot read what SQLite says of a torn file."""

Identity = tuple[int, int]


def identity_of(path: Path) -> Identity | None:
    """Device and inode of what lies at a path; None for nothing.

    Never opens it: closing a file drops all locks that this process has on it, SQLite's too.
    """
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_dev, status.st_ino


def claim(path: Path) -> Identity:
    """Make an empty file where there was nothing, and say which it is.

    Raises:
        InputError: something is there, or a log of a file that was removed.
        RecordError: it cannot be made.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o644)
    except OSError as error:
        # A file where the folder should be says the same as a file that is there.
        if isinstance(error, FileExistsError) and os.path.lexists(path):
            raise InputError(f"{path} exists; open it to go on, or give another name") from error
        raise RecordError(f"{path} cannot be made: {error.strerror}; choose another") from error
    status = os.fstat(handle)
    os.close(handle)
    for part in _LEFT_BEHIND:
        if os.path.lexists(f"{path}{part}"):
            path.unlink()
            raise InputError(
                f"{path.name}{part} lies there from a file that was removed, and would be taken "
                f"for this one's; move it away, or give another name than {path}"
            )
    return status.st_dev, status.st_ino


def discard(path: Path, claimed: Identity) -> None:
    """Remove a file that this process claimed, with its log; whatever else lies there stays.

    What the disk does not let go of stays too: why it was to be removed is what a person must see.
    """
    if identity_of(path) == claimed:
        for part in (*_LEFT_BEHIND, ""):
            with contextlib.suppress(OSError):
                path.with_name(path.name + part).unlink(missing_ok=True)


def is_study(path: Path) -> bool:
    """True where a file is a study's, of whatever version. Nothing of it is changed."""
    try:
        return path.is_file() and _marks(path)[0] == APPLICATION_ID
    except InputError:
        return False


def require_study(path: Path) -> None:
    """Refuse what is no study's file of this version. Nothing of it is changed.

    Raises `InputError`.
    """
    require_regular(path, "a study's file")
    if not path.exists():
        raise InputError(f"{path} does not exist; plan a study and create its file first")
    for part in _LEFT_BEHIND:
        beside = path.with_name(path.name + part)
        require_regular(beside, "what belongs to a study's file")
        # What is written to the log must lie beside the file, and not where a link leads.
        if beside.is_symlink():
            raise InputError(f"{beside} is a link, which no study's file has; move it away")
    if path.stat().st_size == 0 and not path.with_name(f"{path.name}-wal").exists():
        raise InputError(
            f"{path} is empty and so no study's file; if no other program is creating it just "
            "now, remove it and create the study again"
        )
    _require_marks(path, *_marks(path))


def _marks(path: Path) -> tuple[int, int]:
    """Application id and version, read without a write."""
    logged = path.with_name(f"{path.name}-wal").exists()
    try:
        # Without a lock either, and without the log.
        marks = _read_marks(path, "mode=ro&immutable=1")
        if marks[0] or not logged:
            return marks
    except FAILURES as error:
        if not logged:
            raise InputError(f"{path} is no study's file: {error}") from error
    # All that was written may be in the log alone, or half of it in the file: what a program
    # leaves that was killed, or whose disk was full.
    try:
        return _read_marks(path, "mode=ro")
    except FAILURES as error:
        raise InputError(f"{path} is no study's file: {error}") from error


def _read_marks(path: Path, how: str) -> tuple[int, int]:
    place = f"{path.absolute().as_uri()}?{how}"
    with contextlib.closing(sqlite3.connect(place, uri=True)) as connection:
        return _marks_of(connection)


def _marks_of(connection: sqlite3.Connection) -> tuple[int, int]:
    kind = connection.execute("PRAGMA application_id").fetchone()[0]
    return kind, connection.execute("PRAGMA user_version").fetchone()[0]


def _require_marks(path: Path, kind: int, version: int) -> None:
    if kind != APPLICATION_ID:
        raise InputError(f"{path} is no study's file; give one that `study run` made")
    if version not in (1, VERSION):
        raise InputError(
            f"{path} has tables of version {version}; this program reads version {VERSION}; "
            "use the version of squeezefilm that made it"
        )


class Database:
    """An open database, and which files it was when it was opened.

    Args:
        path: of the file, which exists.
        new: whether it was claimed and is still empty.

    Raises:
        InputError: no study's file.
        RecordError: it cannot be opened.
    """

    def __init__(self, path: Path, *, new: bool = False) -> None:
        self.path = path
        self._open(new)

    def _open(self, new: bool) -> None:
        path = self.path
        # Also for who goes to another folder meanwhile.
        place = path.absolute()
        found = identity_of(place)
        self.connection = _connect(path, new)
        try:
            # The log is there once something was read.
            self.connection.execute("SELECT count(*) FROM sqlite_schema").fetchone()
            # SQLite puts log and index beside the file itself, a link or not.
            real = path.resolve()
            parts = (place, *(real.with_name(real.name + part) for part in _PARTS))
            self._parts = {part: identity_of(part) for part in parts}
            if self._parts[place] != found:
                raise RecordError(f"{path} was replaced while it was being opened; open it again")
        except FAILURES as error:
            self.connection.close()
            raise RecordError(f"{path} cannot be opened: {error}") from error
        except BaseException:
            self.connection.close()
            raise

    def require_in_place(self) -> None:
        """Refuse a file that was removed or replaced since it was opened, or whose log was.

        Raises `RecordError`.
        """
        for place, known in self._parts.items():
            if identity_of(place) != known:
                raise RecordError(
                    f"{place} was removed or replaced while {self.path.name} was open, so nothing "
                    "is acknowledged any more: it would be lost. Close every program that has the "
                    "study open, put the file back (backups are made by `study backup`) and open "
                    "it again"
                )

    def compact(self) -> None:
        """Rewrite the file without anything deleted, and empty its log.

        Raises `RecordError` while another program reads or writes it.
        """
        try:
            self.connection.execute("PRAGMA busy_timeout = 500")
            self._empty_log()
            self.connection.execute("VACUUM")
            self._empty_log()
            self.require_in_place()
        except FAILURES as error:
            raise RecordError(f"{self.path} could not be compacted: {error}") from error
        finally:
            self.connection.execute(f"PRAGMA busy_timeout = {_PATIENCE}")

    def _empty_log(self) -> None:
        if self.connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()[0]:
            raise RecordError(
                f"{self.path} is open in another program; close every session, then try again"
            )

    def copy_to(self, target: Path) -> None:
        """Copy it, as it is now, into a new file. Raises `sqlite3.Error`."""
        with contextlib.closing(sqlite3.connect(target)) as copy:
            self.connection.backup(copy)

    def close(self) -> None:
        """Close the file; its write-ahead log is folded in where nobody else has it open."""
        self.connection.close()

    @contextlib.contextmanager
    def closed_meanwhile(self) -> Iterator[None]:
        """Let go of the file, and open it again at the end: for who reads its bytes.

        Raises `RecordError` if it was replaced meanwhile.
        """
        self.close()
        try:
            yield
        finally:
            self._open(new=False)


def same_folders(path: Path) -> list[Path]:
    """Other studies whose names differ in the suffix only: they share all folders with this."""
    beside = path.parent.glob(f"{glob.escape(path.stem)}.*")
    return sorted(one for one in beside if one.stem == path.stem and one != path and is_study(one))


def require_alone(path: Path) -> None:
    """Refuse a file that any other connection has open, of this program or another.

    Raises `RecordError`.
    """
    try:
        with contextlib.closing(
            sqlite3.connect(path, isolation_level=None, timeout=0.5)
        ) as connection:
            connection.execute("PRAGMA locking_mode = EXCLUSIVE")
            connection.execute("BEGIN IMMEDIATE")
            connection.execute("ROLLBACK")
    except FAILURES as error:
        raise RecordError(
            f"{path} is open in another program ({error}); close every session, then try again"
        ) from error


def _connect(path: Path, new: bool) -> sqlite3.Connection:
    if sqlite3.sqlite_version_info < (3, 37):
        raise RecordError(
            f"this Python has SQLite {sqlite3.sqlite_version}; a study needs 3.37 or later, for "
            "tables that check the types of what is written"
        )
    try:
        connection = sqlite3.connect(path, isolation_level=None, timeout=_PATIENCE / 1000)
    except FAILURES as error:
        raise RecordError(f"{path} cannot be opened: {error}; is the folder writable?") from error
    try:
        if not new:
            # Once more: a journal that was left behind may just have been rolled back.
            _require_marks(path, *_marks_of(connection))
        mode = connection.execute("PRAGMA journal_mode = WAL").fetchone()[0]
        if mode != "wal":
            raise RecordError(
                f"{path} lies where no write-ahead log can be kept (journal_mode is {mode}); put "
                "it on a local disk"
            )
        connection.execute("PRAGMA synchronous = FULL")
        connection.execute("PRAGMA fullfsync = ON")
        connection.execute("PRAGMA foreign_keys = ON")
        connection.execute("PRAGMA secure_delete = ON")
        # Somebody else's file may hold functions in its schema: none of them is called.
        connection.execute("PRAGMA trusted_schema = OFF")
        connection.execute("PRAGMA cell_size_check = ON")
        # Journals of statements and sorting stay in memory: no copy of a row in a stray file.
        connection.execute("PRAGMA temp_store = MEMORY")
    except FAILURES as error:
        connection.close()
        if "not a database" in str(error):
            raise InputError(f"{path} is no study's file: {error}") from error
        raise RecordError(f"{path} cannot be opened: {error}") from error
    except (InputError, RecordError):
        connection.close()
        raise
    return connection
