"""Optuna's journal on disk, without waiting for the disk."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any


def journal(file: Path) -> Any:
    """An Optuna storage that appends what is proposed and told to a file, which several hosts may
    share.

    Optuna's own waits for the disk after each of some fifteen lines of a design. Here a computer
    that loses its power may lose the last of them, which the search then proposes again: what was
    computed is kept elsewhere (see `DesignStore`). A process that is killed loses nothing.
    """
    from optuna.storages import JournalStorage
    from optuna.storages.journal import JournalFileBackend, JournalFileSymlinkLock

    class Unhurried(JournalFileBackend):
        def __init__(self) -> None:
            self._own = JournalFileSymlinkLock(str(file))
            super().__init__(str(file), lock_obj=self._own)

        def append_logs(self, logs: list[dict[str, Any]]) -> None:
            text = "".join(json.dumps(one, separators=(",", ":")) + "\n" for one in logs)
            self._own.acquire()
            try:
                with file.open("ab") as there:
                    there.write(text.encode())
            finally:
                self._own.release()

    return JournalStorage(Unhurried())
