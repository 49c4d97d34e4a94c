"""A session on a device in a process of its own, told to the server over a pipe.

The process plays as `squeezefilm play` does, with the same safety: SIGINT ramps to zero and
disarms. Where the server dies, the pipe breaks and the process stops likewise; where this process
dies, the device's own watchdog stops it.
"""

from __future__ import annotations

import math
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError, SqueezefilmError
from squeezefilm.results import to_json

if TYPE_CHECKING:
    from squeezefilm.session.play.plan import PlayView

ROW_PERIOD: si.Second = 2e-3
"""Between two rows that the page's scope gets; the record has them all."""
_STOP_LIMIT: si.Second = 5.0

_STOPPED_BEFORE = "stopped before anything was played"

Tell = Callable[[dict[str, Any]], None]


@dataclass(frozen=True)
class DeviceWork:
    """What a page asks to play: files of display and texture, a drive, and how."""

    display: str
    texture: str
    drive: str
    mode: str
    stroke: str
    sensor: str
    duration: si.Second
    voltage: float | None
    compensation: str
    out: str
    seed: int


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

    def start(self, work: Callable[..., None], *arguments: Any) -> None:
        """Begin; `work(connection, *arguments)` runs in the process.

        Raises:
            InputError: something plays already.
        """
        if self.running:
            raise InputError("a device is in use by this lab already; stop it first")
        self._stopped = False
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe(duplex=False)
        self._process = context.Process(target=work, args=(theirs, *arguments), daemon=False)
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
        if end is None and self._stopped:
            end = {"type": "device ended", "failed": False, "message": _STOPPED_BEFORE}
        elif end is None:
            end = {
                "type": "device ended",
                "failed": True,
                "message": "the process that played ended without a word; the device stops by "
                "its own watchdog",
            }
        self._tell(end)


class _Watched:
    """What a page hears of a session while it plays."""

    def __init__(self, tell: Tell) -> None:
        self.stage = ""
        self._tell = tell
        self._last = -math.inf

    def progress(self, text: str) -> None:
        """What is done now."""
        self.stage = text
        self._tell({"type": "device progress", "text": text})

    def tap(self, rows: si.FloatArray) -> None:
        """The newest rows, as many as a page can draw."""
        from squeezefilm.session.loop.rows import COLUMNS

        kept = []
        for row in rows:
            if row[1] - self._last >= ROW_PERIOD:
                self._last = float(row[1])
                kept.append([float(one) if np.isfinite(one) else None for one in row])
        if kept:
            self._tell({"type": "device rows", "columns": list(COLUMNS), "rows": kept})

    def show(self, view: PlayView) -> None:
        """The moment."""
        self._tell(
            {
                "type": "device view",
                "state": view.state.name,
                "fault": view.fault.name,
                "time_s": view.time,
                "x_m": view.x,
                "speed_m_per_s": view.speed,
                "relative_friction": view.friction,
                "amplitude_m": view.amplitude,
                "wanted_m": view.wanted,
                "level_V": view.level,
                "lag_m": view.lag,
                "lateness_s": view.lateness,
                "flags": list(view.flags),
            }
        )


def play(connection: Connection, work: DeviceWork) -> None:
    """Play, and tell of it."""
    from squeezefilm.bench.play import JUDGING, play_texture
    from squeezefilm.texture_file import load_texture

    tell = _telling(connection)
    page = _Watched(tell)
    try:
        result = play_texture(
            work.display,
            load_texture(work.texture),
            drive=work.drive,
            sensor=work.sensor,
            mode=work.mode,
            stroke=work.stroke,
            duration=work.duration,
            voltage=work.voltage,
            compensation=work.compensation,
            out=Path(work.out),
            seed=work.seed,
            show=page.show,
            tap=page.tap,
            progress=page.progress,
        )
        # The device is at zero and disarmed; what is left to be written is not to be cut short.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        from squeezefilm.report.played.page import write_play

        write_play(result, Path(work.out))
        tell(
            {
                "type": "device ended",
                "failed": result.outcome.failed,
                "ending": result.outcome.ending.name,
                "message": result.outcome.message or result.outcome.ending.value,
                "summary": result.summary(),
                "folder": work.out,
            }
        )
    except KeyboardInterrupt:
        # Whatever was driven is at zero: only what comes before and after playing ends like this.
        message = (
            f"stopped during: {page.stage}; what was played is recorded in {work.out}, not judged"
            if page.stage == JUDGING
            else _STOPPED_BEFORE
        )
        tell({"type": "device ended", "failed": False, "message": message})
    except SqueezefilmError as error:
        tell({"type": "device ended", "failed": True, "message": str(error)})


def check(connection: Connection, drive: str, display: str) -> None:
    """Check a device, and tell of it."""
    from squeezefilm.bench.play import check_drive

    tell = _telling(connection)
    try:
        result = check_drive(
            drive, display, progress=lambda text: tell({"type": "device progress", "text": text})
        )
        tell(
            {
                "type": "device checked",
                "passed": result.passed,
                "results": to_json(result.results),
            }
        )
        tell({"type": "device ended", "failed": False, "message": "checked"})
    except KeyboardInterrupt:
        tell({"type": "device ended", "failed": False, "message": "the check was stopped"})
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
