"""Optuna's journal on disk, without waiting for the disk."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any


def journal(file: Path) -> Any:
    """An Optuna storage that appends what is proposed and told to a file, which several hosts may
    share.

    Optuna's own waits for the disk after each of some fifteen lines of a design. Here a computer
    that loses its power may lose the last of them, which the search then proposes again: what was
    computed is kept elsewhere (see `DesignStore`). A process that is killed loses nothing. A line
    that was cut off is taken away when the file is opened, since Optuna reads none that has one.
    """
    from optuna.storages import JournalStorage
    from optuna.storages.journal import JournalFileBackend, JournalFileSymlinkLock

    class Unhurried(JournalFileBackend):
        def __init__(self) -> None:
            self._own = JournalFileSymlinkLock(str(file))
            super().__init__(str(file), lock_obj=self._own)
            # Nobody writes while the lock is held here: half a line is nobody's any more.
            with self._held():
                _cut_half_line(file)

        def append_logs(self, logs: list[dict[str, Any]]) -> None:
            text = "".join(json.dumps(one, separators=(",", ":")) + "\n" for one in logs)
            with self._held(), file.open("ab") as there:
                there.write(text.encode())

        @contextlib.contextmanager
        def _held(self) -> Iterator[None]:
            self._own.acquire()
            try:
                yield
            finally:
                self._own.release()

    return JournalStorage(Unhurried())


def _cut_half_line(file: Path) -> None:
    with file.open("rb+") as there:
        whole = there.read()
        if not whole.endswith(b"\n"):
            there.truncate(whole.rfind(b"\n") + 1)
