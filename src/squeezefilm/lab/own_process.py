"""Work in a process of its own that tells the server of itself over a pipe until it ends.

A device's session and a design search are such work: one of a kind at a time, stopped by SIGINT,
and ended by the pipe that breaks where the server dies.
"""

from __future__ import annotations

import contextlib
import math
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.core.interrupts import hear_interrupts, interrupts_held
from squeezefilm.core.results import to_json

if TYPE_CHECKING:
    from squeezefilm.instruments.session.play.plan import PlayView

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


# The process plays as `squeezefilm play` does, with the same safety: SIGINT ramps to zero and
# disarms. Where the server dies, the pipe breaks and the process stops likewise; where this process
# dies, the device's own watchdog stops it.
ROW_PERIOD: si.Second = 2e-3
"""Time between two rows that the page's scope gets; the record has them all."""
_STOPPED_BEFORE = "stopped before anything was played"


class DeviceSession(ToldProcess):
    """Session on a device, at most one at a time. Stopped, it ramps to zero, disarms and ends."""

    ended = "device ended"
    in_use = "a device is in use by this lab already; stop it first"
    stopped = _STOPPED_BEFORE
    died = "the process that played ended without a word; the device stops by its own watchdog"
    patience = 5.0


class _PageMessages:
    """Messages for a page about a session while it plays."""

    def __init__(self, tell: Tell) -> None:
        self._tell = tell
        self._last = -math.inf

    def progress(self, text: str) -> None:
        """Tell what is done now."""
        self._tell({"type": "device progress", "text": text})

    def tap(self, rows: si.FloatArray) -> None:
        """The newest rows, as many as a page can draw."""
        from squeezefilm.instruments.session.loop.rows import COLUMNS

        kept = []
        for row in rows:
            if row[1] - self._last >= ROW_PERIOD:
                self._last = float(row[1])
                kept.append(to_json(row))
        if kept:
            self._tell({"type": "device rows", "columns": list(COLUMNS), "rows": kept})

    def show(self, view: PlayView) -> None:
        """The moment."""
        state, fault = view.state.name, view.fault.name
        words = "" if view.held is None else view.held.words.partition(", ")[2]
        named = {"state": state, "fault": fault, "loops": words}
        self._tell({"type": "device view", **to_json(view), **named})


def play(connection: Connection, display: str, texture: str, out: str, **how: Any) -> None:
    """Play a file's texture on a file's display into a folder, and tell of it.

    `how` goes to `play_texture` as it is: drive, mode, stroke, sensor, compensation, hold, seed,
    duration (s) and voltage (V or None).
    """
    from squeezefilm.instruments.bench.play import JUDGING, play_texture
    from squeezefilm.physics.texture_files.texture_file import load_texture

    tell = telling(connection)
    page = _PageMessages(tell)
    stopped = _STOPPED_BEFORE

    def progress(text: str) -> None:
        nonlocal stopped
        page.progress(text)
        if text == JUDGING:
            stopped = f"stopped during: {text}; what was played is recorded in {out}, not judged"

    with _ends(tell, lambda: stopped):
        result = play_texture(
            display,
            load_texture(texture),
            out=Path(out),
            show=page.show,
            tap=page.tap,
            progress=progress,
            **how,
        )
        # The device is at zero and disarmed; what is left to be written is not to be cut short.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        from squeezefilm.instruments.report.page import write_play

        write_play(result, Path(out))
        outcome = result.outcome
        tell(
            {
                "type": "device ended",
                "failed": not outcome.usable,
                "ending": outcome.ending.name,
                "message": outcome.said or outcome.ending.value,
                "summary": result.summary(),
                "folder": out,
            }
        )


def check(connection: Connection, drive: str, display: str) -> None:
    """Check a device, and tell of it."""
    from squeezefilm.instruments.bench.play import check_drive

    tell = telling(connection)
    with _ends(tell, lambda: "the check was stopped"):
        result = check_drive(drive, display, progress=_PageMessages(tell).progress)
        outcome = {"passed": result.passed, "results": to_json(result.results)}
        tell({"type": "device checked", **outcome})
        tell({"type": "device ended", "failed": False, "message": "checked"})


@contextlib.contextmanager
def _ends(tell: Tell, stopped: Callable[[], str]) -> Iterator[None]:
    """Tell of an end that is no success; `stopped` says what Ctrl-C left of it."""
    try:
        hear_interrupts()
        yield
    except KeyboardInterrupt:
        # Whatever was driven is at zero: only what comes before and after playing ends like this.
        tell({"type": "device ended", "failed": False, "message": stopped()})
    except SqueezefilmError as error:
        tell({"type": "device ended", "failed": True, "message": str(error)})
