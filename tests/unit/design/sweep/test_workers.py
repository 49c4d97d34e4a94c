"""Who answers is chosen in one place; a process that dies is replaced, and its task tried again."""

from __future__ import annotations

import collections
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from typing import Any

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.sweep import workers as pools
from squeezefilm.design.sweep.tasks import NoAnswer, Workers
from squeezefilm.design.sweep.workers import Processes, workers


def test_one_process_is_this_one_and_more_are_a_pool() -> None:
    with workers() as pool:
        assert type(pool) is Workers
        assert dict(pool.answers(divmod, {"a": (7, 2)})) == {"a": (3, 1)}
    with workers(jobs=2) as pool:
        assert isinstance(pool, Processes)


def test_no_process_answers_nothing() -> None:
    with pytest.raises(InputError, match="jobs = 0"), workers(jobs=0):
        pass


class StandIn:
    """Stands where an executor of one process was: it answers at once, dies of some tasks, and is
    of no use from then on."""

    made: list[StandIn]

    def __init__(self) -> None:
        self.broken = self.idle_death = False
        self.did: list[Any] = []
        self.ended: list[dict[str, bool]] = []
        self.made.append(self)

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """The answer, or the end of the process."""
        if self.broken or self.idle_death:
            raise BrokenProcessPool
        future: Future[Any] = Future()
        self.did.append(arguments)
        try:
            future.set_result(function(*arguments))
        except ZeroDivisionError as error:
            future.set_exception(error)
        except MemoryError:
            self.broken = True
            future.set_exception(BrokenProcessPool())
        return future

    def shutdown(self, **how: bool) -> None:
        """Keep how it was ended."""
        self.ended.append(how)


@pytest.fixture
def executors(monkeypatch: pytest.MonkeyPatch) -> list[StandIn]:
    """The executors that are begun, in their order."""
    StandIn.made = []
    monkeypatch.setattr(pools, "_executor", StandIn)
    return StandIn.made


def test_no_more_processes_are_begun_than_there_are_tasks(executors: list[StandIn]) -> None:
    with workers(jobs=5) as pool:
        assert executors == []
        assert dict(pool.answers(divmod, {k: (k, 3) for k in range(2)})) == {0: (0, 0), 1: (0, 1)}
        assert len(executors) == 2
        assert len(dict(pool.answers(divmod, {k: (k, 3) for k in range(9)}))) == 9
        assert len(executors) == 5
    assert all(executor.ended for executor in executors)


def test_processes_that_are_known_to_be_asked_begin_at_once(executors: list[StandIn]) -> None:
    with workers(jobs=3, first=divmod):
        assert [executor.did for executor in executors] == [[(divmod,)]] * 3


def test_a_task_that_every_process_dies_of_is_lost_and_no_other(executors: list[StandIn]) -> None:
    tried: collections.Counter[int] = collections.Counter()

    def deadly(key: int) -> int:
        tried[key] += 1
        if key == 3:
            raise MemoryError
        return key * key

    with workers(jobs=2) as pool:
        found = dict(pool.answers(deadly, {k: (k,) for k in range(6)}))
    assert found == {k: k * k for k in range(6) if k != 3} | {3: NoAnswer()}
    # Beside others, and once more alone; each time another process takes the place of the dead.
    assert (tried.pop(3), set(tried.values())) == (2, {1})
    assert len(executors) == 4
    assert sum(executor.broken for executor in executors) == 2


def test_a_task_that_one_process_died_of_is_answered_by_the_next(executors: list[StandIn]) -> None:
    died: list[int] = []

    def once(key: int) -> int:
        if not died:
            died.append(key)
            raise MemoryError
        return -key

    with workers(jobs=2) as pool:
        answers = list(pool.answers(once, {k: (k,) for k in range(1, 5)}))
    assert dict(answers) == {k: -k for k in range(1, 5)}
    assert answers[-1][0] == died[0]


def test_a_process_that_died_idle_is_replaced_when_it_is_asked(executors: list[StandIn]) -> None:
    with workers(jobs=1 + 1) as pool:
        assert dict(pool.answers(abs, {k: (-k,) for k in range(2)})) == {0: 0, 1: 1}
        executors[0].idle_death = True
        assert dict(pool.answers(abs, {k: (-k,) for k in range(2)})) == {0: 0, 1: 1}
        assert executors[0].ended == [{"wait": False}]
        assert len(executors) == 3


def test_what_a_task_raises_ends_the_asking_and_what_is_under_way(
    executors: list[StandIn],
) -> None:
    with workers(jobs=2) as pool:
        with pytest.raises(ZeroDivisionError):
            list(pool.answers(divmod, {1: (1, 0), 2: (1, 1), 3: (2, 1)}))
        assert [executor.ended for executor in executors] == [
            [{"wait": False, "cancel_futures": True}]
        ] * 2
        # The next asking begins new ones.
        assert dict(pool.answers(divmod, {1: (1, 1)})) == {1: (1, 0)}
        assert len(executors) == 3


def test_tasks_that_are_alike_go_to_one_process(executors: list[StandIn]) -> None:
    tasks = {k: (k,) for k in range(8)}
    with workers(jobs=2) as pool:
        assert dict(pool.answers(abs, tasks, {k: k % 2 for k in tasks})) == {k: k for k in tasks}
    # The last argument is the task's: an executor is given what computes it first.
    for executor in executors:
        assert len({arguments[0] % 2 for _, arguments in executor.did}) == 1
