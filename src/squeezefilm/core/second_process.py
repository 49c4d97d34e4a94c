"""A second process that does a part of the work of this one, where there is a processor for it.

Work is cut into pieces that stand by themselves: functions of a module with arguments that can be
sent. Whichever process is free takes the next piece, so that neither waits while any is left; what
the other does not answer (it could not be started, it died, a piece failed) this one does itself,
and meets the error if there is one. So nothing depends on it, and what comes of the work is the
same with it and without.

A verb has one for its time, `second_process`; what it calls asks for work by `later` and for what
comes of it by `values`. Without one all of it is done here, when its value is asked for. One
process takes less time of both processors together: it is worth it for what takes long.

On Linux it is a copy of this process (fork), made once both have what they need. Elsewhere, and
where a thread beside the main one asks, it is a new one that loads all again, which takes seconds
of a processor. A copy asks for nothing that other threads may hold, as that of a progress line.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import pickle
import queue
import signal
import sys
import threading
import warnings
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from multiprocessing.connection import Connection
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.loading import interrupts_held

_PATIENCE: si.Second = 60.0
_LEAVE: si.Second = 2.0
"""How long one waits for a piece before doing it oneself, and for a process to end by itself."""

# A piece that is sent cannot be done here: one that waits there for a long one would be waited for.
_AHEAD = 1


class Kept:
    """Something that many pieces need, sent once; in their arguments this stands for it."""

    def __init__(self, name: int) -> None:
        self.name = name


class Piece:
    """A piece of work that may be done elsewhere."""

    def __init__(self, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
        self.function, self.arguments = function, arguments
        self.value: Any = None
        self.is_done = False

    def do(self) -> None:
        """Do it here."""
        self.value = self.function(*self.arguments)
        self.is_done = True


class SecondProcess:
    """A process that takes pieces of work, once it is started. The first of `prepare` loads what
    they need, before any is sent; the others follow, in a new process when there is nothing to do.
    """

    def __init__(self, *prepare: Callable[[], object]) -> None:
        self._prepare, self._is_started = prepare, False
        self._line: Connection | None = None
        self._kept: list[Any] = []
        self._waiting: deque[Piece] = deque()
        self._sent: deque[Piece] = deque()
        self._warned: list[warnings.WarningMessage] = []
        self._change = threading.Condition()
        self._is_lost, self._is_ready = True, False

    def start(self) -> None:
        """Start it, if it was not started before; what is asked for until then may wait for it."""
        if self._is_started:
            return
        self._is_started = True
        is_copy, lacking = _can_be_copied(), self._prepare
        if is_copy:
            for prepare in self._prepare:
                _load(prepare)
            lacking = ()
        context: Any = multiprocessing.get_context("fork" if is_copy else "spawn")
        # Where the system has no room for a process, this one does everything.
        with contextlib.suppress(OSError):
            ours, theirs = context.Pipe()
            # A copy that kept our end would not hear that this process has ended.
            arguments = theirs, lacking, [ours] if is_copy else []
            self._process = context.Process(target=_work, args=arguments, daemon=True)
            with theirs, interrupts_held(), warnings.catch_warnings():
                # From 3.12 Python warns of every copy of a process with threads, as OpenBLAS has.
                warnings.simplefilter("ignore", DeprecationWarning)
                self._process.start()
            self._line, self._is_lost = ours, False
            threading.Thread(target=self._listen, args=(ours,), daemon=True).start()

    def ask(self, piece: Piece) -> None:
        """Have a piece done by whichever process is free first."""
        with self._change:
            self._waiting.append(piece)
            self._send_ahead()

    def wait(self, pieces: Sequence[Piece]) -> None:
        """Until pieces are done; meanwhile this process does those of them that are not begun.

        Raises what a piece raises.
        """
        while mine := self._mine(pieces):
            mine.do()
        self._say_warnings()

    def end(self) -> None:
        """Let it go; it does nothing more."""
        with self._change:
            line, self._line, self._is_lost = self._line, None, True
        if line is None:
            return
        with contextlib.suppress(OSError):
            line.send(None)
        self._process.join(_LEAVE)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()

    def _mine(self, pieces: Sequence[Piece]) -> Piece | None:
        """The next piece to be done here; None once all are done."""
        with self._change:
            while lacking := [one for one in pieces if not one.is_done]:
                # From the end: the other process begins with the first.
                for one in reversed(lacking):
                    if one not in self._sent:
                        with contextlib.suppress(ValueError):
                            self._waiting.remove(one)
                        return one
                if not self._change.wait(_PATIENCE):
                    self._lose()
        return None

    def _send_ahead(self) -> None:
        # What is sent to one that still loads would be waited for.
        while self._is_ready and not self._is_lost and self._waiting and len(self._sent) < _AHEAD:
            piece = self._waiting.popleft()
            # What cannot be sent is done here.
            with contextlib.suppress(pickle.PicklingError, AttributeError, TypeError):
                self._send((piece.function, [self._as_sent(one) for one in piece.arguments]))
                if not self._is_lost:
                    self._sent.append(piece)

    def _as_sent(self, value: Any) -> Any:
        """What stands for an argument: of a record that was sent before its number."""
        if not hasattr(value, "__dict__"):
            return value
        for name, known in enumerate(self._kept):
            if known is value:
                return Kept(name)
        self._send(value)
        self._kept.append(value)
        return Kept(len(self._kept) - 1)

    def _send(self, message: Any) -> None:
        if self._line is None or self._is_lost:
            return
        try:
            self._line.send(message)
        except OSError:
            self._lose()

    def _lose(self) -> None:
        """It died, or takes too long: what was sent is to be done here."""
        self._is_lost = True
        self._sent.clear()
        self._change.notify_all()

    def _listen(self, line: Connection) -> None:
        """Take answers, which come in the order of what was sent, and send what is next."""
        with contextlib.suppress(OSError, EOFError):
            while True:
                answer = line.recv()
                with self._change:
                    if answer is None:
                        self._is_ready = True
                        self._send_ahead()
                        self._change.notify_all()
                        continue
                    if not self._sent:
                        continue
                    is_done, value, warned = answer
                    piece = self._sent.popleft()
                    piece.value, piece.is_done = value, is_done
                    self._warned += warned
                    self._send_ahead()
                    self._change.notify_all()
        with self._change:
            self._lose()

    def _say_warnings(self) -> None:
        """Warn of what was warned of there, as if it had been done here."""
        with self._change:
            warned, self._warned = self._warned, []
        for one in warned:
            warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)


_PRESENT: ContextVar[SecondProcess | None] = ContextVar("second process", default=None)


@contextmanager
def second_process(
    *prepare: Callable[[], object],
) -> Iterator[SecondProcess | None]:
    """A `SecondProcess` for the block; None unless there is a second processor for it, and in a
    process that must not have children, as the lab's workers are."""
    if _processors() < 2 or multiprocessing.current_process().daemon:
        yield None
        return
    process = SecondProcess(*prepare)
    process.start()
    before = _PRESENT.set(process)
    try:
        # Threads of either would wait for the other's.
        with one_blas_thread():
            yield process
    finally:
        _PRESENT.reset(before)
        process.end()


def is_present() -> bool:
    """Whether there is one now, started or not."""
    return _PRESENT.get() is not None


def later(function: Callable[..., Any], *arguments: Any) -> Piece:
    """Work whose value is wanted later: begun by the second process, where there is one. Records
    among the arguments are sent once, and must not change."""
    piece, process = Piece(function, arguments), _PRESENT.get()
    if process is not None:
        process.ask(piece)
    return piece


def values(*pieces: Piece) -> list[Any]:
    """What comes of pieces, in their order. Raises what one of them raises."""
    process = _PRESENT.get()
    if process is not None:
        process.wait(pieces)
    for one in pieces:
        if not one.is_done:
            one.do()
    return [one.value for one in pieces]


def _processors() -> int:
    """How many processors this process may use."""
    allowed = getattr(os, "sched_getaffinity", None)
    return (os.cpu_count() or 1) if allowed is None else len(allowed(0))


def _can_be_copied() -> bool:
    """Whether a copy of this process can work: not on macOS, whose libraries forbid it."""
    return sys.platform == "linux" and threading.current_thread() is threading.main_thread()


def _work(
    line: Connection, prepare: Sequence[Callable[[], object]], closed: Sequence[Connection]
) -> None:
    """Say that it is ready, then do what comes, and answer each piece."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _PRESENT.set(None)
    for other in closed:
        other.close()
    messages: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_take, args=(line, messages), daemon=True).start()
    others = deque(prepare)
    if others:
        _load(others.popleft())
    with contextlib.suppress(OSError), one_blas_thread():
        line.send(None)
        _answer(line, messages, others)


def _load(prepare: Callable[[], object]) -> None:
    """What fails here is done, and fails, where somebody sees it."""
    with contextlib.suppress(Exception):
        prepare()


def _answer(
    line: Connection, messages: queue.SimpleQueue[Any], others: deque[Callable[[], object]]
) -> None:
    """Do what comes, until the line is gone, and between times what else there is to prepare."""
    kept: list[Any] = []
    while True:
        while others and messages.empty():
            _load(others.popleft())
        message = messages.get()
        if not isinstance(message, tuple):
            kept.append(message)
            continue
        function, arguments = message
        given = [kept[one.name] if isinstance(one, Kept) else one for one in arguments]
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            try:
                answer = True, function(*given), warned
            except Exception:
                answer = False, None, []
        try:
            line.send(answer)
        except OSError:
            return
        except Exception:
            line.send((False, None, []))


def _take(line: Connection, messages: queue.SimpleQueue[Any]) -> None:
    """Take what is sent while something is done; None, or the end of the line, is the end of the
    process, however the one that asks has ended."""
    try:
        while (message := line.recv()) is not None:
            messages.put(message)
    finally:
        os._exit(0)
