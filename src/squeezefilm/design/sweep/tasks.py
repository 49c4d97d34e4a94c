"""Tasks in, answers out: what whoever answers takes and gives, and who takes which task next.

A task is a key and the arguments of one function of a module. Those who answer are this process, a
pool of processes or a Dask cluster (`design.sweep.workers`); what asks (a sweep, a search) does not
know which. What is kept of answers is kept where they are asked for, so that a finished one is
asked for once, whoever dies.
"""

from __future__ import annotations

import collections
import itertools
import warnings
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.kept.store import in_passing

K = TypeVar("K", bound=Hashable)
A = TypeVar("A")


@dataclass(frozen=True)
class NoAnswer:
    """Entry in place of an answer, and why there is none: unless said, since whoever computed it
    died, and so did who tried it again. `lasting` is one that would be the same another time."""

    reason: str = (
        "the process that computed it ended without an answer, as one does that runs out of memory"
    )
    lasting: bool = False


def tried(work: Callable[[], A]) -> A | NoAnswer:
    """What a task's work returns, or why it does not: one of thousands must not lose the others by
    what it is refused, nor by a fault of ours, which is told. Its warnings are said by its answer,
    and what it solves is kept in passing only."""
    try:
        with in_passing(), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return work()
    except SqueezefilmError as error:
        return NoAnswer(str(error), lasting=True)
    except Exception as error:
        return NoAnswer(f"not foreseen: {type(error).__name__}: {error}")


class Workers:
    """Whoever answers: as such this process alone, in the order of the groups of tasks; nothing
    needs to be picklable then, and nobody dies. Others have their own way to be asked (`_asked`).
    """

    def answers(
        self,
        function: Callable[..., A],
        tasks: Mapping[K, tuple[Any, ...]],
        alike: Mapping[K, Hashable] | None = None,
    ) -> Iterator[tuple[K, A | NoAnswer]]:
        """Each task's key and what `function` returns of its arguments, as they come.

        `function` is one of a module; it, its arguments and what it returns can be pickled. Tasks
        that are `alike` (equal values; those that need the same plate solved) follow each other at
        one worker where that costs no time. A task whose worker died is tried again, at last alone,
        since what it needs may be all there is; `NoAnswer` stands for one that nobody survived.
        What the function raises is raised here and ends the asking, so that a refusal which is an
        answer has to be returned. It may be called again, one asking after the other; workers stay
        as they are, with what they have loaded and solved. Where the iteration is closed early,
        what is under way is ended. Raises `WorkersError` where those who answer are gone
        altogether.
        """
        alone: list[K] = []
        for key, answer in self._asked(function, tasks, grouped(tasks, alike)):
            if isinstance(answer, NoAnswer):
                alone.append(key)
            else:
                yield key, answer
        for key in alone:
            yield from self._asked(function, tasks, [[key]])

    def _asked(
        self,
        function: Callable[..., A],
        tasks: Mapping[K, tuple[Any, ...]],
        groups: Sequence[Sequence[K]],
    ) -> Iterator[tuple[K, A | NoAnswer]]:
        """Answers to groups of tasks; `NoAnswer` for one whose worker died."""
        for key in itertools.chain.from_iterable(groups):
            yield key, computed(function, tasks[key])


def computed(function: Callable[..., A], arguments: tuple[Any, ...]) -> A:
    """Compute an answer. One BLAS thread wherever it is: the same bits, and no cores that wait for
    each other."""
    with one_blas_thread():
        return function(*arguments)


def grouped(
    tasks: Mapping[K, tuple[Any, ...]], alike: Mapping[K, Hashable] | None
) -> list[list[K]]:
    """The keys in groups of those that are alike, in the order of the first of each."""
    if alike is None:
        return [[key] for key in tasks]
    groups: dict[Hashable, list[K]] = {}
    for key in tasks:
        groups.setdefault(alike[key], []).append(key)
    return list(groups.values())


class Shares(Generic[K]):
    """Choice of a worker's next task: one that is like those it did; then of a group that nobody
    has begun; then half of what another worker has most left of, which solves that plate twice."""

    def __init__(self, groups: Sequence[Sequence[K]]) -> None:
        self._waiting = collections.deque(collections.deque(group) for group in groups)
        self._own: dict[Hashable, collections.deque[K]] = {}

    def next(self, worker: Hashable) -> K | None:
        """The key of the task for a worker; None where none is left."""
        own = self._own.get(worker)
        if not own:
            own = self._waiting.popleft() if self._waiting else self._half()
            self._own[worker] = own
        return own.popleft() if own else None

    def _half(self) -> collections.deque[K]:
        most = max(self._own.values(), key=len, default=collections.deque[K]())
        return collections.deque(reversed([most.pop() for _ in range((len(most) + 1) // 2)]))
