"""A session on a device in a process of its own, told to the server over a pipe.

The process plays as `squeezefilm play` does, with the same safety: SIGINT ramps to zero and
disarms. Where the server dies, the pipe breaks and the process stops likewise; where this process
dies, the device's own watchdog stops it.
"""

from __future__ import annotations

import contextlib
import math
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squeezefilm import quantities as si
from squeezefilm.errors import InputError, SqueezefilmError
from squeezefilm.results import to_json

if TYPE_CHECKING:
    from squeezefilm.session.play.plan import PlayView

ROW_PERIOD: si.Second = 2e-3
"""Between two rows that the page's scope gets; the record has them all."""
_STOP_LIMIT: si.Second = 5.0

_STOPPED_BEFORE = "stopped before anything was played"
_WITHOUT_A_WORD = (
    "the process that played ended without a word; the device stops by its own watchdog"
)

Tell = Callable[[dict[str, Any]], None]


class DeviceSession:
    """At most one session at a time. `tell` is called from a thread with messages for the pages."""

    def __init__(self, tell: Tell) -> None:
        self._tell = tell
        self._process: Any = None
        self._reader: threading.Thread | None = None
        self._stopped = False

    @property
    def running(self) -> bool:
        """Whether something plays."""
        return self._process is not None and self._process.is_alive()

    def start(self, work: Callable[..., None], **arguments: Any) -> None:
        """Begin; `work(connection, **arguments)` runs in the process.

        Raises:
            InputError: something plays already.
        """
        if self.running:
            raise InputError("a device is in use by this lab already; stop it first")
        self._stopped = False
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe(duplex=False)
        self._process = context.Process(target=work, args=(theirs,), kwargs=arguments, daemon=False)
        self._process.start()
        theirs.close()
        self._reader = threading.Thread(target=self._read, args=(ours, self._process), daemon=True)
        self._reader.start()

    def stop(self) -> None:
        """Ask it to ramp to zero, disarm and end. Returns at once."""
        if self.running:
            self._stopped = True
            os.kill(self._process.pid, signal.SIGINT)

    def close(self) -> None:
        """Stop, and do not wait for long."""
        if self.running:
            self.stop()
            self._process.join(_STOP_LIMIT)
            if self._process.is_alive():
                self._process.kill()

    def _read(self, connection: Connection, process: Any) -> None:
        end: dict[str, Any] | None = None
        while True:
            try:
                message = connection.recv()
            except (EOFError, OSError):
                break
            if message["type"] == "device ended":
                end = message
            else:
                self._tell(message)
        # Told only now: who hears of the end may begin again at once.
        process.join()
        if end is None:
            message = _STOPPED_BEFORE if self._stopped else _WITHOUT_A_WORD
            end = {"type": "device ended", "failed": not self._stopped, "message": message}
        self._tell(end)


class _Watched:
    """What a page hears of a session while it plays."""

    def __init__(self, tell: Tell) -> None:
        self._tell = tell
        self._last = -math.inf

    def progress(self, text: str) -> None:
        """What is done now."""
        self._tell({"type": "device progress", "text": text})

    def tap(self, rows: si.FloatArray) -> None:
        """The newest rows, as many as a page can draw."""
        from squeezefilm.session.loop.rows import COLUMNS

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
        self._tell({"type": "device view", **to_json(view), "state": state, "fault": fault})


def play(connection: Connection, display: str, texture: str, out: str, **how: Any) -> None:
    """Play a file's texture on a file's display into a folder, and tell of it.

    `how` goes to `play_texture` as it is: drive, mode, stroke, sensor, compensation, seed, duration
    (s) and voltage (V or None).
    """
    from squeezefilm.bench.play import JUDGING, play_texture
    from squeezefilm.texture_file import load_texture

    tell = _telling(connection)
    page = _Watched(tell)
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
        from squeezefilm.report.played.page import write_play

        write_play(result, Path(out))
        outcome = result.outcome
        tell(
            {
                "type": "device ended",
                "failed": outcome.failed,
                "ending": outcome.ending.name,
                "message": outcome.message or outcome.ending.value,
                "summary": result.summary(),
                "folder": out,
            }
        )


def check(connection: Connection, drive: str, display: str) -> None:
    """Check a device, and tell of it."""
    from squeezefilm.bench.play import check_drive

    tell = _telling(connection)
    with _ends(tell, lambda: "the check was stopped"):
        result = check_drive(drive, display, progress=_Watched(tell).progress)
        found = {"passed": result.passed, "results": to_json(result.results)}
        tell({"type": "device checked", **found})
        tell({"type": "device ended", "failed": False, "message": "checked"})


@contextlib.contextmanager
def _ends(tell: Tell, stopped: Callable[[], str]) -> Iterator[None]:
    """Tell of an end that is no success; `stopped` says what Ctrl-C left of it."""
    try:
        yield
    except KeyboardInterrupt:
        # Whatever was driven is at zero: only what comes before and after playing ends like this.
        tell({"type": "device ended", "failed": False, "message": stopped()})
    except SqueezefilmError as error:
        tell({"type": "device ended", "failed": True, "message": str(error)})


def _telling(connection: Connection) -> Tell:
    def tell(message: dict[str, Any]) -> None:
        try:
            connection.send(message)
        except OSError:
            # The server is gone: stop as Ctrl-C does, which is safe at any moment.
            os.kill(os.getpid(), signal.SIGINT)

    return tell
