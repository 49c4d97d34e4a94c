"""Points in, answers out: the one way by which anything that searches asks its questions.

`answered` takes points and yields an answer for each as it comes, from this process or several.
Points of one plate follow each other in one process, which keeps the plate it has solved: a sweep
over voltage, force or finger solves it once. A sweep knows its points beforehand; a search would
make them of the answers before, and another computer would answer behind the same function.
"""

from __future__ import annotations

import collections
import contextlib
import itertools
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from typing import Any

from squeezefilm.display import Display
from squeezefilm.errors import SqueezefilmError
from squeezefilm.kept_arrays import in_passing
from squeezefilm.plate.layout import Actuator
from squeezefilm.search.answers import numbers_of
from squeezefilm.search.verbs import VERBS

_ENDED = "the process that computed it ended without an answer, as one does that runs out of memory"


@dataclass(frozen=True, eq=False)
class Point:
    """One question: a display and operating options, and the verb that is asked; `samples` is the
    base of an interval's samples, 0 for none."""

    display: Display
    options: Mapping[str, Any]
    verb: str
    samples: int = 0


@dataclass(frozen=True, eq=False)
class Answer:
    """What a verb said of a point: its numbers by dotted key, its warnings, what it took (s), and
    where it refused, the reason. `lasting` is an answer that would be the same another time;
    `modes` are those to be followed, with their motions."""

    numbers: Mapping[str, float]
    warnings: tuple[str, ...] = ()
    reason: str = ""
    seconds: float = 0.0
    lasting: bool = True
    modes: Mapping[str, Any] | None = field(default=None, repr=False)


def answer_of(point: Point) -> Answer:
    """The answer to one point, in this process. What is refused or fails is an answer, too."""
    import warnings

    began = time.perf_counter()
    verb = VERBS[point.verb]
    try:
        # A sweep keeps its answers, and not the plates.
        with in_passing(), warnings.catch_warnings():
            # Verbs collect those that are of the answer.
            warnings.simplefilter("ignore")
            display = verb.display(point.display, point.options)
            said = verb.answer(display, verb.settings(point.options), point.samples)
    except SqueezefilmError as error:
        return Answer({}, reason=str(error), seconds=time.perf_counter() - began)
    except Exception as error:
        # One point out of many: the others must not be lost by a fault of ours, which is told.
        reason = f"not foreseen: {type(error).__name__}: {error}"
        return Answer({}, reason=reason, seconds=time.perf_counter() - began, lasting=False)
    return Answer(
        dict(numbers_of(said)),
        tuple(said.get("warnings", ())),
        seconds=time.perf_counter() - began,
        modes=said if "motions" in said else None,
    )


def answered(
    points: Sequence[Point], *, jobs: int = 1, answer: Callable[[Point], Answer] = answer_of
) -> Iterator[tuple[int, Answer]]:
    """Each point's number and its answer, as they come, from `jobs` processes.

    Points of equal plates are answered one after the other. One process: this one. `answer` must be
    a function of a module where there are more. A process that dies costs the point it was at,
    which is tried again when no other runs. If the iteration is stopped or interrupted, processes
    end at once.
    """
    groups = of_one_plate(points)
    if jobs <= 1 or len(points) <= 1:
        for number in itertools.chain.from_iterable(groups):
            yield number, answer(points[number])
        return
    alone = []
    for number, found in _pooled(points, Shares(groups), min(jobs, len(points)), answer):
        if found is None:
            alone.append(number)
        else:
            yield number, found
    for number in alone:
        for _, found in _pooled(points, Shares([[number]]), 1, answer):
            yield number, found or Answer({}, reason=_ENDED, lasting=False)


def of_one_plate(points: Sequence[Point]) -> list[list[int]]:
    """The numbers of points in groups of equal actuators, in the order of the first of each."""
    groups: dict[Actuator, list[int]] = {}
    for number, point in enumerate(points):
        groups.setdefault(point.display.actuator, []).append(number)
    return list(groups.values())


class Shares:
    """Which point a process takes next: of the plate that it has solved; then of one that nobody
    has begun; then half of what another process has most left of, which solves that plate twice."""

    def __init__(self, groups: Sequence[Sequence[int]]) -> None:
        self._waiting = collections.deque(collections.deque(one) for one in groups)
        self._own: dict[int, collections.deque[int]] = {}

    def next(self, process: int) -> int | None:
        """The number of the point for a process; None where none is left."""
        own = self._own.get(process)
        if not own:
            own = self._waiting.popleft() if self._waiting else self._half()
            self._own[process] = own
        return own.popleft() if own else None

    def _half(self) -> collections.deque[int]:
        most = max(self._own.values(), key=len, default=collections.deque[int]())
        return collections.deque(reversed([most.pop() for _ in range((len(most) + 1) // 2)]))


def _pooled(
    points: Sequence[Point], shares: Shares, jobs: int, answer: Callable[[Point], Answer]
) -> Iterator[tuple[int, Answer | None]]:
    """Answers of processes that take one point at a time; None for one that a process died of."""
    before = set(multiprocessing.active_children())
    # Each its own executor: only so a point goes to the process that has its plate.
    executors = [_executor() for _ in range(jobs)]
    running: dict[Future[Answer], tuple[int, int]] = {}

    def begin(process: int) -> None:
        number = shares.next(process)
        if number is not None:
            running[executors[process].submit(answer, points[number])] = process, number

    try:
        for process in range(jobs):
            begin(process)
        while running:
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                process, number = running.pop(future)
                found = None
                try:
                    found = future.result()
                except BrokenProcessPool:
                    executors[process].shutdown(wait=False)
                    executors[process] = _executor()
                yield number, found
                begin(process)
    finally:
        for executor in executors:
            executor.shutdown(wait=False, cancel_futures=True)
        left = set(multiprocessing.active_children()) - before
        for child in left:
            child.terminate()
        for child in left:
            child.join(2.0)
            if child.is_alive():
                child.kill()


def _executor() -> ProcessPoolExecutor:
    return ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), _prepare)


def _prepare() -> None:
    """A process of the pool: Ctrl-C ends it without a word, and so does the end of its parent."""
    with contextlib.suppress(ValueError):
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
