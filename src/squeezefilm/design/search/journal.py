"""Optuna's journal on disk, without waiting for the disk, and set aside where it is damaged."""

from __future__ import annotations

import contextlib
import itertools
import os
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, InputError, SqueezefilmWarning, optional
from squeezefilm.core.hard_limits import LINES_BYTES
from squeezefilm.core.regular_file import read_regular
from squeezefilm.design.sweep.lines import SET_ASIDE, checked_line, is_damaged

_LOCK_STAYS = 30
"""How long a lock may stay unchanged (s), by Optuna's clock, before it is taken to be left."""
_LOCK_HELD: si.Second = 1.0
"""How long a lock may be there before that is said; writing takes milliseconds."""


def journal(file: Path) -> Any:
    """An Optuna storage that appends what is proposed and told to a file, which several hosts may
    share.

    Optuna's own waits for the disk after each of some fifteen lines of a design. Here a computer
    that loses its power may lose the last of them, which the search then proposes again: what was
    computed is kept elsewhere (see `DesignStore`). A process that is killed loses nothing. A line
    that was cut off is taken away when the file is opened, since Optuna reads none that has one.
    A lock that a killed process left is taken away after `_LOCK_STAYS`, with a
    `SqueezefilmWarning` while one waits.
    """
    with optional("design", "a search of designs"):
        from optuna.storages import JournalStorage
        from optuna.storages.journal import JournalFileBackend, JournalFileOpenLock

    class Unhurried(JournalFileBackend):
        def __init__(self) -> None:
            # Not Optuna's lock of links: one that leads nowhere it waits for without an end.
            self._own = JournalFileOpenLock(str(file), _LOCK_STAYS)
            super().__init__(str(file), lock_obj=self._own)
            _say_where_locked(file.with_name(f"{file.name}.lock"))
            # Nobody writes while the lock is held here: half a line is nobody's any more.
            with self._held():
                _cut_half_line(file)

        def append_logs(self, logs: list[dict[str, Any]]) -> None:
            text = b"".join(checked_line(log) + b"\n" for log in logs)
            with self._held(), file.open("ab") as there:
                there.write(text)

        @contextlib.contextmanager
        def _held(self) -> Iterator[None]:
            self._own.acquire()
            try:
                yield
            finally:
                self._own.release()

    return JournalStorage(Unhurried())


def usable_journal(file: Path) -> tuple[Any, bool]:
    """The `journal` in a file, and whether it begins anew since the one that lay there is damaged.

    That one is set aside under another name, with a `SqueezefilmWarning`: all that was computed is
    kept among the designs. Raises `InputError` where neither can be done.
    """
    storage, why = None, _damage(file)
    if not why:
        try:
            storage = journal(file)
        except OSError as error:
            raise InputError(
                f"cannot use {file}: {error.strerror}; free space or choose another folder"
            ) from error
        # Lines that are whole may contradict each other, and Optuna then fails anywhere.
        except Exception as error:
            why = f"cannot be replayed ({type(error).__name__})"
    if storage is not None:
        return storage, False
    try:
        aside = _set_aside(file)
    except OSError as error:
        raise InputError(
            f"{file} {why}, and cannot be moved ({error.strerror}); move it away: the search "
            "goes on from what is kept of its designs"
        ) from error
    warnings.warn(
        f"{file} {why}; it is set aside as {aside.name}, and made anew from the designs",
        SqueezefilmWarning,
        stacklevel=2,
    )
    return journal(file), True


def _say_where_locked(lock: Path) -> None:
    """Warn of a lock that stays for longer than it takes to write; remove a link that leads
    nowhere, as an earlier version left them."""
    if lock.is_symlink() and not lock.exists():
        lock.unlink(missing_ok=True)
    begun = time.monotonic()
    while os.path.lexists(lock):
        if time.monotonic() - begun > _LOCK_HELD:
            warnings.warn(
                f"{lock} is there: a search that is held up keeps it, or one that was killed left "
                f"it; the search begins without it once it has not changed for {_LOCK_STAYS} s",
                SqueezefilmWarning,
                stacklevel=2,
            )
            return
        time.sleep(_LOCK_HELD / 50)


def _damage(file: Path) -> str:
    """What is wrong with a journal, in words that follow its name; empty for one that is sound."""
    if not os.path.lexists(file):
        return ""
    try:
        *lines, _ = read_regular(file, LINES_BYTES, "a journal").split(b"\n")
    except ConfigError as error:
        return error.message
    numbers = (number for number, line in enumerate(lines, 1) if is_damaged(line))
    first = next(numbers, None)
    return "" if first is None else f"is damaged in line {first}"


def _set_aside(file: Path) -> Path:
    """Give what lies at a journal's place another name, which nothing has. Raises `OSError`."""
    for number in itertools.count(1):
        aside = file.with_name(f"{file.name}{SET_ASIDE}{number if number > 1 else ''}")
        if not os.path.lexists(aside):
            file.rename(aside)
            return aside
    raise AssertionError


def _cut_half_line(file: Path) -> None:
    with file.open("rb+") as there:
        whole = there.read()
        if not whole.endswith(b"\n"):
            there.truncate(whole.rfind(b"\n") + 1)
