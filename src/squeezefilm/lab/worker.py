"""Physics in processes of its own, so that the page's messages never wait for a solve.

Work of one slot supersedes older work of the same slot: a slider that is dragged asks thirty times
a second and wants the last answer only. What has begun goes on for a moment, because most work is
done by then and a new process takes seconds to start; longer, and its process is ended with it.
"""

from __future__ import annotations

import asyncio
import contextlib
import multiprocessing
import os
import signal
import time
from collections.abc import Callable
from contextvars import ContextVar
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from typing import TYPE_CHECKING, Any, TypeVar

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.interrupts import end_with_parent, interrupts_held

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

T = TypeVar("T")

LARGEST_MEMORY = 2 * 1024**3
"""Bytes of data that a process which computes may hold."""
GRACE: si.Second = 2.0
"""Longest time that work goes on which newer work wants to replace."""
PAGE: ContextVar[WebSocket] = ContextVar("page")
"""The page whose message is being answered."""
_SPAWN = multiprocessing.get_context("spawn")


Told = Callable[[str, float], None]
"""Function that hears how far a piece of work is: a text and the share that is done (0 to 1)."""
_TELL_EVERY: si.Second = 0.1


class SupersededError(Exception):
    """Work whose answer nobody waits for, because newer work came; of which request, if known."""

    number: int | None = None


@dataclass(frozen=True, slots=True)
class _HowFar:
    """Progress of a process before its answer."""

    text: str
    share: float


@dataclass(eq=False, slots=True)
class _Job:
    """A piece of work that was asked for."""

    page: WebSocket | None
    slot: str | None
    gives_way: bool
    told: Told | None
    began: float = 0.0
    ended_because: Exception | None = None


@dataclass(slots=True)
class _Process:
    """A process that computes, and the line to it."""

    process: SpawnProcess
    line: Connection

    @classmethod
    def started(cls) -> _Process:
        ours, theirs = _SPAWN.Pipe()
        process = _SPAWN.Process(target=_work, args=(theirs,), daemon=True)
        # Ctrl-C in a terminal reaches every process of the lab; the server's own ends this one.
        with interrupts_held():
            process.start()
        theirs.close()
        return cls(process, ours)

    def ask(
        self, work: Callable[..., T], arguments: tuple[Any, ...], told: Told | None
    ) -> tuple[bool, Any]:
        """Success, and the result or the error; how far it is is told meanwhile.

        Raises `EOFError` if the process dies.
        """
        try:
            self.line.send((work, arguments))
            while isinstance(said := self.line.recv(), _HowFar):
                if told is not None:
                    told(said.text, said.share)
        except OSError as error:
            raise EOFError from error
        answer: tuple[bool, Any] = said
        return answer

    def end(self) -> None:
        """Kill it; whoever waits for its answer gets an `EOFError`."""
        self.process.kill()


class Busy:
    """A line of work: a process, and at most one piece of work waiting per page and slot.

    Work that takes longer than `longest` (s) is ended.
    """

    def __init__(self, longest: si.Second) -> None:
        self._longest = longest
        self._process: _Process | None = None
        self._turn = asyncio.Lock()
        self._jobs: list[_Job] = []
        self._running: _Job | None = None

    async def do(
        self,
        slot: str | None,
        work: Callable[..., T],
        *arguments: Any,
        gives_way: bool = False,
        told: Told | None = None,
    ) -> T:
        """The result of `work(*arguments)` in the process.

        Args:
            slot: newer work of the same page and slot takes this one's place; None if none does.
            gives_way: whether it is ended for newer work, for `cancel` and with its page also
                when it has begun.
            told: is called with what the work says by `tell`.

        Raises:
            SupersededError: newer work of the same slot came.
            SqueezefilmError: what the work raised, that it took too long or too much memory, was
                cancelled, or that its process died.
        """
        job = _Job(PAGE.get(None), slot, gives_way, told)
        if slot is not None:
            for older in self._jobs:
                if (older.page, older.slot) == (job.page, slot):
                    self._give_way(older)
        self._jobs.append(job)
        running = asyncio.create_task(self._in_turn(job, work, arguments))
        # Nobody may wait for it any more when it fails.
        running.add_done_callback(lambda done: done.cancelled() or done.exception())
        try:
            # What writes a file is not torn where the page that asked for it is closed.
            return await asyncio.shield(running)
        except asyncio.CancelledError:
            if gives_way or job is not self._running:
                self._end(job, _newer())
            raise

    def begin(self) -> None:
        """Start the process where there is none, so that the first work need not wait for it."""
        if self._process is None:
            self._process = _Process.started()

    def cancel(self, page: WebSocket | None) -> None:
        """End what a page asked for and would give way."""
        for job in list(self._jobs):
            if job.page is page and job.gives_way:
                self._end(job, SqueezefilmError("the computation was cancelled"))

    def _give_way(self, older: _Job) -> None:
        """Let newer work take the place of an older piece that waits, or has run long enough."""
        if older is not self._running:
            self._end(older, _newer())
        elif older.gives_way:
            left = older.began + GRACE - time.monotonic()
            asyncio.get_running_loop().call_later(max(left, 0.0), self._end, older, _newer())

    async def _in_turn(self, job: _Job, work: Callable[..., T], arguments: tuple[Any, ...]) -> T:
        try:
            async with self._turn:
                if job.ended_because is not None:
                    raise job.ended_because
                self._running, job.began = job, time.monotonic()
                return await self._run(job, work, arguments)
        finally:
            self._jobs.remove(job)
            self._running = None if self._running is job else self._running

    async def _run(self, job: _Job, work: Callable[..., T], arguments: tuple[Any, ...]) -> T:
        self.begin()
        process = self._process
        assert process is not None
        loop = asyncio.get_running_loop()

        def told(text: str, share: float) -> None:
            if job.told is not None and job.ended_because is None:
                loop.call_soon_threadsafe(job.told, text, share)

        late = SqueezefilmError(
            f"this took more than {self._longest:g} s and was ended; ask for less: fewer nodal "
            "lines, samples or participants, or a coarser quality"
        )
        alarm = loop.call_later(self._longest, self._end, job, late)
        try:
            worked, answer = await loop.run_in_executor(None, process.ask, work, arguments, told)
        except EOFError as error:
            self._process = None if self._process is process else self._process
            raise job.ended_because or SqueezefilmError(
                "the process that computes ended; it starts again with the next request"
            ) from error
        finally:
            alarm.cancel()
        if not worked:
            raise answer
        result: T = answer
        return result

    def _end(self, job: _Job, why: Exception) -> None:
        """End a piece of work for a reason, unless it is done."""
        if job not in self._jobs:
            return
        job.ended_because = job.ended_because or why
        if job is self._running:
            self.close()

    def close(self) -> None:
        """End the process; what it was doing is dropped."""
        if self._process is not None:
            self._process.end()
            self._process = None


_line: Connection | None = None
_told_last = 0.0


def tell(text: str, share: float) -> None:
    """Say how far the work is that runs in this process; without effect outside such a process."""
    global _told_last
    now = time.monotonic()
    if _line is not None and now - _told_last >= _TELL_EVERY:
        _told_last = now
        _line.send(_HowFar(text, share))


def _newer() -> SupersededError:
    return SupersededError("newer work took its place")


def _work(line: Connection) -> None:
    """Answer one piece of work after the other, until the line is closed."""
    global _line
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    prepare()
    _line = line
    with contextlib.suppress(EOFError, OSError):
        while True:
            work, arguments = line.recv()
            line.send(_answered(work, arguments))


def _answered(work: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[bool, Any]:
    try:
        return True, work(*arguments)
    except MemoryError:
        return False, SqueezefilmError(
            f"this needs more than {LARGEST_MEMORY / 1024**3:g} GiB of memory and was ended; ask "
            "for less: fewer nodal lines, samples or participants, or a coarser quality"
        )
    except Exception as error:
        # Whoever asked handles it as its own.
        return False, error


def prepare() -> None:
    """Make this process one that computes: for a server that may be killed, within limits, its
    warnings unsaid."""
    end_with_parent()
    for library in ("OMP", "OPENBLAS", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    _limit_memory()
    import warnings

    from squeezefilm.core.errors import SqueezefilmWarning

    # Answers carry their warnings as sentences.
    warnings.simplefilter("ignore", SqueezefilmWarning)


def _limit_memory() -> None:
    """Let an allocation far beyond any solve fail here, before the computer's memory is full."""
    try:
        import resource
    except ImportError:
        # Windows has no such limit; the time limit holds there.
        return
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    if hard == resource.RLIM_INFINITY or hard > LARGEST_MEMORY:
        resource.setrlimit(resource.RLIMIT_DATA, (LARGEST_MEMORY, hard))
