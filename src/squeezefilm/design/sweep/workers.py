"""Workers that answer: this process, processes of this machine, or a Dask cluster; one method wide.

with workers(jobs=2) as pool:                      # or workers(scheduler="tcp://host:8786")
    for key, answer in pool.answers(function, {key: (argument, ...), ...}):
        ...
"""

from __future__ import annotations

import contextlib
import logging
import multiprocessing
import signal
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager
from typing import Annotated, Any

from squeezefilm import __version__
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import WorkersError, optional
from squeezefilm.core.interrupts import end_with_parent, hear_interrupts, interrupts_held
from squeezefilm.core.kept.computed_by import computed_by
from squeezefilm.core.progress import SayProgress
from squeezefilm.design.sweep.tasks import (
    A,
    K,
    NoAnswer,
    Shares,
    Workers,
    computed,
)

_LOOK: si.Second = 0.02  # between two looks for answers
_ANSWERS: si.Second = 20.0
_PATIENCE: si.Second = 120.0
"""Longest silence of a scheduler, and longest wait for the first worker of a cluster."""


class Cluster(Workers):
    """The workers of the scheduler at an address, as many as there are at any time: they come and
    go. A task is tried again as often as the scheduler's `allowed-failures` says, then once alone;
    where the asking is closed early, workers end the task they are at.

    Raises `MissingPackageError` where Dask is not installed, and on entry `WorkersError` where
    nothing answers at the address.
    """

    def __init__(self, address: str, tell: SayProgress) -> None:
        with optional("cluster", "a scheduler (not the processes of this machine, jobs)"):
            import distributed
        self._dask: Any = distributed
        self._address, self._tell = address, tell
        self._client: Any = None

    def __enter__(self) -> Cluster:
        # What it says of a scheduler that is gone is said by us, and in one sentence.
        logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
        client: Any = self._dask.Client
        try:
            self._client = client(self._address, timeout=_ANSWERS, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise WorkersError(
                f"no scheduler answers at {self._address}; start one with: dask scheduler"
            ) from error
        offered = self._client.scheduler_info(n_workers=0).get("services", {})
        where = f", dashboard at {self._client.dashboard_link}" if "dashboard" in offered else ""
        self._tell(f"scheduler at {self._address}{where}")
        return self

    def __exit__(self, *_: object) -> None:
        # One that is gone is not waited for.
        with contextlib.suppress(Exception):
            self._client.close(timeout=2)

    def _asked(
        self,
        function: Callable[..., A],
        tasks: Mapping[K, tuple[Any, ...]],
        groups: Sequence[Sequence[K]],
    ) -> Iterator[tuple[K, A | NoAnswer]]:
        self._require_workers()
        keys: dict[Any, K] = {}
        for group in groups:
            # Dask gives a task to who has what it needs: here, the first answer of its group.
            first = None
            for key in group:
                future = self._client.submit(
                    _work, _code_here(), first, function, tasks[key], pure=False
                )
                first = first or future
                keys[future] = key
        # An answer is fetched as soon as it is there, so that it outlives its worker.
        coming: Any = self._dask.as_completed(
            list(keys), loop=self._client.loop, with_results=True, raise_errors=False
        )
        try:
            while keys:
                done = coming.next_batch(block=False)
                for future, result in done:
                    key, answer = keys.pop(future), self._answer(future, result)
                    future.release()  # nobody does it again when its worker dies
                    yield key, answer
                # An answer that was on its way when the scheduler ended would never come.
                if not done and self._client.status != "running":
                    raise self._gone()
                if not done:
                    time.sleep(_LOOK)
        finally:
            with contextlib.suppress(Exception):
                self._client.cancel(list(keys))

    def _require_workers(self) -> None:
        """Wait for a worker. Raises `WorkersError` where none comes for too long."""
        try:
            if not self._client.nthreads():
                self._tell(f"waiting for workers at {self._address}")
                self._client.wait_for_workers(1, timeout=_PATIENCE)
        except TimeoutError as error:
            raise WorkersError(
                f"the scheduler at {self._address} has had no worker for {_PATIENCE:.0f} s; start "
                f"some with: dask worker {self._address} --nworkers 2 --nthreads 1"
            ) from error
        except OSError as error:
            raise self._gone() from error

    def _answer(self, future: Any, result: Any) -> Any:
        """The answer of a task that is done, or what is to be raised for it."""
        if isinstance(result, self._dask.client.FutureCancelledError):
            raise self._gone()
        if future.status != "error":
            return result
        error = future.exception()
        if isinstance(error, self._dask.KilledWorker):
            return NoAnswer()
        if isinstance(error, ModuleNotFoundError):
            raise WorkersError(
                f"a worker of {self._address} lacks {error.name}; install squeezefilm "
                f"{__version__} there"
            ) from error
        raise error

    def _gone(self) -> WorkersError:
        return WorkersError(
            f"the scheduler at {self._address} answers no more; start it and its workers again, "
            "and ask again: what was answered and kept is not computed again"
        )


def _code_here() -> str:
    return f"{__version__} (code {computed_by()[:8]})"


def _work(
    asked_by: str, first: object, function: Callable[..., A], arguments: tuple[Any, ...]
) -> A:
    """Do one task at a worker, whose code must be that of who asks, after the `first` like it."""
    from distributed import get_worker

    worker, there = get_worker(), _code_here()
    if worker.state.nthreads > 1:
        raise WorkersError(
            f"the worker at {worker.address} has {worker.state.nthreads} threads, which would wait "
            f"for each other; start workers with one thread each: dask worker "
            f"{worker.scheduler.address} --nworkers 2 --nthreads 1"
        )
    if there != asked_by:
        raise WorkersError(
            f"the worker at {worker.address} has squeezefilm {there}, and here it is {asked_by}; "
            "install the same squeezefilm, NumPy, SciPy and numba there and start it again, so "
            "that answers are of one code"
        )
    return computed(function, arguments)


class Processes(Workers):
    """`jobs` processes, begun when they have something to do, or at once where it is known what
    they will be asked (`first`), which takes a second or two to load; they end at the end of the
    block, and with this process."""

    def __init__(self, jobs: int, first: Callable[..., Any] | None = None) -> None:
        self._jobs, self._first = jobs, first
        # Each its own executor: only so a task goes to the process that has its plate.
        self._executors: list[ProcessPoolExecutor] = []
        self._before: set[Any] = set()

    def __enter__(self) -> Processes:
        self._before = set(multiprocessing.active_children())
        if self._first is not None:
            self._executors = [_executor() for _ in range(self._jobs)]
            for executor in self._executors:
                _submitted(executor, callable, self._first)
        return self

    def __exit__(self, *_: object) -> None:
        self._end()

    def _asked(
        self,
        function: Callable[..., A],
        tasks: Mapping[K, tuple[Any, ...]],
        groups: Sequence[Sequence[K]],
    ) -> Iterator[tuple[K, A | NoAnswer]]:
        shares = Shares(groups)
        running: dict[Future[A], tuple[int, K]] = {}

        def begin(process: int) -> None:
            key = shares.next(process)
            if key is None:
                return
            if process == len(self._executors):
                self._executors.append(_executor())
            try:
                future = _submitted(self._executors[process], computed, function, tasks[key])
            except BrokenProcessPool:  # it died while it had nothing to do
                self._renew(process)
                future = _submitted(self._executors[process], computed, function, tasks[key])
            running[future] = process, key

        try:
            for process in range(min(self._jobs, sum(map(len, groups)))):
                begin(process)
            while running:
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    process, key = running.pop(future)
                    answer: A | NoAnswer = NoAnswer()
                    try:
                        answer = future.result()
                    except BrokenProcessPool:
                        self._renew(process)
                    yield key, answer
                    begin(process)
        finally:
            if running:  # stopped while some are at work: nobody waits for them
                self._end()

    def _renew(self, process: int) -> None:
        """A new process in the place of one that died."""
        self._executors[process].shutdown(wait=False)
        self._executors[process] = _executor()

    def _end(self) -> None:
        for executor in self._executors:
            executor.shutdown(wait=False, cancel_futures=True)
        self._executors = []
        left = set(multiprocessing.active_children()) - self._before
        for child in left:
            child.terminate()
        for child in left:
            child.join(2.0)
            if child.is_alive():
                child.kill()


def _executor() -> ProcessPoolExecutor:
    return ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), _prepare)


def _submitted(
    executor: ProcessPoolExecutor, function: Callable[..., A], *arguments: Any
) -> Future[A]:
    """Future answer of an executor; its process, which the first task starts, loads undisturbed."""
    with interrupts_held():
        return executor.submit(function, *arguments)


def _prepare() -> None:
    """A process of the pool: Ctrl-C ends it without a word, and so does the end of its parent."""
    with contextlib.suppress(ValueError):
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    hear_interrupts()
    end_with_parent()


@si.checked_numbers
def workers(
    jobs: Annotated[int, si.AtLeast(1)] = 1,
    scheduler: str | None = None,
    tell: SayProgress | None = None,
    first: Callable[..., Any] | None = None,
) -> AbstractContextManager[Workers]:
    """Workers that answer, for the block: this process where `jobs` is 1, else so many of their own
    beside it, or all workers of the Dask `scheduler` (``"tcp://host:8786"``) however many there
    are, `jobs` then counting for nothing. `tell` is told of a cluster who is there and where its
    dashboard is. Processes begin at once where it is known which function they are asked `first`,
    while this process has other things to do.

    Raises `InputError` where Dask is not installed, and `WorkersError` where no scheduler answers
    or its workers cannot be used. More than one process in a script needs
    ``if __name__ == "__main__":``.
    """
    if scheduler is not None:
        return Cluster(scheduler, tell or (lambda _: None))
    return contextlib.nullcontext(Workers()) if jobs == 1 else Processes(jobs, first)
