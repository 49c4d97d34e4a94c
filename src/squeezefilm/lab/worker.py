"""Physics in processes of its own, so that the page's messages never wait for a solve.

Work of one slot supersedes older work of the same slot that has not begun: a slider that is
dragged asks thirty times a second and wants the last answer only.
"""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

from squeezefilm.errors import SqueezefilmError

T = TypeVar("T")


class SupersededError(Exception):
    """Work that was not begun, because newer work took its place; of which request, if known."""

    number: int | None = None


class Busy:
    """One line of work: a process, and at most one piece of work waiting per slot."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None
        self._turn = asyncio.Lock()
        self._newest: dict[str, int] = {}

    async def do(self, slot: str, work: Callable[..., T], *arguments: Any) -> T:
        """The result of `work(*arguments)` in the process.

        Raises:
            SupersededError: newer work of the same slot came while this waited.
            SqueezefilmError: what the work raised, or that its process died.
        """
        mine = self._newest.get(slot, 0) + 1
        self._newest[slot] = mine
        async with self._turn:
            if self._newest[slot] != mine:
                raise SupersededError("newer work took its place")
            return await self._run(work, arguments)

    async def _run(self, work: Callable[..., T], arguments: tuple[Any, ...]) -> T:
        if self._pool is None:
            self._pool = ProcessPoolExecutor(
                1, multiprocessing.get_context("spawn"), initializer=_prepare
            )
        try:
            return await asyncio.get_running_loop().run_in_executor(self._pool, work, *arguments)
        except BrokenProcessPool as error:
            self._pool = None
            raise SqueezefilmError(
                "the process that computes ended; it starts again with the next request"
            ) from error

    def close(self) -> None:
        """End the process; what it was doing is dropped."""
        if self._pool is not None:
            processes = list(getattr(self._pool, "_processes", {}).values())
            self._pool.shutdown(wait=False, cancel_futures=True)
            for process in processes:
                process.kill()
            self._pool = None


class Workers:
    """Two lines of work: one for what a drag asks for, one for what takes seconds."""

    def __init__(self) -> None:
        self.quick = Busy()
        self.slow = Busy()

    def close(self) -> None:
        """End both."""
        self.quick.close()
        self.slow.close()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        # The server was killed; a solve for nobody would go on otherwise.
        os._exit(1)


def _prepare() -> None:
    # Ctrl-C in a terminal reaches every process of the lab; the server's own ends this one.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    for library in ("OMP", "OPENBLAS", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    import warnings

    from squeezefilm.errors import SqueezefilmWarning

    # Answers carry their warnings as sentences.
    warnings.simplefilter("ignore", SqueezefilmWarning)
