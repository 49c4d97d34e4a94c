"""A session on a device in a process of its own, told to the server over a pipe.

The process plays as `squeezefilm play` does, with the same safety: SIGINT ramps to zero and
disarms. Where the server dies, the pipe breaks and the process stops likewise; where this process
dies, the device's own watchdog stops it.
"""

from __future__ import annotations

import contextlib
import math
import signal
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.interrupts import hear_interrupts
from squeezefilm.core.results import to_json
from squeezefilm.lab.told_process import Tell, ToldProcess, telling

if TYPE_CHECKING:
    from squeezefilm.instruments.session.play.plan import PlayView

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
