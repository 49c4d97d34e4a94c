"""A second process that does a part of the work of this one, where there is a processor for it.

Work is cut into pieces: functions of a module with arguments that can be sent. Whichever process is
free takes the next piece. What the other does not answer (it could not be started, it died, a piece
failed or cannot be sent) this process does itself, and meets the error if there is one. So what
comes of the work is the same with a second process and without.

A verb has one for its time, `second_process`; what it calls asks for work by `later` and for the
values by `values`. On Linux it is a copy of this process (fork), made once this has what both need.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import sys
import threading
import warnings
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.interrupts import end_with_parent, interrupts_held

_PATIENCE: si.Second = 60.0
"""Longest wait for a piece that the other process has begun, before it is done here."""
_LEAVE: si.Second = 2.0
"""Longest wait for that process to end by itself."""


class Piece:
    """A piece of work that may be done elsewhere."""

    def __init__(self, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
        self.function, self.arguments = function, arguments
        self.elsewhere: Future[Any] | None = None
        self._value: Any = None
        self._is_done = False

    def value(self) -> Any:
        """The value, waited for or computed here. Raises what the function raises."""
        if self.elsewhere is not None and not self._is_done:
            # Whatever went wrong there goes wrong here, or does not.
            with contextlib.suppress(Exception):
                self._value, warned = self.elsewhere.result(_PATIENCE)
                self._is_done = True
                for warning in warned:
                    warnings.warn_explicit(
                        warning.message, warning.category, warning.filename, warning.lineno
                    )
        if not self._is_done:
            self._value, self._is_done = self.function(*self.arguments), True
        return self._value


class _Other:
    """The other process, which has one piece at a time."""

    def __init__(self, pool: ProcessPoolExecutor, ready: Future[Any]) -> None:
        self._pool = pool
        self._waiting: deque[Piece] = deque()
        self._turn = threading.RLock()
        self._last = ready

    def ask(self, piece: Piece) -> None:
        with self._turn:
            self._waiting.append(piece)
            if self._last.done():
                self._send(self._last)
            elif len(self._waiting) == 1:
                self._last.add_done_callback(self._send)

    def take_back(self, piece: Piece) -> bool:
        """True for a piece that is not begun, which is then not begun there."""
        with self._turn:
            is_waiting = piece in self._waiting
            if is_waiting:
                self._waiting.remove(piece)
        return is_waiting

    def _send(self, _: Future[Any]) -> None:
        with self._turn:
            if not self._last.done() or not self._waiting:
                return
            # A process that died takes nothing; what waits is taken back.
            with contextlib.suppress(RuntimeError):
                piece = self._waiting[0]
                sent = self._pool.submit(_with_warnings, piece.function, piece.arguments)
                piece.elsewhere = self._last = sent
                self._waiting.popleft()
                if self._waiting:
                    sent.add_done_callback(self._send)


_PRESENT: ContextVar[_Other | None] = ContextVar("second process", default=None)


@contextmanager
def second_process(prepare: Callable[[], object]) -> Iterator[bool]:
    """A second process for the block, which `prepare` loads; False, and none, where there is no
    second processor, and in a process that must not have children, as the lab's workers are."""
    if _processors() < 2 or multiprocessing.current_process().daemon:
        yield False
        return
    # Libraries of macOS forbid a copy, and what other threads hold would be held in it for ever.
    is_copy = sys.platform == "linux" and threading.current_thread() is threading.main_thread()
    if is_copy:
        _load(prepare)
    context = multiprocessing.get_context("fork" if is_copy else "spawn")
    # Threads of either would wait for the other's.
    with one_blas_thread(), _other(context, prepare) as other:
        token = _PRESENT.set(other)
        try:
            yield other is not None
        finally:
            _PRESENT.reset(token)


@contextmanager
def _other(context: Any, prepare: Callable[[], object]) -> Iterator[_Other | None]:
    """The process, started; None where the system has no room for one."""
    pool = ProcessPoolExecutor(1, context, _begin, (prepare,))
    others = set(multiprocessing.active_children())
    try:
        with interrupts_held(), warnings.catch_warnings():
            # From 3.12 Python warns of every copy of a process with threads, as OpenBLAS has.
            warnings.simplefilter("ignore", DeprecationWarning)
            ready = pool.submit(os.getpid)
    except OSError:
        yield None
        return
    try:
        yield _Other(pool, ready)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for child in set(multiprocessing.active_children()) - others:
            child.join(_LEAVE)
            child.kill()
            child.join()


def is_present() -> bool:
    """True within `second_process`, where there is one."""
    return _PRESENT.get() is not None


def later(function: Callable[..., Any], *arguments: Any) -> Piece:
    """Work whose value is wanted later: begun by the second process, where there is one."""
    piece, other = Piece(function, arguments), _PRESENT.get()
    if other is not None:
        other.ask(piece)
    return piece


def values(*pieces: Piece) -> list[Any]:
    """The values of pieces, in their order. Raises what one of them raises."""
    # From the end: the other process begins with the first.
    other = _PRESENT.get()
    for piece in reversed(pieces):
        if other is not None and other.take_back(piece):
            piece.value()
    return [piece.value() for piece in pieces]


def _processors() -> int:
    """The number of processors that this process may use."""
    allowed = getattr(os, "sched_getaffinity", None)
    return (os.cpu_count() or 1) if allowed is None else len(allowed(0))


def _begin(prepare: Callable[[], object]) -> None:
    """Make ready in the second process, which ends with the first however that ends."""
    _PRESENT.set(None)
    end_with_parent()
    _load(prepare)


def _load(prepare: Callable[[], object]) -> None:
    # What fails here is done, and fails, where somebody sees it.
    with contextlib.suppress(Exception):
        prepare()


def _with_warnings(
    function: Callable[..., Any], arguments: tuple[Any, ...]
) -> tuple[Any, list[warnings.WarningMessage]]:
    """The value and the warnings of a call, which is made with one BLAS thread."""
    with one_blas_thread(), warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        return function(*arguments), warned
