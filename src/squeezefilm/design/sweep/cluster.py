"""The workers of a Dask cluster as those who answer.

A worker sends its answer through the scheduler in the moment in which it has it, ahead of the word
that the task is done, and the task is then forgotten. With futures alone the answer would lie at
the worker until it is fetched, and be computed again if the worker died before.
"""

from __future__ import annotations

import collections
import contextlib
import functools
import itertools
import logging
import pickle
import queue
import time
import uuid
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from types import TracebackType
from typing import Any, Generic

from squeezefilm import __version__
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import WorkersError, optional
from squeezefilm.core.kept.computed_by import computed_by
from squeezefilm.core.progress import SayProgress
from squeezefilm.design.sweep.tasks import A, K, Lost, Shares, computed, grouped, tried_again

_AHEAD, _AHEAD_OF_QUICK = 2, 32
_QUICK: si.Second = 0.1
"""Tasks at a worker: one under way, and one so that it need not wait; more where a task takes less
than the way there and back."""
_LOOK: si.Second = 1.0
"""Time between two looks at who is there."""
_ANSWERS: si.Second = 20.0
_PATIENCE: si.Second = 120.0
"""Longest silence of a scheduler, and longest wait for workers of a cluster."""


class Cluster:
    """The workers of the scheduler at an address, as many as there are at any time.

    Raises `MissingPackageError` where Dask is not installed, and on entry `WorkersError` where
    nothing answers at the address.
    """

    def __init__(self, address: str, tell: SayProgress) -> None:
        with optional("cluster", "a scheduler (not the processes of this machine, jobs)"):
            import distributed
        self._dask, self._address, self._tell = distributed, address, tell
        self._client: Any = None
        self._admitted: list[str] = []
        self._looked = self._seen = 0.0
        self._waits = False
        # One topic for all askings: the scheduler keeps the last answers of each.
        self._topic, self._numbers = f"answers-{uuid.uuid4().hex}", itertools.count()
        self._listener: Callable[[int, bytes], None] | None = None

    def __enter__(self) -> Cluster:
        # What it says of a scheduler that is gone is said by us, and in one sentence.
        logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
        try:
            client: Any = self._dask.Client
            self._client = client(self._address, timeout=_ANSWERS, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            raise WorkersError(
                f"no scheduler answers at {self._address}; start one with: dask scheduler"
            ) from error
        self._client.subscribe_topic(self._topic, self._heard)
        self._seen = time.monotonic()
        offered = self._client.scheduler_info(n_workers=0).get("services", {})
        where = f", dashboard at {self._client.dashboard_link}" if "dashboard" in offered else ""
        self._tell(f"scheduler at {self._address}{where}")
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        # One that is gone is not waited for.
        with contextlib.suppress(Exception):
            self._client.close(timeout=2)

    def answers(
        self,
        function: Callable[..., A],
        tasks: Mapping[K, tuple[Any, ...]],
        alike: Mapping[K, Hashable] | None = None,
    ) -> Iterator[tuple[K, A | Lost]]:
        """Answers as by `Workers.answers`. Workers come and go; a task is tried again as often as
        the scheduler's `allowed-failures` says, and then once alone. Where the iteration is closed
        early, workers end the task they are at."""
        yield from tried_again(
            functools.partial(self._asked, function, tasks), grouped(tasks, alike)
        )

    def _asked(
        self,
        function: Callable[..., A],
        tasks: Mapping[K, tuple[Any, ...]],
        groups: Sequence[Sequence[K]],
    ) -> Iterator[tuple[K, A | Lost]]:
        asking: _Asking[K, A] = _Asking(self._client, self._topic, self._numbers, function)
        self._listener = asking.take
        shares = Shares(groups)
        left = sum(map(len, groups))
        try:
            while left:
                present = self._present()
                asking.hand_out(present, shares, tasks)
                asking.seek(present, tasks)
                for key, answer in asking.arrived(self._address):
                    left -= 1
                    yield key, answer
        finally:
            self._listener = None
            asking.end()

    def _heard(self, event: tuple[float, tuple[int, bytes]]) -> None:
        if self._listener is not None:
            self._listener(*event[1])

    def _present(self) -> Sequence[str]:
        """The addresses of the workers, looked up now and then. Raises `WorkersError` where there
        was none for too long, and for those that cannot be used."""
        now = time.monotonic()
        if self._admitted and now - self._looked < _LOOK:
            return self._admitted
        self._looked = now
        try:
            threads = self._client.sync(self._client.scheduler.ncores, callback_timeout=_ANSWERS)
        except Exception as error:
            raise _gone(self._address) from error
        self._admit(threads, sorted(set(threads) - set(self._admitted)))
        self._admitted = [thread for thread in threads if thread in self._admitted]
        if self._admitted:
            self._seen = now
        elif now - self._seen > _PATIENCE:
            raise WorkersError(
                f"the scheduler at {self._address} has had no worker for {_PATIENCE:.0f} s; start "
                f"some with: dask worker {self._address} --nworkers 2 --nthreads 1"
            )
        elif not self._waits:
            self._tell(f"waiting for workers at {self._address}")
        self._waits = not self._admitted
        return self._admitted

    def _admit(self, threads: Mapping[str, int], new: Sequence[str]) -> None:
        """Take in workers that came. Raises `WorkersError` for what they are to be like."""
        if not new:
            return
        crowded = [address for address in new if threads[address] > 1]
        if crowded:
            raise WorkersError(
                f"the worker at {crowded[0]} has {threads[crowded[0]]} threads, which would wait "
                f"for each other; start workers with one thread each: dask worker {self._address} "
                "--nworkers 2 --nthreads 1"
            )
        try:
            said = self._client.run(_code_here, workers=list(new), on_error="return")
        except Exception:
            return  # gone again, or so is the scheduler: seen when one looks next
        here = _code_here()
        for worker, there in said.items():
            if isinstance(there, ImportError):
                raise WorkersError(
                    f"the worker at {worker} has no squeezefilm; install {__version__} there"
                )
            if isinstance(there, str) and there != here:
                raise WorkersError(
                    f"the worker at {worker} has squeezefilm {there}, and here it is {here}; "
                    "install the same squeezefilm, NumPy, SciPy and numba there and start it "
                    "again, so that answers are of one code"
                )
            if isinstance(there, str):
                self._admitted.append(worker)


class _Asking(Generic[K, A]):
    """A question under way: which task is where, and what came of it."""

    def __init__(
        self, client: Any, topic: str, numbers: Iterator[int], function: Callable[..., A]
    ) -> None:
        self._client, self._topic, self._numbers, self._function = client, topic, numbers, function
        self._keys: dict[int, K] = {}
        self._where: dict[int, str] = {}
        self._futures: dict[int, Any] = {}
        self._there: set[int] = set()
        self._came: queue.SimpleQueue[tuple[int, Any]] = queue.SimpleQueue()
        self._began, self._answered = time.monotonic(), 0
        self._sought, self._missed = self._began, set[int]()

    def hand_out(
        self, workers: Sequence[str], shares: Shares[K], tasks: Mapping[K, tuple[Any, ...]]
    ) -> None:
        """Give workers what they may have at a time, one to each before a second to any."""
        busy = collections.Counter(self._where.values())
        spent = (time.monotonic() - self._began) * len(workers)
        quick = spent < _QUICK * self._answered
        for most in range(1, (_AHEAD_OF_QUICK if quick else _AHEAD) + 1):
            for worker in (address for address in workers if busy[address] < most):
                key = shares.next(worker)
                if key is None:
                    return
                busy[worker] += 1
                self._submit(worker, key, tasks[key])

    def arrived(self, address: str) -> Iterator[tuple[K, A | Lost]]:
        """Answers that have come; where nothing has, what comes within a second. Raises what a task
        raised, and `WorkersError` where the scheduler is gone."""
        with contextlib.suppress(queue.Empty):
            came = [self._came.get(timeout=_LOOK)]
            while not self._came.empty():
                came.append(self._came.get())
            for number, what in came:
                # That a task is done is heard after its answer, and says nothing more.
                if number in self._keys and getattr(what, "status", "") != "finished":
                    answer = self._answer(what, address)
                    self._where.pop(number)
                    self._forget(number)
                    self._answered += 1
                    yield self._keys.pop(number), answer

    def seek(self, workers: Sequence[str], tasks: Mapping[K, tuple[Any, ...]]) -> None:
        """Ask again for tasks that nobody does: Dask gives those of a worker that died to another,
        but where there was no other just then it goes on waiting for the one that died."""
        if not workers or time.monotonic() - self._sought < _LOOK:
            return
        self._sought = time.monotonic()
        astray = [number for number, worker in self._where.items() if worker not in workers]
        missed: set[int] = set()
        if astray:
            with contextlib.suppress(Exception):  # a scheduler that is gone is told elsewhere
                done = {key for keys in self._client.processing().values() for key in keys}
                missed = {
                    n for n in astray if n in self._futures and self._futures[n].key not in done
                }
        # An answer may be on its way: what is missed twice.
        for number in missed & self._missed:
            self._where.pop(number)
            self._forget(number)
            key = self._keys.pop(number)
            self._submit("", key, tasks[key])
        self._missed = missed

    def end(self) -> None:
        """End: nothing more is wanted."""
        with contextlib.suppress(Exception):
            self._client.cancel(list(self._futures.values()))
        self._futures.clear()

    def _submit(self, worker: str, key: K, arguments: tuple[Any, ...]) -> None:
        """Have a task done, by a worker if it can be, or by any."""
        number = next(self._numbers)
        self._keys[number], self._where[number] = key, worker
        future = self._client.submit(
            _work,
            self._topic,
            number,
            worker,
            self._function,
            arguments,
            key=f"{getattr(self._function, '__name__', 'task')}-{self._topic}-{number}",
            workers=[worker] if worker else None,
            allow_other_workers=bool(worker),
            pure=False,
        )
        self._futures[number] = future
        future.add_done_callback(lambda answer: self._came.put((number, answer)))
        if number in self._there:
            self._forget(number)

    def take(self, number: int, data: bytes) -> None:
        """An answer; called by Dask's thread. The task is forgotten at once, so that nobody does it
        again when its worker dies before the answer is looked at."""
        self._there.add(number)
        self._came.put((number, data))
        self._forget(number)

    def _forget(self, number: int) -> None:
        future = self._futures.pop(number, None)
        if future is not None:
            future.release()

    def _answer(self, what: Any, address: str) -> A | Lost:
        """Answer that was sent, or that a future tells of."""
        if isinstance(what, bytes):
            answer: A = pickle.loads(what)
            return answer
        if what.status != "error":
            raise _gone(address)
        error = what.exception()
        if type(error).__name__ == "KilledWorker":
            return Lost()
        raise error


def _gone(address: str) -> WorkersError:
    return WorkersError(
        f"the scheduler at {address} answers no more; start it and its workers again, and ask "
        "again: what was answered and kept is not computed again"
    )


def _code_here() -> str:
    return f"{__version__} (code {computed_by()[:8]})"


def _work(
    topic: str, number: int, meant: str, function: Callable[..., Any], arguments: tuple[Any, ...]
) -> None:
    """Do one task at a worker, that for which it was `meant` or another: its answer goes out before
    the word that it is done."""
    from distributed import get_worker
    from distributed.utils import sync

    worker, sent = get_worker(), f"{topic}-sent"
    if worker.address != meant:
        # The one before may have died between its answer and that word.
        events = sync(worker.loop, worker.scheduler.events, topic=sent)
        if any(one == number for _, one in events):
            return
    answer = pickle.dumps(computed(function, arguments))
    worker.log_event(sent, number)
    worker.log_event(topic, (number, answer))
