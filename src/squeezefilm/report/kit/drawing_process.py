"""A second process that draws figures while this one goes on computing what they show.

It is started before there is anything to draw, so that it loads its libraries meanwhile. Nothing
depends on it: what it does not answer (it could not be started, it died, a figure failed) whoever
asked draws himself, and meets the error there if there is one.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import queue
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from multiprocessing.connection import Connection
from typing import Any

from squeezefilm import quantities as si

_PATIENCE: si.Second = 60.0
_LEAVE: si.Second = 2.0
"""How long a process may take to draw what is left, and to end by itself."""


class DrawingProcess:
    """A process that draws figures of one subject, by their keys.

    `draw` (a function of a module) makes the text of a figure of a subject and a key, `prepare`
    loads what that takes.
    """

    def __init__(self, prepare: Callable[[], object], draw: Callable[[Any, str], str]) -> None:
        self._line: Connection | None = None
        spawn = multiprocessing.get_context("spawn")
        # Where the system has no room for a process, this one draws.
        with contextlib.suppress(OSError):
            ours, theirs = spawn.Pipe()
            self._process = spawn.Process(target=_work, args=(theirs, prepare, draw), daemon=True)
            with theirs, _deaf_to_interrupts():
                self._process.start()
            self._line = ours

    def begin(self, subject: Any) -> None:
        """Send what the figures are of; it is pickled as it is now."""
        self._send(subject)

    def ask(self, key: str, values: Mapping[str, Any]) -> None:
        """Ask for a figure; `values` are put into the subject's attributes before it is drawn."""
        self._send((key, dict(values)))

    def drawings(self) -> dict[str, str]:
        """What was drawn of all that was asked for, by key; waits for it."""
        self._send(None)
        if self._line is None:
            return {}
        drawn: dict[str, str] = {}
        with contextlib.suppress(OSError, EOFError):
            if self._line.poll(_PATIENCE):
                drawn = self._line.recv()
        return drawn

    def end(self) -> None:
        """Let it go; it draws nothing more."""
        if self._line is None:
            return
        self._line.close()
        self._line = None
        self._process.join(_LEAVE)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()

    def _send(self, message: Any) -> None:
        if self._line is None:
            return
        try:
            self._line.send(message)
        except OSError:
            # It died; nobody needs it.
            self.end()


@contextmanager
def drawing_process(
    wanted: bool, prepare: Callable[[], object], draw: Callable[[Any, str], str]
) -> Iterator[DrawingProcess | None]:
    """A `DrawingProcess` that ends with the block; None unless it is `wanted` and there is a second
    processor for it."""
    if not wanted or _processors() < 2:
        yield None
        return
    process = DrawingProcess(prepare, draw)
    try:
        yield process
    finally:
        process.end()


def _processors() -> int:
    """How many processors this process may use."""
    allowed = getattr(os, "sched_getaffinity", None)
    return (os.cpu_count() or 1) if allowed is None else len(allowed(0))


@contextmanager
def _deaf_to_interrupts() -> Iterator[None]:
    """What is started within is not interrupted by Ctrl-C, which is for the process that waits."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _work(line: Connection, prepare: Callable[[], object], draw: Callable[[Any, str], str]) -> None:
    """Draw what comes until there is no more, and answer with all of it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    messages: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(line, messages), daemon=True).start()
    # What fails here is done, and fails, where somebody sees it.
    with contextlib.suppress(Exception):
        prepare()
    subject, drawn = messages.get(), {}
    while (asked := messages.get()) is not None:
        key, values = asked
        vars(subject).update(values)
        with contextlib.suppress(Exception):
            drawn[key] = draw(subject, key)
    line.send(drawn)


def _listen(line: Connection, messages: queue.SimpleQueue[Any]) -> None:
    """Take what is sent while something is drawn; the end of the line is the end of the process,
    however the one that asks has ended."""
    try:
        while True:
            messages.put(line.recv())
    finally:
        os._exit(0)
