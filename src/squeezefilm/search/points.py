"""Points in, answers out: the one way by which anything that searches asks its questions.

`answered` takes points and yields an answer for each as it comes, from this process or several. A
sweep knows its points beforehand; a search would make them of the answers before, and another
computer would answer behind the same function.
"""

from __future__ import annotations

import contextlib
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
        with warnings.catch_warnings():
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

    One process: this one, in order. `answer` must be a function of a module where there are more. A
    process that dies takes along what the others were at: each of these is tried again by itself.
    If the iteration is stopped or interrupted, processes end at once.
    """
    if jobs <= 1 or len(points) <= 1:
        for number, point in enumerate(points):
            yield number, answer(point)
        return
    left, alone = list(range(len(points))), []
    while left:
        seen: set[int] = set()
        for number, found in _pooled(points, left, min(jobs, len(left)), answer):
            seen.add(number)
            if found is None:
                alone.append(number)
            else:
                yield number, found
        # All, unless a process died: then those that nobody has begun.
        left = [number for number in left if number not in seen]
    for number in alone:
        for _, found in _pooled(points, [number], 1, answer):
            yield number, found or Answer({}, reason=_ENDED, lasting=False)


def _pooled(
    points: Sequence[Point], numbers: Sequence[int], jobs: int, answer: Callable[[Point], Answer]
) -> Iterator[tuple[int, Answer | None]]:
    """Answers of a pool of processes; None for those that were lost with a process, and no more
    after them."""
    before = set(multiprocessing.active_children())
    pool = ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _prepare)
    todo = iter(numbers)
    running: dict[Future[Answer], int] = {}
    try:
        # A few more than processes: a pool that breaks takes along no more than these.
        for number in todo:
            running[pool.submit(answer, points[number])] = number
            if len(running) >= jobs + 1:
                break
        while running:
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                number = running.pop(future)
                try:
                    yield number, future.result()
                    following = next(todo, None)
                    if following is not None:
                        running[pool.submit(answer, points[following])] = following
                except BrokenProcessPool:
                    for lost in (number, *running.values()):
                        yield lost, None
                    return
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        left = set(multiprocessing.active_children()) - before
        for process in left:
            process.terminate()
        for process in left:
            process.join(2.0)
            if process.is_alive():
                process.kill()


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
