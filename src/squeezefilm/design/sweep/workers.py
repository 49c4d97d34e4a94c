"""Workers that answer: this process, processes of this machine, or a Dask cluster; one method wide.

with workers(jobs=2) as pool:                      # or workers(scheduler="tcp://host:8786")
    for key, answer in pool.answers(function, {key: (argument, ...), ...}):
        ...
"""

from __future__ import annotations

import contextlib
import functools
import multiprocessing
import signal
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import Annotated, Any

from squeezefilm.core import quantities as si
from squeezefilm.core.interrupts import end_with_parent, hear_interrupts, interrupts_held
from squeezefilm.core.progress import SayProgress
from squeezefilm.design.sweep.tasks import (
    A,
    K,
    Lost,
    Shares,
    ThisProcess,
    Workers,
    computed,
    grouped,
    tried_again,
)


class Processes:
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

    def answers(
        self,
        function: Callable[..., A],
        tasks: Mapping[K, tuple[Any, ...]],
        alike: Mapping[K, Hashable] | None = None,
    ) -> Iterator[tuple[K, A | Lost]]:
        """Answers as by `Workers.answers`."""
        yield from tried_again(
            functools.partial(self._asked, function, tasks), grouped(tasks, alike)
        )

    def _asked(
        self,
        function: Callable[..., A],
        tasks: Mapping[K, tuple[Any, ...]],
        groups: Sequence[Sequence[K]],
    ) -> Iterator[tuple[K, A | Lost]]:
        """Answers of the processes; `Lost` for one that a process died of."""
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
                    answer: A | Lost = Lost()
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


@contextmanager
@si.checked_numbers
def workers(
    jobs: Annotated[int, si.AtLeast(1)] = 1,
    scheduler: str | None = None,
    tell: SayProgress | None = None,
    first: Callable[..., Any] | None = None,
) -> Iterator[Workers]:
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
        from squeezefilm.design.sweep.cluster import Cluster

        with Cluster(scheduler, tell or (lambda _: None)) as cluster:
            yield cluster
    elif jobs == 1:
        yield ThisProcess()
    else:
        with Processes(jobs, first) as processes:
            yield processes
