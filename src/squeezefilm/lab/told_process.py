"""Work in a process of its own that tells the server of itself over a pipe until it ends.

A device's session and a design search are such work: one of a kind at a time, stopped by SIGINT,
and ended by the pipe that breaks where the server dies.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any, ClassVar

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.interrupts import interrupts_held

Tell = Callable[[dict[str, Any]], None]


class ToldProcess:
    """Process of a kind, at most one at a time. `tell` is called from a thread with messages for
    the pages, of which the last has the type `ended` and comes when the process is gone.

    A kind says `in_use` to who begins a second one, `stopped` and `died` in place of a process that
    ended without a word, and how long an end of the lab waits for it (`patience`, s).
    """

    ended: ClassVar[str]
    in_use: ClassVar[str]
    stopped: ClassVar[str]
    died: ClassVar[str]
    patience: ClassVar[si.Second]

    def __init__(self, tell: Tell) -> None:
        self._tell = tell
        self._process: Any = None
        self._reader: threading.Thread | None = None
        self._stopped = False

    @property
    def running(self) -> bool:
        """True where it is at work."""
        return self._process is not None and self._process.is_alive()

    def start(self, work: Callable[..., None], **arguments: Any) -> None:
        """Begin; `work(connection, **arguments)` runs in the process.

        Raises:
            InputError: one runs already.
        """
        if self.running:
            raise InputError(self.in_use)
        self._stopped = False
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe(duplex=False)
        self._process = context.Process(target=work, args=(theirs,), kwargs=arguments, daemon=False)
        # It hears Ctrl-C, and `stop`, once it can act on it.
        with interrupts_held():
            self._process.start()
        theirs.close()
        self._reader = threading.Thread(target=self._read, args=(ours, self._process), daemon=True)
        self._reader.start()

    def stop(self) -> None:
        """Ask it to end, as Ctrl-C does. Returns at once."""
        if self.running:
            self._stopped = True
            # It may have ended since, or the reader's thread have seen it end.
            with suppress(ProcessLookupError):
                os.kill(self._process.pid, signal.SIGINT)

    def kill(self) -> None:
        """End it as it is, with what it told until now."""
        if self.running:
            self._stopped = True
            self._process.kill()

    def close(self) -> None:
        """Stop, and do not wait for long."""
        if self.running:
            self.stop()
            self._process.join(self.patience)
            if self._process.is_alive():
                self._process.kill()

    def _read(self, connection: Connection, process: Any) -> None:
        end: dict[str, Any] | None = None
        while True:
            try:
                message = connection.recv()
            except (EOFError, OSError):
                break
            if message["type"] == self.ended:
                end = message
            else:
                self._tell(message)
        # Told only now: who hears of the end may begin again at once.
        process.join()
        if end is None:
            message = self.stopped if self._stopped else self.died
            end = {"type": self.ended, "failed": not self._stopped, "message": message}
        self._tell(end)


def telling(connection: Connection) -> Tell:
    """Function by which the process tells the server; one that is gone stops it as Ctrl-C does."""

    def tell(message: dict[str, Any]) -> None:
        try:
            connection.send(message)
        except OSError:
            # For a device as for a search, that is safe at any moment.
            os.kill(os.getpid(), signal.SIGINT)

    return tell
